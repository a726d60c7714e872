"""What studies found, read from their logs: tables, paired differences, language models side by side."""

from polyfold.analysis import _factors as _factors
from polyfold.analysis import _rich as _rich
from polyfold.analysis._intervals import Estimate, mean, share
from polyfold.analysis._providers import provider_table
from polyfold.analysis._results import Results
from polyfold.analysis._tables import Table, shown
from polyfold.analysis._tabulation import compare, table

__all__ = [
    "Estimate",
    "Results",
    "Table",
    "compare",
    "mean",
    "provider_table",
    "share",
    "shown",
    "table",
]
