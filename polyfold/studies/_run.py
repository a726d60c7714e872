"""Runs a study: in this process, in several, or on a Dask cluster; resumable, with progress.

A finished episode is on disk before the next is waited for, so killing a run at any moment loses at most what was in
flight, and running it again does only what is missing, and again what failed for lack of an answer by the language
model.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from functools import partial
from pathlib import Path

from polyfold import plugins
from polyfold.errors import ConfigError
from polyfold.logs import RunDirectory, picture_path, write_atomically
from polyfold.studies._cell import PICTURES, Render, evaluate_with_picture
from polyfold.studies._cells import Cell, cells
from polyfold.studies._executors import Record, Results, _results
from polyfold.studies._study import Study, experiment_of

ENGINES = ("local", "dask")


def evaluate(
    study: Study,
    out: str | Path,
    workers: int = 1,
    engine: str = "local",
    address: str | None = None,
    progress: bool = True,
    pictures: str = "failed",
    render: Render | None = None,
) -> list[Record]:
    """Run what a directory lacks of a study and return all its records, in the study's order.

    Args:
        study: what to run.
        out: run directory; made if needed, resumed if it holds the same study.
        workers: processes on this machine.
        engine: ``local`` or ``dask``.
        address: of the Dask scheduler; without one a cluster of ``workers`` is started on this machine.
        progress: show a progress bar with rate, time left and running success.
        pictures: which episodes get a small picture beside their record: ``none``, ``failed`` (and the first episode
            of each task) or ``all``.
        render: draws an episode as the bytes of a WebP file; without it there are no pictures.

    Raises:
        ConfigError: if the directory belongs to another study, or a component can't reach the workers.
        LLMAccessError: if a variant's language model lacks its key; before anything is folded.
    """
    if engine not in ENGINES:
        raise ConfigError(f"there is no engine {engine!r}; choose one of {', '.join(ENGINES)}")
    if pictures not in PICTURES:
        raise ConfigError(f"there are no pictures {pictures!r}; choose one of {', '.join(PICTURES)}")
    run = RunDirectory(out, {"study": study.model_dump(mode="json")})
    wanted = list(cells(study))
    done = {key: record for key, record in run.episodes().items() if not _unanswered(record)}
    missing = [cell for cell in wanted if cell.key not in done]
    if missing and (workers > 1 or engine == "dask"):
        _check_portable()
    _check_language_models(study, missing)
    job = partial(evaluate_with_picture, study, pictures=pictures if render else "none", render=render)
    with closing(_results(job, missing, workers, engine, address)) as results:
        shown = _with_progress(results, len(wanted), list(done.values()), progress and bool(missing))
        for cell, (record, picture) in shown:
            run.append(cell.key, _with_picture(run.path, cell, record, picture))
    done = run.episodes()
    return [done[cell.key] for cell in wanted]


def _unanswered(record: Record) -> bool:
    """Whether the episode ended because its language model gave no answer, which may go better another time."""
    return record["failure"] is not None and record["failure"]["stage"] == "unanswered"


def _with_picture(folder: Path, cell: Cell, record: Record, picture: bytes | None) -> Record:
    """The record with the relative path of its picture, which is on disk before the record is."""
    if picture is None:
        return record
    path = picture_path(cell.key)
    (folder / path).parent.mkdir(exist_ok=True)
    write_atomically(folder / path, picture)
    return {**record, "picture": path}


def _with_progress(results: Results, total: int, done: Sequence[Record], shown: bool) -> Results:
    from tqdm import tqdm

    successes = sum(record["success"]["polyfold"] for record in done)
    with tqdm(total=total, initial=len(done), unit="episode", disable=not shown) as bar:
        for finished, (cell, (record, picture)) in enumerate(results, len(done) + 1):
            yield cell, (record, picture)
            successes += record["success"]["polyfold"]
            bar.set_postfix_str(f"success {successes / finished:.0%}", refresh=False)
            bar.update()


def _check_language_models(study: Study, missing: Sequence[Cell]) -> None:
    """Construct each variant's once, so that no run ends at its second variant for want of a key."""
    for variant in dict.fromkeys(cell.variant for cell in missing):
        experiment = experiment_of(study, variant)
        agent = plugins.component_class("agents", experiment.agent.name.partition(":")[0])
        if "instruction" in getattr(agent, "requires", ()):
            plugins.create_chosen(experiment, "llm")


def _check_portable() -> None:
    """Refuse components that a worker could not import."""
    portable = {(kind, name) for kind, name, _ in plugins.portable()}
    for kind, name in plugins.by_hand():
        if (kind, name) not in portable:
            raise ConfigError(
                f"{name!r} was registered from a notebook or script and can't reach worker processes; "
                "put its class into a module that can be imported, or run with workers=1"
            )
