"""The parameterized polygon model: templates of garment kinds, and the model of a garment that has been folded.

A new kind of garment needs one :class:`Template`; see its docstring for a complete example.
"""

from polyfold.polygon._folded import FoldedModel
from polyfold.polygon._generator import Generator, SymmetricGenerator
from polyfold.polygon._penalties import Penalty, angle_range, offset_range, position_range, ratio_range
from polyfold.polygon._template import Template

__all__ = [
    "FoldedModel",
    "Generator",
    "Penalty",
    "SymmetricGenerator",
    "Template",
    "angle_range",
    "offset_range",
    "position_range",
    "ratio_range",
]
