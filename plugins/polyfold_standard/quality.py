"""How good a fold is, from 0 to 100: what judges of folding contests look at, as one metric beside success.

RoboCup@Home grades so what success only admits or refuses: whether edges meet, whether the packet has the size it
should, whether it lies flat, whether there are folds that nobody asked for. The four shares are multiplied and the
fourth root is taken, so that a fold that fails one of them is not saved by the others: cloth that was left as it lay is
flat and smooth, and has a quality of 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Mesh
from polyfold.types import Outcome
from polyfold_standard.alignment import Aligning, laid_onto

Floats = NDArray[np.float64]

EDGES_OFF = 0.050
"""Mean distance [m] of edges from their places at which nothing of their share is left."""

AREA_OFF = 0.5
"""Share by which the smaller of the two silhouettes is smaller at which nothing of their share is left."""

LOFT = 0.040
"""Mean height [m] above the ideal packet at which nothing of the flatness is left."""

CREASED = 0.3
"""Share of the cloth in creases that nobody asked for at which nothing of their share is left."""

TILT = 0.7
"""Cloth whose projection is smaller than this share of it, or that lies the other way up, is creased: 45 degrees."""

BEND = 0.030
"""Cloth nearer to an ideal crease than this [m] may be bent."""

MOVED = 0.020
"""What the reference moves by more than this [m] was to be folded."""


@dataclass(frozen=True)
class Grades:
    """The four shares, each from 0 to 1.

    Attributes:
        edges: how near the garment's outline lies to where it should, the moved part and the rest each for itself.
        area: how near the silhouette's area is to the ideal's.
        flatness: how near the packet's height is to the ideal's.
        smoothness: how little cloth is creased where the ideal is flat.
    """

    edges: float
    area: float
    flatness: float
    smoothness: float

    @property
    def quality(self) -> float:
        """All of them together, 0 to 100."""
        return 100.0 * float(np.prod(astuple(self))) ** 0.25


def grade(result: Outcome, reference: Outcome, align: bool = False) -> Grades:
    """Grade a result beside one reference.

    Args:
        result: how the episode ended.
        reference: how it should have, such as the geometric ideal.
        align: move and turn the result rigidly onto the reference first.
    """
    found, wanted = result.end.positions, reference.end.positions
    plane = laid_onto(found, wanted, found[:, :2]) if align else found[:, :2]
    off = np.linalg.norm(plane - wanted[:, :2], axis=1)
    areas = sorted((float(result.mask.sum()), float(reference.mask.sum())))
    missing = 1.0 - areas[0] / areas[1] if areas[1] else 1.0
    above = np.clip(found[:, 2] - wanted[:, 2], 0.0, None)
    creased = _creased(found, reference, result.mesh)
    return Grades(
        _left(_outline_off(off, reference, result.mesh), EDGES_OFF),
        _left(missing, AREA_OFF),
        _left(float(above.mean()), LOFT),
        _left(creased, CREASED),
    )


class Quality(Aligning):
    """Graded quality, 0 to 100: edges, area, flatness and creases, best of the references."""

    label: ClassVar[str] = "quality"
    digits: ClassVar[int] = 0
    unit: ClassVar[str] = ""
    most: ClassVar[float] = 100.0
    higher_is_better: ClassVar[bool] = True

    def score(self, result: Outcome, references: Sequence[Outcome]) -> float:
        """The quality beside the nearest reference."""
        return max(grade(result, reference, self._align).quality for reference in references)


def _left(error: float, worst: float) -> float:
    """What is left of a share: 1 without error, 0 from the worst on, and of what can't be measured."""
    return float(np.clip(1.0 - error / worst, 0.0, 1.0)) if np.isfinite(error) else 0.0


def _outline_off(off: Floats, reference: Outcome, mesh: Mesh) -> float:
    """Mean distance [m] of the outline from its place: the worse of what was to be moved and what was not."""
    outline = np.unique(mesh.boundary)
    travel = np.linalg.norm(reference.end.positions - reference.start.positions, axis=1)[outline]
    parts = [off[outline][moved] for moved in (travel > MOVED, travel <= MOVED) if moved.any()]
    return max(float(part.mean()) for part in parts)


def _creased(found: Floats, reference: Outcome, mesh: Mesh) -> float:
    """Share of the cloth, away from the ideal's creases, that is steep or lies the other way up."""
    rest = _areas(mesh.vertices, mesh.triangles)
    ideal = _areas(reference.end.positions[:, :2], mesh.triangles)
    flat = np.abs(ideal) > 0.98 * np.abs(rest)
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    if not flat.all():
        from scipy.spatial import KDTree

        to_crease, _ = KDTree(middles[~flat]).query(middles)
        flat &= to_crease > BEND
    seen = _areas(found[:, :2], mesh.triangles) * np.sign(ideal)
    creased = seen < TILT * np.abs(rest)
    return float(np.abs(rest)[flat & creased].sum() / np.abs(rest).sum())


def _areas(points: Floats, triangles: NDArray[np.int32]) -> Floats:
    """Signed areas [m²] of triangles in the plane, shape (T,)."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
