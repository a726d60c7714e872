"""The fold line of one fold on the cloth as it lies now."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.geometry import FoldLine, signed_distance
from polyfold.tasks import mirror_line
from polyfold_offline.cloth.edges import edge_vertices, partner
from polyfold_offline.cloth.folds import CORNERS, OPPOSITE_EDGE, Fold
from polyfold_offline.cloth.garment import NotUnderstoodError
from polyfold_offline.cloth.shape import Shape

Point = NDArray[np.float64]

_TOGETHER = 10.0
"""Points nearer than this [px] give a line no direction."""

_MOVED = 0.12
"""An edge that lies this share of the garment's extent from where it was has been folded."""

_IMAGE_AXES = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "top": (0.0, -1.0), "bottom": (0.0, 1.0)}


@dataclass(frozen=True)
class Crease:
    """A fold line and how it was found."""

    line: FoldLine
    reasoning: str
    via_pick: bool = False


def crease_of(fold: Fold, shape: Shape) -> Crease:
    """The directed line of a fold, reaching across the cloth and inside the image.

    Raises:
        NotUnderstoodError: if the vertices that the fold needs are missing or coincide.
    """
    find = {"sleeve": _sleeve, "corner": _corner, "middle": _middle, "band": _band, "half": _half}[fold.action]
    crease = find(fold, shape)
    return Crease(_across(crease.line, shape), crease.reasoning, crease.via_pick)


def _say(point: Point) -> str:
    return f"({point[0]:.0f}, {point[1]:.0f})"


def _across(line: FoldLine, shape: Shape) -> FoldLine:
    """The line from where it enters the cloth's extent to where it leaves it, clipped to the image."""
    start = np.asarray(line.start)
    along = np.subtract(line.end, line.start) / line.length
    reach = (shape.outline() - start) @ along
    low, high = float(reach.min()), float(reach.max())
    for axis, limit in ((0, shape.size[0] - 1), (1, shape.size[1] - 1)):
        if abs(along[axis]) > 1e-9:
            a, b = sorted(((0 - start[axis]) / along[axis], (limit - start[axis]) / along[axis]))
            low, high = max(low, a), min(high, b)
    if high - low < _TOGETHER:
        raise NotUnderstoodError("the fold line would lie outside the image")
    return FoldLine.between(start + low * along, start + high * along)


# Sleeves and corners -------------------------------------------------------------------------------------------------


def _sleeve(fold: Fold, shape: Shape) -> Crease:
    side = fold.part
    _still_there(f"sleeve_top_{side}", f"{side} sleeve", shape)
    top = "shoulder" if fold.manner == "straight" else "neck"
    armpit, upper = (_flat(f"{name}_{side}", shape) for name in ("armpit", top))
    cuff = (_flat(f"sleeve_top_{side}", shape) + _flat(f"sleeve_bottom_{side}", shape)) / 2
    line = FoldLine.between(armpit, upper)
    line = line if line.distance(cuff) > 0 else line.reversed()
    return Crease(
        line,
        f"The {side} sleeve hangs on the body along the line from armpit_{side} {_say(armpit)} to {top}_{side} "
        f"{_say(upper)}. I read the fold line off the shape: it is that line, directed so that the cuff at "
        f"{_say(cuff)} lies to its left.",
    )


def _still_there(name: str, part: str, shape: Shape) -> None:
    """Refuse to fold what an outline no longer shows where it lay."""
    if shape.nameless and name in shape.flat and shape.now(name) is None:
        raise NotUnderstoodError(f"the {part} is not seen where it lay: it was folded in already")


def _flat(name: str, shape: Shape) -> Point:
    point = shape.flat.get(name, shape.points.get(name))
    if point is None:
        raise NotUnderstoodError(f"the model has no vertex {name}, which this fold needs")
    return point


def _corner(fold: Fold, shape: Shape) -> Crease:
    pick = _corner_now(fold.part, shape)
    if fold.target == "centre":
        _still_there(fold.part, f"{fold.part.replace('_', ' ')} corner", shape)
        place, name = _centre(shape), "the centre of the cloth"
    else:
        place, name = _corner_now(fold.target, shape), fold.target
    if np.hypot(*(pick - place)) < _TOGETHER:
        raise NotUnderstoodError(f"{fold.part} lies on {name} already, so no fold is left to do")
    start, end = FoldLine.moving(pick, place).start, FoldLine.moving(pick, place).end
    return Crease(
        FoldLine(start, end),
        f"I reason through one pick and place: pick {fold.part} at {_say(pick)}, place it on {name} at {_say(place)}. "
        "The fold line is the perpendicular bisector between the two, directed so that the pick lies to its left.",
        via_pick=True,
    )


def _corner_now(corner: str, shape: Shape) -> Point:
    if corner in shape.flat and (now := shape.now(corner)) is not None:
        return now
    outline = shape.outline()
    vertical, horizontal = corner.split("_")
    toward = np.array(_IMAGE_AXES[vertical]) + np.array(_IMAGE_AXES[horizontal])
    return outline[int(np.argmax(outline @ toward))]


def _centre(shape: Shape) -> Point:
    known = [shape.flat[corner] for corner in CORNERS if corner in shape.flat]
    if len(known) == 4:
        return np.mean(known, axis=0)
    outline = shape.outline()
    return (outline.min(0) + outline.max(0)) / 2


# Edges ---------------------------------------------------------------------------------------------------------------


