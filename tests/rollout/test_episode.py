"""The loop from outside: what agents are told, what observers see, and that nothing is lost when something fails."""

from typing import ClassVar

import numpy as np
import pytest

import polyfold
from polyfold import Action, Decision, plugins
from polyfold.api import attempt
from polyfold.errors import ConfigError, PlanError

TOLD = {}


class Spy:
    """Notes what it is told and folds along the guidance, if it gets any."""

    requires: ClassVar = frozenset()

    def begin(self, goal, observation):
        TOLD.clear()
        TOLD.update({name: value for name, value in vars(goal).items() if value is not None})
        self.lines = list(goal.fold_lines or ())
        return ()

    def decide(self, observation):
        if not self.lines:
            return None
        line = self.lines.pop(0)
        pick = np.array([[199.0, 199.0]])
        return Decision(Action(pick, np.clip(line.mirror(pick), 0, 399)), fold_line=line)


class Guided(Spy):
    requires: ClassVar = frozenset({"subgoal_texts", "subgoal_images", "subgoal_depths", "goal_image"})


class Privileged(Spy):
    requires: ClassVar = frozenset({"fold_lines", "state"})


class Wishful(Spy):
    requires: ClassVar = frozenset({"clairvoyance"})


@pytest.fixture(autouse=True)
def _registered():
    for cls in (Spy, Guided, Privileged, Wishful):
        polyfold.register("agents", cls.__name__.lower(), cls, "a test's agent")
    yield
    for kind, name in plugins.by_hand():
        plugins.unregister(kind, name)


@pytest.fixture
def square():
    return polyfold.garment("square", seed=2001, edge_length=0.03)


def run(square, agent, **settings):
    task = settings.pop("task", None)
    return attempt("fold it", square, 0, polyfold.Experiment.of(agent=agent, **settings), task=task)


def test_an_agent_is_told_only_what_it_requires(square):
    run(square, "spy", task="square-triangle-top_left")
    assert set(TOLD) == {"kind", "template", "seed"}


@pytest.mark.parametrize(("kind", "fabric", "layer"), [("square", "felt", 0.002), ("pants", "denim", 0.0019)])
def test_an_agent_is_told_how_thick_a_layer_is_as_a_label_in_the_garment_would(kind, fabric, layer):
    cloth = polyfold.garment(kind, seed=2001, edge_length=0.05, fabric=fabric)
    attempt("fold it", cloth, 0, polyfold.Experiment.of(agent="spy"))
    assert TOLD["template"].thickness == pytest.approx(layer)


def test_steps_guidance_is_one_text_and_picture_per_fold(square):
    run(square, "guided", task="square-triangle-top_left-then-bottom_left")
    assert set(TOLD) == {
        "kind", "template", "seed", "subgoal_texts", "subgoal_images", "subgoal_depths", "goal_image"
    }  # fmt: skip
    assert TOLD["subgoal_texts"] == (
        "fold top left onto bottom right",
        "fold bottom left onto top right",
    )
    covered = [np.any(image != image[0, 0], axis=2).sum() for image in TOLD["subgoal_images"]]
    assert covered[1] < 0.6 * covered[0]
    assert (TOLD["goal_image"] == TOLD["subgoal_images"][-1]).all()


def test_final_guidance_is_the_goal_alone(square):
    run(square, "guided", task="square-triangle-top_left-then-bottom_left", guidance="final")
    assert TOLD["subgoal_texts"] == ("fold it",)
    assert len(TOLD["subgoal_images"]) == 1


def test_privileged_agents_are_marked(square):
    episode = run(square, "privileged", task="square-triangle-top_left")
    assert episode.privileged
    assert len(TOLD["fold_lines"]) == 1
    assert callable(TOLD["state"])
    assert not run(square, "spy", task="square-triangle-top_left").privileged


def test_guidance_without_a_task_says_what_to_do(square):
    with pytest.raises(ConfigError, match="--task"):
        run(square, "guided")


def test_an_unknown_requirement_is_named(square):
    assert "clairvoyance" in run(square, "wishful").failure.reason


def test_noop_leaves_the_cloth_and_scores_badly(square):
    episode = run(square, "noop", task="square-triangle-top_left")
    assert np.abs(episode.final_state.positions - episode.initial_state.positions).max() < 1e-9
    assert episode.fidelity.iou < 0.6
    assert episode.fidelity.moved_part_error_mm > 100


def test_a_failure_in_the_middle_keeps_what_was_done_until_then(square, tmp_path):
    class Tired:
        """A policy that gives up at the second fold."""

        calls = 0

        def act(self, fold_line, scene, rng):
            self.calls += 1
            if self.calls > 1:
                raise PlanError("tired; rest and try again")
            return plugins.create("policies", "affordance-pair").act(fold_line, scene, rng)

    polyfold.register("policies", "tired", Tired)
    sentence = "fold the left edge onto the right edge, then fold the bottom edge onto the top edge"
    cloth = polyfold.garment("rectangle", seed=2001, edge_length=0.03)
    with pytest.raises(PlanError, match="tired"):
        polyfold.fold(sentence, cloth, policy="tired", out=tmp_path)
    for name in ("episode.json", "transcript.jsonl", "filmstrip.png", "fold.gif"):
        assert (tmp_path / name).stat().st_size > 0
    episode = attempt(sentence, cloth, 0, polyfold.Experiment.of(policy="tired"))
    assert len(episode.steps) == 1
    assert episode.failure.stage == "planning"


def test_observers_see_the_episode_as_it_happens(square):
    seen = []

    class Observer:
        def on_episode_start(self, start):
            seen.append(("start", len(start.subgoals)))

        def on_step(self, step):
            seen.append(("step", step.index))

        def on_episode_end(self, episode):
            seen.append(("end", episode.failure))

    polyfold.fold("fold the square in half", square, observer=Observer())
    assert seen == [("start", 1), ("step", 0), ("end", None)]
    polyfold.fold("fold the square in half", square)
    assert len(seen) == 3, "an observer leaves with its episode"
