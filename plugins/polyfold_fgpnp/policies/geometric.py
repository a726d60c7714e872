"""Policies without learning: the best pair by affordance, or a random or the farthest point with its best partner."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from polyfold.geometry import FoldLine
from polyfold.types import Action, Scene
from polyfold_fgpnp.policies.actions import PickConfig, to_action
from polyfold_fgpnp.policies.affordance import best_pair, second_pick, slide
from polyfold_fgpnp.policies.region import FoldRegion, fold_region, lifted_vertices, nearest_point


class AffordancePair:
    """The pair of contour pixels with the best affordance score: what the paper optimises for one pick, for both.

    Each of two picks then slides along the contour towards the other by a tenth of their distance. That is not in the
    paper (0 turns it off). Over the 70 tasks, their true fold lines and three garments of each kind it lowers the mean
    error of the moved part from 10.2 to 9.7 mm, of trousers folded in half from 11.5 to 7.8 mm; others hardly change.
    """

    class Config(PickConfig):
        """Parameters."""

        slide: float = Field(
            default=0.1, ge=0, lt=0.5, description="share of their distance that two picks move together"
        )

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()

    def act(self, fold_line: FoldLine, scene: Scene, rng: np.random.Generator) -> Action:
        """Pick the best pair; ``rng`` is not used."""
        region = fold_region(fold_line, scene)
        first, second = best_pair(region, self.config.gamma)
        share = self.config.slide
        picks = slide(region, first, second, share), slide(region, second, first, share)
        return to_action(region, *picks, self.config)


class OneArm:
    """One arm, at the contour pixel nearest to the middle of the best pair: a corner, or the middle of the far edge."""

    class Config(PickConfig):
        """Parameters."""

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()

    def act(self, fold_line: FoldLine, scene: Scene, rng: np.random.Generator) -> Action:
        """Pick between the best pair; ``rng`` is not used."""
        region = fold_region(fold_line, scene)
        first, second = best_pair(region, self.config.gamma)
        pick = nearest_point(region.points, (first + second) / 2)
        return to_action(region, pick, pick, self.config)


class Caso:
    """A random contour pixel left of the line, and its partner by conditional affordance score optimisation.

    The paper's own action as far as nothing is learned (Sec. IV-D 1): it collects its data so, and its map replaces the
    random first pick.
    """

    class Config(PickConfig):
        """Parameters."""

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()

    def act(self, fold_line: FoldLine, scene: Scene, rng: np.random.Generator) -> Action:
        """Pick a pixel drawn from ``rng`` and its best partner."""
        region = fold_region(fold_line, scene)
        first = region.points[rng.integers(len(region.points))]
        return to_action(region, first, second_pick(region, first, self.config.gamma), self.config)


class VertexRandom:
    """A random visible vertex of the polygon model left of the line; the second pick by affordance."""

    class Config(PickConfig):
        """Parameters."""

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()

    def act(self, fold_line: FoldLine, scene: Scene, rng: np.random.Generator) -> Action:
        """Pick a vertex drawn from ``rng``, moved to the nearest contour pixel left of the line.

        Raises PlanError also when the scene has no polygon model.
        """
        region = fold_region(fold_line, scene)
        vertices = lifted_vertices(region, scene)
        first = nearest_point(region.points, vertices[rng.integers(len(vertices))])
        return to_action(region, first, second_pick(region, first, self.config.gamma), self.config)


class Farthest:
    """The contour pixel farthest from the line; the second pick by affordance."""

    class Config(PickConfig):
        """Parameters."""

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()

    def act(self, fold_line: FoldLine, scene: Scene, rng: np.random.Generator) -> Action:
        """Pick the farthest pixel and its best partner; ``rng`` is not used."""
        region = fold_region(fold_line, scene)
        first = _farthest(region)
        return to_action(region, first, second_pick(region, first, self.config.gamma), self.config)


def _farthest(region: FoldRegion) -> np.ndarray:
    return region.points[np.argmax(region.distances)]
