"""What the model of a picture is: fitted anew for the first one, followed from the previous model afterwards."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.garments import name_by_pose
from polyfold.geometry import FoldLine, chamfer, resample
from polyfold.polygon import FoldedModel, Template
from polyfold_grounding.fitting.evidence import Evidence
from polyfold_grounding.fitting.flat import fit_flat
from polyfold_grounding.fitting.pattern import fit_flat_by_pattern
from polyfold_grounding.fitting.refit import Refit, Silhouette, refit_fold, register

__all__ = ["Tracked", "first_model", "next_model"]

Floats = NDArray[np.float64]

_BETTER = 0.6
"""A rarer explanation (the fold failed) is believed if its distance is below this share of the usual one ..."""

_MUCH_BETTER = 0.4
"""... and a still rarer one (displaced, an earlier fold came undone) if it is below this share."""

_UNREMARKABLE = 2.0
"""A Chamfer distance [px at scale 1] that needs no rarer explanation."""

_BAD = 6.0
"""A Chamfer distance [px at scale 1] that the caller should know about."""

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
    vertices = _named_by_pose(template, fits[0].vertices)
    notes: tuple[str, ...] = ()
    if not template.cyclic and any(
        other.energy < _AS_GOOD * fits[0].energy
        and _distance(other.vertices, fits[0].vertices) > _DIFFERENT * evidence.scale
        for other in fits[1:]
    ):
        notes = ("ambiguous silhouette: another heading of the garment explains it as well",)
    model = template.model(vertices)
    return Tracked(model, _distance_to(model, evidence), notes)


def _named_by_pose(template: Template, vertices: Floats) -> Floats:
    """Vertices [px], shape (V, 2), in the order of the template's names as they follow from how the garment lies."""
    if not template.cyclic:
        return vertices
    places = {name: place for place, name in enumerate(template.names)}
    named = name_by_pose(template.names, places, vertices * (1.0, -1.0))
    return vertices[[named[name] for name in template.names]]


def next_model(
    model: FoldedModel,
    seen: Floats,
    line: FoldLine | None,
    evidence: Evidence,
    displaced: float,
    thickness: float = 0.0,
) -> Tracked:
    """Follow a model to the next picture, after a fold along ``line`` or after nothing was folded.

    Args:
        model: the model of the picture before.
        seen: the contour in the picture before [px], shape (N, 2).
        line: the fold line [px], in the picture before.
        evidence: the picture now.
        displaced: Chamfer distance [px at scale 1] above which all rotations are searched.
        thickness: of one layer of the model [px].
    """
    found = _as_planned(model, seen, line, evidence, thickness)
    if found.best.chamfer > _UNREMARKABLE * evidence.scale:
        found = min([found, *_with_a_fold_undone(model, seen, line, evidence, found, thickness)], key=_judged)
    if found.best.chamfer > displaced * evidence.scale:
        found = _anywhere(found, evidence)
    notes = found.notes
    if _ambiguous(found, evidence.scale):
        notes += ("ambiguous silhouette: another pose of the garment explains it as well",)
    moved = found.silhouette.moved(found.best.parameters)
    return Tracked(moved, _distance_to(moved, evidence), notes)


@dataclass(frozen=True, eq=False)
class _Explanation:
    """A model, its best pose and last fold line, their rivals, what is unusual, and how much better it has to be."""

    silhouette: Silhouette
    best: Refit
    rivals: list[Refit]
    notes: tuple[str, ...] = ()
    share: float = 1.0


def _judged(explanation: _Explanation) -> float:
    """Chamfer distance [px], as if it were longer for a rare explanation."""
    return explanation.best.chamfer / explanation.share


def _as_planned(
    model: FoldedModel, seen: Floats, line: FoldLine | None, evidence: Evidence, thickness: float
) -> _Explanation:
    try:
        return _explain(Silhouette(model, line, evidence, seen, thickness))
    except PlanError as problem:
        still = _explain(Silhouette(model, None, evidence, seen))
        return replace(still, notes=(f"no fold was added to the model: {problem}",))


def _with_a_fold_undone(
    model: FoldedModel,
    seen: Floats,
    line: FoldLine | None,
    evidence: Evidence,
    planned: _Explanation,
    thickness: float,
) -> Iterator[_Explanation]:
    """What it would be if the last fold had not taken effect, or an earlier one had come undone."""
    if planned.silhouette.folds:
        note = "the last fold did not take effect; the garment looks as it did before it"
        yield replace(_explain(Silhouette(model, None, evidence, seen)), notes=(note,), share=_BETTER)
    for number in range(1, len(model.folds) + 1):
        opened = model.without(number)
        note = f"fold {number} has come undone; later creases are renumbered"
        try:
            yield replace(
                _explain(Silhouette(opened, line, evidence, None, thickness)), notes=(note,), share=_MUCH_BETTER
            )
        except PlanError:
            continue


def _anywhere(found: _Explanation, evidence: Evidence) -> _Explanation:
    """The same model searched at all rotations, if that is much better; a word of warning if nothing is."""
    registered = [r for r in register(found.silhouette, evidence) if found.silhouette.can_fold(r.parameters)]
    best, *rivals = registered or [found.best]
    if best.chamfer < _MUCH_BETTER * found.best.chamfer:
        notes = (*found.notes, "the garment was displaced and has been found again")
        return replace(found, best=best, rivals=rivals, notes=notes)
    if found.best.chamfer > _BAD * evidence.scale:
        warning = f"the model explains the picture badly (Chamfer distance {found.best.chamfer:.0f} px)"
        return replace(found, notes=(*found.notes, warning))
    return found


def _explain(silhouette: Silhouette) -> _Explanation:
    """The best pose, and last fold line, of a model; raises PlanError if no line that explains the picture folds it."""
    if silhouette.folds:
        found = refit_fold(silhouette)
        folding = [refit for refit in found if silhouette.can_fold(refit.parameters)]
        if not folding:
            raise PlanError("the line that explains the picture best leaves all cloth on one side; plan another fold")
        best, *rivals = folding
        return _Explanation(silhouette, best, rivals)
    rigid = silhouette.minimise(silhouette.rest, (0, 1, 2), 15.0)
    return _Explanation(silhouette, silhouette.minimise(rigid.parameters, (0, 1, 2), 4.0, anchored=False), [])


def _ambiguous(found: _Explanation, scale: float) -> bool:
    rivals = [rival for rival in found.rivals if rival.energy < _AS_GOOD * found.best.energy]
    if not rivals:
        return False
    here = found.silhouette.moved(found.best.parameters).points()
    for rival in rivals:
        there = found.silhouette.moved(rival.parameters).points()
        if np.mean([np.hypot(*(here[name] - there[name])) for name in here]) > _DIFFERENT * scale:
            return True
    return False


def _distance(a: Floats, b: Floats) -> float:
    return float(np.hypot(*(a - b).T).mean())


def _distance_to(model: FoldedModel, evidence: Evidence) -> float:
    return chamfer(resample(model.outline(), len(evidence.samples)), evidence.samples)
