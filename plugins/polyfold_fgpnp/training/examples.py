"""Training examples: what a network sees of each state, where was picked, and how it came out."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import ConfigError, PlanError
from polyfold.geometry import FoldLine
from polyfold_fgpnp.data.dataset import Dataset
from polyfold_fgpnp.data.trials import COUPLED
from polyfold_fgpnp.policies.frames import FrameName, view
from polyfold_fgpnp.policies.pairs import pair_geometry
from polyfold_fgpnp.policies.region import fold_region

Floats = NDArray[np.float32]

TRIALS_OF = {
    "csam": COUPLED,
    "vertex-learned": ("vertex",),
    "1sam": ("single",),
    "2sam": ("uniform", "extreme", "slid", "pair"),
    "pair": ("uniform", "extreme", "slid", "pair", "single", "vertex", "chosen"),
}
"""Recipes whose trials teach a variant."""

SOFTNESS = 0.02
"""Errors of a perfect fold are about this share of its way; the logarithm does not tell smaller ones apart."""


@dataclass(frozen=True, eq=False)
class Examples:
    """States with the trials from each; K trials at most, fewer are padded.

    Attributes:
        images: views of the states, uint8, shape (S, C, H, W).
        lines: fold lines over the image's size, float32, shape (S, 4).
        points: both picks of each trial in pixels of the network's map, float32, shape (S, K, 2, 2); of two arms the
            first is the one nearer the fold line's start for ``2sam``.
        geometry: what :func:`pair_geometry` says of each trial, float32, shape (S, K, GEOMETRY).
        labels: higher is better, float32, shape (S, K).
        valid: which trials are there, bool, shape (S, K).
        garments: garment seed of each state, shape (S,).
    """

    images: NDArray[np.uint8]
    lines: Floats
    points: Floats
    geometry: Floats
    labels: Floats
    valid: NDArray[np.bool_]
    garments: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.images)

    def chosen(self, states: NDArray[np.integer | np.bool_]) -> Examples:
        """The examples of some states, by index, shape (K,), or mask, shape (S,)."""
        return Examples(**{name: value[states] for name, value in vars(self).items()})


def label(reward: ArrayLike, scale: str) -> NDArray[np.float64]:
    """What a network learns for rewards, shape (...).

    Themselves (``linear``), or minus the logarithm of what they lack to 1 (``log``).

    Between two good folds the reward differs by a percent, between good and bad ones by all of it. The logarithm makes
    the first count as well.
    """
    reward = np.asarray(reward, float)
    return reward if scale == "linear" else -np.log(np.maximum(1.0 - reward, 0.0) + SOFTNESS)


def make_examples(
    data: Sequence[Dataset], variant: str, frame: FrameName, reward: str, scale: str, folds: int | None = None
) -> Examples:
    """Examples for a variant of the network.

    Args:
        data: one or more data sets.
        variant: a key of :data:`TRIALS_OF`.
        frame: how the network sees the flap.
        reward: ``contour``, ``particles``, or ``both`` for the mean of the two labels: particles tell layers apart
            that the contour can't, the contour sees a corner turned over that hardly counts among the particles.
        scale: see :func:`label`.
        folds: use only about so many folds of each data set, the first ones.

    Raises:
        ConfigError: if the data sets hold no trials for this variant.
    """
    recipes = TRIALS_OF[variant]
    useful = [one for one in data if len(_trials(one, variant, reward, folds))]
    if not useful:
        raise ConfigError(
            f"no data for {variant}: it learns from the recipes {', '.join(recipes)}; collect some with --mix"
        )
    parts = [_examples_of(one, variant, frame, reward, scale, folds) for one in useful]
    most = max(part.valid.shape[1] for part in parts)
    padded = [_padded_to(part, most) for part in parts]
    names = vars(padded[0])
    joined = Examples(**{name: np.concatenate([getattr(part, name) for part in padded]) for name in names})
    return joined.chosen(np.asarray(joined.valid.any(1)))


def _examples_of(data: Dataset, variant: str, frame: FrameName, reward: str, scale: str, folds: int | None) -> Examples:
    from tqdm.auto import tqdm

    trials = _trials(data, variant, reward, folds)
    states = data["trial_state"][trials]
    kept = np.unique(states)
    most = int(np.bincount(states).max())
    labels = np.mean([label(found, scale) for found in _rewards(data, reward)], axis=0)
    rows = {name: [] for name in ("images", "lines", "points", "geometry", "labels", "valid", "garments")}
    for state in tqdm(kept, unit="state", desc="views", disable=not sys.stderr.isatty()):
        mine = trials[states == state]
        try:
            scene = data.scene(state)
            region = fold_region(data.line(state), scene)
        except PlanError:
            continue
        seen = view(region, scene.mask, frame)
        picks = np.stack([data["first"][mine], data["second"][mine]], 1).astype(float)
        picks = _ordered(picks, region.fold_line) if variant == "2sam" else picks
        rows["images"].append(seen.image)
        rows["lines"].append(seen.line)
        rows["points"].append(_filled(seen.frame.apply(picks), most))
        rows["geometry"].append(_filled(pair_geometry(region, picks[:, 0], picks[:, 1]), most))
        rows["labels"].append(_filled(labels[mine], most))
        rows["valid"].append(np.arange(most) < len(mine))
        rows["garments"].append(data["garment_seed"][state])
    return Examples(**{name: np.array(row) for name, row in rows.items()})


def _trials(data: Dataset, variant: str, reward: str, folds: int | None) -> NDArray[np.int64]:
    """Trials that teach a variant, of the first so many; one without a reward would make every weight NaN."""
    trials = data.of_recipes(*TRIALS_OF[variant])
    trials = trials[trials < (folds or data.folds)]
    sound = np.asarray(np.isfinite(_rewards(data, reward)).all(0))
    return trials[sound[trials]]


def _rewards(data: Dataset, reward: str) -> NDArray[np.float64]:
    """The rewards that make up a label, shape (R, T)."""
    return np.stack([data.reward(name) for name in (("contour", "particles") if reward == "both" else (reward,))])


def _ordered(picks: NDArray[np.float64], line: FoldLine) -> NDArray[np.float64]:
    """The two picks of each trial, shape (K, 2, 2), ordered along the fold line."""
    along = picks @ (np.asarray(line.end) - np.asarray(line.start))
    return np.take_along_axis(picks, np.argsort(along, 1)[..., None], 1)


def _filled(values: NDArray, count: int) -> Floats:
    padded = np.zeros((count, *values.shape[1:]), np.float32)
    padded[: len(values)] = values
    return padded


def _padded_to(part: Examples, most: int) -> Examples:
    def widened(values: NDArray) -> NDArray:
        return np.pad(values, [(0, 0), (0, most - values.shape[1])] + [(0, 0)] * (values.ndim - 2))

    wide = {name: widened(getattr(part, name)) for name in ("points", "geometry", "labels", "valid")}
    return replace(part, **wide)
