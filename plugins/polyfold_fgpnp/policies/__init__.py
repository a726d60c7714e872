"""Fold-line-guided pick-and-place policies.

Every one of them has the same three stages: :func:`polyfold_fgpnp.policies.region.fold_region` keeps what the line
lifts, the policy chooses two contour pixels of it, by affordance or by a learned value, and
:func:`polyfold_fgpnp.policies.actions.to_action` mirrors them into an action.
"""
