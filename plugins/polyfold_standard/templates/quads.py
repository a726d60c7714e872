"""Templates of four-cornered cloths: squares, rectangles and real towels."""

from __future__ import annotations

from functools import cache

from polyfold.polygon import Penalty, SymmetricGenerator, Template, angle_range, ratio_range

CORNERS = ("bottom_left", "top_left", "top_right", "bottom_right")
LEFT, TOP, RIGHT, BOTTOM = zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True)

DESCRIPTIONS = {name: f"{name.replace('_', ' ')} corner" for name in CORNERS}

PARTS = {
    **{f"{name.replace('_', ' ')} corner": (name,) for name in CORNERS},
    "left edge": LEFT,
    "top edge": TOP,
    "right edge": RIGHT,
    "bottom edge": BOTTOM,
}


@cache
def square_template() -> Template:
    """A square cloth, one layer."""
    aspect = [ratio_range(LEFT, BOTTOM, 0.85, 1.18, 0.05), ratio_range(RIGHT, TOP, 0.85, 1.18, 0.05)]
    return _quad("square", aspects=(1.0,), corner=20.0, opposite=0.85, further=aspect)


@cache
def rectangle_template() -> Template:
    """A rectangular cloth, one layer, of any proportion up to 3 to 1."""
    aspect = [ratio_range(LEFT, BOTTOM, 0.33, 3.0)]
    return _quad("rectangle", aspects=(0.7, 1.4), corner=20.0, opposite=0.85, further=aspect)


@cache
def towel_template() -> Template:
    """A real towel seen obliquely: perspective slants its sides and foreshortens it."""
    aspect = [ratio_range(LEFT, BOTTOM, 0.2, 5.0)]
    return _quad("towel", aspects=(1.0, 0.7, 1.4, 0.5, 2.0), corner=35.0, opposite=0.6, further=aspect)


def _quad(kind: str, aspects: tuple[float, ...], corner: float, opposite: float, further: list[Penalty]) -> Template:
    """``corner``: how far an angle may be from 90 degrees. ``opposite``: least ratio of opposite sides."""
    edges = (LEFT, TOP, RIGHT, BOTTOM)
    turns = [
        angle_range(after, before, 90 - corner, 90 + corner, 4.0)
        for before, after in zip(edges, edges[1:] + edges[:1], strict=True)
    ]
    sides = [
        ratio_range(LEFT, RIGHT, opposite, 1 / opposite, 0.05),
        ratio_range(TOP, BOTTOM, opposite, 1 / opposite, 0.05),
    ]
    return Template(
        kind=kind,
        names=CORNERS,
        descriptions=DESCRIPTIONS,
        parts=PARTS,
        canonical_shapes=[[(-w, 1.0), (-w, -1.0), (w, -1.0), (w, 1.0)] for w in aspects],
        generator=SymmetricGenerator(CORNERS, [("bottom_left", "bottom_right"), ("top_left", "top_right")]),
        penalties=[*turns, *sides, *further],
        cyclic=True,
    )
