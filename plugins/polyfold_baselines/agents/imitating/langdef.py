"""``langdef``: a sentence, depth and a graph of the cloth in one transformer; picks at the graph's nodes.

Y. Deng, K. Mo, C. Xia and X. Wang, Learning Language-Conditioned Deformable Object Manipulation with Graph Dynamics,
ICRA 2024, arXiv:2303.01310. The paper of PolyFold trains it with one arm and with two, and gives it an accurate
sentence for each fold (Table II) or the whole instruction (Table III).

The same here: tokens of the sentence from a frozen encoder, patches of depth and nodes of a graph over the visible
cloth go through one transformer; the pick is one of the nodes, the place a heatmap; learned by demonstrations.
Different: 128 x 128 pixels about the garment and width 192; nodes are spread over the picture evenly and tied to
their nearest six, instead of voxels of a point cloud tied by a learned mesh; nothing says whether a fold is done,
since each sentence is one fold here, as in the paper's tables; all of an example is turned and moved together when
examples are varied.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from polyfold_baselines.agents.imitating.imitation import SentenceImitation

if TYPE_CHECKING:
    from polyfold_baselines.learning.networks.network import Network


class LangDef(SentenceImitation):
    """A transformer over words, patches and nodes."""

    row: ClassVar[str] = "langdef"
    arms: ClassVar[int] = 1

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> Network:
        """The network."""
        from polyfold_baselines.learning.networks.language import LanguageGraph

        return LanguageGraph(config["arms"], config["width"], config["depth"])


class LangDef2Arm(LangDef):
    """A transformer over words, patches and nodes, for two arms."""

    row: ClassVar[str] = "langdef-2arm"
    arms: ClassVar[int] = 2
