"""What is drawn over a picture of the cloth: the polygon model, the fold line, and the arms' picks and places."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.geometry import FoldLine, signed_distance, span_on_mask
from polyfold.geometry._areas import covered
from polyfold.types import Action, ActionMap, Scene
from polyfold.viz._draw._canvas import Surface
from polyfold.viz._draw._style import ARMS, FOLD_LINE, GOAL, INK, MAP, PAPER, POLYGON, Colour

if TYPE_CHECKING:
    from polyfold.polygon import FoldedModel
    from polyfold.polygon._layers import Facet


Floats = NDArray[np.float64]

BAR_WIDTH, BAR_HEIGHT, BAR_STEPS = 10, 84, 42
"""Of the colour bar of an action map [px]."""
ROOM_FOR_BAR = 240
"""Smaller pictures [px] have none."""


def draw_model(canvas: Surface, model: FoldedModel) -> None:
    """The fitted polygon: outlines solid, creases dashed, vertices as dots; hidden ones fainter and hollow."""
    hidden, visible = _edges_by_visibility(model.facets())
    for points, crease in hidden:
        canvas.line(points, PAPER, 1.2, dash=3.0 if crease else 0.0, opacity=0.45)
    for points, _ in visible:
        canvas.line(points, PAPER, 3.2, opacity=0.75)
    for points, crease in visible:
        canvas.line(points, POLYGON, 1.4, dash=4.0 if crease else 0.0)
    for state in sorted(model.vertices().values(), key=lambda state: state.visible):
        canvas.disc(state.point, 3.6, PAPER)
        canvas.disc(state.point, 2.7, POLYGON)
        if not state.visible:
            canvas.disc(state.point, 1.5, PAPER)


def _edges_by_visibility(facets: Sequence[Facet]) -> tuple[list[tuple[Floats, bool]], list[tuple[Floats, bool]]]:
    """Edges as (polyline, is a crease), those under other facets first and those in sight second."""
    from shapely import LineString, union_all

    polygons = [covered(facet.polygon) for facet in facets]
    hidden, visible, seen = [], [], set()
    for facet in facets:
        above = [polygons[i] for i, other in enumerate(facets) if other.layer > facet.layer]
        cover = union_all(above).buffer(-1.0) if above else None
        for i, label in enumerate(facet.edges):
            ends = facet.polygon[[i, (i + 1) % len(facet.polygon)]]
            key = tuple(sorted(map(tuple, ends.round().tolist())))
            if key in seen or key[0] == key[1]:
                continue
            line = LineString(ends)
            in_sight = line if cover is None else line.difference(cover)
            if in_sight.length > 0.5 * line.length:
                seen.add(key)
            visible += [(points, label == "crease") for points in _polylines(in_sight)]
            if cover is not None:
                hidden += [(points, label == "crease") for points in _polylines(line.intersection(cover))]
    return hidden, visible


def _polylines(shape) -> list[Floats]:
    parts = getattr(shape, "geoms", [shape])
    return [np.array(part.coords) for part in parts if part.geom_type == "LineString" and part.length > 1.0]


def draw_outline(canvas: Surface, outline: ArrayLike, colour: Colour = GOAL, dash: float = 5.0) -> None:
    """A closed outline [px], shape (N, 2), such as the ideal result: dashed."""
    outline = np.asarray(outline, float)
    closed = np.vstack([outline, outline[:1]])
    canvas.line(closed, PAPER, 3.4, opacity=0.7)
    canvas.line(closed, colour, 1.8, dash=dash)


def draw_action_map(canvas: Surface, action_map: ActionMap) -> None:
    """Places to pick as discs, dark blue for the lowest value, yellow for the highest, which lies on top."""
    points, values = (np.asarray(part, float) for part in action_map)
    finite = np.isfinite(values)
    points, values = points[finite], values[finite]
    for point in points:
        canvas.disc(point, 4.2, PAPER)
    if not len(values):
        return
    low, high = float(values.min()), float(values.max())
    for index in np.argsort(values):
        share = 0.5 if high <= low else (float(values[index]) - low) / (high - low)
        canvas.disc(points[index], 3.2, _map_colour(share))
    if min(canvas.size) >= ROOM_FOR_BAR:
        _draw_colour_bar(canvas, low, high)


def _draw_colour_bar(canvas: Surface, low: float, high: float) -> None:
    """The map's colours from the lowest value, below, to the highest, in the picture's lower right corner."""
    unit = canvas.length(1.0)
    right, bottom = (side * unit for side in canvas.size)
    left, top = right - (BAR_WIDTH + 8) * unit, bottom - (BAR_HEIGHT + 10) * unit
    step = BAR_HEIGHT * unit / BAR_STEPS
    canvas.fill(_rectangle(left - unit, top - unit, (BAR_WIDTH + 2) * unit, BAR_STEPS * step + 2 * unit), PAPER)
    for number in range(BAR_STEPS):
        at = top + (BAR_STEPS - 1 - number) * step
        canvas.fill(_rectangle(left, at, BAR_WIDTH * unit, step), _map_colour(number / (BAR_STEPS - 1)))
    for value, at in ((high, top + 5 * unit), (low, bottom - 15 * unit)):
        canvas.text(f"{value:.3g}", (left - 4 * unit, at), 11, INK, "rm")


def _rectangle(left: float, top: float, width: float, height: float) -> Floats:
    return np.array([(left, top), (left + width, top), (left + width, top + height), (left, top + height)])


def _map_colour(share: float) -> Colour:
    stops = np.array(MAP, float)
    at = share * (len(stops) - 1)
    red, green, blue = (round(float(np.interp(at, np.arange(len(stops)), stops[:, c]))) for c in range(3))
    return red, green, blue


def draw_lifted(canvas: Surface, fold_line: FoldLine, scene: Scene) -> None:
    """The cloth that a fold line lifts: tinted."""
    canvas.tint(scene.mask & _left_pixels(fold_line, scene.mask.shape), FOLD_LINE, 0.22)


def draw_fold_line(canvas: Surface, fold_line: FoldLine, scene: Scene | None = None) -> None:
    """The directed fold line: an arrow with teeth on the side that is lifted.

    With a scene the line is drawn where it crosses the cloth and a little beyond.
    """
    line = fold_line if scene is None else _across_cloth(fold_line, scene, canvas.length(14))
    start, end = np.array(line.start), np.array(line.end)
    if not line.length > 0:
        return
    along = (end - start) / line.length
    left = np.array([along[1], -along[0]])
    teeth = _teeth(start, end, along, left, canvas.length(9))
    head = _arrowhead(end, along, canvas.length(15), canvas.length(6.5))
    neck = end - along * min(canvas.length(10), line.length / 2)
    for shape in (*teeth, head):
        canvas.line(np.vstack([shape, shape[:2]]), PAPER, 2.6)
    canvas.line([start, neck], PAPER, 5.6)
    for shape in (*teeth, head):
        canvas.fill(shape, FOLD_LINE)
    canvas.line([start, neck], FOLD_LINE, 3.0)


def _across_cloth(line: FoldLine, scene: Scene, beyond: float) -> FoldLine:
    span = span_on_mask(scene.mask, line.start, line.end) if line.length > 0 else None
    if span is None or np.hypot(*(span[1] - span[0])) < 1.0:
        return line
    along = (span[1] - span[0]) / np.hypot(*(span[1] - span[0]))
    return FoldLine.between(span[0] - along * beyond, span[1] + along * beyond)


def _left_pixels(line: FoldLine, shape: tuple[int, int]) -> NDArray[np.bool_]:
    if not line.length > 0:
        return np.zeros(shape, bool)
    y, x = np.indices(shape)
    return signed_distance(np.stack([x, y], axis=-1), line.start, line.end) > 0


def _teeth(start: Floats, end: Floats, along: Floats, left: Floats, size: float) -> list[Floats]:
    """Three triangles on the left of the line, as on a map of thrust faults."""
    found = []
    for share in (0.25, 0.5, 0.75):
        foot = start + (end - start) * share
        found.append(np.array([foot - along * size * 0.62, foot + left * size, foot + along * size * 0.62]))
    return found


def _arrowhead(tip: Floats, along: Floats, length: float, half_width: float) -> Floats:
    across = np.array([along[1], -along[0]])
    back = tip - along * length
    return np.array([tip, back + across * half_width, tip - along * length * 0.74, back - across * half_width])


def draw_action(canvas: Surface, action: Action) -> None:
    """Picks as discs and places as tips of arrows that curve away from each other, one colour per arm."""
    curves = [
        _curve(pick, place, side) for pick, place, side in zip(action.picks, action.places, _bends(action), strict=True)
    ]
    for curve in curves:
        _draw_arrow(canvas, curve, PAPER, 2.6)
    for curve, colour in zip(curves, ARMS, strict=False):
        _draw_arrow(canvas, curve, colour, 0.0)
    for pick, colour in zip(action.picks, ARMS, strict=False):
        canvas.disc(pick, 6.6, PAPER)
        canvas.disc(pick, 5.2, colour)
        canvas.disc(pick, 1.9, PAPER)


def _bends(action: Action) -> list[Floats]:
    """Unit vectors that each arrow bends towards: apart for two arms, up the image for one."""
    middles = (action.picks + action.places) / 2
    found = []
    for i, way in enumerate(action.places - action.picks):
        side = np.array([way[1], -way[0]]) / max(float(np.hypot(*way)), 1e-9)
        outward = middles[i] - middles.mean(axis=0) if action.arms == 2 else np.array([0.0, -1.0])
        found.append(side if side @ outward >= 0 else -side)
    return found


def _curve(pick: Floats, place: Floats, side: Floats) -> Floats:
    """A quadratic Bezier curve from pick to place, shape (33, 2)."""
    control = (pick + place) / 2 + side * 0.36 * np.hypot(*(place - pick))
    t = np.linspace(0, 1, 33)[:, None]
    return (1 - t) ** 2 * pick + 2 * t * (1 - t) * control + t**2 * place


def _draw_arrow(canvas: Surface, curve: Floats, colour: Colour, halo: float) -> None:
    length = canvas.length(15)
    to_tip = np.hypot(*(curve - curve[-1]).T)
    along = curve[-1] - _at_distance(curve, to_tip, length)
    size = float(np.hypot(*along))
    if size == 0.0:
        return
    along = along / size
    shaft = curve[to_tip > length * 0.6]
    head = _arrowhead(curve[-1], along, length, canvas.length(7.0))
    if len(shaft) > 1:
        canvas.line(np.vstack([shaft, curve[-1] - along * length * 0.6]), colour, 3.2 + halo)
    if halo:
        canvas.line(np.vstack([head, head[:2]]), colour, halo)
    canvas.fill(head, colour)


def _at_distance(curve: Floats, to_tip: Floats, length: float) -> Floats:
    """The last point of the curve that is at least ``length`` from its tip, or its start."""
    far = np.flatnonzero(to_tip >= length)
    return curve[far[-1]] if len(far) else curve[0]
