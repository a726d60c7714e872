"""Tables for reading on the page: figures aligned, intervals quieter than means, repeated labels left out."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence

from markupsafe import Markup

from polyfold.analysis import Results, Table, compare
from polyfold.analysis._tables import CERTAIN, Cell


def comparison_html(results: Results, first: str, others: Sequence[str], columns: Sequence[str]) -> Markup:
    """Paired differences of the other variants to the first, in one table."""
    tables = [(variant, compare(results, variant, first, columns)) for variant in others]
    cells: list[list[Cell]] = [[variant, *row] for variant, made in tables for row in made.cells]
    return table_html(Table(["variant", *tables[0][1].headers], cells), 2, differences=True)


def download(table: Table, name: str) -> Markup:
    """A link that saves a table's numbers as ``name``.csv; they are in the page itself."""
    content = b64encode(f"{table.csv()}\n".encode()).decode()
    return Markup(
        '<a class="data" download="{name}.csv" href="data:text/csv;charset=utf-8;base64,{}">{name}.csv</a>'
    ).format(content, name=name)


def table_html(table: Table, columns_of_text: int, differences: bool = False) -> Markup:
    """A table whose intervals are quieter than its means, with repeated labels dimmed.

    Args:
        table: what to show; its note becomes the caption below.
        columns_of_text: leading columns that are labels; the others are figures.
        differences: dim figures that are not certain.
    """
    head = Markup("").join(_header(name, index < columns_of_text) for index, name in enumerate(table.headers))
    body, before = [], None
    for row in table.cells:
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


def _label(cell: Cell, index: int, fresh: bool) -> Markup:
    dimmed = index == 0 and not fresh
    return Markup('<td class="label{}" title="{}">{}</td>').format(" again" if dimmed else "", cell, cell)


def _value(cell: Cell, difference: bool) -> Markup:
    if isinstance(cell, str) or not cell.is_known:
        return Markup("<td>{}</td>").format(cell)
    unsure = difference and not cell.certain
    low, high = cell.ends
    interval = Markup(' <span class="interval">[{}, {}]</span>').format(_signed(low), _signed(high))
    return Markup("<td{}>{}{}{}{}</td>").format(
        Markup(' class="unsure"') if unsure else "",
        _signed(cell.mean),
        interval if cell.has_interval else "",
        CERTAIN if cell.certain else "",
        f" {cell.note}" if cell.note else "",
    )


def _signed(figure: str) -> str:
    return figure.replace("-", "−")
