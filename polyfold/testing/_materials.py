"""What components are tried on: drawn scenes, pictures of them, a conversation that follows a script."""

from __future__ import annotations

import copy
import socket
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import LLMError
from polyfold.geometry import Camera, FoldLine, contour_of
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins._fabrics import garment_template
from polyfold.polygon import FoldedModel
from polyfold.types import Message, Observation, Reply, Scene

SIDE, OBLONG = 400, 360
CLOTH, TABLE = (66, 133, 180), (236, 236, 232)
TURN = np.deg2rad(13.0)


def scene(kind: str = "square", folded: bool = False) -> Scene:
    """A garment as a perfect grounding sees it: lying a little turned, flat or folded once."""
    template = garment_template(kind)
    turn = np.array([[np.cos(TURN), -np.sin(TURN)], [np.sin(TURN), np.cos(TURN)]])
    model = template.model(template.canonical @ turn.T * 190.0 + SIDE / 2)
    return scene_of(model.fold(upward(model)) if folded else model)


def scene_of(model: FoldedModel) -> Scene:
    """The scene of a model."""
    mask = fill_polygon(model.outline(), SIDE, SIDE)
    size, text = (SIDE, SIDE), model.to_text((SIDE, SIDE), Camera().pixels_per_metre)
    return Scene(model.kind, size, mask, contour_of(mask), model, text, picture=_colours(mask))


def upward(model: FoldedModel) -> FoldLine:
    """A line that lifts the lower third of what is drawn, as the garment lies."""
    return _across(model.outline(), 0.30)


def lines(seen: Scene) -> list[FoldLine]:
    """Lines that lift some of a scene: the lower half, a corner, a third from the side."""
    half = _across(seen.contour, 0.03)
    middle = seen.contour.mean(0)
    along = np.array([np.cos(TURN + 0.8), np.sin(TURN + 0.8)])
    corner = FoldLine.between(middle + 25 * _left(along) - 200 * along, middle + 25 * _left(along) + 200 * along)
    upright = np.array([-np.sin(TURN), np.cos(TURN)])
    side = FoldLine.between(middle - 30 * _left(upright) - 200 * upright, middle - 30 * _left(upright) + 200 * upright)
    return [half, corner, side.reversed()]


def _left(along: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([along[1], -along[0]])


def _across(points: NDArray[np.float64], share: float) -> FoldLine:
    """A line across the garment whose left is its lower part, beyond this share of its height below the middle."""
    along = np.array([np.cos(TURN), np.sin(TURN)])
    down = np.array([-np.sin(TURN), np.cos(TURN)])
    below = (points - points.mean(0)) @ down
    middle = points.mean(0) + share * (below.max() - below.min()) * down
    return FoldLine.between(middle + 200 * along, middle - 200 * along)


def picture(seen: Scene) -> Observation:
    """The picture of a scene: flat colours, and cloth a millimetre high."""
    camera = Camera()
    depth = np.full((SIDE, SIDE), camera.elevation, np.float32)
    depth[seen.mask] -= np.float32(0.001)
    return Observation(_colours(seen.mask), depth, camera)


def oblong(seen: Observation) -> Observation:
    """A picture without its last rows, in which width and height can't be confused; the cloth is all there."""
    camera = Camera(seen.camera.width, OBLONG, seen.camera.focal, seen.camera.elevation)
    return Observation(seen.rgb[:OBLONG].copy(), seen.depth[:OBLONG].copy(), camera)


def _colours(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    rgb = np.full((*mask.shape, 3), TABLE, np.uint8)
    rgb[mask] = CLOTH
    return rgb


def empty() -> Observation:
    """A picture of the bare table."""
    nothing = np.zeros((SIDE, SIDE), bool)
    return picture(Scene("square", (SIDE, SIDE), nothing, np.zeros((0, 2)), None, "{}"))


class Scripted:
    """A conversation whose other side always says the same; see :class:`polyfold.plugins.interfaces.Conversation`.

    Args:
        reply: what it says, or the error that it raises.

    Attributes:
        asked: how often it was asked.
    """

    MOST = 40

    def __init__(self, reply: Reply | Exception) -> None:
        self._reply = reply
        self.asked = 0

    def ask(self, role: str, messages: Sequence[Message], params: Mapping[str, Any] | None = None) -> Reply:
        """The same again."""
        self.asked += 1
        if self.asked > self.MOST:
            raise AssertionError(f"it asked {self.MOST} times and did not give up; bound the repairs")
        if isinstance(self._reply, Exception):
            raise self._reply
        return self._reply

    def reject(self, reason: str) -> None:
        """Nothing: it will say the same."""


def unanswered() -> Scripted:
    """A model that can't be reached."""
    return Scripted(LLMError("the model did not answer within 60 s; try again"))


class TriedNetworkError(Exception):
    """A connection was asked for."""


@contextmanager
def without_network() -> Iterator[list[Any]]:
    """Let no connection be made; yields the addresses that were asked for."""
    asked: list[Any] = []

    def refuse(self: Any, address: Any) -> None:
        asked.append(address)
        raise TriedNetworkError(f"a connection to {address} was asked for")

    with patch.object(socket.socket, "connect", refuse), patch.object(socket.socket, "connect_ex", refuse):
        yield asked


def kept(value: Any) -> Any:
    """A copy to compare with later."""
    return copy.deepcopy(value)


def changed(before: Any, after: Any, where: str = "") -> str | None:
    """Where a value differs from the copy that was kept of it; None where nothing does."""
    if isinstance(before, np.ndarray):
        same = before.shape == after.shape and np.array_equal(before, after, equal_nan=before.dtype.kind == "f")
        return None if same else where or "it"
    if is_dataclass(before) and not isinstance(before, type):
        names = [field.name for field in fields(before)]
        parts = ((name, getattr(before, name), getattr(after, name)) for name in names)
        return next((found for name, a, b in parts if (found := changed(a, b, name))), None)
    if isinstance(before, Mapping):
        return next(
            (found for key in before if (found := changed(before[key], after.get(key), f"{where}[{key!r}]"))), None
        )
    return None
