"""What studies found, read from their logs: tables, paired differences, language models side by side."""

from polyfold.analysis._columns import Column, column_of, columns_of
from polyfold.analysis._providers import provider_table
from polyfold.analysis._results import Results, open_results
from polyfold.analysis._statistics import Estimate, estimate, paired, ratio
from polyfold.analysis._tables import Figure, Table, shown
from polyfold.analysis._tabulation import compare, noise_floor, table

__all__ = [
    "Column",
    "Estimate",
    "Figure",
    "Results",
    "Table",
    "column_of",
    "columns_of",
    "compare",
    "estimate",
    "noise_floor",
    "open_results",
    "paired",
    "provider_table",
    "ratio",
    "shown",
    "table",
]
