"""States of a garment, flat and already folded, each with a fold line across it; and what an action does there."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.errors import GroundingError, PlanError, SimulationError
from polyfold.garments import Garment
from polyfold.geometry import contour_of
from polyfold.plugins.interfaces import Segmenter, Simulator
from polyfold.types import Action, Observation, Scene, SimState
from polyfold_fgpnp.data.interaction import FOLDS_IN_A_ROW, Interaction, create_segmenter, create_simulator
from polyfold_fgpnp.data.outcomes import Expectation, Outcome, expect
from polyfold_fgpnp.policies.geometric import AffordancePair
from polyfold_fgpnp.policies.lines import LINE_KINDS, PLAUSIBLE, RandomLine, random_line
from polyfold_fgpnp.policies.region import FoldRegion

LINES_PER_STAGE = (2, 1, 1)
"""Fold lines tried on the flat garment, after one good fold, and after two."""

GOOD_FOLD = 0.75
"""A fold on the way to a folded state counts as good if its flap went this share of its way."""

ATTEMPTS = 4
"""Lines tried for one good fold; without one the garment stays as it is."""

ROWS_PER_JOB = 3
"""How often a garment is laid out flat in one job of the random course."""


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


def states_per_job(interaction: Interaction) -> int:
    """States that one job comes to."""
    return FOLDS_IN_A_ROW * ROWS_PER_JOB if interaction.course == "random" else sum(LINES_PER_STAGE)


def situations(interaction: Interaction, job: int) -> Iterator[tuple[Simulator, Segmenter, Situation]]:
    """The states and fold lines of one job: one garment, on its course.

    Each comes with the simulator that is in that state and with the segmenter, which serve until the job ends. On the
    random course the simulator's state after each is what the next one starts from.
    """
    first, last = interaction.seeds
    garment_seed = first + job % (last - first + 1)
    rng = np.random.default_rng([interaction.seed, job])
    segmenter = create_segmenter(interaction)
    course = _random_course if interaction.course == "random" else _course_of_good_folds
    with closing(create_simulator(interaction)) as simulator:
        garment = _garment(interaction, garment_seed)
        for folds, line, scene in course(simulator, segmenter, garment, rng):
            state = simulator.state()
            expectation = expect(line.region, scene.mask, state)
            own = np.random.default_rng(rng.integers(2**63))
            yield simulator, segmenter, Situation(garment_seed, folds, line, scene, state, expectation, own)


Step = tuple[int, RandomLine, Scene]
"""Folds before, a fold line, and what is seen."""


def _course_of_good_folds(
    simulator: Simulator, segmenter: Segmenter, garment: Garment, rng: np.random.Generator
) -> Iterator[Step]:
    """Flat, after one good fold and after two, whatever was tried in between."""
    observation = simulator.reset(garment, int(rng.integers(2**31)))
    folds = 0
    for stage, lines in enumerate(LINES_PER_STAGE):
        if stage > 0:
            folded = _good_fold(simulator, segmenter, observation, garment.kind, rng)
            observation, folds = (observation, folds) if folded is None else (folded, folds + 1)
        state = simulator.state()
        scene = scene_of(observation, segmenter, garment.kind)
        for _ in range(lines):
            simulator.restore(state)
            yield folds, random_line(scene, rng, LINE_KINDS), scene
        simulator.restore(state)


def _random_course(
    simulator: Simulator, segmenter: Segmenter, garment: Garment, rng: np.random.Generator
) -> Iterator[Step]:
    """A line between two random contour points on whatever came of the fold before; now and then laid out flat."""
    folds = FOLDS_IN_A_ROW
    for _ in range(FOLDS_IN_A_ROW * ROWS_PER_JOB):
        found = _chord(simulator.observe(), segmenter, garment.kind, rng) if folds < FOLDS_IN_A_ROW else None
        if found is None:
            folds, flat = 0, simulator.reset(garment, int(rng.integers(2**31)))
            scene = scene_of(flat, segmenter, garment.kind)
            found = random_line(scene, rng, ("chord",)), scene
        yield folds, *found
        folds += 1


def _chord(
    observation: Observation, segmenter: Segmenter, garment_kind: str, rng: np.random.Generator
) -> tuple[RandomLine, Scene] | None:
    """A random line across cloth as it lies, and what is seen; None where none lifts a part worth folding."""
    try:
        scene = scene_of(observation, segmenter, garment_kind)
        return random_line(scene, rng, ("chord",)), scene
    except (GroundingError, PlanError):
        return None


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
            after = simulator.execute(AffordancePair().act(drawn.line, scene, rng))
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
