"""The goals of the suite ambiguous: about all kinds, in their own words, and none that an untouched garment reaches."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from laid_flat import SUITE

from polyfold.evaluation import known_tasks, suite
from polyfold.evaluation._suites import accepted_tasks
from polyfold.tasks import OpenTask
from polyfold.tasks._goals import measure

GOALS = suite("ambiguous").goals
goals = pytest.mark.parametrize("goal", GOALS, ids=lambda goal: goal.id)


def test_at_least_thirty_goals_on_all_four_kinds() -> None:
    assert len(GOALS) >= 30
    assert str(len(GOALS)) in suite("ambiguous").description
    assert min(Counter(goal.garment for goal in GOALS).values()) >= 7
    assert {goal.garment for goal in GOALS} == {"square", "rectangle", "tshirt", "pants"}


def test_sentences_are_unique_and_are_no_task_s_instructions() -> None:
    sentences = {goal.text.lower() for goal in GOALS}
    assert len(sentences) == len(GOALS)
    assert not sentences & {sentence.lower() for task in SUITE.tasks for sentence in task.instructions}


@goals
def test_accepted_tasks_are_those_named_and_for_the_goals_garment(goal: OpenTask) -> None:
    accepted = accepted_tasks("ambiguous", goal)
    assert [task.id for task in accepted] == list(goal.accept)
    assert {task.garment for task in accepted} <= {goal.garment}


def test_goals_are_no_tasks_that_a_plan_can_be_recognised_as() -> None:
    assert {task.id for task in known_tasks("square")} == {task.id for task in SUITE.for_garment("square")}


@goals
def test_bounds_leave_room_and_exclude_the_flat_garment(goal: OpenTask) -> None:
    if goal.done is None:
        return
    assert goal.done.area_max is not None
    assert goal.done.area_max <= 0.93
    assert (goal.done.area_min or 0.0) <= goal.done.area_max - 0.08
    flat = np.zeros((60, 60), bool)
    flat[10:50, 20:40] = True
    assert "area_max" in goal.done.failing(measure(flat, flat, 0))
