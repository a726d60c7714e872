"""Interaction: states of a garment, flat and already folded at random, and the outcome of many picks from each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.errors import ConfigError, GroundingError, PlanError, SimulationError
from polyfold.garments import Garment
from polyfold.geometry import FoldLine, contour_of
from polyfold.plugins.interfaces import Segmenter, Simulator
from polyfold.types import Action, Observation, Scene, SimState
from polyfold_fgpnp.data.outcomes import Expectation, Outcome, expect
from polyfold_fgpnp.data.trials import MIX, RECIPES, Flap, ValueMap, draw_trials
from polyfold_fgpnp.policies.actions import PickConfig, to_action
from polyfold_fgpnp.policies.caso import Caso
from polyfold_fgpnp.policies.learned import CoupledActionMap
from polyfold_fgpnp.policies.lines import LINE_KINDS, PLAUSIBLE, RandomLine, random_line
from polyfold_fgpnp.policies.region import FoldRegion
from polyfold_fgpnp.policies.weights import file_hash, weights_file

LINES_PER_STAGE = (2, 1, 1)
"""Fold lines tried on the flat garment, after one good fold, and after two."""

GOOD_FOLD = 0.75
"""A fold on the way to a folded state counts as good if its flap went this share of its way."""

ATTEMPTS = 4
"""Lines tried for one good fold; without one the garment stays as it is."""


class Interaction(BaseModel):
    """Parameters of interaction; the same ones and the same job give the same data.

    Weights count by their content: ``weights_hash`` follows from ``weights``, whose path is no parameter.

    Raises:
        ConfigError: if the mix holds the recipe ``chosen`` without weights, weights without it, or there is no file.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    garment_kind: str = Field(default="tshirt", description="kind of the garments")
    seeds: tuple[int, int] = Field(default=(1000, 1099), description="first and last garment seed")
    edge_length: float = Field(default=0.018, gt=0.005, le=0.05, description="edge length of the mesh [m]")
    mix: Mapping[str, int] = Field(default_factory=lambda: dict(MIX), description="trials of each recipe from a state")
    simulator: ComponentSpec = Field(default=ComponentSpec(name="xpbd"), description="what folds, with its parameters")
    fabric: ComponentSpec = Field(default=Experiment().fabric, description="what the garments are made of")
    segmenter: ComponentSpec = Field(default=ComponentSpec(name="colour"), description="what tells cloth from table")
    seed: int = Field(default=0, ge=0, description="of everything random")
    weights: Path | None = Field(default=None, exclude=True, description="file of the network that chosen picks ask")
    weights_hash: str | None = Field(default=None, description="SHA-256 of that file")

    @model_validator(mode="before")
    @classmethod
    def _with_hash(cls, given: Any) -> Any:
        """Hash the file; a description of data that was collected holds the hash alone."""
        if not isinstance(given, Mapping) or given.get("weights") is None:
            return given
        file = weights_file(str(given["weights"]))
        return {**given, "weights": file, "weights_hash": file_hash(file)}

    @model_validator(mode="after")
    def _weights_go_with_chosen(self) -> Interaction:
        if "chosen" in self.mix and self.weights_hash is None:
            raise ConfigError("the recipe chosen asks a trained network where to pick; give its file with --weights")
        if "chosen" not in self.mix and self.weights_hash is not None:
            raise ConfigError("no recipe of the mix asks the weights; add chosen, such as --mix chosen=3,uniform=1")
        return self


@dataclass(frozen=True, eq=False)
class Situation:
    """A garment as it lies and a fold line across it.

    Attributes:
        garment_seed: which garment.
        folds_before: good folds that led here.
        line: the fold line, its kind and what it lifts.
        scene: what is seen, without a polygon model.
        state: what to restore before each trial.
        expectation: what the ideal fold would give.
        rng: generator for the picks.
    """

    garment_seed: int
    folds_before: int
    line: RandomLine
    scene: Scene
    state: SimState
    expectation: Expectation
    rng: np.random.Generator

    @property
    def region(self) -> FoldRegion:
        """What the fold line lifts."""
        return self.line.region


def _garment(interaction: Interaction, seed: int) -> Garment:
    cut = _cut(interaction.garment_kind, seed, interaction.edge_length)
    return replace(cut, fabric=plugins.make_fabric(interaction.fabric, interaction.garment_kind))


@lru_cache(maxsize=2)
def _cut(kind: str, seed: int, edge_length: float) -> Garment:
    """Kept for the next job on it, whose constraints then need not be made again."""
    return plugins.generate_garment(kind, seed, edge_length)


def check(interaction: Interaction) -> None:
    """Construct what an interaction names, once, so that what does not serve is refused before anything is written.

    Raises:
        PluginError: if a component is not there.
        ConfigError: if a parameter of one is wrong, or the weights do not serve.
    """
    plugins.make_fabric(interaction.fabric, interaction.garment_kind)
    _create_segmenter(interaction)
    _create_simulator(interaction).close()
    value_policy(interaction)


