"""A line of the table, and what a test is asked."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from polyfold.garments import Fabric


@dataclass(frozen=True)
class Row:
    """One figure.

    Attributes:
        test, fabric, quantity: what was measured.
        published: figure or range, with its source.
        ours: the same in the simulator.
        n: what it is the mean of.
    """

    test: str
    fabric: str
    quantity: str
    published: str
    ours: str
    n: str


Test = Callable[[Fabric, float], Iterator[Row]]
"""A test takes a fabric and an edge length [m] and gives its rows, one by one."""


def millimetres(metres: float, digits: int = 1) -> str:
    """A length [m] as it stands in the table."""
    return f"{1000 * metres:.{digits}f} mm"


def percent(share: float, digits: int = 1) -> str:
    """A share as it stands in the table."""
    return f"{100 * share:.{digits}f} %"
