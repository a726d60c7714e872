"""The template of shorts: the vertices of pants with shorter, wider legs."""

from __future__ import annotations

from functools import cache

from polyfold.polygon import Template
from polyfold_standard.templates.pants import leg_penalties, leg_shape, two_legged

__all__ = ["shorts_template"]


@cache
def shorts_template() -> Template:
    """Shorts, also seen obliquely."""
    return two_legged(
        "shorts",
        shapes=[
            leg_shape(waist=0.2, length=0.45, rise=0.28, gap=0.04, leg=0.24),
            leg_shape(waist=0.2, length=0.35, rise=0.24, gap=0.04, leg=0.24),
            leg_shape(waist=0.2, length=0.55, rise=0.3, gap=0.04, leg=0.2),
        ],
        penalties=leg_penalties(
            slender=(0.4, 2.2), rise=(0.35, 0.92), leg=(0.35, 0.95), outer=(-12, 50), crotch=(0.3, 0.7)
        ),
    )
