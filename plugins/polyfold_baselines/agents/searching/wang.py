"""``wang``: search in a simulator for the pick and place that bring a simplified mesh nearest to its goal.

S. Wang, R. Papallas, M. Leonetti and M. Dogar, Goal-Conditioned Action Space Reduction for Deformable Object
Manipulation, ICRA 2023; reference 13 of the paper of PolyFold, which gives it accurate subgoals (Table II) or the last
one alone (Table III). It is told the true state of the cloth and the goal of each particle, and marked so.

The same here: a mesh that is simplified by its goal leaves a few points to pick at; a cross-entropy search over which
point and how far it moves; each try is a fold in the simulator; one arm; the cost is how far all particles are from
where they should be. Different: the points are corners of the simplified outline, of which those count that the goal
moves; tries are made in a coarse copy of the garment (500 particles) that follows what is done to the real one, 192 a
fold; the search begins at each point's own way to its goal, which helps it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.config import ComponentSpec
from polyfold.plugins.interfaces import Goal
from polyfold.types import Action, Decision, Observation, SimState, Subgoal
from polyfold_baselines.agents.goals import InTurn
from polyfold_baselines.agents.searching.planning import Copy, pixels

Floats = NDArray[np.float64]

MOVES = 0.02
"""A point that the goal moves by less [m] is none to pick at."""
SMOOTHED = 0.3
"""What is kept of the distribution before, at each round."""


class Wang:
    """Cross-entropy search over points of a simplified mesh and how far they move."""

    requires: ClassVar[frozenset[str]] = frozenset({"ideals", "state", "fold_count"})
    uses: ClassVar[tuple[str, ...]] = ()

    class Config(BaseModel):
        """Parameters."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        samples: int = Field(default=24, ge=2, description="tries in a round")
        rounds: int = Field(default=8, ge=1, description="rounds for a fold")
        elite: float = Field(default=0.25, gt=0, lt=1, description="share of the tries that the next round is drawn by")
        spread_m: float = Field(default=0.1, gt=0, description="standard deviation of the first displacements [m]")
        particles: int = Field(default=500, ge=50, description="of the copy that it plans with")
        simulator: ComponentSpec = Field(default=ComponentSpec(name="xpbd"), description="that the copy lies in")

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Copy the garment, and note where each fold should bring it."""
        assert goal.ideals
        ideals = goal.ideals
        self._state, self._rng = goal.state, np.random.default_rng(goal.seed)
        mesh = ideals[0].mesh
        self._copy = Copy.of(mesh, goal.state(), goal.kind, self._config.particles, self._config.simulator)
        self._ideals = InTurn([ideal.end.positions for ideal in ideals], goal.fold_count)
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """The best action found; None after the last fold."""
        if (wanted := self._ideals.next()) is None:
            return None
        before = self._copy.simulator.state()
        targets = wanted[self._copy.match]
        best = self._searched(before, targets)
        self._follow(before, best)
        # The real garment's own particle, which may have come to lie a little elsewhere than the copy's.
        real = self._state().positions[self._copy.match[best.point]]
        return Decision(Action(*pixels(observation.camera, real, best.by)))

    def _searched(self, before: SimState, targets: Floats) -> _Try:
        config = self._config
        points = self._pickable(before, targets)
        chance = np.full(len(points), 1 / len(points))
        mean = targets[points, :2] - before.positions[points, :2]
        spread = np.full(mean.shape, config.spread_m)
        found: list[_Try] = []
        for _ in range(config.rounds):
            chosen = self._rng.choice(len(points), config.samples, p=chance)
            moves = mean[chosen] + spread[chosen] * self._rng.standard_normal((config.samples, 2))
            tries = [self._tried(before, targets, int(points[k]), move) for k, move in zip(chosen, moves, strict=True)]
            found += tries
            order = np.argsort([each.cost for each in tries])[: max(2, round(config.elite * config.samples))]
            chance = SMOOTHED * chance + (1 - SMOOTHED) * np.bincount(chosen[order], minlength=len(points)) / len(order)
            for point in np.unique(chosen[order]):
                best = moves[order[chosen[order] == point]]
                mean[point] = SMOOTHED * mean[point] + (1 - SMOOTHED) * best.mean(0)
                narrow = best.std(0) if len(best) > 1 else spread[point] / 2
                spread[point] = SMOOTHED * spread[point] + (1 - SMOOTHED) * narrow
        return min(found, key=lambda each: each.cost)

    def _pickable(self, before: SimState, targets: Floats) -> NDArray[np.int64]:
        """Corners that the goal moves; all of them if it moves none."""
        corners = self._copy.corners
        way = np.linalg.norm(targets[corners, :2] - before.positions[corners, :2], axis=1)
        return corners[way > MOVES] if (way > MOVES).any() else corners

    def _tried(self, before: SimState, targets: Floats, point: int, by: Floats) -> _Try:
        ends = self._copy.lands(before, self._action(before, point, by))
        cost = np.inf if ends is None else float(np.linalg.norm(ends - targets, axis=1).mean())
        return _Try(point, by, cost)

    def _action(self, before: SimState, point: int, by: Floats) -> Action:
        return Action(*pixels(before.camera, before.positions[point], by))

    def _follow(self, before: SimState, best: _Try) -> None:
        """The copy does as the real garment will."""
        if self._copy.lands(before, self._action(before, best.point, best.by)) is None:
            self._copy.simulator.restore(before)


@dataclass(frozen=True, eq=False)
class _Try:
    """A pick at a point of the copy, how far it was moved [m], and how far all lay from the goal then [m]."""

    point: int
    by: Floats
    cost: float
