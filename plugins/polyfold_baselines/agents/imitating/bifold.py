"""``bifold``: heatmaps of two arms from the cloth and a sentence.

O. Barbany, A. Colomé, C. Torras, BiFold: Bimanual Cloth Folding with Language Guidance, ICRA 2025, arXiv:2501.16458.
It is newer than the paper of PolyFold and not in its tables.

The same here: from one view and a sentence, a heatmap each for where the left and the right arm pick and place, read
on the cloth; learned by demonstrations alone; one sentence a fold. Different: a U-Net that the sentence modulates, as
their own smaller variant, instead of SigLIP's towers with low-rank adapters; heights and mask instead of colour, which
tell plies apart in our camera's flat colours; no pictures of earlier steps; the better naming of two arms.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from polyfold_baselines.agents.imitating.imitation import SentenceImitation

if TYPE_CHECKING:
    from polyfold_baselines.learning.networks.network import Network


class BiFold(SentenceImitation):
    """A U-Net that a sentence modulates, to heatmaps."""

    row: ClassVar[str] = "bifold"
    arms: ClassVar[int] = 2

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> Network:
        """The network."""
        from polyfold_baselines.learning.networks.conditioned import ConditionedUNet

        return ConditionedUNet(config["arms"], config["width"], config["depth"])
