"""Folds that nobody meant: one arm drags a point of the cloth in one of a few ways, and what comes of it is kept.

After R. Lee et al., Learning Arbitrary-Goal Fabric Folding with One Hour of Real Robot Experience, CoRL 2020,
arXiv:2010.03209: whatever was reached serves afterwards as the goal that was to be reached.
"""

from __future__ import annotations

import zlib

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.errors import ActionError, SimulationError
from polyfold.garments import Mesh
from polyfold.plugins.interfaces import Simulator
from polyfold.types import Action, Observation, SimState
from polyfold_baselines.demos.demonstrating import Arrays, DemoPlan, as_bits, as_heights, padded
from polyfold_baselines.demos.window import SIDE, Window, on_table

Floats = NDArray[np.float64]

DIRECTIONS = 8
LENGTHS = (0.25, 0.5, 0.75)
"""Of drags, as shares of a view's side; the longest takes one end of a garment to the other."""
EACH = 4
"""Drags of one garment, each from where the last one left it."""
AT_EDGE = 0.7
"""Share of the picks that are near the cloth's edge, where folds begin."""
NEAR_EDGE = 5.0
"""What counts as near [px of the view]."""


def drags() -> Floats:
    """Every drag, in the view [px], shape (DIRECTIONS * LENGTHS, 2): direction by direction, the shortest first."""
    angles = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return (ways[:, None] * (np.array(LENGTHS) * SIDE)[None, :, None]).reshape(-1, 2)


def drag_at_random(plan: DemoPlan, job: int) -> Arrays:
    """What some drags of one garment came to, as :func:`polyfold_baselines.demos.demonstrating.demonstrate` has it.

    The goals are what was reached, ``error_mm`` is 0 and ``text`` empty. Beside the folds stands the cloth under their
    pictures, as :class:`polyfold_baselines.demos.cloths.Cloth` has it. Nothing if the first one can't be done.
    """
    task, seed = plan.jobs()[job]
    rng = np.random.default_rng([seed, zlib.crc32(task.id.encode())])
    garment = plugins.generate_garment(task.garment, seed, plan.edge_length)
    simulator: Simulator = plugins.create("simulators", plan.simulator.name, plan.simulator.params)
    segmenter = plugins.create("segmenters", "colour")
    seen = simulator.reset(garment, seed)
    mask = segmenter.segment(seen)
    window = Window.around(mask)
    rows, lay = [], [_particles(window, simulator.state())]
    for step in range(EACH):
        action = _drawn(window, mask, seen, rng)
        before = _view(window, seen, mask)
        try:
            seen = simulator.execute(action)
            mask = segmenter.segment(seen)
        except (ActionError, SimulationError):
            break
        after = _view(window, seen, mask)
        lay.append(_particles(window, simulator.state()))
        rows.append({
            "height": before[0], "mask": before[1], "goal_height": after[0], "goal_mask": after[1],
            "picks": padded(window.to_view(action.picks)), "places": padded(window.to_view(action.places)),
            "error_mm": np.float32(0.0), "text": np.str_(""), "step": np.int8(step), "steps": np.int8(EACH),
            "task": np.str_(task.id), "kind": np.str_(task.garment), "garment_seed": np.int32(seed),
        })  # fmt: skip
    simulator.close()
    if not rows:
        return {}
    columns = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    extent = np.array(window.extent(seen.camera), np.float32)
    return {**columns, **_cloth(garment.mesh, lay), "extent": extent}


def _view(window: Window, seen: Observation, mask: NDArray[np.bool_]) -> tuple[NDArray, NDArray]:
    return as_heights(window, seen.camera.elevation - seen.depth), as_bits(window, mask)


def _particles(window: Window, state: SimState) -> NDArray[np.float16]:
    seen = window.to_view(state.camera.to_pixels(state.positions))
    return np.column_stack([on_table(seen, window.extent(state.camera)), state.positions[:, 2]]).astype(np.float16)


def _cloth(mesh: Mesh, lay: list[NDArray[np.float16]]) -> Arrays:
    return {
        "particles": np.stack(lay), "rest": mesh.vertices.astype(np.float16), "layer": mesh.layer, "seam": mesh.seam,
    }  # fmt: skip


def _drawn(window: Window, mask: NDArray[np.bool_], seen: Observation, rng: np.random.Generator) -> Action:
    """A drag whose place lies in the picture."""
    import cv2

    view = (window.view(mask) > 0.5).astype(np.uint8)
    depth = cv2.distanceTransform(np.pad(view, 1), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    near = (depth > 0) & (depth <= NEAR_EDGE)
    chosen = near if rng.uniform() < AT_EDGE and near.any() else depth > 0
    rows, columns = np.nonzero(chosen)
    limit = np.array([seen.camera.width, seen.camera.height]) - 1.0
    while True:
        k = rng.integers(len(rows))
        pick = np.array([columns[k], rows[k]], float)
        ends = window.to_pixels(np.stack([pick, pick + drags()[rng.integers(len(drags()))]]))
        if ((ends >= 0) & (ends <= limit)).all():
            return Action(ends[:1], ends[1:])
