"""Policies whose two picks go together: the coupled spatial action map, its vertices, and values of pairs."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from polyfold.geometry import FoldLine
from polyfold.types import Scene
from polyfold_fgpnp.policies.affordance import PARTNER_SLIDE, affordance, best_pair, coupled_pick
from polyfold_fgpnp.policies.learned import WEIGHTS, LearnedConfig, LearnedPolicy, network_of
from polyfold_fgpnp.policies.region import FoldRegion, fold_region, lifted_vertices, nearest_point

Floats = NDArray[np.float64]

CANDIDATES = 72
"""Contour points that a network which values pairs compares."""

PRIOR = "what the best affordance adds, in standard deviations of labels"


class CoupledConfig(LearnedConfig):
    """Parameters of policies whose second pick follows from the first."""

    weights: str = Field(default="csam", description=WEIGHTS)
    prior: float = Field(default=0.0, ge=0, description=PRIOR)
    slide: float = Field(default=0.0, ge=0, lt=0.5, description="share of their distance that the partner moves")


def _prior(region: FoldRegion, first: Floats, second: Floats, weight: float, gamma: float) -> Floats:
    """The affordance of pairs of points [px], each of shape (K, 2), over the best one's, weighted: shape (K,)."""
    return weight * affordance(region, first, second, gamma) / affordance(region, *best_pair(region, gamma), gamma)


class Coupled(LearnedPolicy):
    """The first pick by value; its partner by affordance, given the first."""

    config: CoupledConfig

    def action_map(self, fold_line: FoldLine, scene: Scene) -> tuple[Floats, Floats]:
        """The lifted contour [px], shape (N, 2), and the value of picking there, shape (N,); higher is better."""
        points, _, values = self._coupled(fold_region(fold_line, scene), scene)
        return points, values

    def _choose(self, region: FoldRegion, scene: Scene) -> tuple[Floats, Floats]:
        points, partners, values = self._coupled(region, scene)
        best = int(np.argmax(values))
        return points[best], partners[best]

    def _coupled(self, region: FoldRegion, scene: Scene) -> tuple[Floats, Floats, Floats]:
        """Points and their partners [px], shape (N, 2) each, and values, shape (N,)."""
        points = self._candidates(region, scene)
        partners = coupled_pick(region, points, self.config, self.config.slide)
        values = self._coupled_values(region, scene, points, partners)
        return points, partners, values + _prior(region, points, partners, self.config.prior, self.config.gamma)

    @abstractmethod
    def _candidates(self, region: FoldRegion, scene: Scene) -> Floats:
        """Points that may be picked first [px], shape (N, 2)."""

    @abstractmethod
    def _coupled_values(self, region: FoldRegion, scene: Scene, firsts: Floats, partners: Floats) -> Floats:
        """What picking at points and their partners [px], shape (N, 2) each, is worth, shape (N,)."""


class CoupledActionMap(Coupled):
    """The contour point with the highest value in the coupled spatial action map; its partner by affordance.

    The paper's policy (Sec. IV-D): nothing is added to the map, and the partner is the conditional optimum itself. With
    weights in the canonical frame it is the same policy that sees otherwise.
    """

    variant: ClassVar[str] = "csam"
    Config = CoupledConfig

    def _candidates(self, region: FoldRegion, scene: Scene) -> Floats:
        return region.points

    def _coupled_values(self, region: FoldRegion, scene: Scene, firsts: Floats, partners: Floats) -> Floats:
        return self._values(region, scene, firsts)[0]


class VertexLearned(CoupledActionMap):
    """As the coupled spatial action map, but only visible vertices of the polygon model are picked first.

    The network was trained on picks at the outline's corners alone, as the paper's. With weights of ``csam`` what the
    dense map adds can be told from what the network adds.
    """

    variant: ClassVar[str] = "vertex-learned"
    also: ClassVar[tuple[str, ...]] = ("csam",)

    class Config(CoupledConfig):
        """Parameters."""

        weights: str = Field(default="vertex-learned", description=WEIGHTS)

    def _candidates(self, region: FoldRegion, scene: Scene) -> Floats:
        return np.array([nearest_point(region.points, vertex) for vertex in lifted_vertices(region, scene)])


class CoupledPairValue(Coupled):
    """The contour point that promises most together with its partner by affordance, by a network that values pairs.

    Not in the paper. The partner moves a little towards the first pick, as in training (see :func:`coupled_pick`). To
    the value comes the pair's affordance, as a share of the best one, times ``prior``. It steadies the choice on flaps
    unlike any in training, and lowers the flap's error on t-shirts held out from training too (13.8 to 13.5 mm,
    n = 120).
    """

    variant: ClassVar[str] = "pair"

    class Config(CoupledConfig):
        """Parameters."""

        weights: str = Field(default="pair", description=WEIGHTS)
        prior: float = Field(default=2.0, ge=0, description=PRIOR)
        slide: float = Field(
            default=PARTNER_SLIDE, ge=0, lt=0.5, description="share of their distance that the partner moves"
        )

    def _candidates(self, region: FoldRegion, scene: Scene) -> Floats:
        return _thinned(region.points)

    def _coupled_values(self, region: FoldRegion, scene: Scene, firsts: Floats, partners: Floats) -> Floats:
        return self._pair_values(region, scene, firsts, partners)


class PairConfig(LearnedConfig):
    """Parameters of :class:`PairValue`."""

    weights: str = Field(default="pair", description=WEIGHTS)
    prior: float = Field(default=2.0, ge=0, description=PRIOR)


class PairValue(LearnedPolicy):
    """Both picks at once: the pair of contour points with the highest joint value, the same twice for one arm.

    Not in the paper, whose map knows the second pick only through affordance. As in :class:`CoupledPairValue` the
    pair's affordance is added to its value.
    """

    variant: ClassVar[str] = "pair"
    Config = PairConfig
    config: PairConfig

    def _choose(self, region: FoldRegion, scene: Scene) -> tuple[Floats, Floats]:
        points, values = self._all_pairs(region, scene)
        first, second = np.unravel_index(int(np.argmax(values)), values.shape)
        return points[first], points[second]

    def action_map(self, fold_line: FoldLine, scene: Scene) -> tuple[Floats, Floats]:
        """The lifted contour [px], shape (N, 2), and the value of picking there with the best partner, shape (N,)."""
        points, values = self._all_pairs(fold_region(fold_line, scene), scene)
        return points, values.max(axis=1)

    def _all_pairs(self, region: FoldRegion, scene: Scene) -> tuple[Floats, Floats]:
        """N points of the contour, shape (N, 2), and the value of every pair of them, symmetric, shape (N, N)."""
        points = _thinned(region.points)
        first, second = np.triu_indices(len(points))
        found = self._pair_values(region, scene, points[first], points[second])
        found += _prior(region, points[first], points[second], self.config.prior, self.config.gamma)
        values = np.empty((len(points), len(points)))
        values[first, second] = values[second, first] = found
        return points, values


def _thinned(points: Floats) -> Floats:
    """At most :data:`CANDIDATES` of the points, evenly spread."""
    return points[np.linspace(0, len(points) - 1, min(len(points), CANDIDATES)).astype(int)]


def value_policy(weights: Path) -> Coupled:
    """The policy with a map of first picks that a file of weights serves, by what they are.

    Raises:
        ConfigError: if they can't be read, or are of a network without such a map.
    """
    of_pairs = network_of(str(weights), (CoupledActionMap.variant, CoupledPairValue.variant)).config.variant == "pair"
    cls = CoupledPairValue if of_pairs else CoupledActionMap
    return cls(cls.Config(weights=str(weights)))
