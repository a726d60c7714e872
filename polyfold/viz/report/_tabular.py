"""Tables for reading on the page: figures aligned, intervals quieter than means, repeated labels left out."""

from __future__ import annotations

import re
from collections.abc import Sequence

from markupsafe import Markup

from polyfold.analysis import Results, Table, compare
from polyfold.analysis._results import COLUMNS

_FIGURE = re.compile(r"(?P<mean>\S+) \[(?P<low>[-+.\d]+), (?P<high>[-+.\d]+)\]")
"""A cell as :func:`polyfold.tables.shown` writes it."""


def comparison_html(results: Results, first: str, others: Sequence[str]) -> Markup:
    """Paired differences of the other variants to the first, in one table."""
    tables = [(variant, success_first(compare(results, variant, first))) for variant in others]
    rows = [[variant, *row] for variant, made in tables for row in made.rows]
    return table_html(Table(["variant", *tables[0][1].headers], rows), 2, differences=True)


def success_first(table: Table) -> Table:
    """The table with shares of success before the errors, so that a narrow window shows what matters most."""
    order = sorted(range(len(table.headers)), key=lambda index: _rank(table.headers[index]))
    return Table(
        [table.headers[index] for index in order], [[row[index] for index in order] for row in table.rows], table.note
    )


def _rank(header: str) -> int:
    if header.endswith("%"):
        return 1
    return 2 if header in COLUMNS else 0


def table_html(table: Table, columns_of_text: int, differences: bool = False) -> Markup:
    """A table whose intervals are quieter than its means, with repeated labels dimmed.

    Args:
        table: what to show; its note becomes the caption below.
        columns_of_text: leading columns that are labels; the others are figures.
        differences: dim figures whose interval includes zero.
    """
    head = Markup("").join(_header(name, index < columns_of_text) for index, name in enumerate(table.headers))
    body, before = [], None
    for row in table.rows:
        fresh = before is None or row[0] != before[0]
        cells = Markup("").join(
            _label(cell, index, fresh) if index < columns_of_text else _value(cell, differences)
            for index, cell in enumerate(row)
        )
        total = " total" if "all" in row[1:columns_of_text] else ""
        body.append(Markup('<tr class="{}{}">{}</tr>').format("block" if fresh else "", total, cells))
        before = row
    note = Markup('<p class="note">{}</p>').format(table.note) if table.note else ""
    return Markup(
        '<div class="scroll" tabindex="0"><table><thead><tr>{}</tr></thead><tbody>{}</tbody></table></div>{}'
    ).format(head, Markup("").join(body), note)


def _header(name: str, label: bool) -> Markup:
    text, bracket, unit = name.partition(" [")
    unit_html = Markup(' <span class="unit">{}</span>').format(unit.rstrip("]")) if bracket else ""
    return Markup('<th scope="col"{}>{}{}</th>').format(Markup(' class="label"') if label else "", text, unit_html)


def _label(cell: str, index: int, fresh: bool) -> Markup:
    dimmed = index == 0 and not fresh
    return Markup('<td class="label{}" title="{}">{}</td>').format(" again" if dimmed else "", cell, cell)


def _value(cell: str, difference: bool) -> Markup:
    found = _FIGURE.fullmatch(cell)
    if found is None:
        return Markup("<td>{}</td>").format(cell)
    unsure = difference and float(found["low"]) <= 0.0 <= float(found["high"])
    return Markup('<td{}>{} <span class="interval">[{}, {}]</span></td>').format(
        Markup(' class="unsure"') if unsure else "", *(_signed(found[part]) for part in ("mean", "low", "high"))
    )


def _signed(figure: str) -> str:
    return figure.replace("-", "−")
