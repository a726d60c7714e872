"""Classic mistakes, one a component: each is found, and its message says which it is and what to change."""

import json
import re
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from pydantic import BaseModel, ConfigDict, Field

from polyfold import plugins
from polyfold.cli import main
from polyfold.errors import PluginError
from polyfold.polygon import Template
from polyfold.testing import check, conformance
from polyfold.types import Action, Reply, Subgoal


def geometric():
    return plugins.create("policies", "affordance-pair")


class RightOfTheLine:
    def act(self, fold_line, scene, rng):
        return geometric().act(fold_line.reversed(), scene, rng)


class RowsForColumns:
    def act(self, fold_line, scene, rng):
        action = geometric().act(fold_line, scene, rng)
        return Action(action.picks[:, ::-1], action.places[:, ::-1])


class NotMirrored:
    def act(self, fold_line, scene, rng):
        action = geometric().act(fold_line, scene, rng)
        return Action(action.picks, action.picks[::-1] + 5.0)


class RandomOfItsOwn:
    def act(self, fold_line, scene, rng):
        left = scene.contour[fold_line.lifts(scene.contour)]
        picks = left[np.random.default_rng().integers(len(left), size=1)]
        return Action(picks, fold_line.mirror(picks))


class Remembers:
    def __init__(self):
        self.calls = 0

    def act(self, fold_line, scene, rng):
        self.calls += 1
        left = scene.contour[fold_line.lifts(scene.contour)]
        picks = left[[self.calls % len(left)]]
        return Action(picks, fold_line.mirror(picks))


class WritesIntoTheScene:
    def act(self, fold_line, scene, rng):
        scene.mask[:10] = True
        return geometric().act(fold_line, scene, rng)


class FoldsNothing:
    def act(self, fold_line, scene, rng):
        picks = scene.contour[:1]
        left = scene.contour[fold_line.lifts(scene.contour)]
        return geometric().act(fold_line, scene, rng) if len(left) else Action(picks, picks)


class ReturnsNothing:
    def act(self, fold_line, scene, rng):
        geometric().act(fold_line, scene, rng)


class UndescribedParameters:
    class Config(BaseModel):
        model_config = ConfigDict(extra="forbid")

        arms: int = 2

    def __init__(self, config):
        self.config = config

    def act(self, fold_line, scene, rng):
        return geometric().act(fold_line, scene, rng)


class SilentParameters:
    class Config(BaseModel):
        arms: int = Field(default=2, description="arms to use")

    def __init__(self, config):
        self.config = config

    def act(self, fold_line, scene, rng):
        return geometric().act(fold_line, scene, rng)


class TableForCloth:
    def segment(self, observation):
        return ~plugins.create("segmenters", "colour").segment(observation)


class UndoesItself:
    def segment(self, observation):
        observation.rgb[:] = observation.rgb[..., ::-1]
        return plugins.create("segmenters", "colour").segment(observation)


class HeightForWidth:
    def ground(self, observation, mask, template, previous=None, fold_line=None):
        scene = plugins.create("groundings", "polygon").ground(observation, mask, template, previous, fold_line)
        return replace(scene, image_size=scene.image_size[::-1])


class SwappedContour:
    def ground(self, observation, mask, template, previous=None, fold_line=None):
        scene = plugins.create("groundings", "polygon").ground(observation, mask, template, previous, fold_line)
        return replace(scene, contour=scene.contour[:, ::-1])


class WritesIntoTheMask:
    def ground(self, observation, mask, template, previous=None, fold_line=None):
        scene = plugins.create("groundings", "polygon").ground(observation, mask, template, previous, fold_line)
        mask[:200] = False
        return scene


class LeavesPython:
    def __init__(self):
        raise SystemExit("bye")

    def act(self, fold_line, scene, rng):
        """Never."""


class LooseJson:
    def ground(self, observation, mask, template, previous=None, fold_line=None):
        scene = plugins.create("groundings", "polygon").ground(observation, mask, template, previous, fold_line)
        return replace(scene, text=scene.text.replace("}", ', "residual": NaN}', 1))


class NothingExplains:
    def ground(self, observation, mask, template, previous=None, fold_line=None):
        scene = plugins.create("groundings", "polygon").ground(observation, mask, template, previous, fold_line)
        return replace(scene, shown=("polygons",))


