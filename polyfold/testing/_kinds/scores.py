"""What metrics, criteria and suites of tasks are held to."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from polyfold import plugins
from polyfold.evaluation._suites import suite as suite_of
from polyfold.geometry import Camera
from polyfold.geometry._masks import fill_polygon
from polyfold.testing._checks import checks
from polyfold.testing._materials import changed, kept
from polyfold.testing._subjects import Subject
from polyfold.types import Outcome, SimState

COARSE, SIZE, PLY = 0.02, 0.3, 0.0006


def outcome(share: float) -> Outcome:
    """A square, and where it lies after the part beyond this share of its height was folded up, geometrically."""
    garment = plugins.generate_garment("square", 0, COARSE, size=SIZE)
    mesh, camera = garment.mesh, Camera()
    flat = np.column_stack([mesh.vertices, np.full(len(mesh.vertices), PLY / 2)])
    height = float(np.ptp(mesh.vertices[:, 1]))
    y = mesh.vertices[:, 1].max() - share * height
    folded = flat.copy()
    moved = flat[:, 1] < y
    folded[moved, 1], folded[moved, 2] = 2 * y - flat[moved, 1], 1.5 * PLY
    still = np.zeros_like(flat)
    start, end = (SimState(places, still, garment.keypoints, camera) for places in (flat, folded))
    mask = np.zeros((camera.height, camera.width), bool)
    for triangle in mesh.triangles:
        mask |= fill_polygon(camera.to_pixels(folded[triangle]), camera.width, camera.height)
    return Outcome(start, end, mask, mesh)


@checks("metrics", "what is compared with itself is perfect, and nothing scores better")
def _identity(subject: Subject) -> None:
    metric = subject.make()
    good, other = outcome(0.5), outcome(0.8)
    best, worse = metric.score(good, [good]), metric.score(other, [good])
    if math.isnan(best):
        return
    better = worse > best + 1e-9 if metric.higher_is_better else worse < best - 1e-9
    subject.require(
        not better, "score", f"another fold scores {worse:g}, the same one {best:g}", "look at higher_is_better"
    )
    most = getattr(metric, "most", None)
    subject.require(
        most is None or best <= most + 1e-9,
        "most",
        f"it is {most}, and the score is {best:g}",
        "give its largest value",
    )


@checks("metrics", "a plain fold has a value")
def _valued(subject: Subject) -> None:
    metric, wanted = subject.make(), outcome(0.5)
    values = [metric.score(wanted, [wanted]), metric.score(outcome(0.8), [wanted])]
    subject.require(
        any(map(math.isfinite, values)), "score",
        f"a square folded in half scores {values[0]:g} against itself, one folded elsewhere {values[1]:g}",
        "NaN is for what can't be measured, as without a reference; a plain fold can be",
    )  # fmt: skip


@checks("metrics", "of several references the nearest counts")
def _nearest(subject: Subject) -> None:
    metric, result = subject.make(), outcome(0.5)
    one, other = outcome(0.52), outcome(0.8)
    alone = [metric.score(result, [one]), metric.score(result, [other])]
    if any(map(math.isnan, alone)):
        return
    both = metric.score(result, [other, one])
    wanted = max(alone) if metric.higher_is_better else min(alone)
    subject.require(
        math.isclose(both, wanted, rel_tol=1e-6, abs_tol=1e-6), "score",
        f"against two it is {both:g}, against each alone {alone[0]:g} and {alone[1]:g}", "take the best of them",
    )  # fmt: skip


@checks("metrics", "it changes nothing, and a second look agrees")
def _pure(subject: Subject) -> None:
    metric, result, reference = subject.make(), outcome(0.5), outcome(0.6)
    before = kept(result)
    first, second = metric.score(result, [reference]), metric.score(result, [reference])
    subject.require(first == second or math.isnan(first), "score", f"{first:g}, then {second:g}", "keep no state")
    part = changed(replace(before, mesh=result.mesh), result)
    subject.require(not part, "score", f"it writes into the result's {part}", "copy it first")


@checks("criteria", "its bounds are on metrics that there are, the way these are good")
def _bounds(subject: Subject) -> None:
    thresholds = subject.cls().thresholds
    subject.require(thresholds, "thresholds", "there is none, so that everything succeeds", "give at least one")
    for threshold in thresholds:
        subject.require(
            threshold.metric in plugins.names("metrics"), "thresholds", f"no metric is called {threshold.metric!r}",
            f"there are {', '.join(plugins.names('metrics'))}",
        )  # fmt: skip
        right = plugins.component_class("metrics", threshold.metric).higher_is_better
        subject.require(
            threshold.higher_is_better == right, "thresholds", f"its bound on {threshold.metric!r} is the wrong way",
            f"write higher_is_better={right}",
        )  # fmt: skip


@checks("tasks", "its tasks can be read, and are of kinds that there are")
def _suite(subject: Subject) -> None:
    suite = suite_of(subject.name)
    kinds = {task.garment for task in suite.tasks}
    unknown = sorted(kinds - set(plugins.names("garments")))
    subject.require(not unknown, "tasks", f"no garment is called {', '.join(unknown)}", "register the kind as well")
