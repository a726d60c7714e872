"""``ltf``: learning to fold. Values of every drag of every pixel, learned from folds that nobody meant.

R. Lee, D. Ward, V. Dasagi, A. Cosgun, J. Leitner and P. Corke, Learning Arbitrary-Goal Fabric Folding with One Hour of
Real Robot Experience, CoRL 2020, arXiv:2010.03209. The paper of PolyFold trains it with a sparse reward and gives it
accurate subgoals (Table II) or the last one alone (Table III).

The same here: a fully convolutional network from the cloth and the goal, as depth, to a value for each pixel, direction
and length of drag; one arm; random drags; goals in hindsight, so that what was reached had been the goal. Different: a
drag either reaches its goal or not, and nothing of what comes later is counted in (a subgoal is one fold here); what
another drag reached stands for the goals that are missed; drags have lengths by the garment's size and not in
centimetres; directions are maps of their own instead of turned pictures.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from polyfold_baselines.agents.imitating.imitation import PictureImitation

if TYPE_CHECKING:
    from polyfold_baselines.learning.networks.network import Network


class LearningToFold(PictureImitation):
    """The drag of the highest value."""

    row: ClassVar[str] = "ltf"
    arms: ClassVar[int] = 1

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> Network:
        """The network."""
        from polyfold_baselines.learning.networks.drag_values import DragValues

        return DragValues(config["width"], config["depth"])
