"""The goals of the suite ambiguous: well formed, about known tasks, and none that an untouched garment reaches."""

from __future__ import annotations

import tomllib
from collections import Counter
from importlib.resources import files

import pytest

from polyfold.tasks import load_suite

BOUNDS = {
    "area_min",
    "area_max",
    "rectangular_min",
    "triangular_min",
    "length_max",
    "steps_min",
    "steps_max",
}


@pytest.fixture(scope="module")
def goals() -> list[dict]:
    content = tomllib.loads(files("polyfold_standard").joinpath("tasks/ambiguous.toml").read_text("utf-8"))
    assert content["schema_version"] == 1
    assert content["name"] == "ambiguous"
    assert str(len(content["goal"])) in content["description"]
    return content["goal"]


def test_at_least_thirty_goals_on_all_four_kinds(goals: list[dict]) -> None:
    assert len(goals) >= 30
    assert min(Counter(goal["garment"] for goal in goals).values()) >= 7
    assert {goal["garment"] for goal in goals} == {"square", "rectangle", "tshirt", "pants"}


def test_ids_and_sentences_are_unique(goals: list[dict]) -> None:
    assert len({goal["id"] for goal in goals}) == len({goal["text"].lower() for goal in goals}) == len(goals)


def test_goals_say_what_counts_as_done(goals: list[dict]) -> None:
    for goal in goals:
        assert goal.keys() <= {"id", "garment", "text", "accept", "done"}, goal["id"]
        assert goal.get("accept") or goal.get("done"), goal["id"]
        assert goal.get("done", {}).keys() <= BOUNDS, goal["id"]


def test_accepted_tasks_exist_and_are_of_the_goals_garment(goals: list[dict]) -> None:
    suite = load_suite("polyfold_standard:tasks/polyfold70.toml")
    for goal in goals:
        accepted = goal.get("accept", [])
        assert len(set(accepted)) == len(accepted), goal["id"]
        assert all(suite.task(task_id).garment == goal["garment"] for task_id in accepted), goal["id"]


def test_bounds_leave_room_and_exclude_the_flat_garment(goals: list[dict]) -> None:
    for goal in goals:
        if done := goal.get("done"):
            assert done["area_max"] <= 0.93, goal["id"]
            assert done.get("area_min", 0.0) <= done["area_max"] - 0.08, goal["id"]
            assert done.get("steps_min", 0) <= done.get("steps_max", 99), goal["id"]


def test_goals_do_not_name_the_folds_of_a_task(goals: list[dict]) -> None:
    instructions = {
        sentence.lower()
        for task in load_suite("polyfold_standard:tasks/polyfold70.toml").tasks
        for sentence in task.instructions
    }
    assert not instructions & {goal["text"].lower() for goal in goals}
