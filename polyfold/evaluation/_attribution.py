"""Why an episode failed: the first error in the chain, found by comparing with what the oracle would have done.

Stages in order (paper, Sec. VI): ``infrastructure``, ``grounding``, ``subgoal``, ``fold line``, ``policy``,
``execution``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from polyfold.evaluation._references import Reference
from polyfold.geometry import FoldLine
from polyfold.tasks._ideal import fidelity, fold_ideally
from polyfold.types import Episode, SimState, Step

CAUSES = ("infrastructure", "grounding", "subgoal", "fold line", "policy", "execution")

OFF = 0.05
"""Share of the garment's span by which lines, vertices and landing places may be off."""
TURNED = 10.0
"""Degrees by which a fold line may be turned."""
AS_PLANNED = 0.85
"""IoU with the ideal fold along the planned lines from which the folds came out as planned."""


def attribute(episode: Episode, lines: Sequence[FoldLine], reference: Reference) -> str:
    """The first cause of a failure.

    Args:
        episode: the failed episode.
        lines: the oracle's fold lines [px], on the garment as it lay at the start.
        reference: the oracle's states.
    """
    if episode.failure is not None:
        return _of_failure(episode.failure.stage, bool(episode.subgoals))
    pixels = np.array(list(episode.initial_state.keypoint_pixels().values()))
    span = float(np.ptp(pixels, axis=0).max())
    settled = episode.final_attempts()
    for number, (step, line) in enumerate(zip(settled, lines, strict=False)):
        cause = _of_step(number, step, line, lines, span, episode, reference)
        if cause is not None:
            return cause
    return "subgoal" if len(settled) != len(lines) else "execution"


def attribute_open(episode: Episode, mask: NDArray[np.bool_]) -> str:
    """The first cause of missing a goal that prescribes no folds.

    There is no right plan to compare with. So it is ``subgoal`` where the folds came out as planned, for then the plan
    was wrong, also if that was to fold nothing; ``execution`` where they did not, or where nothing tells what was
    planned. A plan that went wrong because the garment was seen wrongly counts as ``subgoal`` too.

    Args:
        episode: the failed episode.
        mask: the cloth in the last picture, bool, shape (H, W).
    """
    if episode.failure is not None:
        return _of_failure(episode.failure.stage, bool(episode.subgoals))
    settled = episode.final_attempts()
    lines = [step.fold_line for step in settled if step.fold_line is not None]
    if len(lines) != len(settled):
        return "execution"
    planned = fold_ideally(episode.initial_state, episode.garment, lines)
    found = fidelity(mask, episode.final_state, episode.initial_state, planned, reference="self-referenced")
    return "subgoal" if found.iou >= AS_PLANNED else "execution"


def _of_failure(stage: str, decomposed: bool) -> str:
    """The cause of an episode that ended early; a plan that failed before there were subgoals failed at them."""
    causes = {
        "infrastructure": "infrastructure",
        "unanswered": "infrastructure",
        "refused": "subgoal",
        "grounding": "grounding",
        "policy": "policy",
        "planning": "fold line" if decomposed else "subgoal",
    }
    return causes.get(stage, "execution")


def _of_step(
    number: int,
    step: Step,
    line: FoldLine,
    lines: Sequence[FoldLine],
    span: float,
    episode: Episode,
    reference: Reference,
) -> str | None:
    """The cause if the fault lies in this step."""
    if step.fold_line is None:
        return None
    if not _agree(step.fold_line, line, span):
        before = episode.initial_state if number == 0 else episode.final_attempts()[number - 1].after
        if _vertices_off(step, before) > OFF * span:
            return "grounding"
        meant_another = any(_agree(step.fold_line, other, span) for other in lines if other is not line)
        return "subgoal" if meant_another or len(episode.subgoals) != len(lines) else "fold line"
    landed = _landing_error(number, step, reference)
    if landed is None or landed * episode.start.camera.pixels_per_metre <= OFF * span:
        return None
    return "policy" if _picks_off(step, span) else "execution"


def _agree(planned: FoldLine, wanted: FoldLine, span: float) -> bool:
    a, b = (np.subtract(line.end, line.start) / line.length for line in (planned, wanted))
    middle = (np.asarray(wanted.start) + wanted.end) / 2
    return bool(a @ b >= np.cos(np.radians(TURNED)) and abs(float(planned.distance(middle))) <= OFF * span)


def _vertices_off(step: Step, before: SimState) -> float:
    """Mean distance [px] between fitted vertices and true keypoints before the step; 0 without a model."""
    if step.scene is None or step.scene.model is None:
        return 0.0
    truth = before.keypoint_pixels()
    vertices = step.scene.model.vertices()
    distances = [np.hypot(*(vertices[name].point - truth[name])) for name in truth if name in vertices]
    return float(np.mean(distances)) if distances else 0.0


def _landing_error(number: int, step: Step, reference: Reference) -> float | None:
    """Mean particle distance [m] from the oracle's state after the same step."""
    if number >= len(reference.after):
        return None
    return float(np.linalg.norm(step.after.positions - reference.after[number].positions, axis=1).mean())


def _picks_off(step: Step, span: float) -> bool:
    """Whether the picks lie nearer to the line than to the far side of what they lift."""
    if step.scene is None or step.fold_line is None:
        return False
    depth = step.fold_line.distance(step.scene.contour).max()
    return bool(step.fold_line.distance(step.action.picks).max() < 0.6 * depth)
