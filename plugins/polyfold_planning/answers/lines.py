"""What a fold line from a language model must keep: on the cloth, and on the side of the part that should move."""

from __future__ import annotations

import re

import numpy as np

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine, signed_distance
from polyfold.types import Scene

MIN_LENGTH = 10.0
"""Shortest fold line with a trustworthy direction [px]."""

MIN_SHARE = 0.005
"""Each side of a fold line needs this share of the visible cloth."""

_PART = re.compile(r"fold (?:the |its )?(?P<part>.+?) (?:\w+ )?(?:on)?to ", re.IGNORECASE)
_SIDE = re.compile(r"\b(left|right|top|bottom|upper|lower)\b")
_SAME = {"upper": "top", "lower": "bottom"}


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
        raise PlanError(
            f"the fold line is {line.length:.0f} px long; choose two points at least {MIN_LENGTH:.0f} px apart "
            "(vertices that an earlier fold brought together coincide: use the crease's ends)"
        )
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
    """Compare the lifted side with the part that the subgoal names, as far as the flat garment's names tell.

    Raises:
        PlanError: if all vertices of the part lie on the side that stays, in words for the model that wrote it.
    """
    if scene.model is None:
        return
    found = _PART.match(subgoal)
    names = _vertices_of(found["part"].lower(), scene) if found else []
    if not names:
        return
    points = scene.model.points()
    away = np.array([float(line.distance(points[name])) for name in names])
    if (away < 0).all():
        where = ", ".join(f"{name} ({points[name][0]:.0f}, {points[name][1]:.0f})" for name in names[:3])
        raise PlanError(
            f"the subgoal moves the {found['part'] if found else 'part'}, but {where} lies to the right of the line, "
            "on the side that stays; swap start and end, or find the line anew"
        )


def _vertices_of(part: str, scene: Scene) -> list[str]:
    """Vertices that surely move with a part: those of its name, where nothing has carried them elsewhere."""
    assert scene.model is not None
    sides = {_SAME.get(side, side) for side in _SIDE.findall(part)}
    noun = next((noun for noun in ("sleeve", "cuff", "corner", "hem", "waist", "leg") if noun in part), "")
    flat = dict(zip(scene.model.names, scene.model.rest, strict=True))
    points = scene.model.points()
    still = [name for name in flat if np.hypot(*(points[name] - flat[name])) < 1.5]
    if noun in ("sleeve", "cuff"):
        return [name for name in still if name.startswith("sleeve") and sides & set(name.split("_"))]
    if noun in ("hem", "waist"):
        return [name for name in still if name.startswith(noun) and (not sides or sides & set(name.split("_")))]
    if not sides or "again" in part:
        return []
    whole = {"sleeve", "armpit", "shoulder", "neck", "crotch"}
    return [name for name in still if sides <= set(name.split("_")) and not whole & set(name.split("_"))]
