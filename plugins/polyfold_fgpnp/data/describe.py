"""What a data set of random folds holds: counts, rewards, and a sheet of good, median and bad picks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.types import Action
from polyfold.viz import Card, overlay, score_sheet
from polyfold_fgpnp.data.dataset import Dataset, load_dataset
from polyfold_fgpnp.data.outcomes import mirrored_mask
from polyfold_fgpnp.data.trials import RECIPES
from polyfold_fgpnp.policies.lines import LINE_KINDS
from polyfold_fgpnp.policies.region import fold_region

PERCENTILES = (5, 25, 50, 75, 95)

PAPER, CLOTH, LOST, MISSED = (250, 250, 248), (120, 144, 156), (214, 96, 77), (67, 147, 195)
"""Colours of the background, of cloth where it should be, where it should not be, and of what is not covered."""

STATES_SHOWN = 12


def describe(path: str | Path) -> str:
    """Counts and distributions as text; writes the sheet of picks into the data set's folder, or beside its file."""
    data = load_dataset(path)
    path = Path(path)
    sheet = path.with_name(f"{path.stem}-picks.png") if path.is_file() else path / "picks.png"
    pick_sheet(data, sheet)
    return "\n".join([*_counts(data), "", *_rewards(data), "", f"good, median and bad picks: {sheet}"])


def pick_sheet(data: Dataset, path: str | Path | None = None, states: int = STATES_SHOWN) -> NDArray[np.uint8]:
    """For states spread over the data: the picks with the highest, median and lowest particle reward, and results.

    In results, red cloth lies where it should not and blue is what it should cover.

    Args:
        data: what to show.
        path: PNG to write.
        states: how many.

    Returns:
        The sheet, uint8, shape (H, W, 3).
    """
    cards = []
    rewards = {name: data.reward(name) for name in ("particles", "contour")}
    for state in np.unique(np.linspace(0, data.states - 1, states).astype(int)):
        trials = np.flatnonzero((data["trial_state"] == state) & ~data["diverged"])
        trials = trials[np.argsort(-rewards["particles"][trials], kind="stable")]
        if len(trials) == 0:
            continue
        for name, trial in zip(("good", "median", "bad"), trials[[0, len(trials) // 2, -1]], strict=True):
            cards.append(_card(data, int(state), int(trial), name, rewards))
    return score_sheet(cards, f"{data.folds} random folds from {data.states} states", path, columns=6, side=150)


def _card(data: Dataset, state: int, trial: int, name: str, rewards: dict[str, NDArray[np.float64]]) -> Card:
    scene, line = data.scene(state), data.line(state)
    picks = data["picks"][trial].astype(float)
    picks = picks[np.isfinite(picks).all(1)]
    before = np.where(scene.mask[..., None], CLOTH, PAPER).astype(np.uint8)
    expected = _expected(data, state)
    result = data.result(trial)
    after = np.full((*result.shape, 3), PAPER, np.uint8)
    after[result & expected], after[result & ~expected], after[expected & ~result] = CLOTH, LOST, MISSED
    pictures = (overlay(before, fold_line=line, action=Action(picks, line.mirror(picks))), after)
    caption = (
        f"{data['flap_mm'][trial]:.0f} of {data['travel_mm'][state]:.0f} mm; "
        f"particles {rewards['particles'][trial]:.2f}, contour {rewards['contour'][trial]:.2f}"
    )
    return Card(pictures, f"{name}: {list(RECIPES)[data['recipe'][trial]]}", caption)


def _expected(data: Dataset, state: int) -> NDArray[np.bool_]:
    scene = data.scene(state)
    try:
        region = fold_region(data.line(state), scene)
    except PlanError:
        return scene.mask
    return (scene.mask & ~region.mask) | mirrored_mask(region)


def _counts(data: Dataset) -> list[str]:
    parameters = data.description["parameters"]
    kind, edge_mm = parameters["garment_kind"], 1000 * parameters["edge_length"]
    seeds = np.unique(data["garment_seed"])
    before = np.bincount(data["folds_before"], minlength=3)
    lines = np.bincount(data["line_kind"], minlength=len(LINE_KINDS))
    return [
        f"{data.folds} folds from {data.states} states of {len(seeds)} garments "
        f"({kind} {seeds.min()}-{seeds.max()}, edges of {edge_mm:.1f} mm)",
        f"diverged: {int(data['diverged'].sum())}",
        "states by folds before: " + ", ".join(f"{n}: {count}" for n, count in enumerate(before)),
        "states by line: " + ", ".join(f"{kind}: {count}" for kind, count in zip(LINE_KINDS, lines, strict=True)),
        f"hash: {data.description['hash']}",
    ]


def _rewards(data: Dataset) -> list[str]:
    names = " | ".join(f"p{p}" for p in PERCENTILES)
    rows = [f"| reward | picks | folds | {names} |", "|---" * (3 + len(PERCENTILES)) + "|"]
    for reward in ("particles", "contour"):
        values = data.reward(reward)
        for recipe in RECIPES:
            found = values[data.of_recipes(recipe)]
            if len(found):
                cells = " | ".join(f"{value:.2f}" for value in np.percentile(found, PERCENTILES))
                rows.append(f"| {reward} | {recipe} | {len(found)} | {cells} |")
    return rows
