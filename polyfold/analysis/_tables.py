"""Tables that print as markdown, HTML, LaTeX and CSV, and show themselves in Jupyter."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from polyfold.analysis._statistics import Estimate

FORMATS = ("markdown", "html", "latex", "csv")


@dataclass(frozen=True)
class Table:
    """A table of text.

    Attributes:
        headers: column names.
        rows: cells, each row as long as the headers.
        note: what stands below: what the figures are, and on how many episodes.
    """

    headers: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""

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
        """A booktabs tabular."""
        lines = [f"\\begin{{tabular}}{{ll{'r' * (len(self.headers) - 2)}}}", "\\toprule"]
        lines += [_latex_row(self.headers), "\\midrule", *map(_latex_row, self.rows), "\\bottomrule", "\\end{tabular}"]
        return "\n".join([*lines, f"% {self.note}"] if self.note else lines)

    def csv(self) -> str:
        """Comma-separated values with a header line."""
        out = io.StringIO()
        csv.writer(out, lineterminator="\n").writerows([self.headers, *self.rows])
        return out.getvalue().rstrip("\n")

    def _repr_html_(self) -> str:
        return self.html()

    def __str__(self) -> str:
        return self.markdown()


def _latex_row(cells: Sequence[str]) -> str:
    special = {"\\": r"\textbackslash{}", "%": r"\%", "&": r"\&", "_": r"\_", "#": r"\#", "$": r"\$", "−": "$-$"}
    return " & ".join("".join(special.get(letter, letter) for letter in cell) for cell in cells) + r" \\"


def shown(value: Estimate, digits: int = 1, signed: bool = False) -> str:
    """An estimate as text: ``94.0 [92.1, 95.6]``; a dash if there was nothing to measure."""
    if math.isnan(value.mean):
        return "–"
    sign = "+" if signed else ""
    return f"{value.mean:{sign}.{digits}f} [{value.low:.{digits}f}, {value.high:.{digits}f}]"
