"""The goals that a reader may learn from: well formed, about known tasks, and none from the suites."""

from __future__ import annotations

import tomllib
from collections import Counter
from importlib.resources import files
from pathlib import Path

import pytest

from experiments.benchmarks.language.wishes import outcome
from polyfold.plugins import create
from polyfold.tasks import OpenTask, load_suite

BOUNDS = {"area_min", "area_max", "rectangular_min", "triangular_min", "length_max", "steps_min", "steps_max"}
CONTENT = tomllib.loads((Path(__file__).parent / "goals.toml").read_text("utf-8"))
GOALS = CONTENT["goal"]


@pytest.fixture(scope="module")
def suite():
    return load_suite("polyfold_standard:tasks/polyfold70.toml")


def test_all_kinds_are_covered_and_counted():
    assert min(Counter(goal["garment"] for goal in GOALS).values()) >= 20
    assert {goal["garment"] for goal in GOALS} == {"square", "rectangle", "tshirt", "pants"}
    assert CONTENT["description"].startswith(f"{len(GOALS)} goals")


def test_ids_and_sentences_are_unique():
    assert len({goal["id"] for goal in GOALS}) == len(GOALS)
    assert len({(goal["garment"], goal["text"].lower()) for goal in GOALS}) == len(GOALS)


@pytest.mark.parametrize("goal", GOALS, ids=lambda goal: goal["id"])
def test_a_goal_says_what_counts_as_done(goal, suite):
    assert goal.keys() <= {"id", "garment", "text", "accept", "done"}
    accepted, done = goal.get("accept", []), goal.get("done", {})
    assert accepted or done
    assert len(set(accepted)) == len(accepted)
    assert all(suite.task(task_id).garment == goal["garment"] for task_id in accepted)
    assert done.keys() <= BOUNDS
    if done:
        assert done.get("area_min", 0.0) + 0.08 <= done["area_max"] <= 0.93
        assert done.get("steps_min", 0) <= done.get("steps_max", 99)


def test_no_sentence_is_one_that_the_reader_is_measured_on(suite):
    ambiguous = tomllib.loads(files("polyfold_standard").joinpath("tasks/ambiguous.toml").read_text("utf-8"))
    measured = {goal["text"].lower() for goal in ambiguous["goal"]}
    measured |= {sentence.lower() for task in suite.tasks for sentence in task.instructions}
    assert not measured & {goal["text"].lower() for goal in GOALS}


def test_most_goals_are_reached_and_few_are_missed(suite):
    """Of a third of them; the shipped weights have learned from these goals, and of all 300 they reach 278."""
    planner, llm = create("planners", "hierarchical"), create("llms", "offline")
    found = Counter(outcome(OpenTask(**goal), suite, planner, llm)[0] for goal in GOALS[::3])
    assert found["reached"] >= 0.85 * found.total()
    assert found["missed"] <= 0.04 * found.total()