def _edge_line(edge: str, shape: Shape, share: float) -> tuple[FoldLine, str]:
    """The line parallel to an edge at a share of the way to the opposite edge of the FLAT garment, and a word on it."""
    pairs = [
        (shape.flat[name], shape.flat[other])
        for name in edge_vertices(shape.flat, edge)
        if (other := partner(name, edge, shape.flat)) is not None
    ]
    if not pairs:
        raise NotUnderstoodError(f"the model does not show the {edge} edge and the one opposite to it")
    sources = np.array([source for source, _ in pairs])
    targets = np.array([source + 2 * share * (target - source) for source, target in pairs])
    line = mirror_line(sources, targets)
    middle = sources.mean(0), np.array([target for _, target in pairs]).mean(0)
    return line, f"the {edge} side around {_say(middle[0])} and the opposite side around {_say(middle[1])}"


def _half(fold: Fold, shape: Shape) -> Crease:
    edge = _longer(fold.part, shape) if fold.part in ("long", "short") else fold.part
    if not shape.named:
        return _half_of_outline(edge, shape, np.array(_IMAGE_AXES[edge]))
    line, where = _edge_line(edge, shape, 0.5)
    if _edge_moved(edge, line, shape):
        start, end = np.asarray(line.start), np.asarray(line.end)
        along = (end - start) / np.hypot(*(end - start))
        return _half_of_outline(edge, shape, np.array([along[1], -along[0]]))
    return Crease(
        line,
        f"Vertices on the two sides mirror each other: {where}. I read the fold line off the shape: it is the line of "
        f"symmetry between them, directed so that the {edge} side, which moves, lies to its left.",
    )


def _edge_moved(edge: str, line: FoldLine, shape: Shape) -> bool:
    """Whether an earlier fold across this direction has moved the edge or the one opposite to it."""
    flat = line.distance(np.array(list(shape.flat.values())))
    extent = float(flat.max() - flat.min())
    for side in (edge, OPPOSITE_EDGE[edge]):
        for name in edge_vertices(shape.flat, side):
            now = shape.now(name)
            if now is None or abs(abs(line.distance(now)) - abs(line.distance(shape.flat[name]))) > _MOVED * extent:
                return True
    return shape.folds > 0 and not _still_spread(line, shape, extent)


def _still_spread(line: FoldLine, shape: Shape, extent: float) -> bool:
    now = line.distance(shape.outline())
    return bool(now.max() > 0.25 * extent and now.min() < -0.25 * extent)


def _half_of_outline(edge: str, shape: Shape, toward: Point) -> Crease:
    """Half of what is left: the line midway between the outermost points on both sides."""
    outline = shape.outline()
    level = outline @ toward
    far, near = _extreme(level, outline, True), _extreme(level, outline, False)
    middle = toward * (far[0] + near[0]) / 2
    along = np.array([-toward[1], toward[0]])
    line = FoldLine.between(middle, middle + along)
    if signed_distance(far[1], line.start, line.end) < 0:
        line = line.reversed()
    return Crease(
        line,
        f"The cloth was folded before: I go by its outline now. I reason through one pick and place: pick the middle "
        f"of the {edge} border at {_say(far[1])}, place it on the border opposite at {_say(near[1])}. The fold line "
        "runs midway, perpendicular to the way between them, with the pick to its left.",
        via_pick=True,
    )


def _extreme(level: NDArray[np.float64], outline: NDArray[np.float64], highest: bool) -> tuple[float, Point]:
    """Mean level and position of the points at one end."""
    extent = float(level.max() - level.min())
    chosen = level > level.max() - 0.1 * extent if highest else level < level.min() + 0.1 * extent
    return float(level[chosen].mean()), outline[chosen].mean(0)


def _longer(which: str, shape: Shape) -> str:
    """The edge to move when only *long* or *short* is said."""
    bottom_left, top_left, bottom_right = (_flat(n, shape) for n in ("bottom_left", "top_left", "bottom_right"))
    upright = np.hypot(*(top_left - bottom_left)) > np.hypot(*(bottom_right - bottom_left))
    return "left" if upright == (which == "long") else "bottom"


def _middle(fold: Fold, shape: Shape) -> Crease:
    line, where = _edge_line(fold.part, shape, 0.25)
    return Crease(
        line,
        f"On the flat cloth I see {where}; the middle line runs halfway between them. Bringing the {fold.part} side "
        "onto the middle line needs a fold line a quarter of the way across, parallel to it, that side to its left.",
    )


def _band(fold: Fold, shape: Shape) -> Crease:
    share = _share_of_cm(fold, shape) if fold.cm else float(fold.share)
    if not 0 < share < 1:
        raise NotUnderstoodError(f"a strip of {fold.cm:g} cm is wider than the cloth")
    line, where = _edge_line(fold.part, shape, share)
    return Crease(
        line,
        f"On the flat cloth I see {where}. The fold line lies {share:.2f} of the way from the {fold.part} side, "
        "parallel to it, directed so that this part lies to its left.",
    )


def _share_of_cm(fold: Fold, shape: Shape) -> float:
    """Width of a strip as a share of the way from its edge to the opposite one."""
    if not shape.px_per_cm:
        raise NotUnderstoodError("nothing says how many pixels are a centimetre; give the width as a fraction")
    middle, _ = _edge_line(fold.part, shape, 0.5)
    edge = np.array([shape.flat[name] for name in edge_vertices(shape.flat, fold.part)])
    apart = 2 * float(middle.distance(edge).mean())
    return fold.cm * shape.px_per_cm / apart
