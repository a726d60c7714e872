"""How well an episode went: against the ideal, against a reference, and why it failed."""

from polyfold.evaluation._attribution import CAUSES, attribute, attribute_open
from polyfold.evaluation._criteria import criteria, needed_scale, succeeded
from polyfold.evaluation._judging import final_mask, first_mask, judge
from polyfold.evaluation._references import Reference, ideal_reference, reference_for
from polyfold.evaluation._scoring import Comparison, compare_end
from polyfold.evaluation._suites import accepted_tasks, find_task, known_tasks, suite

__all__ = [
    "CAUSES",
    "Comparison",
    "Reference",
    "accepted_tasks",
    "attribute",
    "attribute_open",
    "compare_end",
    "criteria",
    "final_mask",
    "find_task",
    "first_mask",
    "ideal_reference",
    "judge",
    "known_tasks",
    "needed_scale",
    "reference_for",
    "succeeded",
    "suite",
]
