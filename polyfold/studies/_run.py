"""Runs a study: in this process, in several, or on a Dask cluster; resumable, with progress.

A finished episode is on disk before the next is waited for, so killing a run at any moment loses at most what was in
flight, and running it again does only what is missing, and again what failed for lack of an answer by the language
model. A run does not go on with changed code, prompts or weights unless that is asked for. One that is asked for
further variants or more garments keeps what it has and runs the rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

from polyfold import plugins
from polyfold.errors import ConfigError
from polyfold.evaluation._criteria import criteria
from polyfold.logs import RunDirectory, StudyEpisodeRecord, exclusive
from polyfold.logs._components import components_in_use
from polyfold.logs._dependencies import fingerprint
from polyfold.logs._disk.files import picture_path, write_atomically
from polyfold.logs._fingerprint import Fingerprint
from polyfold.logs._records import MetricRecord
from polyfold.plugins.hookspecs import plural
from polyfold.plugins.interfaces import LabelledMetric, Metric, RoundedMetric
from polyfold.studies._cell import PICTURES, Render, Scored, evaluate_cell
from polyfold.studies._cells import Cell, cells
from polyfold.studies._executors import check_dask, in_processes, on_dask
from polyfold.studies._study import Study, experiment_of
from polyfold.tasks._suite import is_file
from polyfold.types import Threshold

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
    accept_change: bool = False,
) -> list[StudyEpisodeRecord]:
    """Run the study's episodes that are not in a directory yet; returns the records of all, in the study's order.

    Args: as for :func:`polyfold.run`, and besides

        render: draws an episode as the bytes of a WebP file; without it there are no pictures.
    """
    if engine not in ENGINES:
        raise ConfigError(f"there is no engine {engine!r}; choose one of {', '.join(ENGINES)}")
    if pictures not in PICTURES:
        raise ConfigError(f"there are no pictures {pictures!r}; choose one of {', '.join(PICTURES)}")
    if workers < 1:
        raise ConfigError(f"there are no {workers} workers; give 1 or more")
    if engine == "dask":
        check_dask(address)
    wanted = list(cells(study))
    with exclusive(out):
        run = _opened(study, sorted({cell.garment for cell in wanted}), out, accept_change)
        done = {key: record for key, record in run.records().items() if not record.unanswered}
        missing = [cell for cell in wanted if cell.key not in done]
        if missing:
            run.guard(accept_change)
            _check_language_models(study, missing)
            if workers > 1 or engine == "dask":
                _check_portable(study, missing)
        plugins.notify("on_study_start", study=study)
        job = partial(evaluate_cell, study, pictures=pictures, render=render)
        dask = missing and engine == "dask"
        results = on_dask(job, missing, workers, address) if dask else in_processes(job, missing, workers)
        try:
            with closing(results):
                shown = _with_progress(results, len(wanted), list(done.values()), progress and bool(missing))
                for cell, (record, picture) in shown:
                    run.append(_with_picture(run.path, cell, record, picture))
        finally:
            finished = run.records()
            plugins.notify("on_study_end", study=study, finished=sum(cell.key in finished for cell in wanted))
        return [finished[cell.key] for cell in wanted]


def _opened(
    study: Study, kinds: Sequence[str], out: str | Path, accept_change: bool
) -> RunDirectory[StudyEpisodeRecord]:
    """The study's run directory, described if it is new."""
    bounds = criteria(study.criteria)
    return RunDirectory(
        out,
        {"study": study.model_dump(mode="json")},
        StudyEpisodeRecord,
        study_fingerprint(study, kinds),
        metric_records(bounds[study.criteria[0]]),
        bounds,
        {variant: components_in_use(experiment_of(study, variant), kinds) for variant in study.variants},
        extends=_asks_for_more,
        redescribe=accept_change,
    )


def _asks_for_more(before: Mapping[str, Any], now: Mapping[str, Any]) -> bool:
    """Whether a study is one from before with further variants or more garments, and otherwise the same.

    What others published is only shown, and may change.
    """
    old, new = before["study"], now["study"]
    may_grow = ("variants", "factors")
    same = all(old.get(name) == new.get(name) for name in {*old, *new} - {*may_grow, "garments", "published"})
    kept = all(new[name].get(key) == value for name in may_grow for key, value in old[name].items())
    return same and kept and new["garments"] >= old["garments"]


