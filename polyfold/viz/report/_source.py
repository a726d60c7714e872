"""What a report is made from: a run directory, finished or not."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from polyfold.analysis import Results, open_results
from polyfold.analysis._results import Record
from polyfold.errors import PolyfoldError
from polyfold.studies import Study, cells


@dataclass(frozen=True, eq=False)
class Source:
    """A run directory that was read.

    Attributes:
        folder: the directory.
        results: its study and finished episodes.
        versions: of the packages it was made with.
        expected: episodes of the whole study; None where its task suite is not installed.
    """

    folder: Path
    results: Results
    versions: Mapping[str, str]
    expected: int | None

    @property
    def variants(self) -> list[str]:
        """Names of the study's variants, in its order."""
        return list(self.results.study.variants)

    @property
    def records(self) -> Sequence[Record]:
        """The finished episodes."""
        return self.results.records

    def of(self, variant: str, kind: str | None = None) -> Sequence[Record]:
        """Records of a variant, of one garment kind or of all."""
        return self._by_group.get((variant, kind), [])

    @cached_property
    def _by_group(self) -> Mapping[tuple[str, str | None], Sequence[Record]]:
        """Large runs are asked for the same records many times."""
        found: dict[tuple[str, str | None], list[Record]] = {}
        for record in self.records:
            for kind in (record["garment"], None):
                found.setdefault((record["variant"], kind), []).append(record)
        return found

    def groups(self) -> list[tuple[str, str | None]]:
        """Headings and garment kinds to break figures down by: each kind, then all if there are several."""
        kinds = self.results.kinds()
        found: list[tuple[str, str | None]] = [(kind, kind) for kind in kinds]
        return found if len(kinds) == 1 else [*found, ("all", None)]


def open_source(folder: str | Path) -> Source:
    """Read a run directory. Raises ConfigError if there is none."""
    folder = Path(folder)
    results = open_results(folder)
    description: dict[str, Any] = json.loads((folder / "run.json").read_text("utf-8"))
    return Source(folder, results, description.get("versions", {}), _expected(results.study))


def _expected(study: Study) -> int | None:
    """The report of a run from elsewhere must not need the plugins that made it."""
    try:
        return sum(1 for _ in cells(study))
    except PolyfoldError:
        return None
