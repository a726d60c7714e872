"""Where the parts of a t-shirt are when only the corners of its outline are known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold_rules.shapes.outlines import Outline, pockets
from polyfold_rules.shapes.parts import NotUnderstoodError

Floats = NDArray[np.float64]

_SIGN = {"left": -1.0, "right": 1.0}

_DEEP = 0.04
"""A concave corner at least this deep, as a share of the hem, is an armpit or a collar."""

_ARMHOLE = 0.9
"""Half the width between the armholes' upper ends as a share of that between the armpits."""

_NEAR = 0.12
"""A corner this near to where the shoulder should be, as a share of the hem, belongs to it: the shoulder is taken to
lie halfway between the two, since the corner may be one of the sleeve's."""


@dataclass(frozen=True, eq=False)
class Sleeve:
    """One sleeve that hangs out, in the image [px], each of shape (2,): armpit, shoulder, neck end, cuff's middle."""

    armpit: Floats
    shoulder: Floats
    neck: Floats
    cuff: Floats


def hem_corner(outline: Outline, side: str) -> Floats:
    """The hem's corner on a side [px], shape (2,): the outermost of the lowest corners."""
    framed = outline.framed
    low, high = framed.min(0), framed.max(0)
    lowest = framed[:, 1] < low[1] + 0.12 * (high[1] - low[1])
    return outline.corners[int(np.argmax(np.where(lowest, _SIGN[side] * framed[:, 0], -np.inf)))]


def sleeve_of(outline: Outline, side: str) -> Sleeve:
    """The sleeve of a side.

    Raises:
        NotUnderstoodError: if none hangs out there, or the outline has no collar.
    """
    sign, framed = _SIGN[side], outline.framed
    hem, middle = _hem(outline)
    deep = [pocket for pocket in pockets(framed) if pocket[3] > _DEEP * hem]
    armpits = [
        p for p in deep if sign * (framed[p[0], 0] - middle) > 0.2 * hem and _lower_end(p, framed) < _third(framed)
    ]
    if not armpits:
        raise NotUnderstoodError(f"I see no {side} sleeve that hangs out of the outline; it may be folded in already")
    armpit, start, end, _ = min(armpits, key=lambda pocket: framed[pocket[0], 1])
    forward = framed[end, 1] > framed[start, 1]
    neck = _neck_end(outline, deep, side, armpit)
    path = framed[_walk(armpit, neck, 1 if forward else -1, len(framed))]
    tip = int(np.argmax(sign * path[:, 0]))
    upper = max(_second_of_cuff(path, tip, sign), tip)
    cuff = path[1 : upper + 1].mean(0) if upper > 0 else path[tip]
    top = _shoulder(path[upper:], sign, middle, _half_width(outline, side, framed[armpit, 0], middle), hem)
    return Sleeve(outline.corners[armpit], outline.pixel(top), outline.corners[neck], outline.pixel(cuff))


def shoulder(outline: Outline, side: str) -> Floats:
    """The upper end of the armhole [px], shape (2,): the outer upper corner, or where the sleeve begins."""
    try:
        return sleeve_of(outline, side).shoulder
    except NotUnderstoodError:
        return outline.corners[_outer_upper(outline, side)]


def _hem(outline: Outline) -> tuple[float, float]:
    """Length of the hem [px], and the coordinate of its middle in the garment's frame."""
    ends = [float(hem_corner(outline, side) @ outline.right) for side in ("left", "right")]
    return abs(ends[1] - ends[0]), sum(ends) / 2


def _outer_upper(outline: Outline, side: str) -> int:
    """The corner that reaches farthest up and out on a side."""
    return int(np.argmax(outline.framed @ np.array([_SIGN[side], 1.0])))


def _lower_end(pocket: tuple[int, int, int, float], framed: Floats) -> float:
    return float(min(framed[pocket[1], 1], framed[pocket[2], 1]))


def _third(framed: Floats) -> float:
    """Height below which the lower end of an armpit's pocket lies: the hem, or a sleeve's tip that hangs low."""
    low, high = framed[:, 1].min(), framed[:, 1].max()
    return float(low + 0.35 * (high - low))


def _neck_end(outline: Outline, deep: list[tuple[int, int, int, float]], side: str, armpit: int) -> int:
    """The collar's end on a side: of the concave corner at the top, or the highest corner of that side."""
    framed = outline.framed
    hem, middle = _hem(outline)
    low, high = framed[:, 1].min(), framed[:, 1].max()
    collars = [p for p in deep if abs(framed[p[0], 0] - middle) < 0.25 * hem and framed[p[0], 1] > (low + high) / 2]
    if collars:
        collar = max(collars, key=lambda pocket: pocket[3])
        return max(collar[1:3], key=lambda index: _SIGN[side] * framed[index, 0])
    half = _SIGN[side] * (framed[:, 0] - middle) > 0
    half &= np.abs(framed[:, 0] - middle) < 0.35 * hem
    half[armpit] = False
    if not half.any():
        raise NotUnderstoodError("I see no collar in the outline, from which the sleeve could be told")
    return int(np.argmax(np.where(half, framed[:, 1], -np.inf)))


def _walk(start: int, end: int, step: int, count: int) -> list[int]:
    """Indices along the outline from one corner to another, both included."""
    path = [start]
    while path[-1] != end and len(path) <= count:
        path.append((path[-1] + step) % count)
    return path


def _second_of_cuff(path: Floats, tip: int, sign: float) -> int:
    """Where the cuff ends on the way up: the corner after the tip if it is nearly as far out and higher."""
    following = tip + 1
    if following >= len(path) - 1:
        return tip
    reach = sign * (path[tip, 0] - path[0, 0])
    out = sign * (path[following, 0] - path[0, 0])
    return following if out > 0.55 * reach else tip


def _half_width(outline: Outline, side: str, armpit: float, middle: float) -> float:
    """Distance of the armhole's upper end from the middle [px]: as on the other side if its sleeve is folded straight
    in, else a little less than the armpit's."""
    usual = _ARMHOLE * abs(armpit - middle)
    other = "left" if side == "right" else "right"
    mirrored = abs(float(outline.framed[_outer_upper(outline, other), 0]) - middle)
    return mirrored if 0.75 < mirrored / max(usual, 1e-9) < 1.15 else usual


def _shoulder(upper: Floats, sign: float, middle: float, half_width: float, hem: float) -> Floats:
    """The point of the upper edge, from the cuff to the collar, that far from the middle; a corner if one is near."""
    out = sign * (upper[:, 0] - middle)
    at = float(np.clip(half_width, out.min(), out.max()))
    order = np.argsort(out)
    expected = np.array([middle + sign * at, np.interp(at, out[order], upper[order, 1])])
    inner = upper[1:-1]
    if len(inner):
        distance = np.hypot(*(inner - expected).T)
        if distance.min() < _NEAR * hem:
            return (inner[int(np.argmin(distance))] + expected) / 2
    return expected
