"""Studies that cross settings: a table with a factor along each side, and what each setting does by itself."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from polyfold.analysis._columns import Column, column_of, shared
from polyfold.analysis._differences import difference, holm
from polyfold.analysis._intervals import Estimate
from polyfold.analysis._notes import about, interval, remarks
from polyfold.analysis._results import Results
from polyfold.analysis._tables import CERTAIN, Cell, Figure, Table
from polyfold.errors import ConfigError, did_you_mean
from polyfold.logs import StudyEpisodeRecord
from polyfold.types._views import makes

Levels = Mapping[str, tuple[str, ...]]
Combination = tuple[str, ...]
"""One level of each factor, in the factors' order."""

Values = Mapping[Any, float | None]
"""A figure of each episode, by what tells episodes of one variant apart."""


@makes(Results, "pivot")
def pivot(results: Results, rows: str, columns: str, figure: str) -> Table:
    """Levels of one factor down, of another across; see :meth:`polyfold.analysis.Results.pivot`."""
    levels = _levels(results)
    for name in (rows, columns):
        if name not in levels:
            raise ConfigError(f"{results.study.name} varies no {name!r}; {did_you_mean(name, levels)}")
    if rows == columns:
        raise ConfigError(f"{rows!r} can't be both down and across; name two of {', '.join(levels)}")
    column = column_of(results.run, figure)
    cells: list[list[Cell]] = []
    for down in levels[rows]:
        found = [_of(results, {rows: down, columns: across}) for across in levels[columns]]
        cells.append([down, *(Figure(column.over(one), column.digits) if one else "–" for one in found)])
    counts = {len(_of(results, {rows: down, columns: across})) for down in levels[rows] for across in levels[columns]}
    n = f"n = {counts.pop()} a cell" if len(counts) == 1 else f"n = {min(counts)} to {max(counts)} a cell"
    headers = [f"{rows} \\ {columns}", *levels[columns]]
    return Table(headers, cells, f"{column.heading}; {n}. {about(results)}")


@makes(Results, "effects")
def effects(results: Results, figure: str) -> Table:
    """What each level does, and each pair of levels; see :meth:`polyfold.analysis.Results.effects`."""
    levels = _levels(results)
    column = column_of(results.run, figure)
    values = _values(results, levels, column)
    keys = [key for key in next(iter(values.values())) if all(key in mine for mine in values.values())]
    records = {_key(record): record for record in results.records}
    clusters = shared([records[key] for key in keys])

    def estimate(signs: Mapping[Combination, int], times: int) -> Estimate:
        """Mean over episodes of what the variants of one sign have more than those of the other."""
        sides = [[values[one] for one, sign in signs.items() if sign == side] for side in (1, -1)]
        ours, theirs = ([_mean_of(side, key, times) for key in keys] for side in sides)
        found = difference(ours, theirs, *clusters)
        # Episodes that do not differ at all say nothing of how others would.
        return replace(found, low=-math.inf, high=math.inf) if found.low == found.high else found

    found = [(what, estimate(signs, 1)) for what, signs in _main(levels, values)]
    found += [(what, estimate(signs, 2)) for what, signs in _interactions(levels, values)]
    adjusted = holm([one.p for _, one in found])
    cells: list[list[Cell]] = [
        [what, Figure(one, column.digits, signed=True, certain=p is not None and p < 0.05)]
        for (what, one), p in zip(found, adjusted, strict=True)
    ]
    note = (
        f"{column.heading}, differences over the same {len(keys)} episodes; mean [{interval(results)}]. A line with × "
        f"is how much more the first does where the second is so. {CERTAIN}: not 0, p < 0.05 by sign flips of "
        f"sentences or garments, after Holm over the lines.{remarks(results)}"
    )
    return Table(["effect", column.heading], cells, note)


def _levels(results: Results) -> Levels:
    """Each factor with its levels, in the study's order."""
    study = results.study
    if not study.factors or set(study.factors) != set(study.variants):
        raise ConfigError(f"{study.name} crosses no settings; make the study with polyfold.grid")
    names = dict.fromkeys(name for found in study.factors.values() for name in found)
    levels = {name: tuple(dict.fromkeys(found[name] for found in study.factors.values())) for name in names}
    return {name: found for name, found in levels.items() if len(found) > 1}


def _of(results: Results, chosen: Mapping[str, str]) -> list[StudyEpisodeRecord]:
    """Records of the variants with these levels."""
    factors = results.study.factors
    variants = [name for name in results.study.variants if chosen.items() <= factors[name].items()]
    return [record for name in variants for record in results.of(name)]


def _key(record: StudyEpisodeRecord) -> Any:
    return record.task, record.garment.seed, record.wording


def _values(results: Results, levels: Levels, column: Column) -> dict[Combination, Values]:
    """The figures of each combination of levels; raises ConfigError where one has none."""
    values: dict[Combination, dict[Any, float | None]] = {}
    for variant, factors in results.study.factors.items():
        mine = values.setdefault(tuple(factors[name] for name in levels), {})
        mine |= {_key(record): column.value(record) for record in results.of(variant)}
    wanted = int(np.prod([len(found) for found in levels.values()]))
    if len(values) != wanted or not all(values.values()):
        raise ConfigError(f"{results.study.name} does not hold every combination of {', '.join(levels)} yet; run it on")
    return dict(values)


def _mean_of(side: Sequence[Values], key: Any, times: int) -> float | None:
    found = [values[key] for values in side]
    known = [value for value in found if value is not None]
    return times * float(np.mean(known)) if len(known) == len(found) else None


def _main(levels: Levels, values: Mapping[Combination, Values]) -> list[tuple[str, dict[Combination, int]]]:
    """Each level against the first of its factor, over all levels of the others."""
    told = []
    for place, (name, found) in enumerate(levels.items()):
        for level in found[1:]:
            sign = _sign(place, level, found[0])
            told.append((f"{name}: {level} − {found[0]}", {one: sign(one) for one in values}))
    return told


def _interactions(levels: Levels, values: Mapping[Combination, Values]) -> list[tuple[str, dict[Combination, int]]]:
    """Each pair of levels of two factors: what both do together beyond what each does."""
    told = []
    for (first, (one, mine)), (second, (other, theirs)) in combinations(enumerate(levels.items()), 2):
        for level in mine[1:]:
            for another in theirs[1:]:
                a, b = _sign(first, level, mine[0]), _sign(second, another, theirs[0])
                label = f"{one}: {level} − {mine[0]} × {other}: {another} − {theirs[0]}"
                told.append((label, {each: a(each) * b(each) for each in values}))
    return told


def _sign(place: int, level: str, base: str) -> Callable[[Combination], int]:
    return lambda combination: {level: 1, base: -1}.get(combination[place], 0)
