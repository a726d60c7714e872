"""Checks that a plugin does what its components promise, for the plugin's own tests.

The whole test file of a plugin called ``my-plugin``::

    from polyfold.testing import conformance
    test_conformance = conformance("my-plugin")

Each check of each component is a test of its own. ``polyfold check my-plugin`` runs the same without pytest. They hold
components to what stands in :mod:`polyfold.plugins.interfaces`.
"""

from polyfold.testing._running import check, conformance

__all__ = ["check", "conformance"]
