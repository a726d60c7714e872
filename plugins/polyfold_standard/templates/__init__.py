"""Polygon templates: the four standard kinds, and shorts and towels for real data."""

from polyfold_standard.templates.pants import pants_template
from polyfold_standard.templates.quads import rectangle_template, square_template, towel_template
from polyfold_standard.templates.shorts import shorts_template
from polyfold_standard.templates.tshirt import tshirt_template

__all__ = [
    "pants_template",
    "rectangle_template",
    "shorts_template",
    "square_template",
    "towel_template",
    "tshirt_template",
]
