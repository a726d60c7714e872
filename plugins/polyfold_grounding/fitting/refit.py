"""Following a garment from fold to fold: the skeleton and earlier folds are frozen, six numbers are refitted.

The paper refits all parameters; freezing them, and registering rigidly first, is this implementation's choice, because
freeing them made it worse with every fold.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine, resample
from polyfold.polygon import FoldedModel
from polyfold_grounding.fitting import fold_terms
from polyfold_grounding.fitting.evidence import Evidence
from polyfold_grounding.fitting.levenberg_marquardt import Damping, Terms, minimise

__all__ = ["Refit", "Silhouette", "refit_fold", "register"]

Floats = NDArray[np.float64]

_WEIGHT = 3.0

_SIGMAS = np.array([15.0, 15.0, np.radians(8.0), 1.5, np.radians(1.5), 4.0])
"""How far a fold usually moves the garment, misses its line, and rounds its crease: shift [px at scale 1], turn, offset
[px at scale 1], turn, half the allowance [px at scale 1]. A flap is laid down where it was meant to, while the crease
ends where the cloth lets it."""

_ALL = (0, 1, 2, 3, 4, 5)

_TIGHT = 0.5 * np.pi - 2.0
"""Allowance of a tight fold, in thicknesses of the bent packet: its plies are half rings, π/2 long on average, and the
outermost stands out by one thickness on the way there and back."""

_DAMPING = Damping(most=1e6, floor=1e-9)

_FAR = 1e5
"""Offset of a line that lifts nothing [px]."""

_SPREAD = [(0.0, 0.0), (7.0, 6.0), (7.0, -6.0), (-7.0, 6.0), (-7.0, -6.0)]
"""Further starts for the line [px, degrees]: half folds have two basins, the base moved or the flap moved."""


@dataclass(frozen=True, eq=False)
class Refit:
    """One explanation of the silhouette by a moved model.

    Attributes:
        parameters: shift [px], turn [rad], the last line's offset [px] and turn [rad], and half its allowance
            [px], shape (6,).
        energy: contour distance plus priors, without unit.
        chamfer: Chamfer distance [px].
    """

    parameters: Floats
    energy: float
    chamfer: float


@dataclass(frozen=True, eq=False)
class _FoldTerms(Terms):
    """The energy around some parameters, and the Chamfer distance [px]."""

    chamfer: float

    def of(self, index: NDArray[np.int64]) -> _FoldTerms:
        """The same by some of the parameters only."""
        return _FoldTerms(self.cost, self.gradient[index], self.hessian[np.ix_(index, index)], self.chamfer)


class Silhouette:
    """A silhouette before a fold, ready to be folded along a line, moved and compared.

    Args:
        model: the model before the fold.
        line: the fold line, or None if nothing was folded.
        evidence: the picture to explain.
        seen: the contour that was seen before the fold [px], shape (N, 2): better than the model's own outline, whose
            edges are straight. None takes that outline.
        thickness: of one layer of the model [px].
    """

    def __init__(
        self,
        model: FoldedModel,
        line: FoldLine | None,
        evidence: Evidence,
        seen: Floats | None = None,
        thickness: float = 0.0,
    ) -> None:
        self._model, self._line, self._evidence = model, line, evidence
        after = model.fold(line).outline() if line else model.outline()
        self._outline = np.ascontiguousarray(model.outline() if seen is None else _simplified(seen))
        self._boundary = resample(self._outline, 240)
        self.centre = (after.min(0) + after.max(0)) / 2
        if line is None:
            self._pivot, self._angle, self._half, self._inset = self.centre, 0.0, 0.0, 0.0
        else:
            start, end = np.array(line.start), np.array(line.end)
            self._pivot, self._angle = (start + end) / 2, float(np.arctan2(*(end - start)[::-1]))
            self._half = line.length / 2
            self._inset = 0.5 * _TIGHT * model.plies(line) * thickness

    @property
    def folds(self) -> bool:
        """Whether there is a fold line to refit."""
        return self._line is not None

    @property
    def rest(self) -> Floats:
        """Parameters of the model as planned."""
        return np.array([0.0, 0.0, 0.0, 0.0 if self._line else _FAR, 0.0, self._inset])

    def minimise(
        self, start: Floats, free: tuple[int, ...], delta: float, anchored: bool = True, iterations: int = 25
    ) -> Refit:
        """Levenberg-Marquardt over the ``free`` parameters; ``anchored`` keeps the priors on the garment's motion."""
        scale = self._evidence.scale
        sigmas = _SIGMAS * np.array([scale, scale, 1.0, scale, 1.0, scale])
        precision = 1.0 / sigmas**2
        if not anchored:
            precision[:3] = 0.0
        index = np.array(free)
        precision = np.where(np.isin(np.arange(6), index), precision, 0.0)

        def completed(chosen: Floats) -> Floats:
            parameters = start.copy()
            parameters[index] = chosen
            return parameters

        def terms(chosen: Floats) -> _FoldTerms:
            return self._terms(completed(chosen), precision, delta).of(index)

        chosen, found = minimise(terms, start[index], iterations, _DAMPING)
        return Refit(completed(chosen), found.cost, found.chamfer)

    def moved(self, parameters: Floats) -> FoldedModel:
        """The model, folded along the refitted line and moved."""
        model = self._model
        if self._line is not None:
            model = model.fold(self.line(parameters), 2.0 * float(parameters[5]), self._line)
        return model.transformed(float(parameters[2]), parameters[:2], self.centre)

    def can_fold(self, parameters: Floats) -> bool:
        """Whether the refitted line still has cloth on both sides of the model."""
        try:
            self.moved(parameters)
        except PlanError:
            return False
        return True

    def line(self, parameters: Floats) -> FoldLine:
        """The refitted line, before the motion."""
        angle = self._angle + parameters[4]
        along, left = np.array([np.cos(angle), np.sin(angle)]), np.array([np.sin(angle), -np.cos(angle)])
        middle = self._pivot + parameters[3] * left
        return FoldLine.between(middle - self._half * along, middle + self._half * along)

    def _terms(self, parameters: Floats, precision: Floats, delta: float) -> _FoldTerms:
        evidence = self._evidence
        cost, chamfer, gradient, hessian = fold_terms.fold_normal_equations(
            self._boundary,
            self._outline,
            self.centre,
            self._pivot,
            self._angle,
            parameters,
            evidence.samples,
            evidence.field,
            evidence.margin,
            delta * evidence.scale,
        )
        weight = _WEIGHT / evidence.scale**2
        unusual = parameters - np.array([0.0, 0.0, 0.0, 0.0, 0.0, self._inset])
        prior = precision * unusual
        return _FoldTerms(
            weight * cost + 0.5 * float(prior @ unusual),
            weight * gradient + prior,
            weight * hessian + np.diag(precision),
            chamfer,
        )


