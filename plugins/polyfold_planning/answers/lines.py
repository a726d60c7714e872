"""What a fold line from a language model must keep: on the cloth, and on the side of the part that should move."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine, signed_distance
from polyfold.polygon import FoldedModel
from polyfold.types import Scene

MIN_LENGTH = 10.0
"""Shortest fold line with a trustworthy direction [px]."""

MIN_SHARE = 0.005
"""Each side of a fold line needs this share of the visible cloth."""

MOVED = 1.5
"""A vertex this far from where it lay on the flat garment [px] has been moved."""

_PART = re.compile(r"fold (?:the |its )?(?P<part>.+?) (?:\w+ )?(?:on)?to ", re.IGNORECASE)
_SIDE = re.compile(r"\b(left|right|top|bottom|upper|lower)\b")
_SAME = {"upper": "top", "lower": "bottom"}
_SEAMS = {("sleeve", "cuff"): "sleeve", ("hem",): "hem", ("waist",): "waist"}
"""Words for parts, and how the names of their vertices begin."""

_INNER = ("sleeve", "armpit", "shoulder", "neck", "crotch")
"""Vertices that a fold of a side need not take along."""


def too_short(length: float) -> str:
    """What a model is told of a fold line of so many pixels."""
    return (
        f"the fold line is {length:.0f} px long; choose two points at least {MIN_LENGTH:.0f} px apart "
        "(vertices that an earlier fold brought together coincide: use the crease's ends)"
    )


def check_fold_line(line: FoldLine, scene: Scene) -> None:
    """Inside the image, long enough, cloth on both sides.

    Raises:
        PlanError: saying what is wrong, in words for the model that wrote it.
    """
    width, height = scene.image_size
    for end, (x, y) in (("start", line.start), ("end", line.end)):
        if not (-0.5 <= x <= width - 0.5 and -0.5 <= y <= height - 0.5):
            raise PlanError(f"{end} ({x:.0f}, {y:.0f}) lies outside the {width} x {height} image; move it inside")
    if not line.length >= MIN_LENGTH:
        raise PlanError(too_short(line.length))
    ys, xs = np.nonzero(scene.mask)
    distance = signed_distance(np.column_stack([xs, ys]), line.start, line.end)
    for share, side in ((np.mean(distance > 0), "left"), (np.mean(distance < 0), "right")):
        if share < MIN_SHARE:
            raise PlanError(
                f"there is no cloth to the {side} of the fold line; move it onto the cloth, or swap start and end"
            )
    if scene.model is not None:
        scene.model.fold(line)


def check_lifted(line: FoldLine, subgoal: str, scene: Scene) -> None:
    """Compare the lifted side with the part that the subgoal names, as far as the vertices' names tell.

    Raises:
        PlanError: if all vertices of the part lie on the side that stays, in words for the model that wrote it.
    """
    found = _PART.match(subgoal)
    if scene.model is None or found is None:
        return
    points = scene.model.points()
    names = _bounding(found["part"].lower(), _unmoved(scene.model))
    if names and all(line.distance(points[name]) < 0 for name in names):
        where = ", ".join(f"{name} ({points[name][0]:.0f}, {points[name][1]:.0f})" for name in names[:3])
        raise PlanError(
            f"the subgoal moves the {found['part']}, but {where} lies to the right of the line, on the side that "
            "stays; swap start and end, or find the line anew"
        )


def _unmoved(model: FoldedModel) -> list[str]:
    """Vertices that lie where they lay on the flat garment: what was carried elsewhere may bound another part now."""
    points = model.points()
    return [name for name, at in zip(model.names, model.rest, strict=True) if np.hypot(*(points[name] - at)) < MOVED]


def _bounding(part: str, names: Sequence[str]) -> list[str]:
    """Those of the vertices that surely go with a part: of its seam, or at all its sides; none where that is open."""
    sides = {_SAME.get(side, side) for side in _SIDE.findall(part)}
    for words, stem in _SEAMS.items():
        if any(word in part for word in words):
            return [name for name in names if name.startswith(stem) and sides <= set(name.split("_"))]
    inner = [name for name in names if not name.startswith(_INNER)]
    return [name for name in inner if sides <= set(name.split("_"))] if sides else []
