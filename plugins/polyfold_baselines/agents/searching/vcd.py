"""``vcd``: visible connectivity dynamics. The drag is taken that a learned model of visible cloth says is the best.

X. Lin, Y. Wang, Z. Huang and D. Held, Learning Visible Connectivity Dynamics for Cloth Smoothing, CoRL 2021,
arXiv:2105.10389; reference 14 of the paper of PolyFold, which trains it on random folds of its four kinds of cloth and
gives it accurate subgoals (Table II) or the last one alone (Table III).

The same here: points of the cloth that is seen are nodes of a graph; a graph network learns from the simulator which
near nodes are joined on the cloth, another where nodes come to lie; both from random drags alone; random shooting over
500 picks and places of one arm, the best of which is done. Different: the cost is the Chamfer distance to the goal's
points, since smoothing, by the area that cloth covers, has no goal; a whole drag is one prediction, instead of steps of
a centimetre or two with velocities and a picker's height, so that each node is told where the pick is and how far it
goes; 128 nodes spread evenly, with their ten nearest, instead of voxels of 2 cm and a radius; 6 rounds of messages
instead of 10, which are not kept at edges; the two networks are trained at once; half of the tries move what the goal
leaves bare onto the goal, instead of all anywhere; no teacher that sees the whole cloth and predicts rewards besides.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from polyfold.plugins.interfaces import Goal, Segmenter
from polyfold.types import Action, Decision, Observation, Subgoal
from polyfold_baselines.agents.goals import GoalPictures
from polyfold_baselines.agents.imitating.imitation import ImitationConfig, read_weights, weights_file
from polyfold_baselines.agents.searching.shooting import best_drag
from polyfold_baselines.demos.window import in_view, on_cloth, on_table
from polyfold_baselines.learning.dynamics.graphs import nodes_of

if TYPE_CHECKING:
    from polyfold_baselines.learning.dynamics.network import VisibleDynamics

Floats = NDArray[np.float64]


class Vcd:
    """Random shooting in a model of the visible cloth, towards a picture of the goal in depth.

    With steps guidance it folds once for each subgoal; with the final goal alone as often as the task takes, each time
    as near to it as one drag comes.
    """

    row: ClassVar[str] = "vcd"
    requires: ClassVar[frozenset[str]] = frozenset({"subgoal_depths", "fold_count"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter",)

    class Config(ImitationConfig):
        """Parameters."""

        tries: int = Field(default=500, ge=2, description="drags to choose from, for a fold")

    def __init__(self, config: Config, segmenter: Segmenter) -> None:
        self._config, self._segmenter = config, segmenter
        self._model: VisibleDynamics = read_weights(type(self), config).network

    @classmethod
    def files_read(cls, config: Config) -> list[Path]:
        """The file of its weights."""
        return [weights_file(cls, config)]

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> VisibleDynamics:
        """The untrained networks of what ``fit.json`` says."""
        from polyfold_baselines.learning.dynamics.network import VisibleDynamics

        return VisibleDynamics(config["width"], config["depth"])

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Look at the garment, and at the goals as they would look from there."""
        self._goals = GoalPictures(goal, observation, self._segmenter.segment(observation))
        self._rng = np.random.default_rng(goal.seed)
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """The best of the drags that were drawn; None after the last fold."""
        if (wanted := self._goals.next()) is None:
            return None
        window, camera = self._goals.window, observation.camera
        mask, extent = self._segmenter.segment(observation), window.extent(camera)
        nodes, goal = (nodes_of(*view, extent) for view in (self._goals.now(observation, mask), wanted))

        def lands(picks: Floats, places: Floats) -> Floats:
            return self._model.lands(nodes, picks, places, extent)

        limit = [camera.width - 1.0, camera.height - 1.0]
        bounds = on_table(window.to_view([[0.0, 0.0], limit]), extent)
        drag = best_drag(lands, nodes, goal, self._config.tries, extent, bounds, self._rng)
        pick, place = (window.to_pixels(in_view(point[None], extent)) for point in (drag.pick, drag.place))
        return Decision(Action(on_cloth(pick, mask), np.clip(place, 0.0, limit)))
