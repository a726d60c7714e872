"""Folds to measure a simulator with: scripted sequences with a geometric ideal, and random ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.garments import Garment
from polyfold.geometry import FoldLine, contour_of
from polyfold.types import Action, Observation, SimState

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Fold:
    """One fold in terms of named points of the flat garment; ``a+b`` is the middle between two names.

    Attributes:
        line: two points on the fold line, or "source>target" for the perpendicular bisector between two points.
        picks: what the grippers take; they are carried to their mirror images.
    """

    line: tuple[str, ...]
    picks: tuple[str, ...]


@dataclass(frozen=True)
class Script:
    """A named sequence of folds of one kind of garment."""

    name: str
    kind: str
    folds: tuple[Fold, ...]


SCRIPTS = (
    Script(
        "t-shirt, block",
        "tshirt",
        (
            Fold(("armpit_left", "shoulder_left"), ("sleeve_top_left", "sleeve_bottom_left")),
            Fold(("armpit_right", "shoulder_right"), ("sleeve_top_right", "sleeve_bottom_right")),
            Fold(("hem_left+hem_right>shoulder_left+shoulder_right",), ("hem_left", "hem_right")),
        ),
    ),
    Script(
        "pants, halves",
        "pants",
        (
            Fold(("waist_left+waist_right", "crotch"), ("leg_outer_left", "waist_left")),
            Fold(
                ("leg_inner_right+leg_outer_right>waist_left+waist_right+waist_right+waist_right",),
                ("leg_outer_right", "leg_inner_right"),
            ),
        ),
    ),
    Script(
        "square, diagonals",
        "square",
        (
            Fold(("bottom_left>top_right",), ("bottom_left",)),
            Fold(("top_left>bottom_right",), ("top_left",)),
        ),
    ),
    Script(
        "rectangle, quarters",
        "rectangle",
        (
            Fold(("bottom_left+top_left>bottom_right+top_right",), ("bottom_left", "top_left")),
            Fold(
                ("bottom_left+bottom_right>top_left+top_right",),
                ("bottom_right", "bottom_left+bottom_right"),
            ),
        ),
    ),
)


class Trial:
    """A scripted sequence on one flat garment, with where the particles ideally go.

    Attributes:
        ideal: particle positions after the folds so far if cloth folded like paper [px], shape (N, 2).
    """

    def __init__(self, script: Script, flat: SimState) -> None:
        self.script = script
        self._points = flat.keypoint_pixels()
        self._flat = flat.camera.to_pixels(flat.positions)
        self._size = (flat.camera.height, flat.camera.width)
        self.ideal = self._flat.copy()

    def act(self, fold: Fold, now: SimState) -> Action:
        """The action for a fold from where the picked particles are now; moves ``ideal`` along."""
        line = self._line(fold)
        self.ideal = line.fold(self.ideal)
        pixels = now.camera.to_pixels(now.positions)
        picks = np.array([pixels[self._particle(name)] for name in fold.picks])
        return Action(picks, np.clip(line.mirror(picks), 0, np.array(self._size)[::-1] - 1))

    def flap_error(self, now: SimState, moved_by: float = 0.020) -> tuple[float, float]:
        """Mean distance from the ideal [m] of particles that it moves more than ``moved_by`` [m], and of the rest."""
        scale = now.camera.pixels_per_metre
        moved = np.hypot(*(self.ideal - self._flat).T) > moved_by * scale
        error = np.hypot(*(now.camera.to_pixels(now.positions) - self.ideal).T) / scale
        return float(error[moved].mean()), float(error[~moved].mean()) if (~moved).any() else 0.0

    def ideal_mask(self, triangles: NDArray[np.int32]) -> NDArray[np.bool_]:
        """Where the ideally folded garment, triangles of shape (T, 3), would be seen: bool, shape (H, W)."""
        return mask_of(self.ideal, triangles, self._size)

    def _point(self, name: str) -> Floats:
        return np.mean([self._points[part] for part in name.split("+")], axis=0)

    def _particle(self, name: str) -> int:
        return int(np.hypot(*(self._flat - self._point(name)).T).argmin())

    def _line(self, fold: Fold) -> FoldLine:
        if len(fold.line) == 1:
            source, target = fold.line[0].split(">")
            return FoldLine.moving(self._point(source), self._point(target))
        line = FoldLine.between(self._point(fold.line[0]), self._point(fold.line[1]))
        return line if line.lifts(self._point(fold.picks[0])) else line.reversed()


def mask_of(pixels: Floats, triangles: NDArray[np.int32], size: tuple[int, int]) -> NDArray[np.bool_]:
    """Union of triangles, shape (T, 3), with corners at ``pixels`` [px], shape (N, 2): bool, shape (H, W)."""
    import cv2

    mask = np.zeros(size, np.uint8)
    for corners in np.round(np.asarray(pixels)[triangles] * 16).astype(np.int32):
        cv2.fillConvexPoly(mask, corners, 1, shift=4)
    return mask.astype(bool)


def cloth_mask(observation: Observation) -> NDArray[np.bool_]:
    """Where cloth is seen, bool, shape (H, W); by colour, since one thin ply hardly rises above the table."""
    return plugins.create("segmenters", "colour").segment(observation)


def random_action(mask: NDArray[np.bool_], rng: np.random.Generator) -> tuple[Action, FoldLine]:
    """A random fold line across a cloth, bool, shape (H, W), and picks: a random one on its outline, one far off."""
    outline = contour_of(mask)
    height, width = mask.shape
    while True:
        ends = outline[rng.choice(len(outline), 2, replace=False)]
        if np.hypot(*(ends[1] - ends[0])) < 30:
            continue
        line = FoldLine.between(*ends)
        liftable = outline[line.distance(outline) > 8]
        if len(liftable) < 20:
            continue
        first = liftable[rng.integers(len(liftable))]
        second = liftable[_partner(liftable, first, line)]
        near = np.hypot(*(second - first)) < 25
        picks = ((first + second) / 2)[None] if near else np.stack([first, second])
        return Action(picks, np.clip(line.mirror(picks), 0, [width - 1, height - 1])), line


def _partner(outline: Floats, first: Floats, line: FoldLine) -> int:
    """Index of the point that spans the largest quadrilateral with the first pick and the fold line."""
    start, end = np.asarray(line.start), np.asarray(line.end)
    along = (end - start) / np.hypot(*(end - start))

    def area(p: Floats, q: Floats) -> Floats:
        corners = np.stack(np.broadcast_arrays(start, p, q, end), axis=-2)
        x, y = corners[..., 0], corners[..., 1]
        return np.abs((x * np.roll(y, -1, -1) - y * np.roll(x, -1, -1)).sum(-1)) / 2

    before = ((outline - first) @ along < 0)[:, None]
    p, q = np.where(before, outline, first), np.where(before, first, outline)
    return int(area(p, q).argmax())


def sized(kind: str, seed: int, particles: int) -> Garment:
    """The seeded garment of a kind, meshed so finely that it has about this many particles."""
    edge_length = 0.02
    for _ in range(3):
        garment = plugins.generate_garment(kind, seed, edge_length)
        edge_length *= float(np.sqrt(len(garment.mesh.vertices) / particles))
    return plugins.generate_garment(kind, seed, edge_length)
