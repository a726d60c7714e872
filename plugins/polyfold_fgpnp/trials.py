"""What random interaction tries on a flap: pairs of contour points, by a few recipes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError

from .affordance import FoldRegion, PickConfig, best_pair, coupled_pick, nearest_point, slide
from .lines import outline_corners

__all__ = ["COUPLED", "MIX", "RECIPES", "Trial", "draw_trials", "parse_mix"]

Floats = NDArray[np.float64]

LARGEST_SLIDE = 0.3
"""Picks are tried up to this share of their distance inwards of a corner."""


@dataclass(frozen=True, eq=False)
class Trial:
    """Two contour points [px], each of shape (2,), to pick at; the same twice means one arm."""

    recipe: str
    first: Floats
    second: Floats


def _uniform(region: FoldRegion, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    first = region.points[int(place * len(region.points))]
    return first, coupled_pick(region, first, PickConfig())


def _extreme(region: FoldRegion, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    corner = _corner(region, rng)
    partner = coupled_pick(region, corner, PickConfig())
    first = slide(region, corner, partner, rng.uniform(0, LARGEST_SLIDE))
    return first, coupled_pick(region, first, PickConfig())


def _slid(region: FoldRegion, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    first, second = best_pair(region, PickConfig().gamma)
    shares = rng.uniform(0, LARGEST_SLIDE, 2)
    return slide(region, first, second, shares[0]), slide(region, second, first, shares[1])


def _pair(region: FoldRegion, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    return region.points[int(place * len(region.points))], region.points[rng.integers(len(region.points))]


def _vertex(region: FoldRegion, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    first = nearest_point(region.points, _corner(region, rng))
    return first, coupled_pick(region, first, PickConfig())


def _single(region: FoldRegion, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    pick = region.points[int(place * len(region.points))]
    return pick, pick


RECIPES: Mapping[str, Callable[[FoldRegion, float, np.random.Generator], tuple[Floats, Floats]]] = {
    "uniform": _uniform,
    "extreme": _extreme,
    "slid": _slid,
    "pair": _pair,
    "single": _single,
    "vertex": _vertex,
}
"""How two picks are drawn.

``uniform``: the first anywhere on the lifted contour, its partner by affordance (the paper's). ``extreme``: the first
at or a little inwards of a corner, its partner by affordance. ``slid``: the pair with the best affordance, each moved
inwards by a random share. ``pair``: two random points. ``single``: one arm at a random point. ``vertex``: the first at
a corner of the outline, where a polygon model has its vertices, its partner by affordance.
"""

COUPLED = ("uniform", "extreme")
"""Recipes whose second pick follows from the first, as the coupled spatial action map assumes."""

MIX = {"uniform": 3, "extreme": 2, "slid": 1, "pair": 1, "single": 1}
"""Trials of each recipe from every state, by default."""


def draw_trials(region: FoldRegion, mix: Mapping[str, int], rng: np.random.Generator) -> list[Trial]:
    """Trials of a mix of recipes; those of one recipe are spread evenly along the contour from a random start."""
    trials = []
    for recipe, count in mix.items():
        for place in (np.arange(count) + rng.uniform()) / max(count, 1):
            trials.append(Trial(recipe, *RECIPES[recipe](region, float(place), rng)))
    return trials


def parse_mix(text: str) -> dict[str, int]:
    """Read ``"uniform=3,single=1"``. Raises ConfigError if a recipe is unknown or a count is no positive number."""
    mix = {}
    for part in text.split(","):
        recipe, _, count = part.strip().partition("=")
        if recipe not in RECIPES or not count.isdigit() or int(count) < 1:
            raise ConfigError(
                f"{part!r} does not read RECIPE=COUNT with RECIPE one of {', '.join(RECIPES)}; "
                "for example uniform=3,single=1"
            )
        mix[recipe] = int(count)
    return mix


def _corner(region: FoldRegion, rng: np.random.Generator) -> Floats:
    """A random corner of the lifted contour, not one at the crease."""
    corners = outline_corners(region.points)
    distances = region.fold_line.distance(corners)
    corners = corners[distances > 0.15 * distances.max()]
    return corners[rng.integers(len(corners))]
