"""``metafold-like``: a sentence and the cloth's points to where each point goes; two of them are carried there.

H. Chen, J. Li, R. Wu, Y. Liu et al., MetaFold: Language-Guided Multi-Category Garment Folding Framework via Trajectory
Generation and Foundation Model, IROS 2025, arXiv:2503.08372. It is newer than the paper of PolyFold and not in its
tables. What is public of it is not the whole, hence *-like*.

The same here: a sentence and a cloud of points give a flow, where each point goes; what acts on cloth is told by the
flow alone. Different: one fold is one flow, instead of a trajectory of a point cloud; the flow is predicted outright
instead of drawn by a conditional variational autoencoder; points of the view with their heights, near ones joined, in a
small transformer with a frozen sentence encoder, instead of learned set features and a large language model; the flow
that is learned is the mirroring by which demonstrated picks come to their places, instead of simulated points' ways;
picks are those two points that are carried far and lie far apart, instead of contacts of a foundation model for
manipulation (ManiFoundation).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from polyfold_baselines.agents.imitating.imitation import SentenceImitation

if TYPE_CHECKING:
    from polyfold_baselines.learning.networks.network import Network


class MetaFoldLike(SentenceImitation):
    """A flow of points that a sentence asks for."""

    row: ClassVar[str] = "metafold-like"
    arms: ClassVar[int] = 2

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> Network:
        """The network."""
        from polyfold_baselines.learning.networks.flow import PointFlow

        return PointFlow(config["width"], config["depth"])
