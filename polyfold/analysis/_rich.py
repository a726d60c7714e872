"""Tables in notebooks: figures stay on one line, and a click on a heading sorts by it."""

from __future__ import annotations

from html import escape

from polyfold.analysis._tables import Figure, Table
from polyfold.types._views import makes

_SORT = (
    "const h=this,t=h.closest('table'),b=t.tBodies[0],i=h.cellIndex,d=h.dataset.up==='1'?-1:1;"
    "h.dataset.up=d===1?'1':'0';"
    "const v=r=>{const c=r.cells[i],n=c.dataset.value;return n===undefined?c.textContent:Number(n)};"
    "[...b.rows].sort((x,y)=>{const p=v(x),q=v(y);return d*(p>q?1:p<q?-1:0)}).forEach(r=>b.append(r))"
)
"""What a heading does when it is clicked: rows by its column, up, then down."""

_CELL = "white-space:nowrap;padding:2px 8px;text-align:"


@makes(Table, "rich")
def rich(table: Table) -> str:
    """The table with what it does under a mouse; without scripts it is the table as it stands."""
    figures = [any(isinstance(row[place], Figure) for row in table.cells) for place in range(len(table.headers))]
    sides = ["right" if figure else "left" for figure in figures]
    head = "".join(
        f'<th style="{_CELL}{side};cursor:pointer" title="sort" onclick="{escape(_SORT)}">{escape(header)}</th>'
        for header, side in zip(table.headers, sides, strict=True)
    )
    body = "".join(
        "<tr>" + "".join(_cell(cell, side) for cell, side in zip(row, sides, strict=True)) + "</tr>"
        for row in table.cells
    )
    note = f'<p style="max-width:60em;font-size:90%">{escape(table.note)}</p>' if table.note else ""
    return (
        f'<div style="overflow-x:auto"><table style="border-collapse:collapse"><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>{note}"
    )


def _cell(cell: str | Figure, side: str) -> str:
    value = f' data-value="{cell.value.mean}"' if isinstance(cell, Figure) and cell.is_known else ""
    value = f' data-value="{cell}"' if isinstance(cell, str) and cell.isdigit() else value
    return f'<td style="{_CELL}{side}"{value}>{_stacked(cell)}</td>'


def _stacked(cell: str | Figure) -> str:
    """A figure over its interval, so that a table of many columns fits a notebook."""
    if isinstance(cell, str) or not cell.has_interval:
        return escape(str(cell))
    mean, _, rest = str(cell).partition(" ")
    return f'{escape(mean)}<br><span style="font-size:80%;opacity:0.75">{escape(rest)}</span>'
