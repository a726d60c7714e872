"""What the model of a picture is: fitted anew for the first one, followed from the previous model afterwards."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.geometry import chamfer, resample
from polyfold.polygon import FoldedModel, Template
from polyfold.types import FoldLine
from polyfold_grounding.evidence import Evidence
from polyfold_grounding.flat import fit_flat
from polyfold_grounding.naming import named_by_top
from polyfold_grounding.pattern import fit_flat_by_pattern
from polyfold_grounding.refit import Refit, Silhouette, refit_fold, register

__all__ = ["Tracked", "first_model", "next_model"]

Floats = NDArray[np.float64]

_BETTER = 0.6
"""A rarer explanation (displaced, fold failed) is believed when its distance is below this share of the usual one."""

_UNREMARKABLE = 2.0
"""A Chamfer distance [px at scale 1] that needs no rarer explanation."""

_AS_GOOD = 1.15
"""Another explanation with up to this multiple of the energy makes a silhouette ambiguous ..."""

_DIFFERENT = 15.0
"""... if its vertices are on average this far away [px at scale 1]."""


@dataclass(frozen=True, eq=False)
class Tracked:
    """A model that explains the picture, its Chamfer distance [px], and what the caller should know."""

    model: FoldedModel
    chamfer: float
    notes: tuple[str, ...] = ()


def first_model(template: Template, evidence: Evidence, rotations: int, optimizer: str) -> Tracked:
    """Fit the flat template at any rotation."""
    fit = fit_flat if optimizer == "lm" else fit_flat_by_pattern
    fits = fit(template, evidence, rotations)
    vertices = named_by_top(fits[0].vertices) if template.cyclic else fits[0].vertices
    notes: tuple[str, ...] = ()
    if not template.cyclic and any(
        other.energy < _AS_GOOD * fits[0].energy
        and _distance(other.vertices, fits[0].vertices) > _DIFFERENT * evidence.scale
        for other in fits[1:]
    ):
        notes = ("ambiguous silhouette: another heading of the garment explains it as well",)
    model = template.model(vertices)
    return Tracked(model, _distance_to(model, evidence), notes)


def next_model(model: FoldedModel, line: FoldLine | None, evidence: Evidence, displaced: float) -> Tracked:
    """Follow a model to the next picture, after a fold along ``line`` or after nothing was folded."""
    notes: list[str] = []
    try:
        silhouette = Silhouette(model, line, evidence)
    except PlanError as problem:
        notes.append(f"no fold was added to the model: {problem}")
        line, silhouette = None, Silhouette(model, None, evidence)
    best, others = _explain(silhouette)
    limit = displaced * evidence.scale
    if line is not None and best.chamfer > _UNREMARKABLE * evidence.scale:
        unfolded = Silhouette(model, None, evidence)
        still = _explain(unfolded)[0]
        if still.chamfer < _BETTER * best.chamfer:
            notes.append("the last fold did not take effect; the garment looks as it did before it")
            silhouette, best, others = unfolded, still, []
    if best.chamfer > limit:
        found = register(silhouette, evidence)
        if found[0].chamfer < _BETTER * best.chamfer:
            notes.append("the garment was displaced and has been found again")
            best, others = found[0], found[1:]
        elif best.chamfer > 2 * limit:
            notes.append(f"the model explains the picture badly (Chamfer distance {best.chamfer:.0f} px)")
    if _ambiguous(silhouette, best, others, evidence.scale):
        notes.append("ambiguous silhouette: another pose of the garment explains it as well")
    return Tracked(silhouette.moved(best.parameters), best.chamfer, tuple(notes))


def _explain(silhouette: Silhouette) -> tuple[Refit, list[Refit]]:
    if silhouette.folds:
        first, *others = refit_fold(silhouette)
        return first, others
    rigid = silhouette.minimise(silhouette.rest, (0, 1, 2), 15.0)
    return silhouette.minimise(rigid.parameters, (0, 1, 2), 4.0), []


def _ambiguous(silhouette: Silhouette, best: Refit, others: list[Refit], scale: float) -> bool:
    rivals = [other for other in others if other.energy < _AS_GOOD * best.energy]
    if not rivals:
        return False
    here = silhouette.moved(best.parameters).points()
    for rival in rivals:
        there = silhouette.moved(rival.parameters).points()
        if np.mean([np.hypot(*(here[name] - there[name])) for name in here]) > _DIFFERENT * scale:
            return True
    return False


def _distance(a: Floats, b: Floats) -> float:
    return float(np.hypot(*(a - b).T).mean())


def _distance_to(model: FoldedModel, evidence: Evidence) -> float:
    return chamfer(resample(model.outline(), len(evidence.samples)), evidence.samples)
