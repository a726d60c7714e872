"""The square's template."""

from polyfold_standard.templates.quads import square_template

__all__ = ["square_template"]