def _simplified(contour: Floats) -> Floats:
    """The contour with fewer corners, nowhere more than half a pixel off."""
    import cv2

    return cv2.approxPolyDP(contour.astype(np.float32), 0.5, True)[:, 0, :].astype(float)


def refit_fold(silhouette: Silhouette) -> list[Refit]:
    """Explanations of the picture after a fold, best first: rigid registration, then six starts for six numbers."""
    rigid = silhouette.minimise(silhouette.rest, (0, 1, 2), 15.0)
    starts = [silhouette.rest]
    for offset, turn in _SPREAD:
        starts.append(rigid.parameters + np.array([0.0, 0.0, 0.0, offset, np.radians(turn), 0.0]))
    found = [silhouette.minimise(start, _ALL, 4.0) for start in starts]
    return sorted(found, key=lambda refit: refit.energy)


def register(silhouette: Silhouette, evidence: Evidence, rotations: int = 24) -> list[Refit]:
    """Rigid explanations from all rotations, best first, for a garment that was displaced."""
    shift = (evidence.contour.min(0) + evidence.contour.max(0)) / 2 - silhouette.centre
    coarse = []
    for turn in np.arange(rotations) * 2 * np.pi / rotations:
        start = silhouette.rest + np.array([*shift, turn, 0.0, 0.0, 0.0])
        coarse.append(silhouette.minimise(start, (0, 1, 2), 15.0, anchored=False, iterations=6))
    coarse.sort(key=lambda refit: refit.energy)
    free = _ALL if silhouette.folds else (0, 1, 2)
    fine = [silhouette.minimise(refit.parameters, free, 4.0, anchored=False) for refit in coarse[:4]]
    return sorted(fine, key=lambda refit: refit.energy)
