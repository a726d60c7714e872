"""``polyfold.fold``: from a sentence to a folded garment, its figures and its pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, nullcontext
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from polyfold import plugins
from polyfold.api._loaders import garment as named_garment
from polyfold.config import USUAL, ComponentSpec, Experiment, checked_seed
from polyfold.errors import ConfigError
from polyfold.evaluation import judge
from polyfold.evaluation._suites import find_task
from polyfold.garments import Garment
from polyfold.logs._disk.files import write_atomically
from polyfold.logs._writing import fold_record, transcript_lines
from polyfold.plugins.interfaces import RecordsMotion, Simulator
from polyfold.rollout import run_episode
from polyfold.rollout._sentences import plain
from polyfold.types import Episode, Step
from polyfold.viz._film import Moment, write_film

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
        ConfigError: if the seed is no whole number, or a setting is wrong.
        PolyfoldError: if grounding, planning or simulation fail; ``out`` then holds what was done until then.
    """
    instruction, seed = plain(instruction), checked_seed(seed)  # before a folder is made for what is neither
    experiment = (experiment or Experiment()).override(components)
    garment = garment_for(experiment, garment, seed)
    recorded = None if out is None else _Film()
    folder = None if out is None else folder_for(Path(out))
    if observer is not None:
        plugins.observe(observer)
    started = datetime.now(UTC)
    try:
        episode = attempt(instruction, garment, seed, experiment, task=task, film=recorded)
    finally:
        if observer is not None:
            plugins.unobserve(observer)
    if folder is not None:
        save(episode, folder, recorded.moments if recorded else (), started)
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
    film: _Film | None = None,
) -> Episode:
    """Run and judge one episode; a failed one is returned with its ``failure`` instead of raised.

    Args:
        film: if given, it is told how the cloth moves (by simulators that can ``record``).
    """
    goal = None if task is None else find_task(task, garment.kind)
    with (
        closing(plugins.create_chosen(experiment, "simulator")) as simulator,
        nullcontext() if film is None else film.of(simulator),
    ):
        return run_episode(
            experiment, garment, instruction, seed, simulator, task=goal, judge=lambda episode: judge(episode, task)
        )


class _Film:
    """What moved during an episode, in order."""

    def __init__(self) -> None:
        self.moments: list[Moment] = []
        self._fold = 0

    @contextmanager
    def of(self, simulator: Simulator) -> Iterator[None]:
        """Keep what a simulator shows of its motion, if it can, and count the folds meanwhile."""
        if not isinstance(simulator, RecordsMotion):
            yield
            return
        simulator.record(lambda seen: self.moments.append(Moment(seen, simulator.state(), self._fold)), GIF_RATE)
        plugins.observe(self)
        try:
            yield
        finally:
            plugins.unobserve(self)

    def on_step(self, step: Step) -> None:
        """A fold is over."""
        self._fold = step.index + 1


def save(episode: Episode, folder: Path, moments: Sequence[Moment] = (), started: datetime | None = None) -> None:
    """Write ``episode.json``, ``transcript.jsonl``, ``filmstrip.png`` and, if there was motion, ``fold.gif``.

    Args:
        episode: what happened.
        folder: where to.
        moments: how the cloth moved.
        started: when it began, in UTC.
    """
    record = fold_record(episode, started, datetime.now(UTC)).model_copy(update={"out": str(folder)})
    write_atomically(folder / "episode.json", record.model_dump_json(indent=2) + "\n")
    write_atomically(folder / "transcript.jsonl", transcript_lines(episode.calls))
    episode.show(folder / "filmstrip.png")
    (folder / "fold.gif").unlink(missing_ok=True)  # an earlier fold's
    if moments:
        write_film(episode, moments, folder / "fold.gif", GIF_RATE)


def garment_for(experiment: Experiment, garment: str | Garment, seed: int) -> Garment:
    """A kind's seeded garment, or the one that is given, of the fabric that the experiment names if it names one."""
    if isinstance(garment, str):
        return named_garment(garment, seed=seed, experiment=experiment)
    if not isinstance(garment, Garment):
        raise ConfigError(f"{garment!r} is no garment; give a kind, such as 'tshirt', or one of polyfold.garment(...)")
    if experiment.fabric == ComponentSpec(name=USUAL):
        return garment
    return replace(garment, fabric=plugins.make_fabric(experiment.fabric, garment.kind))


def folder_for(folder: Path) -> Path:
    """The folder, made if needed. Raises ConfigError if it can't be written to."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(f"can't write to {folder} ({error.strerror}); choose another --out") from error
    return folder
