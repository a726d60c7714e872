"""``polyfold.fold``: from a sentence to a folded garment, its figures and its pictures."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from polyfold import plugins, viz
from polyfold.api._loaders import garment as named_garment
from polyfold.config import USUAL, ComponentSpec, Experiment
from polyfold.errors import ConfigError
from polyfold.evaluation import judge
from polyfold.evaluation._suites import find_task
from polyfold.garments import Garment
from polyfold.logs._disk.files import write_atomically
from polyfold.logs._writing import fold_record, transcript_lines
from polyfold.plugins.interfaces import RecordsMotion, Simulator
from polyfold.rollout import run_episode
from polyfold.rollout._sentences import plain
from polyfold.types import Episode, Observation

GIF_RATE = 12.0
"""Frames of the animation per simulated second."""


def fold(
    instruction: str,
    garment: str | Garment = "tshirt",
    seed: int = 0,
    *,
    task: str | None = None,
    out: str | Path | None = None,
    experiment: Experiment | None = None,
    observer: Any = None,
    **components: Any,
) -> Episode:
    """Fold a garment from a sentence, in simulation.

    Args:
        instruction: what to do, for example ``"fold the t-shirt into a rectangular block"``.
        garment: a kind (``tshirt``, ``pants``, ``square``, ``rectangle``, ...), of which ``seed`` picks the instance,
            or a garment made by :func:`polyfold.garment`, which keeps its fabric unless the experiment names one.
        seed: picks the garment and how it lies, and the agent's random choices.
        task: id of the standard task to judge against; by default the plan is recognised as one where it is.
        out: directory for ``episode.json``, ``transcript.jsonl``, ``filmstrip.png`` and ``fold.gif``.
        experiment: the components; by default those that need no key and no GPU.
        observer: an object whose ``on_episode_start``, ``on_step`` and ``on_episode_end`` are called as it happens.
        components: single components instead: ``policy="farthest"``, ``fabric="denim"``, ``llm={"name": "offline"}``.

    Returns:
        The episode; it shows itself in Jupyter.

    Raises:
        RefusedError: if the instruction can't be understood or done; nothing is folded.
        PolyfoldError: if grounding, planning or simulation fail; ``out`` then holds what was done until then.
    """
    instruction = plain(instruction)  # before a folder is made for what is no text
    experiment = (experiment or Experiment()).override(components)
    if isinstance(garment, str):
        garment = named_garment(garment, seed=seed, experiment=experiment)
    elif experiment.fabric != ComponentSpec(name=USUAL):
        garment = replace(garment, fabric=plugins.make_fabric(experiment.fabric, garment.kind))
    frames: list[Observation] | None = None if out is None else []
    folder = None if out is None else _prepare(Path(out))
    if observer is not None:
        plugins.observe(observer)
    started = datetime.now(UTC)
    try:
        episode = attempt(instruction, garment, seed, experiment, task=task, frames=frames)
    finally:
        if observer is not None:
            plugins.unobserve(observer)
    if folder is not None:
        save(episode, folder, frames or [], started)
    if episode.error is not None:
        raise episode.error
    return episode


def attempt(
    instruction: str,
    garment: Garment,
    seed: int,
    experiment: Experiment,
    *,
    task: str | None = None,
    frames: list[Observation] | None = None,
) -> Episode:
    """Run and judge one episode; a failed one is returned with its ``failure`` instead of raised.

    Args:
        frames: if given, pictures of the motion are appended (for simulators that can ``record``).
    """
    goal = None if task is None else find_task(task, garment.kind)
    with closing(plugins.create_chosen(experiment, "simulator")) as simulator:
        if frames is not None:
            _record_motion(simulator, frames)
        return run_episode(
            experiment, garment, instruction, seed, simulator, task=goal, judge=lambda episode: judge(episode, task)
        )


def _record_motion(simulator: Simulator, frames: list[Observation]) -> None:
    """Have pictures of the motion appended, if the simulator can take them."""
    if isinstance(simulator, RecordsMotion):
        simulator.record(frames.append, GIF_RATE)


def save(episode: Episode, folder: Path, frames: Sequence[Observation] = (), started: datetime | None = None) -> None:
    """Write ``episode.json``, ``transcript.jsonl``, ``filmstrip.png`` and, if there was motion, ``fold.gif``.

    Args:
        episode: what happened.
        folder: where to.
        frames: pictures of the motion.
        started: when it began, in UTC.
    """
    record = fold_record(episode, started, datetime.now(UTC)).model_copy(update={"out": str(folder)})
    write_atomically(folder / "episode.json", record.model_dump_json(indent=2) + "\n")
    write_atomically(folder / "transcript.jsonl", transcript_lines(episode.calls))
    viz.save(viz.filmstrip_of(episode), folder / "filmstrip.png")
    (folder / "fold.gif").unlink(missing_ok=True)  # an earlier fold's
    if frames:
        motion = [episode.start.rgb, *(frame.rgb for frame in frames), episode.final.rgb]
        viz.gif(motion, folder / "fold.gif", fps=GIF_RATE)


def _prepare(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(f"can't write to {folder} ({error.strerror}); choose another --out") from error
    return folder
