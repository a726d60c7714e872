"""``foldsformer``: attention over space and time from the cloth and a picture of the goal to heatmaps.

K. Mo et al., Foldsformer: Learning Sequential Multi-Step Cloth Manipulation With Space-Time Attention, IEEE RA-L 2023,
10.1109/LRA.2022.3229573. The paper of PolyFold trains it on its own demonstrations, with one arm and with two, and
gives it accurate subgoals (Table II) or the last one alone (Table III).

The same here: patches of depth that attend over time and space in turn, the cloth attending to the goal, heatmaps by
cross-entropy with Gaussians at demonstrated picks and places, the better naming of two arms, picks kept on the cloth.
Different: 128 x 128 pixels about the garment instead of 224 x 224; width 128 and depth 4 instead of ViT's 768 and 12;
two frames, the cloth and its next goal, instead of a whole sequence of goals; softmax over the picture instead of a
sigmoid at each pixel; heights count in millimetres over the table and not in 8 bits, which hide plies.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from polyfold_baselines.agents.imitating.imitation import PictureImitation

if TYPE_CHECKING:
    from polyfold_baselines.learning.networks.network import Network


class Foldsformer(PictureImitation):
    """Space-time attention to heatmaps."""

    row: ClassVar[str] = "foldsformer"
    arms: ClassVar[int] = 1

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> Network:
        """The network."""
        from polyfold_baselines.learning.networks.spacetime import SpaceTime

        return SpaceTime(config["arms"], config["width"], config["depth"])


class Foldsformer2Arm(Foldsformer):
    """Space-time attention to heatmaps of two arms."""

    row: ClassVar[str] = "foldsformer-2arm"
    arms: ClassVar[int] = 2
