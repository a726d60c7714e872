"""How well an episode went: against the ideal, against a reference, and why it failed."""

from polyfold.evaluation._judging import judge
from polyfold.evaluation._suites import known_tasks, suite

__all__ = [
    "judge",
    "known_tasks",
    "suite",
]
