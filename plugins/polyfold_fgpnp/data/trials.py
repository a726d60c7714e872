"""What interaction tries on a flap: pairs of contour points, at random or where a trained network promises most."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError
from polyfold_fgpnp.policies.actions import PickConfig
from polyfold_fgpnp.policies.affordance import PARTNER_SLIDE, best_pair, coupled_pick, slide
from polyfold_fgpnp.policies.lines import outline_corners
from polyfold_fgpnp.policies.region import FoldRegion, nearest_point

Floats = NDArray[np.float64]
Pairs = Sequence[tuple[Floats, Floats]]

ValueMap = Callable[[], tuple[Floats, Floats]]
"""Asks a network for points of the lifted contour [px], shape (N, 2), and their values, shape (N,)."""

LARGEST_SLIDE = 0.3
"""Picks are tried up to this share of their distance inwards of a corner."""

CHOSEN_SHARE = 0.2
"""Chosen picks are drawn among so large a share of the contour, that of the highest values."""

CHOSEN_APART = 0.05
"""Chosen picks lie at least this share of the lifted contour's length apart, where there is room."""


@dataclass(frozen=True, eq=False)
class Trial:
    """Two contour points [px], each of shape (2,), to pick at; the same twice means one arm."""

    recipe: str
    first: Floats
    second: Floats


@dataclass(frozen=True, eq=False)
class Flap:
    """What picks are drawn from.

    Attributes:
        region: the flap.
        value_map: a trained network's opinion of it, which only the recipe ``chosen`` asks for.
        slide: how far partners by affordance move towards the first pick, as a share of their distance.
    """

    region: FoldRegion
    value_map: ValueMap | None = None
    slide: float = PARTNER_SLIDE

    def partner(self, first: Floats) -> Floats:
        """The best second pick of a first one [px], each of shape (2,)."""
        return coupled_pick(self.region, first, PickConfig(), self.slide)


def _uniform(flap: Flap, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    first = flap.region.points[int(place * len(flap.region.points))]
    return first, flap.partner(first)


def _extreme(flap: Flap, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    corner = _corner(flap.region, rng)
    first = slide(flap.region, corner, flap.partner(corner), rng.uniform(0, LARGEST_SLIDE))
    return first, flap.partner(first)


def _slid(flap: Flap, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    region = flap.region
    first, second = best_pair(region, PickConfig().gamma)
    shares = rng.uniform(0, LARGEST_SLIDE, 2)
    return slide(region, first, second, shares[0]), slide(region, second, first, shares[1])


def _pair(flap: Flap, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    region = flap.region
    return region.points[int(place * len(region.points))], region.points[rng.integers(len(region.points))]


def _vertex(flap: Flap, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    first = nearest_point(flap.region.points, _corner(flap.region, rng))
    return first, flap.partner(first)


def _single(flap: Flap, place: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    pick = flap.region.points[int(place * len(flap.region.points))]
    return pick, pick


def _along(
    draw: Callable[[Flap, float, np.random.Generator], tuple[Floats, Floats]],
) -> Callable[[Flap, int, np.random.Generator], Pairs]:
    """A recipe that draws pair by pair, from places spread evenly along the contour from a random start, in 0..1."""

    def drawn(flap: Flap, count: int, rng: np.random.Generator) -> Pairs:
        places = (np.arange(count) + rng.uniform()) / max(count, 1)
        return [draw(flap, float(place), rng) for place in places]

    return drawn


def _chosen(flap: Flap, count: int, rng: np.random.Generator) -> Pairs:
    if flap.value_map is None:
        raise ConfigError("the recipe chosen asks a trained network where to pick; give its file with --weights")
    points, values = flap.value_map()
    firsts = points[_valued_most(points, values, count, CHOSEN_APART * len(flap.region.points), rng)]
    return [(first, flap.partner(first)) for first in firsts]


def _valued_most(points: Floats, values: Floats, count: int, apart: float, rng: np.random.Generator) -> list[int]:
    """Indices of the best point and of random ones of high value, this far apart [px].

    Where the points of high value lie too close together the next best ones follow; where there is no room at all,
    those left out for being too close. There are fewer than ``count`` only if there are fewer points.
    """
    best = int(np.argmax(values))
    high = values >= np.quantile(values, 1 - CHOSEN_SHARE)
    low = np.flatnonzero(~high)
    queue = [best, *rng.permutation(np.flatnonzero(high)), *low[np.argsort(-values[low], kind="stable")]]
    taken: list[int] = []
    for index in map(int, queue):
        if all(np.hypot(*(points[index] - points[other])) >= apart for other in taken):
            taken.append(index)
    close = [int(index) for index in queue if index not in taken]
    return (taken + close)[:count]


RECIPES: Mapping[str, Callable[[Flap, int, np.random.Generator], Pairs]] = {
    "uniform": _along(_uniform),
    "extreme": _along(_extreme),
    "slid": _along(_slid),
    "pair": _along(_pair),
    "single": _along(_single),
    "vertex": _along(_vertex),
    "chosen": _chosen,
}
"""How so many pairs of picks are drawn. Data sets keep a recipe's place in this order: new ones come last.

``uniform``: the first anywhere on the lifted contour, its partner by affordance (the paper's). ``extreme``: the first
at or a little inwards of a corner, its partner by affordance. ``slid``: the pair with the best affordance, each moved
inwards by a random share. ``pair``: two random points. ``single``: one arm at a random point. ``vertex``: the first at
a corner of the outline, where a polygon model has its vertices, its partner by affordance. ``chosen``: the first where
a trained network promises most, so that it is corrected where it is over-confident: once the best point of all, then
random ones of the highest fifth of the values, spread along the contour; the partner by affordance.
"""

COUPLED = ("uniform", "extreme", "chosen")
"""Recipes whose second pick follows from the first, as the coupled spatial action map assumes."""

MIX = {"uniform": 3, "extreme": 2, "slid": 1, "pair": 1, "single": 1}
"""Trials of each recipe from every state, by default."""


def draw_trials(flap: Flap, mix: Mapping[str, int], rng: np.random.Generator) -> list[Trial]:
    """Trials of a mix of recipes. Raises ConfigError if one asks for a network and there is none."""
    return [Trial(recipe, *pair) for recipe, count in mix.items() for pair in RECIPES[recipe](flap, count, rng)]


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