def _create_simulator(interaction: Interaction) -> Simulator:
    return plugins.create("simulators", interaction.simulator.name, interaction.simulator.params)


def _create_segmenter(interaction: Interaction) -> Segmenter:
    return plugins.create("segmenters", interaction.segmenter.name, interaction.segmenter.params)


def value_policy(interaction: Interaction) -> CoupledActionMap | None:
    """The policy whose values the recipe ``chosen`` follows, if there is one; read once in a process.

    Raises:
        ConfigError: if the weights can't be read, have changed, or are of a network that does not serve.
    """
    return _trained(interaction.weights, interaction.weights_hash) if interaction.weights is not None else None


@lru_cache(maxsize=1)
def _trained(weights: Path, expected: str | None) -> CoupledActionMap:
    if not weights.is_file() or file_hash(weights) != expected:
        raise ConfigError(f"{weights} has changed since this collection began; put the old file back or start anew")
    return CoupledActionMap(CoupledActionMap.Config(weights=str(weights)))


def trials_per_job(mix: Mapping[str, int]) -> int:
    """Folds that one job tries."""
    return sum(LINES_PER_STAGE) * sum(mix.values())


def situations(interaction: Interaction, job: int) -> Iterator[tuple[Simulator, Segmenter, Situation]]:
    """The states and fold lines of one job: one garment, flat, after one good fold and after two.

    Each comes with the simulator that is in that state and with the segmenter, which serve until the job ends.
    """
    first, last = interaction.seeds
    kind, garment_seed = interaction.garment_kind, first + job % (last - first + 1)
    rng = np.random.default_rng([interaction.seed, job])
    segmenter = _create_segmenter(interaction)
    with closing(_create_simulator(interaction)) as simulator:
        garment = _garment(interaction, garment_seed)
        observation = simulator.reset(garment, int(rng.integers(2**31)))
        folds = 0
        for stage, lines in enumerate(LINES_PER_STAGE):
            if stage > 0:
                folded = _good_fold(simulator, segmenter, observation, kind, rng)
                observation, folds = (observation, folds) if folded is None else (folded, folds + 1)
            state = simulator.state()
            scene = scene_of(observation, segmenter, kind)
            for _ in range(lines):
                line = random_line(scene, rng, LINE_KINDS)
                expectation = expect(line.region, scene.mask, state)
                own = np.random.default_rng(rng.integers(2**63))
                yield simulator, segmenter, Situation(garment_seed, folds, line, scene, state, expectation, own)
            simulator.restore(state)


def scene_of(observation: Observation, segmenter: Segmenter, garment_kind: str) -> Scene:
    """The scene without a polygon model."""
    mask, camera = segmenter.segment(observation), observation.camera
    return Scene(garment_kind, (camera.width, camera.height), mask, contour_of(mask), None, "{}")


def _good_fold(
    simulator: Simulator, segmenter: Segmenter, before: Observation, garment_kind: str, rng: np.random.Generator
) -> Observation | None:
    """Fold along a plausible line with the best pair of picks; None if no attempt came out well."""
    state, scene = simulator.state(), scene_of(before, segmenter, garment_kind)
    for _ in range(ATTEMPTS):
        try:
            drawn = random_line(scene, rng, PLAUSIBLE)
            expectation = expect(drawn.region, scene.mask, state)
            after = simulator.execute(Caso().act(drawn.line, scene, rng))
            outcome = expectation.judge(segmenter.segment(after), simulator.state())
        except (PlanError, SimulationError, GroundingError):
            simulator.restore(state)
            continue
        if 1 - outcome.flap_mm / expectation.travel_mm >= GOOD_FOLD:
            return after
        simulator.restore(state)
    return None


def execute(
    simulator: Simulator, segmenter: Segmenter, situation: Situation, action: Action
) -> tuple[Outcome | None, NDArray[np.bool_]]:
    """Try an action from a situation: how it came out, and the resulting mask, bool, shape (H, W).

    There is no outcome if the cloth diverged.
    """
    simulator.restore(situation.state)
    try:
        after = simulator.execute(action)
    except SimulationError:
        return None, np.zeros_like(situation.scene.mask)
    try:
        mask = segmenter.segment(after)
    except GroundingError:
        mask = np.zeros_like(situation.scene.mask)
    return situation.expectation.judge(mask, simulator.state()), mask


def explore(interaction: Interaction, job: int) -> dict[str, NDArray[Any]]:
    """One job as the arrays of a shard, of the shapes that :mod:`polyfold_fgpnp.data.dataset` names."""
    states: list[dict[str, Any]] = []
    trials: list[dict[str, Any]] = []
    for simulator, segmenter, situation in situations(interaction, job):
        states.append(_state_row(situation))
        flap = Flap(situation.region, _value_map(interaction, situation))
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
    policy = value_policy(interaction)
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
