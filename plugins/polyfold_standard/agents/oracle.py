"""The oracle: the best that one knows how to do with a task, told all that there is to know.

It folds along the true lines, looks how near each fold came to the ideal, and while that is not near enough puts the
cloth back and tries its next-best picks: a little less far, since a bend uses up cloth, or a little further in or out.
A task that even the oracle can't bring near the ideal is unfit to judge others by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import GroundingError
from polyfold.geometry import Camera, FoldLine, contour_of
from polyfold.plugins.interfaces import Goal, Policy, Segmenter
from polyfold.types import Action, Decision, Observation, Outcome, Scene, SimState, Subgoal
from polyfold_standard.criteria import Strict
from polyfold_standard.metrics import MPPE, IoU, MovedPartError

VARIATIONS = (
    (6.0, 0.0),
    (0.0, 0.12),
    (12.0, 0.0),
    (6.0, 0.12),
    (-6.0, 0.0),
    (0.0, -0.08),
    (12.0, 0.12),
    (0.0, 0.24),
)
"""What is tried in turn: how much less far the flap is carried than the line says [mm], and how much further towards
each other two arms pick, as a share of their distance. A resting bend of a ply takes up 6 to 8 mm of cloth."""

REPEATS = 3
"""How often the best try is made again at most, where faults that are never twice the same spoil it."""

NEARLY = 1.05
"""How near to the best try its repetition must come."""

BUDGET = 48
"""Tries of all folds together, so that a task of many folds comes to its end: no episode takes more."""


@dataclass(eq=False)
class _Trial:
    """A fold that is being tried.

    Attributes:
        line: its fold line [px].
        scene: what was seen before it.
        state: the cloth before it.
        ideal: what it should lead to.
        action: what is tried now.
        waiting: what else there is to try.
        tried: how far from the ideal each try came, as a share of what is allowed.
        repeats: how often the best of them may still be made again.
        settled: whether the best that was found lies there, or nearly.
    """

    line: FoldLine
    scene: Scene
    state: SimState
    ideal: Outcome
    action: Action
    waiting: list[Action]
    repeats: int
    tried: list[tuple[float, Action]] = field(default_factory=list)
    settled: bool = False

    def next_action(self, error: float, enough: float) -> Action | None:
        """What to do after the last try came that far from the ideal: another, the best again, or None."""
        self.tried.append((error, self.action))
        if error > enough and self.waiting:
            self.action = self.waiting.pop(0)
            return self.action
        self.waiting.clear()
        least, best = min(self.tried, key=lambda tried: tried[0])
        self.settled = error <= max(NEARLY * least, enough) or self.repeats == 0
        if self.settled:
            return None
        self.repeats -= 1
        self.action = best
        return best


class Oracle:
    """Folds along the true lines, compares each fold with the ideal, and tries other picks until it is near enough."""

    requires: ClassVar[frozenset[str]] = frozenset({"fold_lines", "ideals", "simulator"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter", "policy")

    class Config(BaseModel):
        """Parameters."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        enough: float = Field(
            default=0.6,
            ge=0,
            description="share of what the strict criterion allows at which a fold is near enough to the ideal",
        )

    def __init__(self, config: Config, segmenter: Segmenter, policy: Policy) -> None:
        self._enough = config.enough
        self._segmenter = segmenter
        self._policy = policy
        self._metrics = {"mppe": MPPE(), "miou": IoU(), "moved-part": MovedPartError()}

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Take the true lines, and what each fold should lead to."""
        self._kind, self._simulator = goal.template.kind, goal.simulator
        self._pending = list(zip(goal.fold_lines or (), goal.ideals or (), strict=True))
        self._tries = BUDGET // max(len(self._pending), 1)
        self._rng = np.random.default_rng(goal.seed)
        self._trial: _Trial | None = None
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """Another try of the last fold while none was near enough, else the next fold; None after the last."""
        if self._trial is not None and not self._trial.settled:
            action = self._trial.next_action(self._error(self._trial.ideal, observation), self._enough)
            if action is not None:
                self._simulator.restore(self._trial.state)
                return Decision(action, None, self._trial.line, self._trial.scene, retry=True)
        if not self._pending:
            return None
        line, ideal = self._pending.pop(0)
        mask = self._segmenter.segment(observation)
        scene = Scene(self._kind, (mask.shape[1], mask.shape[0]), mask, contour_of(mask), None, "{}")
        action = self._policy.act(line, scene, self._rng)
        repeats = min(REPEATS, self._tries - 1)
        others = _variations(action, line, mask, observation.camera)[: self._tries - 1 - repeats]
        self._trial = _Trial(line, scene, self._simulator.state(), ideal, action, others, repeats)
        return Decision(action, None, line, scene)

    def _error(self, ideal: Outcome, observation: Observation) -> float:
        """How far the cloth is from the ideal, as a share of what the strict criterion allows."""
        try:
            mask = self._segmenter.segment(observation)
        except GroundingError:
            return np.inf
        result = replace(ideal, end=self._simulator.state(), mask=mask)
        return max(bound.share(self._metrics[bound.metric].score(result, [ideal])) for bound in Strict.thresholds)


def _variations(action: Action, line: FoldLine, mask: NDArray[np.bool_], camera: Camera) -> list[Action]:
    """An action carried less far, or with its arms nearer together or farther apart, where all still hold cloth."""
    found = []
    for short_mm, inwards in VARIATIONS:
        picks = action.picks + inwards * (action.picks.mean(axis=0) - action.picks)
        column, row = np.clip(np.rint(picks).astype(int), 0, [camera.width - 1, camera.height - 1]).T
        if not mask[row, column].all():
            continue
        way = line.mirror(picks) - picks
        share = 1.0 - short_mm / 1000 * camera.pixels_per_metre / np.hypot(*way.T)[:, None]
        places = np.clip(picks + share * way, 0.0, [camera.width - 1.0, camera.height - 1.0])
        found.append(Action(picks, places))
    return found
