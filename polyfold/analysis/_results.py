"""What a study found: its records, and how they are selected."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polyfold.errors import ConfigError
from polyfold.logs import RunRecord, StudyEpisodeRecord, read_episodes, read_run
from polyfold.studies import Study
from polyfold.types._views import view_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from polyfold.analysis._tables import Table

KINDS = ("square", "rectangle", "tshirt", "pants")
"""The paper's kinds of garment, in its order; others follow."""


@dataclass(frozen=True, eq=False, repr=False)
class Results:
    """The finished episodes of a study.

    Attributes:
        run: what was run, and what it depends on.
        records: one per episode.
    """

    run: RunRecord
    records: Sequence[StudyEpisodeRecord]

    @cached_property
    def study(self) -> Study:
        """The study that was run, defaults included."""
        return Study.model_validate(self.run.asked["study"])

    def __repr__(self) -> str:
        variants = ", ".join(self.study.variants)
        return f"<Results of {self.study.name!r}: {len(self.records)} episodes of {variants}>"

    @property
    def criterion(self) -> str:
        """The study's own success criterion."""
        return next(iter(self.run.criteria))

    def of(self, variant: str, kind: str | None = None) -> list[StudyEpisodeRecord]:
        """Records of a variant, of one kind of garment or of all."""
        return [r for r in self.records if r.variant == variant and (kind is None or r.garment.kind == kind)]

    def kinds(self) -> list[str]:
        """Kinds of garment that occur, the paper's four first."""
        found = {record.garment.kind for record in self.records}
        return [kind for kind in KINDS if kind in found] + sorted(found - set(KINDS))

    def of_length(self, steps: str) -> Results:
        """Only the episodes whose task has one fold (``single``) or several (``multi``)."""
        wanted = {"single": lambda count: count == 1, "multi": lambda count: count > 1}[steps]
        kept = [r for r in self.records if r.steps_wanted is not None and wanted(r.steps_wanted)]
        return self._only(kept, {"single": "a task of one fold", "multi": "a task of several folds"}[steps])

    def of_wordings(self, wordings: str | Collection[int]) -> Results:
        """Only the episodes of some of the tasks' sentences.

        Args:
            wordings: their numbers; or ``unseen``, those that nothing was tuned on, or ``seen``, the others.

        Raises:
            ConfigError: if the suite does not say which of them are unseen, or no episode is of these.
        """
        if not isinstance(wordings, str):
            said = ", ".join(map(str, sorted(wordings)))
            return self._only([r for r in self.records if r.wording in wordings], f"a wording {said}")
        if wordings not in ("seen", "unseen"):
            raise ConfigError(f"wordings are seen, unseen or numbers, not {wordings!r}; for example unseen, or 3,4")
        if all(record.wording_unseen is None for record in self.records):
            raise ConfigError(
                f"this run doesn't say which wordings are unseen: the suite {self.study.suite} did not when it was "
                "recorded; leave the choice out, or run the study again"
            )
        wanted = wordings == "unseen"
        kept = [record for record in self.records if record.wording_unseen == wanted]
        return self._only(kept, {"seen": "a seen wording", "unseen": "an unseen wording"}[wordings])

    def _only(self, records: Sequence[StudyEpisodeRecord], what: str) -> Results:
        """These records; raises ConfigError if there are none, though there were some."""
        if self.records and not records:
            raise ConfigError(f"no episode of {self.study.name} is of {what}; leave the choice out")
        return replace(self, records=records)

    def plot(self, column: str = "success %") -> Figure:
        """Bars per kind of garment and variant with intervals, as a matplotlib figure.

        Args:
            column: heading of a column, a metric's name or a criterion's.
        """
        return view_of(self, "bars", column)

    def pivot(self, rows: str, columns: str, figure: str = "success %") -> Table:
        """A study that crosses settings (:func:`polyfold.grid`), one setting's values down, another's across.

        Args:
            rows, columns: settings that the study varies, for example ``"policy"`` and ``"agent.recover"``; over the
                others is averaged.
            figure: heading of a column, a metric's name or a criterion's.

        Raises:
            ConfigError: if the study varies no such setting.
        """
        return view_of(self, "pivot", rows, columns, figure)

    def effects(self, figure: str = "success %") -> Table:
        """What each value of each setting does over all values of the others, and what two do together beyond that.

        Args:
            figure: as in :meth:`pivot`.

        Raises:
            ConfigError: if the study crosses no settings, or some combination has no episode yet.
        """
        return view_of(self, "effects", figure)

    def dataframe(self) -> DataFrame:
        """One row an episode, for pandas: settings by name, metrics, success by criterion, seconds by stage.

        Factors of a grid are columns of their own (``policy``, ``grounding``), so that effects can be pivoted.

        Raises:
            ConfigError: if pandas is not installed.
        """
        try:
            from pandas import DataFrame
        except ModuleNotFoundError as error:
            raise ConfigError("a data frame needs pandas; install it with: pip install pandas") from error
        return DataFrame([_row(record) for record in self.records])

    def _repr_html_(self) -> str:
        return view_of(self, "html")


def open_results(out: str | Path) -> Results:
    """Read a run directory, finished or not. Raises ConfigError if there is none, or none of a study."""
    if not isinstance(out, str | PathLike):
        raise ConfigError(f"{out!r} is no folder; give the --out of an evaluation")
    run = read_run(out)
    if "study" not in run.asked:
        raise ConfigError(f"{out} holds no study; give the --out of an evaluation")
    return Results(run, read_episodes(out))


def check_results(results: object) -> None:
    """Raise ConfigError, saying how to come by them, for what is no results: most often the folder that holds them."""
    if not isinstance(results, Results):
        raise ConfigError(f"{results!r} is no results; give what polyfold.run returned, or polyfold.open(folder)")


def _row(record: StudyEpisodeRecord) -> dict[str, Any]:
    """An episode as one flat row."""
    return {
        "key": record.key,
        "variant": record.variant,
        **record.factors,
        "task": record.task,
        "type": record.type,
        "split": record.split,
        "steps_wanted": record.steps_wanted,
        "garment": record.garment.kind,
        "garment_seed": record.garment.seed,
        "size_m": record.garment.size_m,
        "fabric": None if record.garment.fabric is None else record.garment.fabric.name,
        "wording": record.wording,
        "wording_unseen": record.wording_unseen,
        "instruction": record.instruction,
        "folds": record.folds,
        "retries": record.retries,
        **record.metrics,
        **{f"success_{name}": holds for name, holds in record.success.items()},
        "failure": record.failure.stage if record.failure else None,
        "cause": record.cause,
        "privileged": record.privileged,
        **{f"seconds_{stage}": spent for stage, spent in record.seconds.items()},
    }