class SwappedPlaces:
    def ground(self, observation, mask, template, previous=None, fold_line=None):
        scene = plugins.create("groundings", "polygon").ground(observation, mask, template, previous, fold_line)
        told = json.loads(scene.text)
        told["vertices"] = {name: place[::-1] for name, place in told["vertices"].items()}
        return replace(scene, text=json.dumps(told))


class BelievesAnything:
    def subgoals(self, instruction, template, conversation):
        return [Subgoal(conversation.ask("subgoals", []).text)]

    def plan(self, subgoal, scene, conversation):
        return None


class NeverGivesUp:
    def subgoals(self, instruction, template, conversation):
        while True:
            conversation.ask("subgoals", [])

    def plan(self, subgoal, scene, conversation):
        return None


class FreeOfCharge:
    def complete(self, messages, params):
        return Reply("yes", cost=0.0)


class UpsideDownMetric:
    unit: ClassVar[str] = "mm"
    higher_is_better: ClassVar[bool] = True

    def score(self, result, references):
        return min(float(np.abs(result.end.positions - one.end.positions).mean()) for one in references)


class FirstReferenceOnly:
    unit: ClassVar[str] = "mm"
    higher_is_better: ClassVar[bool] = False

    def score(self, result, references):
        return float(np.abs(result.end.positions - references[0].end.positions).mean())


class NeverMeasures:
    unit: ClassVar[str] = ""
    higher_is_better: ClassVar[bool] = True

    def score(self, result, references):
        return float("nan")


class OneMesh:
    kind: ClassVar[str] = "mine"

    def template(self):
        return plugins.create("garments", "square").template()

    def generate(self, seed, edge_length=0.02):
        return replace(plugins.create("garments", "square").generate(seed, 0.02), kind="mine")


class OtherNames:
    kind: ClassVar[str] = "mine"

    def template(self):
        square = plugins.create("garments", "square").template()
        names = {name: f"corner_{number}" for number, name in enumerate(square.names)}
        return Template(
            "mine", list(names.values()), dict.fromkeys(names.values(), "a corner"), {"side": list(names.values())[:2]},
            square.canonical_shapes, square.generator,
        )  # fmt: skip

    def generate(self, seed, edge_length=0.01):
        return replace(plugins.create("garments", "square").generate(seed, edge_length), kind="mine")


class ForgetsSpeed:
    """A simulator that rounds what it is to return to."""

    def __init__(self):
        self._inner = plugins.create("simulators", "xpbd")

    def restore(self, state):
        self._inner.restore(replace(state, positions=state.positions.round(3)))

    def __getattr__(self, name):
        return getattr(self._inner, name)

    def reset(self, garment, seed):
        return self._inner.reset(garment, seed)

    def execute(self, action):
        return self._inner.execute(action)


class CallsHome:
    def __init__(self):
        import socket
        from contextlib import suppress

        with suppress(Exception):
            socket.create_connection(("127.0.0.1", 9), 0.1)

    def connect(self):
        """Open it."""

    def close(self):
        """Release it."""

    def get_rgbd(self, frames=1):
        """Nothing yet."""


