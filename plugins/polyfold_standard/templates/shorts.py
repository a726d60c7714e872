"""The template of shorts: the vertices of pants with shorter, wider legs."""

from __future__ import annotations

from functools import cache

from polyfold.polygon import Template
from polyfold_standard.templates.pants import LegRanges, leg_penalties, leg_shape, two_legged


@cache
def shorts_template() -> Template:
    """Shorts, also seen obliquely."""
    return two_legged(
        "shorts",
        shapes=[
            leg_shape(waist=0.2, length=0.43, rise=0.31, gap=0.03, leg=0.24),
            leg_shape(waist=0.2, length=0.36, rise=0.27, gap=0.02, leg=0.26),
            leg_shape(waist=0.2, length=0.5, rise=0.34, gap=0.04, leg=0.22),
        ],
        penalties=leg_penalties(
            LegRanges(
                slender=(0.88, 1.28),
                rise=(0.72, 0.78),
                crotch=(0.44, 0.56),
                gap=(0.05, 0.36),
                leg=(0.5, 0.7),
                cuff=(77.0, 97.0),
                flare=(3.0, 20.0),
                likeness=(0.86, 1.16),
            )
        ),
        # Real legs overlap at the crotch.
        covered=("crotch",),
    )
