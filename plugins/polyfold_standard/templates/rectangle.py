"""The rectangle's template."""

from polyfold_standard.templates.quads import rectangle_template

__all__ = ["rectangle_template"]
