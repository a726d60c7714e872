"""The parameterized polygon model: templates of garment kinds, and the model of a garment that has been folded.

A new kind of garment needs one :class:`Template`; see its docstring for a complete example.
"""

from polyfold.polygon.folded import FoldedModel, VertexState
from polyfold.polygon.generator import Generator, SymmetricGenerator
from polyfold.polygon.layers import Facet, fold_facets
from polyfold.polygon.penalties import Penalty, PenaltySet, angle_range, offset_range, position_range, ratio_range
from polyfold.polygon.template import Template

__all__ = [
    "Facet",
    "FoldedModel",
    "Generator",
    "Penalty",
    "PenaltySet",
    "SymmetricGenerator",
    "Template",
    "VertexState",
    "angle_range",
    "fold_facets",
    "offset_range",
    "position_range",
    "ratio_range",
]
