"""Registers the example's policy. Nothing heavy is imported here: the target is a string."""

from polyfold import hookimpl


@hookimpl
def register_policies(register):
    """Register the policy."""
    register("middle", "polyfold_example.middle:Middle", "picks on both sides of the flap's middle")