WRONG = [
    ("policies", RightOfTheLine, "a pick lies right of the fold line, on cloth that stays. what is LEFT"),
    ("policies", RowsForColumns, "px from the contour, where no cloth's edge is. choose among scene.contour"),
    ("policies", NotMirrored, "px from where its pick is mirrored on the fold line. places = fold_line.mirror(picks)"),
    (
        "policies",
        RandomOfItsOwn,
        "the same line, scene and seed give other picks. draw from the rng that act is handed",
    ),
    ("policies", Remembers, "after other lines the same one gives other picks. keep nothing between calls"),
    ("policies", WritesIntoTheScene, "writes in act into an array that is read-only"),
    ("policies", FoldsNothing, "no cloth lies left of the line, and it picks at"),
    ("policies", ReturnsNothing, "returned None from act; it must return an Action"),
    ("policies", UndescribedParameters, "arms has no description. write Field(default=…, description='… [unit]')"),
    ("policies", SilentParameters, "it takes parameters that it does not know in silence"),
    ("segmenters", TableForCloth, "the mask of a blue square on a pale table covers it to 0.00 (IoU). True is cloth"),
    ("policies", LeavesPython, "can't be constructed: SystemExit: bye"),
    ("segmenters", UndoesItself, "writes in segment into an array that is read-only, as all"),
    ("groundings", HeightForWidth, "image_size is (360, 400), not (400, 360). it is (width, height)"),
    ("groundings", SwappedContour, "px off the cloth. contour_of(mask) gives it, (x, y), y down"),
    ("groundings", WritesIntoTheMask, "writes in ground into an array that is read-only, as all"),
    ("groundings", LooseJson, "a Scene whose text holds NaN, which JSON does not have"),
    ("groundings", NothingExplains, "and no prompt explains 'polygons' to a language model. show one of image, key"),
    ("groundings", SwappedPlaces, "px off the cloth. places are [x, y] in pixels of the picture, x to the right"),
    ("planners", BelievesAnything, "and the plan is None. check the answer; raise PlanError"),
    ("planners", NeverGivesUp, "it asked 40 times and did not give up; bound the repairs"),
    ("llms", FreeOfCharge, "the cost is 0, which says that it was free"),
    ("metrics", UpsideDownMetric, "the same one 0. look at higher_is_better"),
    ("metrics", FirstReferenceOnly, "take the best of them"),
    ("metrics", NeverMeasures, "a square folded in half scores nan against itself, one folded elsewhere nan. NaN is"),
    ("garments", OneMesh, "vertices at an edge length of 20 mm, and"),
    ("garments", OtherNames, "keypoints are ['bottom_left', 'bottom_right', 'top_left', 'top_right'], the template's"),
    ("simulators", ForgetsSpeed, "mm off. put all of the state back"),
    (
        "cameras",
        CallsHome,
        "constructing it asks for a connection to [('127.0.0.1', 9)]. connect when it is first used",
    ),
]


@pytest.fixture
def registered():
    """Register a class under the name ``mine`` for a test."""
    done = []

    def register(kind, cls):
        plugins.register(kind, "mine", cls)
        done.append(kind)

    yield register
    for kind in done:
        plugins.unregister(kind, "mine")


@pytest.mark.parametrize(("kind", "cls", "says"), WRONG, ids=lambda value: getattr(value, "__name__", None))
def test_every_classic_mistake_is_named(registered, kind, cls, says):
    registered(kind, cls)
    faults = [found.fault for found in check("mine") if found.fault]
    assert any(says in fault for fault in faults), faults
    assert all("\n" not in fault for fault in faults)


def test_one_fault_that_every_check_meets_is_said_once(registered, capsys):
    registered("policies", LeavesPython)
    assert main(["check", "policy mine"]) == 1
    said = capsys.readouterr().out
    assert said.count("can't be constructed: SystemExit: bye") == 1
    assert said.count("✗") == said.count("      the same as above") + 1 > 5
    assert re.search(r"^\d+ checks, (\d+) faults, all the same$", said.splitlines()[-1])


def test_a_right_component_has_no_faults(registered):
    class Right:
        class Config(BaseModel):
            model_config = ConfigDict(extra="forbid")

            arms: int = Field(default=2, description="arms to use")

        def __init__(self, config):
            self.config = config

        def act(self, fold_line, scene, rng):
            return geometric().act(fold_line, scene, rng)

    registered("policies", Right)
    found = list(check("policy mine"))
    assert len(found) > 7
    assert not [one.fault for one in found if one.fault]


def test_what_can_t_be_made_without_parameters_says_how_to_give_them(registered):
    class Needs:
        class Config(BaseModel):
            model_config = ConfigDict(extra="forbid")

            weights: str = Field(description="a file")

        def __init__(self, config):
            self.weights = config.weights

        def act(self, fold_line, scene, rng):
            return geometric().act(fold_line, scene, rng)

    registered("policies", Needs)
    assert {found.untried for found in check("mine")} == {"needs params={'policy mine': {'weights': …}}"}
    given = list(check("mine", {"policy mine": {"weights": "here"}}))
    assert not [found for found in given if found.untried or found.fault]
    with pytest.raises(PluginError, match="has no 'policy other' to give parameters to"):
        list(check("mine", {"policy other": {}}))


def test_nothing_to_check_is_a_failure():
    with pytest.raises(PluginError, match=r"no plugin or component is called 'polyfold-nothing'.*pip install -e \."):
        list(check("polyfold-nothing"))
    test = conformance("polyfold-nothing")
    with pytest.raises(pytest.fail.Exception, match="no plugin or component is called"):
        test()


def test_an_expected_failure_must_be_of_a_check_that_there_is():
    with pytest.raises(PluginError, match="'policy caso: it sings' is expected to fail and no check of 'caso'"):
        conformance("caso", expected_failures={"policy caso: it sings": "it can't"})
