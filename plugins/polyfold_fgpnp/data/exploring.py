"""One job of interaction: every state of it with the outcome of what was tried there, as the arrays of a shard."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.errors import ConfigError
from polyfold.geometry import FoldLine
from polyfold_fgpnp.data.interaction import Interaction, create_segmenter, create_simulator
from polyfold_fgpnp.data.outcomes import Outcome
from polyfold_fgpnp.data.situations import Situation, execute, situations, states_per_job
from polyfold_fgpnp.data.trials import RECIPES, Flap, ValueMap, draw_trials
from polyfold_fgpnp.policies.actions import PickConfig, to_action
from polyfold_fgpnp.policies.affordance import PARTNER_SLIDE
from polyfold_fgpnp.policies.coupled import Coupled, value_policy
from polyfold_fgpnp.policies.lines import LINE_KINDS
from polyfold_fgpnp.policies.weights import file_hash


def check(interaction: Interaction) -> None:
    """Construct what an interaction names, once, so that what does not serve is refused before anything is written.

    Raises:
        PluginError: if a component is not there.
        ConfigError: if a parameter of one is wrong, or the weights do not serve.
    """
    plugins.make_fabric(interaction.fabric, interaction.garment_kind)
    create_segmenter(interaction)
    create_simulator(interaction).close()
    _asked_policy(interaction)


def _asked_policy(interaction: Interaction) -> Coupled | None:
    """The policy whose values the recipe ``chosen`` follows, if there is one; read once in a process.

    Raises:
        ConfigError: if the weights can't be read, have changed, or are of a network that does not serve.
    """
    return _trained(interaction.weights, interaction.weights_hash) if interaction.weights is not None else None


@lru_cache(maxsize=1)
def _trained(weights: Path, expected: str | None) -> Coupled:
    if not weights.is_file() or file_hash(weights) != expected:
        raise ConfigError(f"{weights} has changed since this collection began; put the old file back or start anew")
    return value_policy(weights)


def trials_per_job(interaction: Interaction) -> int:
    """Folds that one job tries."""
    return states_per_job(interaction) * sum(interaction.mix.values())


def explore(interaction: Interaction, job: int) -> dict[str, NDArray[Any]]:
    """One job as the arrays of a shard, of the shapes that :mod:`polyfold_fgpnp.data.dataset` names."""
    states: list[dict[str, Any]] = []
    trials: list[dict[str, Any]] = []
    slide = 0.0 if interaction.course == "random" else PARTNER_SLIDE
    for simulator, segmenter, situation in situations(interaction, job):
        states.append(_state_row(situation))
        flap = Flap(situation.region, _value_map(interaction, situation), slide)
        for trial in draw_trials(flap, interaction.mix, situation.rng):
            action = to_action(situation.region, trial.first, trial.second, PickConfig())
            outcome, mask = execute(simulator, segmenter, situation, action)
            row = {
                "trial_state": np.int32(len(states) - 1),
                "recipe": np.int8(list(RECIPES).index(trial.recipe)),
                "first": trial.first.astype(np.float32),
                "second": trial.second.astype(np.float32),
                "picks": _padded(action.picks),
                "diverged": np.bool_(outcome is None),
                "result": np.packbits(mask),
            }
            found = outcome or Outcome(np.nan, np.nan, np.nan, np.nan)
            row |= {name: np.float32(value) for name, value in vars(found).items()}
            trials.append(row)
    return _columns(states) | _columns(trials)


def _value_map(interaction: Interaction, situation: Situation) -> ValueMap | None:
    """The network's map of a situation, asked on one thread so that its rounding does not depend on the machine."""
    policy = _asked_policy(interaction)
    if policy is None:
        return None

    def asked() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        import torch

        threads = torch.get_num_threads()
        torch.set_num_threads(1)
        try:
            return policy.action_map(situation.line.line, situation.scene)
        finally:
            torch.set_num_threads(threads)

    return asked


def _state_row(situation: Situation) -> dict[str, Any]:
    line: FoldLine = situation.line.line
    return {
        "mask": np.packbits(situation.scene.mask),
        "line": np.array([*line.start, *line.end], np.float32),
        "line_kind": np.int8(LINE_KINDS.index(situation.line.kind)),
        "garment_seed": np.int32(situation.garment_seed),
        "folds_before": np.int8(situation.folds_before),
        "pixels_per_metre": np.float32(situation.state.camera.pixels_per_metre),
        "idle_chamfer_px": np.float32(situation.expectation.idle_chamfer_px),
        "travel_mm": np.float32(situation.expectation.travel_mm),
    }


def _padded(picks: NDArray[np.float64]) -> NDArray[np.float32]:
    padded = np.full((2, 2), np.nan, np.float32)
    padded[: len(picks)] = picks
    return padded


def _columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, NDArray[Any]]:
    return {name: np.stack([row[name] for row in rows]) for name in rows[0]} if rows else {}
