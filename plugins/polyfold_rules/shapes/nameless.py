"""The fold line of one fold on a cloth of which only the outline's corners are known.

Names are gone as soon as something was folded, so there has been a fold before, but not which one. What the outline
does not tell is taken from what usually goes before such a fold, and the reasoning says so.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import FoldLine
from polyfold.tasks import mirror_line
from polyfold_rules.shapes.creases import Crease
from polyfold_rules.shapes.folds import OPPOSITE_EDGE, Fold
from polyfold_rules.shapes.outlines import Outline
from polyfold_rules.shapes.parts import NotUnderstoodError
from polyfold_rules.shapes.shirts import hem_corner, shoulder, sleeve_of

Point = NDArray[np.float64]

_TOGETHER = 10.0
"""Points nearer than this [px] give a line no direction."""

_LEG = 3.5
"""Trousers on which one leg lies on the other are at least this many times as long as wide at the waist, unless a third
is folded over; with both legs side by side the bound is half as much."""

_PAIR = 2.5
"""Trousers with both legs side by side are at most this many times as long as wide at the waist."""


def crease_of_outline(fold: Fold, outline: Outline) -> Crease:
    """The directed line of a fold.

    Raises:
        NotUnderstoodError: if the outline does not show what the fold needs.
    """
    find = {"sleeve": _sleeve, "corner": _corner, "middle": _middle, "band": _band, "half": _half}[fold.action]
    crease = find(fold, outline)
    said = (
        "The points have no names, so something has been folded already; I go by the outline. Its direction nearest to "
        f"upright is turned by {outline.tilt:.0f} degrees. "
    )
    return Crease(_reaching(crease.line, outline), said + crease.reasoning, crease.via_pick)


def _say(point: Point) -> str:
    return f"({point[0]:.0f}, {point[1]:.0f})"


def _reaching(line: FoldLine, outline: Outline) -> FoldLine:
    """The line across the outline, clipped to the image."""
    start = np.asarray(line.start)
    along = np.subtract(line.end, line.start) / line.length
    reach = (outline.corners - start) @ along
    low, high = float(reach.min()), float(reach.max())
    for axis in (0, 1):
        if abs(along[axis]) > 1e-9:
            a, b = sorted(((0 - start[axis]) / along[axis], (outline.size[axis] - 1 - start[axis]) / along[axis]))
            low, high = max(low, a), min(high, b)
    if high - low < _TOGETHER:
        raise NotUnderstoodError("the fold line would lie outside the image")
    return FoldLine.between(start + low * along, start + high * along)


def _sleeve(fold: Fold, outline: Outline) -> Crease:
    side = fold.part
    sleeve = sleeve_of(outline, side)
    straight = fold.manner == "straight"
    upper, name = (sleeve.shoulder, "shoulder") if straight else (sleeve.neck, "collar's end")
    line = FoldLine.between(sleeve.armpit, upper)
    line = line if line.distance(sleeve.cuff) > 0 else line.reversed()
    return Crease(
        line,
        f"The concave corner at {_say(sleeve.armpit)} is the {side} armpit, the sleeve hangs out around "
        f"{_say(sleeve.cuff)}, and the {name} of that side is at {_say(upper)}. I read the fold line off the shape: "
        f"from the armpit to the {name}, directed so that the sleeve lies to its left.",
    )


def _corner(fold: Fold, outline: Outline) -> Crease:
    pick = outline.corner(fold.part)
    low, high = outline.extent()
    place = outline.pixel((low + high) / 2) if fold.target == "centre" else outline.corner(fold.target)
    name = "the centre of the outline's extent" if fold.target == "centre" else f"the corner {fold.target}"
    if np.hypot(*(pick - place)) < _TOGETHER:
        raise NotUnderstoodError(f"{fold.part} lies on {name} already, so no fold is left to do")
    return Crease(
        FoldLine.moving(pick, place),
        f"I reason through one pick and place: pick {fold.part} at {_say(pick)}, place it on {name} at {_say(place)}. "
        "The fold line is the perpendicular bisector between the two, directed so that the pick lies to its left.",
        via_pick=True,
    )


def _half(fold: Fold, outline: Outline) -> Crease:
    edge = _longer(fold.part, outline) if fold.part in ("long", "short") else fold.part
    if outline.kind == "tshirt" and fold.manner != "again" and edge in ("top", "bottom"):
        return _hem_and_shoulders(edge, outline)
    return _across(edge, outline, 0.5, "halfway to the border opposite")


def _hem_and_shoulders(edge: str, outline: Outline) -> Crease:
    hems = np.array([hem_corner(outline, side) for side in ("left", "right")])
    shoulders = np.array([shoulder(outline, side) for side in ("left", "right")])
    moving, resting = (hems, shoulders) if edge == "bottom" else (shoulders, hems)
    return Crease(
        mirror_line(moving, resting),
        f"The hem's corners are at {_say(hems[0])} and {_say(hems[1])}, the shoulders at {_say(shoulders[0])} and "
        f"{_say(shoulders[1])}. The fold line is the line of symmetry between them, the part that moves to its left.",
    )


def _longer(which: str, outline: Outline) -> str:
    """The edge to move when only *long* or *short* is said."""
    low, high = outline.extent()
    upright = high[1] - low[1] > high[0] - low[0]
    return "left" if upright == (which == "long") else "bottom"


def _middle(fold: Fold, outline: Outline) -> Crease:
    return _across(
        fold.part,
        outline,
        1 / 3,
        "a third of the way across what I see: most likely the opposite edge was brought to the middle line before, so "
        "that three quarters of the flat cloth's width are left and the fold line lies one quarter in. The outline "
        "alone can't tell",
    )


def _band(fold: Fold, outline: Outline) -> Crease:
    third = abs(fold.share - 1 / 3) < 0.01
    if third and _third_is_folded(outline, fold):
        why = "it is too short for whole trousers" if outline.kind == "pants" else "the outline alone can't tell"
        return _across(
            fold.part, outline, 0.5, f"halfway across what I see: the opposite third most likely lies on it; {why}"
        )
    where = f"{fold.share:.0%} of the way across what I see, which I take for whole"
    return _across(fold.part, outline, fold.share, where)


def _third_is_folded(outline: Outline, fold: Fold) -> bool:
    """Whether the opposite third most likely lies on top: trousers tell by their length, else thirds come in pairs."""
    low, high = outline.extent()
    ratio = float(high[1] - low[1]) / max(outline.width_at_top(), 1.0)
    if outline.kind != "pants" or fold.part not in ("top", "bottom"):
        return outline.kind in ("square", "rectangle")
    return ratio < _LEG / 2 or _PAIR < ratio < _LEG


def _across(edge: str, outline: Outline, share: float, where: str) -> Crease:
    """The line parallel to a border at a share of the way to the one opposite."""
    toward = outline.toward(edge)
    near, here = outline.border(edge)
    far, there = outline.border(OPPOSITE_EDGE[edge])
    level = near - share * (near + far)
    along = np.array([-toward[1], toward[0]])
    line = FoldLine.between(level * toward, level * toward + along)
    line = line if line.distance(level * toward + toward) > 0 else line.reversed()
    return Crease(
        line,
        f"The {edge} border is around {_say(here)}, the one opposite around {_say(there)}. The fold line is parallel "
        f"to them, {where}; the {edge} side, which moves, lies to its left.",
    )