def study_fingerprint(study: Study, garment_kinds: Iterable[str]) -> Fingerprint:
    """What the results of a study on some kinds of garment depend on besides the study itself."""
    also = [("metrics", name) for name in plugins.names("metrics")]
    also += [("criteria", name) for name in study.criteria]
    also += [("garments", kind) for kind in sorted(garment_kinds)]
    also += [("tasks", study.suite), ("agents", "oracle")]
    return fingerprint([experiment_of(study, variant) for variant in study.variants], also)


def metric_records(own: Sequence[Threshold]) -> dict[str, MetricRecord]:
    """How each installed metric is shown, by name; those that a study's own criterion bounds first."""
    bounded = dict.fromkeys(threshold.metric for threshold in own)
    names = [*bounded, *(name for name in plugins.names("metrics") if name not in bounded)]
    return {name: _metric_record(name) for name in names}


def _metric_record(name: str) -> MetricRecord:
    metric: Metric = plugins.component_class("metrics", name)
    return MetricRecord(
        label=metric.label if isinstance(metric, LabelledMetric) else name,
        unit=metric.unit,
        digits=metric.digits if isinstance(metric, RoundedMetric) else 1,
        higher_is_better=metric.higher_is_better,
        summary=plugins.find("metrics", name).summary,
        most=getattr(metric, "most", None),
    )


def _with_picture(folder: Path, cell: Cell, record: StudyEpisodeRecord, picture: bytes | None) -> StudyEpisodeRecord:
    """The record with the relative path of its picture, which is on disk before the record is."""
    if picture is None:
        return record
    path = picture_path(cell.key)
    (folder / path).parent.mkdir(exist_ok=True)
    write_atomically(folder / path, picture)
    return record.model_copy(update={"picture": path})


def _with_progress(
    results: Iterable[tuple[Cell, Scored]], total: int, done: Sequence[StudyEpisodeRecord], shown: bool
) -> Iterator[tuple[Cell, Scored]]:
    from tqdm.auto import tqdm

    successes = sum(record.succeeded for record in done)
    with tqdm(total=total, initial=len(done), unit="episode", disable=not shown) as bar:
        for finished, (cell, (record, picture)) in enumerate(results, len(done) + 1):
            yield cell, (record, picture)
            successes += record.succeeded
            bar.set_postfix_str(f"success {successes / finished:.0%}", refresh=False)
            bar.update()


def _check_language_models(study: Study, missing: Sequence[Cell]) -> None:
    """Construct each variant's once, so that no run ends at its second variant for want of a key."""
    for variant in dict.fromkeys(cell.variant for cell in missing):
        experiment = experiment_of(study, variant)
        if "llm" in components_in_use(experiment):
            plugins.create_chosen(experiment, "llm")


def _check_portable(study: Study, missing: Sequence[Cell]) -> None:
    """Refuse components in use that can't be sent to a worker."""
    portable = {(kind, name) for kind, name, _ in plugins.portable()}
    used = _names_in_use(study, missing)
    for kind, name in plugins.by_hand():
        if (kind, name) in used and (kind, name) not in portable:
            raise ConfigError(
                f"{name!r} was registered from a notebook or script and holds on to what can't be sent to worker "
                "processes, such as a lock or an open file; make that in its __init__, or run with workers=1"
            )


def _names_in_use(study: Study, missing: Sequence[Cell]) -> set[tuple[str, str]]:
    """(kind, name) of the components that the missing episodes take, those of every episode included."""
    used = {("metrics", name) for name in plugins.names("metrics")}
    used |= {("criteria", name) for name in study.criteria} | {("agents", "oracle")}
    used |= set() if is_file(study.suite) else {("tasks", study.suite)}
    kinds = sorted({cell.garment for cell in missing})
    used |= {("garments", kind) for kind in kinds}
    for variant in dict.fromkeys(cell.variant for cell in missing):
        for field, spec in components_in_use(experiment_of(study, variant), kinds).items():
            used.add((plural(field.partition(" of ")[0]), spec.name.partition(":")[0]))
    return used
