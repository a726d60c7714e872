"""Tables as text in every form."""

import csv
import math

from polyfold.analysis import Estimate, Table
from polyfold.analysis._tables import Figure

TABLE = Table(
    ["variant", "kind", "n", "success %"],
    [["a_b & c", "square", "3", "97.3"], ["a_b & c", "all", "3", "97.3"], ["far", "all", "3", "9.0"]],
    "All of 3.",
)


def test_latex_is_for_booktabs_and_says_what_rows_share_once():
    text = TABLE.latex()
    assert text.startswith("% \\usepackage{booktabs, multirow}\n\\begin{tabular}{llrr}\n\\toprule\n")
    assert text.count("\\multirow{2}{*}{a\\_b \\& c} & square") == 1
    assert "\n & all & 3 & 97.3 \\\\\n" in text
    assert "\nfar & all & 3 & 9.0 \\\\\n\\bottomrule\n" in text
    rows = [line for line in text.splitlines() if line.endswith("\\\\")]
    assert all(row.replace("\\&", "").count("&") == 3 for row in rows)


def test_csv_has_every_cell_in_every_row():
    assert list(csv.reader(TABLE.csv().splitlines())) == [TABLE.headers, *TABLE.rows]


def test_csv_has_figures_as_numbers():
    some = Figure(Estimate(97.25, 90.125, math.inf, 3), note="(n = 3)", certain=True)
    table = Table(["variant", "success %"], [["ours", some], ["theirs", "–"]])
    assert table.csv().splitlines() == [
        "variant,success %,success % low,success % high",
        "ours,97.25,90.125,",
        "theirs,,,",
    ]


def test_markdown_keeps_bars_within_cells():
    assert "| a\\|b | x |" in Table(["one", "two"], [["a|b", "x"]]).markdown()
