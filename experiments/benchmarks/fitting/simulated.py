"""Fits to camera images of simulated garments, flat and folded, against the true keypoints."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from polyfold import plugins
from polyfold.errors import PolyfoldError
from polyfold.geometry import FoldLine, turn_onto
from polyfold.plugins._fabrics import garment_template
from polyfold.plugins.interfaces import GarmentKind, Grounding, Segmenter, Simulator
from polyfold.polygon import FoldedModel, Template
from polyfold.tasks import fold_lines, load_suite
from polyfold.types import Observation, Scene

Floats = NDArray[np.float64]

NEARLY_45 = 5.0
"""A square this close [deg] to standing on a corner may be named either way."""


@dataclass(frozen=True, eq=False)
class FlatResult:
    """One flat garment.

    Attributes:
        errors: distance of each vertex from its keypoint [px], shape (V,).
        turned: the fit's orientation is off by more than 45 degrees.
        seconds: CPU time [s].
    """

    errors: Floats
    turned: bool
    seconds: float


@dataclass(frozen=True)
class FoldResult:
    """One garment after some folds: mean vertex error [px] and CPU time of the refit [s]."""

    folds: int
    error: float
    seconds: float


def fitted_garments(
    kind: str, seeds: Iterable[int], grounding: Grounding, rotation: float
) -> Iterator[tuple[dict[str, Floats], dict[str, Floats]]]:
    """The fit's and the true vertices, name -> pixel, of flat garments turned by up to ``rotation`` [deg]."""
    garments, simulator, segmenter = _parts(kind, rotation)
    template = garments.template()
    for seed in _progress(seeds, f"{kind}, creases"):
        observation = simulator.reset(garments.generate(seed), seed)
        scene, _ = _timed(grounding, observation, segmenter, template)
        yield _model_of(scene).points(), _pixels(simulator)


def measure_flat(kind: str, seeds: Iterable[int], grounding: Grounding) -> list[FlatResult]:
    """Fit garments at any rotation."""
    garments, simulator, segmenter = _parts(kind, rotation=180.0)
    template = garments.template()
    results = []
    for seed in _progress(seeds, f"{kind}, flat"):
        observation = simulator.reset(plugins.generate_garment(kind, seed), seed)
        truth = _truth(simulator, template)
        scene, seconds = _timed(grounding, observation, segmenter, template)
        if not results:  # the first call compiles
            scene, seconds = _timed(grounding, observation, segmenter, template)
        found = _model_of(scene).rest
        if template.cyclic and _stands_on_corner(truth):
            found = min((np.roll(found, k, axis=0) for k in range(len(found))), key=lambda v: _errors(v, truth).mean())
        results.append(FlatResult(_errors(found, truth), _turned(found, truth), seconds))
    return results


def measure_folds(kind: str, seeds: Iterable[int], grounding: Grounding, policy: str) -> list[FoldResult]:
    """Follow garments through the folds of one standard task each."""
    _, simulator, segmenter = _parts(kind, rotation=20.0)
    template, act = garment_template(kind), plugins.create("policies", policy, {}).act
    tasks = load_suite(str(plugins.find("tasks", "polyfold70").target)).for_garment(kind)
    results: list[FoldResult] = []
    for number, seed in enumerate(_progress(seeds, f"{kind}, folds")):
        observation = simulator.reset(plugins.generate_garment(kind, seed), seed)
        lines = fold_lines(tasks[number % len(tasks)], _pixels(simulator))
        scene, _ = _timed(grounding, observation, segmenter, template)
        for folds, line in enumerate(lines, start=1):
            try:
                observation = simulator.execute(act(line, scene, np.random.default_rng([seed, folds])))
            except PolyfoldError:
                break
            scene, seconds = _timed(grounding, observation, segmenter, template, scene, line)
            results.append(FoldResult(folds, _mean_error(_model_of(scene), _pixels(simulator), template), seconds))
    return results


def _parts(kind: str, rotation: float) -> tuple[GarmentKind, Simulator, Segmenter]:
    simulator = plugins.create("simulators", "xpbd", {"rotation_deg": rotation})
    return plugins.create("garments", kind), simulator, plugins.create("segmenters", "colour", {})


def _timed(
    grounding: Grounding,
    observation: Observation,
    segmenter: Segmenter,
    template: Template,
    previous: Scene | None = None,
    line: FoldLine | None = None,
) -> tuple[Scene, float]:
    mask = segmenter.segment(observation)
    clock = time.process_time()
    scene = grounding.ground(observation, mask, template, previous, line)
    return scene, time.process_time() - clock


def _model_of(scene: Scene) -> FoldedModel:
    assert scene.model is not None, "this measures groundings that fit a model"
    return scene.model


def _pixels(simulator: Simulator) -> dict[str, Floats]:
    return dict(simulator.state().keypoint_pixels())


def _truth(simulator: Simulator, template: Template) -> Floats:
    pixels = _pixels(simulator)
    return np.array([pixels[name] for name in template.names])


def _mean_error(model: FoldedModel, truth: dict[str, Floats], template: Template) -> float:
    found = model.points()
    return float(np.mean([np.hypot(*(found[name] - truth[name])) for name in template.names]))


def _errors(found: Floats, truth: Floats) -> Floats:
    return np.hypot(*(found - truth).T)


def _turned(found: Floats, truth: Floats) -> bool:
    return abs(np.degrees(turn_onto(found, truth))) > 45.0


def _stands_on_corner(truth: Floats) -> bool:
    x, y = truth[2] - truth[1]
    return abs(abs(np.degrees(np.arctan2(y, x))) - 45.0) < NEARLY_45


def _progress(seeds: Iterable[int], words: str) -> Iterable[int]:
    return tqdm(list(seeds), desc=words, leave=False)
