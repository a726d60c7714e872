"""What a report is made from: a run directory, finished or not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from polyfold.analysis import Results
from polyfold.analysis._results import open_results
from polyfold.errors import PolyfoldError
from polyfold.logs import StudyEpisodeRecord
from polyfold.studies import Study
from polyfold.studies._cells import cells
from polyfold.types import Threshold


@dataclass(frozen=True, eq=False)
class Source:
    """A run directory that was read.

    Attributes:
        folder: the directory.
        results: its study and finished episodes.
        expected: episodes of the whole study; None where its task suite is not installed.
    """

    folder: Path
    results: Results
    expected: int | None

    @property
    def variants(self) -> list[str]:
        """Names of the study's variants, in its order."""
        return list(self.results.study.variants)

    @property
    def records(self) -> Sequence[StudyEpisodeRecord]:
        """The finished episodes."""
        return self.results.records

    @property
    def own_criterion(self) -> Sequence[Threshold]:
        """Bounds of the study's own criterion."""
        return self.results.run.criteria[self.results.criterion]

    def of(self, variant: str, kind: str | None = None) -> Sequence[StudyEpisodeRecord]:
        """Records of a variant, of one garment kind or of all."""
        return self._by_group.get((variant, kind), [])

    @cached_property
    def _by_group(self) -> Mapping[tuple[str, str | None], Sequence[StudyEpisodeRecord]]:
        """Large runs are asked for the same records many times."""
        found: dict[tuple[str, str | None], list[StudyEpisodeRecord]] = {}
        for record in self.records:
            for kind in (record.garment.kind, None):
                found.setdefault((record.variant, kind), []).append(record)
        return found

    def groups(self) -> list[tuple[str, str | None]]:
        """Headings and garment kinds to break figures down by: each kind, then all if there are several."""
        kinds = self.results.kinds()
        found: list[tuple[str, str | None]] = [(kind, kind) for kind in kinds]
        return found if len(kinds) == 1 else [*found, ("all", None)]


def open_source(folder: str | Path) -> Source:
    """Read a run directory. Raises ConfigError if there is none."""
    results = open_results(folder)
    return Source(Path(folder), results, _expected(results.study))


def _expected(study: Study) -> int | None:
    """The report of a run from elsewhere must not need the plugins that made it."""
    try:
        return sum(1 for _ in cells(study))
    except PolyfoldError:
        return None
