"""What studies found, read from their logs: tables, paired differences, language models side by side."""

from polyfold.analysis._providers import provider_table
from polyfold.analysis._results import Results, compare, noise_floor, open_results, table
from polyfold.analysis._statistics import Estimate, estimate, paired, ratio
from polyfold.analysis._tables import Table, shown

__all__ = [
    "Estimate",
    "Results",
    "Table",
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
