"""What the oracle makes of a task on a garment: the reference that metrics compare with, cached by content."""

from __future__ import annotations

import hashlib
import io
import json
import os
import warnings
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from polyfold.config import ComponentSpec, Experiment
from polyfold.evaluation._judging import final_mask
from polyfold.evaluation._undisturbed import undisturbed
from polyfold.garments import Garment, Mesh
from polyfold.geometry import Camera
from polyfold.logs._dependencies import fingerprint
from polyfold.logs._disk.files import write_atomically
from polyfold.logs._host import processor
from polyfold.rollout import run_episode
from polyfold.tasks import Task, fold_lines
from polyfold.tasks._ideal import fold_step_by_step
from polyfold.types import Outcome, SimState

MOVED = 0.020
"""A reference in which no particle moves further than this [m] asks for nothing to be done."""


@dataclass(frozen=True, eq=False)
class Reference:
    """What counts as right: where every particle lay after each fold, and the final silhouette.

    Attributes:
        outcome: start and end for metrics.
        after: state after each step.
    """

    outcome: Outcome
    after: tuple[SimState, ...]

    def is_idle(self) -> bool:
        """Whether nothing moves, so that doing nothing is right."""
        travel = np.linalg.norm(self.outcome.end.positions - self.outcome.start.positions, axis=1)
        return bool((travel <= MOVED).all())


def cache_folder() -> Path:
    """Where references are kept: ``$POLYFOLD_CACHE``, else ``~/.cache/polyfold``."""
    return Path(os.environ.get("POLYFOLD_CACHE") or Path.home() / ".cache" / "polyfold")


def reference_for(task: Task, garment: Garment, seed: int, simulator: ComponentSpec) -> Reference:
    """The oracle's result from the same start, computed once and then read from the cache.

    Args:
        task: the task.
        garment: the garment.
        seed: of the pose.
        simulator: the simulator and its parameters; one that injects faults or noise says which to use
            instead (:class:`polyfold.plugins.interfaces.HasReferenceConfig`).
    """
    experiment = Experiment.of(agent="oracle", simulator=undisturbed("simulators", simulator))
    path = cache_folder() / "references" / f"{_key(task, garment, seed, experiment)}.npz"
    if (kept := _kept(path, garment.mesh)) is not None:
        return kept
    episode = run_episode(experiment, garment, "", seed, task=task, role="reference")
    if episode.error is not None:
        raise episode.error
    mask = final_mask(episode)
    after = tuple(step.after for step in episode.final_attempts())
    found = Reference(Outcome(episode.initial_state, episode.final_state, mask, garment.mesh), after)
    _keep(path, found)
    return found


def ideal_reference(task: Task, garment: Garment, flat: SimState) -> Reference:
    """The flat garment folded geometrically along the task's lines: no simulator and no policy has a part in it.

    Args:
        task: the task.
        garment: the garment.
        flat: the state before the first fold.
    """
    lines = fold_lines(task, flat.keypoint_pixels())
    folded = [ideal.outcome(flat, garment.mesh) for ideal in fold_step_by_step(flat, garment, lines)]
    return Reference(folded[-1], tuple(outcome.end for outcome in folded))


def _key(task: Task, garment: Garment, seed: int, experiment: Experiment) -> str:
    """What the oracle's result depends on: the same fingerprint guards resumed runs."""
    content = {
        "steps": task.model_dump(mode="json")["steps"],
        "mesh": hashlib.sha256(garment.mesh.vertices.tobytes() + garment.mesh.triangles.tobytes()).hexdigest(),
        "fabric": garment.fabric.constants(),
        "angle": garment.angle_deg,
        "seed": seed,
        "experiment": experiment.model_dump(mode="json"),
        "fingerprint": fingerprint([experiment], [("garments", garment.kind)], commits=False).digest(),
        "processor": processor(),
    }
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:40]


def _keep(path: Path, reference: Reference) -> None:
    """Write all at once, so that a kill leaves no half reference and two workers never disturb each other."""
    start, mask = reference.outcome.start, reference.outcome.mask
    camera, content = start.camera, io.BytesIO()
    np.savez_compressed(
        content,
        positions=np.stack([state.positions for state in (start, *reference.after)]),
        mask=np.packbits(mask),
        camera=np.array([camera.width, camera.height, camera.focal, camera.elevation]),
        names=np.array(list(start.keypoints)),
        indices=np.array(list(start.keypoints.values())),
    )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, content.getvalue())
    except OSError as error:
        _mention(f"references can't be kept in {path.parent} ({error.strerror}), and are computed by each run")


def _kept(path: Path, mesh: Mesh) -> Reference | None:
    """A reference that was computed before; None if there is none, or it can't be read."""
    if not path.exists():
        return None
    try:
        return _read(path, mesh)
    except Exception as error:  # a damaged archive raises whatever its bytes make of it
        _mention(f"the reference {path} is damaged ({error}), and is computed anew")
        return None


@cache
def _mention(problem: str) -> None:
    """Warn once: a study asks for the same references again and again."""
    warnings.warn(f"{problem}; set POLYFOLD_CACHE to another folder if that comes again", stacklevel=4)


def _read(path: Path, mesh: Mesh) -> Reference:
    with np.load(path, allow_pickle=False) as stored:
        width, height, focal, elevation = stored["camera"]
        camera = Camera(int(width), int(height), float(focal), float(elevation))
        keypoints = {str(name): int(index) for name, index in zip(stored["names"], stored["indices"], strict=True)}
        states = [SimState(positions, np.zeros_like(positions), keypoints, camera) for positions in stored["positions"]]
        pixels = camera.width * camera.height
        mask = np.unpackbits(stored["mask"], count=pixels).astype(bool).reshape(camera.height, camera.width)
    return Reference(Outcome(states[0], states[-1], mask, mesh), tuple(states[1:]))
