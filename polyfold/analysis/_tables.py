"""Tables that print as markdown, HTML, LaTeX and CSV, and show themselves in Jupyter."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby
from operator import itemgetter

from polyfold.analysis._intervals import Estimate
from polyfold.types._views import view_of

CERTAIN = "†"
"""Mark of a difference that is certain."""

FORMATS = ("markdown", "html", "latex", "csv")


@dataclass(frozen=True)
class Figure:
    """A cell with a figure: an estimate and how to write it.

    Attributes:
        value: mean and interval; a dash is written where there was nothing to measure.
        digits: after the point.
        signed: whether to write a plus, for differences.
        note: what follows, such as on how many episodes it rests.
        certain: whether a difference remains when all of its table's are looked at.
    """

    value: Estimate
    digits: int = 1
    signed: bool = False
    note: str = ""
    certain: bool = False

    @property
    def is_known(self) -> bool:
        """Whether there was anything to measure."""
        return not math.isnan(self.value.mean)

    @property
    def has_interval(self) -> bool:
        """Whether there is an interval: a single episode says nothing of others."""
        return math.isfinite(self.value.high - self.value.low)

    @property
    def mean(self) -> str:
        """The mean as text; a dash if there was nothing to measure."""
        return f"{self.value.mean:{'+' if self.signed else ''}.{self.digits}f}" if self.is_known else "–"

    @property
    def ends(self) -> tuple[str, str]:
        """The ends of the interval as text."""
        return f"{self.value.low:.{self.digits}f}", f"{self.value.high:.{self.digits}f}"

    def __str__(self) -> str:
        interval = f" [{self.ends[0]}, {self.ends[1]}]" if self.has_interval else ""
        return f"{self.mean}{interval}{CERTAIN if self.certain else ''}" + (f" {self.note}" if self.note else "")


Cell = str | Figure


@dataclass(frozen=True, repr=False)
class Table:
    """A table of text and figures.

    Attributes:
        headers: column names.
        cells: each row as long as the headers.
        note: what stands below: what the figures are, and on how many episodes.
    """

    headers: Sequence[str]
    cells: Sequence[Sequence[Cell]]
    note: str = ""

    @property
    def rows(self) -> list[list[str]]:
        """The cells as text."""
        return [[str(cell) for cell in row] for row in self.cells]

    def markdown(self) -> str:
        """A GitHub table."""
        lines = ["| " + " | ".join(self.headers) + " |", "|" + "---|" * len(self.headers)]
        lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in self.rows]
        return "\n".join([*lines, "", self.note]) if self.note else "\n".join(lines)

    def html(self) -> str:
        """An HTML table without styles of its own."""
        head = "".join(f"<th>{escape(header)}</th>" for header in self.headers)
        body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in self.rows)
        caption = f"<caption>{escape(self.note)}</caption>" if self.note else ""
        return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

    def latex(self) -> str:
        """A tabular for booktabs and multirow: what rows below each other share stands in the first column once."""
        lines = ["% \\usepackage{booktabs, multirow}", f"\\begin{{tabular}}{{ll{'r' * (len(self.headers) - 2)}}}"]
        lines += ["\\toprule", _latex_row(self.headers), "\\midrule"]
        for number, (_, rows) in enumerate(groupby(self.rows, itemgetter(0))):
            shared = list(rows)
            lines += ["\\midrule"] if number and len(shared) > 1 else []
            lines += [_latex_row(row, 0 if place else len(shared)) for place, row in enumerate(shared)]
        lines += ["\\bottomrule", "\\end{tabular}"]
        return "\n".join([*lines, f"% {self.note}"] if self.note else lines)

    def csv(self) -> str:
        """Comma-separated values with a header line: of figures, mean and both ends of the interval as numbers.

        Their columns are called ``name``, ``name low`` and ``name high``; what is not known is left empty.
        """
        out = io.StringIO()
        columns = [_numbers(header, column) for header, column in zip(self.headers, self._columns(), strict=True)]
        csv.writer(out, lineterminator="\n").writerows(
            [name for column in columns for name in column[row]] for row in range(1 + len(self.cells))
        )
        return out.getvalue().rstrip("\n")

    def _columns(self) -> list[list[Cell]]:
        return [[row[place] for row in self.cells] for place in range(len(self.headers))]

    def _repr_html_(self) -> str:
        return view_of(self, "rich")

    def __repr__(self) -> str:
        return self.markdown()


def _numbers(header: str, column: Sequence[Cell]) -> list[list[str]]:
    """A column for machines, header first, each row in as many parts as it takes."""
    if not any(isinstance(cell, Figure) for cell in column):
        return [[header], *([str(cell)] for cell in column)]
    return [[header, f"{header} low", f"{header} high"], *map(_parts, column)]


def _parts(cell: Cell) -> list[str]:
    if isinstance(cell, str):
        return ["" if cell == "–" else cell, "", ""]
    value = cell.value
    return [f"{number:.6g}" if math.isfinite(number) else "" for number in (value.mean, value.low, value.high)]


def _latex_row(cells: Sequence[str], rows: int = 1) -> str:
    """A row whose first cell stands for so many rows; 0 if it stands in one above."""
    first, *others = map(_latex, cells)
    if rows != 1:
        first = f"\\multirow{{{rows}}}{{*}}{{{first}}}" if rows else ""
    return " & ".join([first, *others]) + r" \\"


def _latex(text: str) -> str:
    special = {"\\": r"\textbackslash{}", "%": r"\%", "&": r"\&", "_": r"\_", "#": r"\#", "$": r"\$", "−": "$-$"}
    return "".join(special.get(letter, letter) for letter in text)


def shown(value: Estimate, digits: int = 1, signed: bool = False) -> str:
    """An estimate as text: ``94.0 [92.1, 95.6]``; a dash if there was nothing to measure."""
    return str(Figure(value, digits, signed))
