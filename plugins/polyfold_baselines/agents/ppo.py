"""``ppo``: proximal policy optimisation from depth and particles, with a dense reward.

J. Schulman et al., Proximal Policy Optimization Algorithms, arXiv:1707.06347, as stable-baselines3 has it (A. Raffin et
al., JMLR 22(268), 2021). The paper of PolyFold gives it the picture and down-sampled particles, rewards it by distance,
and gives it accurate subgoals (Table II) or the last one alone (Table III). It is told the true state, and marked so.

The same here: picture and particles, now and wanted, to picks and places of two arms; a reward by the distance that a
fold takes away; only seen tasks. Different: heights, cloth and the goal's silhouette at 84 x 84 pixels instead of
colour and depth; 100 particles; picks are moved onto the nearest cloth; an episode ends with the first bad fold,
since what follows has no sense then.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from polyfold.plugins.interfaces import Goal, Segmenter
from polyfold.types import Decision, Observation, Subgoal
from polyfold_baselines.agents.goals import InTurn
from polyfold_baselines.agents.imitating.imitation import ImitationConfig, read_weights, weights_file
from polyfold_baselines.demos.window import Window


class Ppo:
    """A policy that learned by trying."""

    row: ClassVar[str] = "ppo"
    requires: ClassVar[frozenset[str]] = frozenset({"ideals", "state", "fold_count"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter",)
    Config: ClassVar[type[ImitationConfig]] = ImitationConfig

    def __init__(self, config: ImitationConfig, segmenter: Segmenter) -> None:
        self._policy: Any = read_weights(type(self), config).network
        self._segmenter = segmenter

    @classmethod
    def files_read(cls, config: ImitationConfig) -> list[Path]:
        """The file of its weights."""
        return [weights_file(cls, config)]

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> Any:
        """The untrained policy of what ``fit.json`` says."""
        from polyfold_baselines.learning.trying.reinforcing import policy_of

        return policy_of(config)

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Look at the garment, and note where each fold should bring it."""
        from polyfold_baselines.learning.trying.environment import TaskView

        assert goal.ideals
        self._state = goal.state
        window = Window.around(self._segmenter.segment(observation))
        self._view = TaskView(goal.ideals[0].mesh, window)
        self._ideals = InTurn([ideal.end.positions for ideal in goal.ideals], goal.fold_count)
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """The policy's likeliest action; None after the last fold."""
        if (wanted := self._ideals.next()) is None:
            return None
        mask = self._segmenter.segment(observation)
        numbers, _ = self._policy.predict(
            self._view.observation(observation, mask, self._state(), wanted), deterministic=True
        )
        return Decision(self._view.action(numbers, mask, observation))
