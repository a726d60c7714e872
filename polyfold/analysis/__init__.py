"""What studies found, read from their logs: tables, paired differences, language models side by side."""

from polyfold.analysis._columns import shared
from polyfold.analysis._differences import difference, holm, share_difference
from polyfold.analysis._intervals import Estimate, mean, ratio, share, wilson
from polyfold.analysis._providers import provider_table
from polyfold.analysis._results import Results, open_results
from polyfold.analysis._tables import Table, shown
from polyfold.analysis._tabulation import compare, table

__all__ = [
    "Estimate",
    "Results",
    "Table",
    "compare",
    "difference",
    "holm",
    "mean",
    "open_results",
    "provider_table",
    "ratio",
    "share",
    "share_difference",
    "shared",
    "shown",
    "table",
    "wilson",
]
