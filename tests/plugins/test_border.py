"""Whatever a component gets wrong, the message names it, its plugin and the method, and says what was expected."""

import inspect
import re
from dataclasses import replace

import numpy as np
import pytest

import polyfold
from polyfold import plugins
from polyfold.errors import ActionError, ConfigError, PluginError
from polyfold.geometry import FoldLine
from polyfold.plugins import hardware, interfaces
from polyfold.plugins._owed import METHODS
from polyfold.testing._materials import scene as scene_of_square
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


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"text": "the hem is at the bottom"}, "a Scene whose text is no JSON ('the hem is at the bottom')"),
        ({"text": '{"garment": "square", "residual": NaN}'}, "a Scene whose text holds NaN, which JSON does not have"),
        ({"text": {"garment": "square"}}, "a Scene whose text is a dict and no string"),
        ({"text": "[1, 2]"}, "a Scene whose text is JSON and no object ('[1, 2]')"),
        ({"shown": "polygon"}, "a Scene whose shown is 'polygon', no tuple of names"),
        ({"mask": np.zeros((3, 4), bool)}, "a Scene whose mask is an array of bool, shape (3, 4), not bool and of"),
        ({"contour": np.zeros((5, 3))}, "a Scene whose contour has shape (5, 3), not (N, 2)"),
    ],
)
def test_a_scene_that_a_planner_would_stumble_over_is_its_grounding_s(registered, changes, said):
    def ground(self, observation, mask, template, previous=None, fold_line=None):
        scene = plugins.create("groundings", "polygon").ground(observation, mask, template, previous, fold_line)
        return replace(scene, **changes)

    message = told(registered, "groundings", policy(ground=ground))
    assert f"returned {said}" in message
    assert "it must return a Scene: its text a strict JSON object" in message


def test_what_no_prompt_explains_is_told_with_the_grounding_that_shows_it(registered):
    def ground(self, observation, mask, template, previous=None, fold_line=None):
        scene = plugins.create("groundings", "polygon").ground(observation, mask, template, previous, fold_line)
        return replace(scene, shown=("polygons",))

    name = registered("groundings", policy(ground=ground))
    with pytest.raises(ConfigError) as caught:
        polyfold.fold("fold it in half", garment="square", seed=0, grounding=name)
    assert str(caught.value).startswith(
        "the grounding 'mine' that was registered by hand says that its scene shows polygons (scene.shown), and there "
        "is no prompt fold_line@polygons-v2; did you mean"
    )


def write_mask(scene):
    scene.mask[:] = False


def write_contour(scene):
    scene.contour -= 1.0


def draw(scene):
    import cv2

    cv2.circle(scene.picture, (5, 5), 3, (0, 0, 0))


@pytest.mark.parametrize("write", [write_mask, write_contour, draw])
def test_what_is_handed_can_t_be_written_into_and_who_tries_is_named(registered, write):
    def act(self, fold_line, scene, rng):
        write(replace(scene))
        return Action([scene.contour[0]], [scene.contour[1]])

    mine = plugins.create("policies", registered("policies", policy(act=act)))
    seen = scene_of_square()
    before = seen.mask.copy()
    with pytest.raises(PluginError) as caught:
        mine.act(FoldLine((0.0, 200.0), (400.0, 200.0)), seen, np.random.default_rng(0))
    assert str(caught.value).startswith(
        "the policy 'mine' that was registered by hand writes in act into an array that is read-only, as all are "
    )
    assert re.search(
        rf"\(.*test_border.py:\d+, in {write.__name__}\); copy it first: array.copy\(\)$", str(caught.value)
    )
    assert (seen.mask == before).all()
    seen.mask[0] = True  # theirs again who made it


def test_a_picture_is_read_only_too(registered):
    def segment(self, observation):
        observation.rgb[:5] = 0
        return observation.rgb[..., 0] > 0

    assert "writes in segment into an array that is read-only" in told(
        registered, "segmenters", policy(segment=segment)
    )


@pytest.mark.parametrize("flaw", [{"vertices": np.nan}, {"triangles": 10_000}])
def test_a_mesh_that_is_none_is_refused_with_the_garment_that_made_it(registered, flaw):
    def generate(self, seed, edge_length=0.02):
        garment = plugins.create("garments", "square").generate(seed, edge_length)
        mesh = replace(garment.mesh, **{name: getattr(garment.mesh, name).copy() for name in flaw})
        for name, value in flaw.items():
            getattr(mesh, name)[0] = value
        return replace(garment, mesh=mesh)

    def template(self):
        return plugins.create("garments", "square").template()

    name = registered("garments", policy(kind="mine", template=template, generate=generate))
    with pytest.raises(
        PluginError, match=r"^the garment 'mine' that was registered by hand returned a Garment whose mesh"
    ):
        polyfold.garment(name)


def test_arguments_in_another_order_are_refused_before_they_are_mistaken_for_each_other(registered):
    message = told(registered, "policies", policy(act=lambda self, scene, fold_line, rng: None))
    assert "has act(scene, fold_line, rng), whose order is act(fold_line, scene, rng); give" in message


def test_a_constructor_is_given_nothing_or_a_config(registered):
    def begin(self, weights, arms=2):
        """It would be given neither."""

    message = told(registered, "policies", policy(__init__=begin, act=lambda self, fold_line, scene, rng: None))
    assert "its __init__(weights, arms=2) is given nothing, as it has no Config; take that alone" in message


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
