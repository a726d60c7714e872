"""The offline reader with less than a polygon: keypoints, pictures, and picks instead of fold lines."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from experiments.benchmarks.language.understanding import folded_states, laid_garment
from polyfold.errors import RefusedError
from polyfold.geometry import Camera
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins import create, find
from polyfold.rollout._transcript import Transcript
from polyfold.tasks import fold_lines, load_suite
from polyfold.types import Reply, Scene, Subgoal

SUITE = load_suite(str(find("tasks", "polyfold70").target))
SEED = 2005
SEEN = SimpleNamespace(camera=Camera())
PICTURE = np.full((400, 400, 3), 90, np.uint8)


@pytest.fixture(scope="module")
def solver():
    return create("llms", "offline")


def mask_of(model, size):
    mask = np.zeros((size[1], size[0]), bool)
    for facet in model.facets():
        mask |= fill_polygon(facet.polygon, size[1], size[0])
    return mask


def scene_of(kind, task=None, folds=0, words="keypoints", **more) -> Scene:
    """The garment after the first folds of a task, folded ideally, as a grounding would show it."""
    laid = laid_garment(kind, SEED)
    model, size = laid.model, laid.size
    lines = fold_lines(SUITE.task(task), dict(zip(model.names, model.rest, strict=True)))[:folds] if task else []
    grounding, template = create("groundings", "keypoints"), create("garments", kind).template()
    flat = grounding.ground(SEEN, mask_of(model, size), template)
    for line in lines:
        model = model.fold(line)
    if words == "polygon":
        mask = mask_of(model, size)
        return replace(Scene(kind, size, mask, model.outline(), model, model.to_text(size)), **more)
    scene = grounding.ground(SEEN, mask_of(model, size), template, flat, lines[-1]) if lines else flat
    return replace(scene, **more)


def plan(planner, text, scene, solver):
    conversation = Transcript(solver)
    found = create("planners", planner).plan(Subgoal(text), scene, conversation)
    return found, conversation.calls[-1].reply.text


@pytest.mark.parametrize(
    "name",
    [
        "square-corners-all",
        "square-triangle-bottom_left-then-top_left",
        "rectangle-middle-left-right-half",
        "rectangle-half-right-then-top",
        "tshirt-sleeves-left-straight-right-slanted",
        "tshirt-sleeves-right-slanted-left-straight",
        "tshirt-block-right-first",
        "pants-block-left-halves",
        "pants-block-right-thirds",
    ],
)
def test_named_and_then_nameless_keypoints_are_enough_on_ideal_folds(name, solver):
    task = SUITE.task(name)
    laid = laid_garment(task.garment, SEED)
    template, planner = create("garments", task.garment).template(), create("planners", "hierarchical")
    grounding, model, scene, lines = create("groundings", "keypoints"), laid.model, None, []
    for subgoal in planner.subgoals(task.instructions[0], template, Transcript(solver)):
        scene = grounding.ground(SEEN, mask_of(model, laid.size), template, scene, lines[-1] if lines else None)
        lines.append(planner.plan(subgoal, scene, Transcript(solver)))
        model = model.fold(lines[-1])
    wanted = fold_lines(task, dict(zip(laid.model.names, laid.model.rest, strict=True)))
    ours, theirs = folded_states(laid.particles, lines)[-1], folded_states(laid.particles, wanted)[-1]
    moved = (theirs != laid.particles).any(1)
    assert np.hypot(*(ours - theirs)[moved].T).mean() < 0.05 * np.ptp(laid.particles, axis=0).max()


def test_the_middle_line_is_that_of_the_flat_cloth_though_only_the_outline_is_seen(solver):
    line, _ = plan(
        "hierarchical",
        "fold the right edge inward to the middle line",
        scene_of("rectangle", "rectangle-middle-left-right", 1),
        solver,
    )
    flat = laid_garment("rectangle", SEED).model
    corners = dict(zip(flat.names, flat.rest, strict=True))
    for name, other in (("top_right", "top_left"), ("bottom_right", "bottom_left")):
        middle = (corners[name] + corners[other]) / 2
        assert np.hypot(*(line.mirror(corners[name]) - middle)) < 8


def test_words_without_vertices_are_refused_with_what_is_missing(solver):
    text = json.dumps({"garment": "square", "image": {"width": 400, "height": 400}, "corners": [[1, 2]]})
    with pytest.raises(RefusedError, match=r"lacks vertices and keypoints \(it has garment, image, corners"):
        plan("hierarchical", "fold the left edge to the right edge", scene_of("square", text=text), solver)


@pytest.mark.parametrize(
    ("kind", "task", "text"),
    [
        ("tshirt", "tshirt-block-left-first", "fold the left sleeve inward to the body along the armhole"),
        ("square", "square-corners-all", "fold the bottom left corner inward to the centre"),
    ],
)
def test_a_part_that_the_outline_does_not_show_is_refused(kind, task, text, solver):
    with pytest.raises(RefusedError, match="folded in already"):
        plan("hierarchical", text, scene_of(kind, task, 1), solver)


def test_a_picture_alone_is_refused_with_what_to_do(solver):
    text = json.dumps({"garment": "square", "image": {"width": 400, "height": 400}})
    scene = scene_of("square", text=text, picture=PICTURE, shown=("image",))
    for planner in ("hierarchical", "zero-shot-vlm"):
        with pytest.raises(RefusedError, match="vision model"):
            plan(planner, "fold the left edge to the right edge", scene, solver)


@pytest.mark.parametrize("words", ["keypoints", "polygon"])
def test_words_beside_a_picture_are_answered_as_without_it(words, solver):
    text = "fold the left edge rightward to the right edge along the vertical centre line"
    plain = scene_of("rectangle", words=words)
    both = replace(plain, picture=PICTURE, shown=(words, "image"))
    assert plan("hierarchical", text, plain, solver) == plan("hierarchical", text, both, solver)


HALF = "fold the left edge rightward to the right edge along the vertical centre line"


@pytest.mark.parametrize("words", ["keypoints", "polygon"])
def test_one_arm_takes_the_middle_of_an_edge_and_two_its_corners(words, solver):
    corners = dict(
        zip(laid_garment("rectangle", SEED).model.names, laid_garment("rectangle", SEED).model.rest, strict=True)
    )
    height = np.hypot(*(corners["top_left"] - corners["bottom_left"]))
    one, _ = plan("direct-1arm", HALF, scene_of("rectangle", words=words), solver)
    two, _ = plan("direct-2arm", HALF, scene_of("rectangle", words=words), solver)
    assert (one.arms, two.arms) == (1, 2)
    assert np.hypot(*(one.picks[0] - (corners["top_left"] + corners["bottom_left"]) / 2)) < 8
    assert np.hypot(*(one.places[0] - (corners["top_right"] + corners["bottom_right"]) / 2)) < 8
    for name, goal in (("top_left", "top_right"), ("bottom_left", "bottom_right")):
        assert np.hypot(*(two.picks - corners[name]).T).min() < 0.1 * height + 8
        assert np.hypot(*(two.places - corners[goal]).T).min() < 0.1 * height + 8


@pytest.mark.parametrize(
    ("kind", "task", "folds", "text", "arms"),
    [
        ("square", "square-corners-all", 1, "fold the top left corner inward to the centre", 1),
        ("tshirt", "tshirt-block-left-first", 1, "fold the right sleeve inward to the body along the armhole", 2),
        (
            "tshirt",
            "tshirt-block-left-first",
            2,
            "fold the hem upward to the shoulders along the horizontal centre line",
            2,
        ),
        ("pants", "pants-half-left-then-bottom", 1, "fold the leg ends upward to the waist", 2),
    ],
)
@pytest.mark.parametrize("words", ["keypoints", "polygon"])
def test_two_arms_hold_folded_cloth_where_the_ideal_fold_lifts_it(kind, task, folds, text, arms, words, solver):
    laid = laid_garment(kind, SEED)
    wanted = fold_lines(SUITE.task(task), dict(zip(laid.model.names, laid.model.rest, strict=True)))[folds]
    action, _ = plan("direct-2arm", text, scene_of(kind, task, folds, words), solver)
    assert action.arms == arms
    assert wanted.lifts(action.picks).all()
    off = np.hypot(*(wanted.mirror(action.picks) - action.places).T)
    assert off.max() < 0.06 * np.ptp(laid.particles, axis=0).max()


def test_a_question_that_comes_back_with_what_was_wrong_is_answered_again(solver):
    class WrongAtFirst:
        def __init__(self):
            self.asked = 0

        def complete(self, messages, params):
            self.asked += 1
            return Reply("no object") if self.asked == 1 else solver.complete(messages, params)

    scene, llm = scene_of("rectangle"), WrongAtFirst()
    assert plan("hierarchical", HALF, scene, llm)[0] == plan("hierarchical", HALF, scene, solver)[0]
    assert llm.asked == 2
