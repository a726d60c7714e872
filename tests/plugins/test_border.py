"""Whatever a component gets wrong, the message names it, its plugin and the method, and says what was expected."""

import inspect
import re

import numpy as np
import pytest

import polyfold
from polyfold import plugins
from polyfold.errors import ActionError, PluginError
from polyfold.plugins import hardware, interfaces
from polyfold.plugins._border import METHODS
from polyfold.types import Action, Observation

PROTOCOLS = {
    "simulators": interfaces.Simulator, "cameras": hardware.DepthCamera, "robots": hardware.Robot,
    "segmenters": interfaces.Segmenter, "groundings": interfaces.Grounding, "planners": interfaces.Planner,
    "policies": interfaces.Policy, "llms": interfaces.LLM, "agents": interfaces.Agent,
    "garments": interfaces.GarmentKind, "fabrics": interfaces.FabricKind, "metrics": interfaces.Metric,
}  # fmt: skip


@pytest.mark.parametrize("kind", PROTOCOLS)
def test_what_is_owed_is_what_the_protocol_says(kind):
    methods = {name: found for name, found in vars(PROTOCOLS[kind]).items() if inspect.isfunction(found)}
    asked = {name: tuple(inspect.signature(found).parameters)[1:] for name, found in methods.items() if name[0] != "_"}
    assert {name: owed.arguments for name, owed in METHODS[kind].items()} == asked
    assert set(METHODS) == set(PROTOCOLS)


@pytest.fixture
def registered():
    """Register components for a test; what it is called."""
    made = set()

    def register(kind, cls):
        plugins.register(kind, "mine", cls)
        made.add(kind)
        return "mine"

    yield register
    for kind in made:
        plugins.unregister(kind, "mine")


def policy(**members):
    return type("Mine", (), members)


def told(registered, kind, cls):
    """What is said of a component of a class: as it is made, or as it folds."""
    name = registered(kind, cls)
    chosen = {"policies": "policy", "segmenters": "segmenter", "planners": "planner", "llms": "llm"}.get(
        kind, kind[:-1]
    )
    with pytest.raises(PluginError) as caught:
        polyfold.fold("fold it in half", garment="square", seed=0, **{chosen: name})
    message = str(caught.value)
    assert message.startswith(f"the {chosen} 'mine' that was registered by hand")
    assert "\n" not in message
    return message


@pytest.mark.parametrize(
    ("returned", "said"),
    [(None, "None"), (((1, 2), (3, 4)), "a tuple"), (np.zeros((2, 2)), "a ndarray"), (Action, "a type")],
)
def test_what_a_policy_returns_is_looked_at(registered, returned, said):
    message = told(registered, "policies", policy(act=lambda self, fold_line, scene, rng: returned))
    assert f"returned {said} from act; it must return an Action: picks and places [px]" in message


def test_what_it_raises_is_told_with_its_place(registered):
    def act(self, fold_line, scene, rng):
        return scene.model.nothing

    message = told(registered, "policies", policy(act=act))
    assert re.search(
        r"failed in act: AttributeError: .* has no attribute 'nothing' \(.*test_border.py:\d+, in act\)", message
    )


@pytest.mark.parametrize("missing", ["rng", "everything"])
def test_a_method_that_can_t_be_called_as_it_will_be_is_refused_before(registered, missing):
    act = (lambda self, fold_line, scene: None) if missing == "rng" else (lambda self: None)
    message = told(registered, "policies", policy(act=act))
    assert "which is called as act(fold_line, scene, rng); give it these arguments" in message


def test_a_missing_method_and_a_failing_constructor_are_named(registered):
    assert "has no method act(fold_line, scene, rng)" in told(registered, "policies", policy())

    def broken(self):
        raise KeyError("weights")

    assert "can't be constructed: KeyError: 'weights'" in told(registered, "policies", policy(__init__=broken))


def test_a_mask_is_bool_and_as_large_as_the_picture(registered):
    def segment(self, observation):
        return np.ones((7, 7), np.uint8)

    message = told(registered, "segmenters", policy(segment=segment))
    assert "returned an array of uint8, shape (7, 7), from segment; it must return a mask: bool" in message


def test_subgoals_are_a_list_of_them(registered):
    def subgoals(self, instruction, template, conversation):
        return ["fold it"]

    message = told(
        registered, "planners", policy(subgoals=subgoals, plan=lambda self, subgoal, scene, conversation: None)
    )
    assert "returned a str among them from subgoals" in message


def test_an_agent_says_what_it_requires(registered):
    members = {"begin": lambda self, goal, observation: [], "decide": lambda self, observation: None}
    message = told(registered, "agents", policy(**members))
    assert "has no 'requires'" in message


def test_errors_that_say_what_to_do_pass_as_they_are(registered):
    def act(self, fold_line, scene, rng):
        raise FileNotFoundError(2, "No such file", "weights.safetensors")

    name = registered("policies", policy(act=act))
    with pytest.raises(FileNotFoundError):
        polyfold.fold("fold it in half", garment="square", seed=0, policy=name)


def test_picks_and_places_that_cannot_be_are_told_with_who_chose_them(registered):
    name = registered("policies", policy(act=lambda self, fold_line, scene, rng: Action([[1.0, 2.0]], [[1.0]])))
    with pytest.raises(ActionError, match=r"the policy 'mine'.+one \(x, y\) pixel per arm"):
        plugins.create("policies", name).act(None, None, None)


def test_what_is_right_folds_as_ever(registered):
    class Mine:
        """Copies another; slots leave no room for guards."""

        __slots__ = ("other",)

        def __init__(self):
            self.other = plugins.create("policies", "affordance-pair")

        def act(self, fold_line, scene, rng):
            return self.other.act(fold_line, scene, rng)

    name = registered("policies", Mine)
    mine = polyfold.fold("fold it in half", garment="square", seed=0, policy=name)
    other = polyfold.fold("fold it in half", garment="square", seed=0)
    assert isinstance(mine.final, Observation)
    assert (mine.final.rgb == other.final.rgb).all()
