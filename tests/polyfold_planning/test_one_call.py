"""The planner ``plan``: every line in one call, and another call only where the cloth lies otherwise."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from experiments.benchmarks.language.understanding import folded_states, laid_garment
from polyfold.errors import ConfigError, PlanError
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins import create, find
from polyfold.rollout._transcript import Transcript
from polyfold.tasks import fold_lines, load_suite
from polyfold.types import Reply, Scene, Subgoal

SUITE = load_suite(str(find("tasks", "polyfold70").target))
SEED = 2005


class Watched:
    """A language model that counts its calls."""

    def __init__(self, model):
        self.model, self.messages = model, []

    def complete(self, messages, params):
        self.messages.append(messages)
        return self.model.complete(messages, params)


class Scripted:
    def __init__(self, *answers):
        self.answers = list(answers)

    def complete(self, messages, params):
        return Reply(f"So:\n```json\n{json.dumps(self.answers.pop(0))}\n```")


def shown(model, size) -> Scene:
    mask = fill_polygon(model.outline(), size[1], size[0])
    return Scene(model.kind, size, mask, model.outline(), model, model.to_text(size))


def carried_out(planner, instruction, laid, llm, disturb=None):
    """The lines planned until nothing is left, each folded ideally; ``disturb`` moves the model after the first."""
    conversation, model, lines = Transcript(llm), laid.model, []
    (subgoal,) = planner.subgoals(instruction, None, conversation)
    while (line := planner.plan(subgoal, shown(model, laid.size), conversation)) is not None:
        lines.append(line)
        model = model.fold(line)
        if disturb is not None and len(lines) == 1:
            model = disturb(model)
    return lines


@pytest.mark.parametrize("name", ["square-corners-all", "tshirt-block-right-first", "pants-block-left-thirds"])
def test_one_call_plans_all_folds(name):
    task = SUITE.task(name)
    laid, llm = laid_garment(task.garment, SEED), Watched(create("llms", "offline"))
    lines = carried_out(create("planners", "plan"), task.instructions[0], laid, llm)
    assert len(llm.messages) == 1
    wanted = fold_lines(task, dict(zip(laid.model.names, laid.model.rest, strict=True)))
    ours, theirs = folded_states(laid.particles, lines)[-1], folded_states(laid.particles, wanted)[-1]
    moved = (theirs != laid.particles).any(1)
    assert np.hypot(*(ours - theirs)[moved].T).mean() < 0.05 * np.ptp(laid.particles, axis=0).max()


def test_cloth_that_lies_elsewhere_is_planned_anew_with_what_was_done():
    task = SUITE.task("square-corners-all")
    laid, llm = laid_garment("square", SEED), Watched(create("llms", "offline"))

    def moved(model):
        return model.transformed(0.2, (18.0, -9.0), (200.0, 200.0))

    lines = carried_out(create("planners", "plan"), task.instructions[0], laid, llm, moved)
    assert len(llm.messages) == 2
    assert "Done so far: []" in llm.messages[0][-1]["content"]
    assert 'Done so far: ["fold the bottom left corner inward to the centre"]' in llm.messages[1][-1]["content"]
    assert len(lines) == 4


def test_a_line_that_lies_off_the_cloth_as_it_will_be_goes_back_with_its_number():
    def fold(x0, y0, x1, y1):
        return {"subgoal": "fold the left edge to the right edge", "fold_line": {
            "start": {"x": x0, "y": y0}, "end": {"x": x1, "y": y1}}}  # fmt: skip

    laid = laid_garment("rectangle", SEED)
    (x0, y0), (x1, y1) = laid.model.outline().min(0), laid.model.outline().max(0)
    middle = (x0 + x1) / 2
    halves = {"plan": [fold(middle, y1, middle, y0), fold(x0 + 5, y1, x0 + 5, y0)]}
    planner = create("planners", "plan", {"max_attempts": 1})
    with pytest.raises(PlanError, match="fold 2"):
        planner.plan(Subgoal("fold it"), shown(laid.model, laid.size), Transcript(Scripted(halves)))


def test_a_grounding_without_a_polygon_is_refused_with_what_to_choose():
    laid = laid_garment("square", SEED)
    bare = replace(shown(laid.model, laid.size), model=None)
    with pytest.raises(ConfigError, match="--grounding polygon"):
        create("planners", "plan").plan(Subgoal("fold it"), bare, Transcript(Scripted()))
