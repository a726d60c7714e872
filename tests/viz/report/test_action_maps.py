"""A policy of anyone's that values picks: its maps are in the pictures of its folds, and asked for only there."""

import numpy as np
import pytest
from PIL import Image

import polyfold
from polyfold import plugins
from polyfold.api import attempt
from polyfold.errors import PlanError
from polyfold.rollout import run_episode
from polyfold.types import Action
from polyfold.viz._draw._style import MAP
from polyfold.viz._report import write_report

SMALL = {"name": "small", "tasks": ("square-corner-bottom_left",), "first_seed": 2000, "edge_length": 0.03}
ASKED = []


class Plain:
    """Folds as ``affordance-pair`` does."""

    def act(self, fold_line, scene, rng):
        return plugins.create("policies", "affordance-pair").act(fold_line, scene, rng)


class Valued(Plain):
    """The same, and values what is far from the line."""

    def action_map(self, fold_line, scene):
        ASKED.append(fold_line)
        distances = fold_line.distance(scene.contour)
        values = np.where(distances > 0, distances, np.nan)
        return scene.contour, values


class Unsure(Plain):
    def action_map(self, fold_line, scene):
        raise PlanError("no values here; ask elsewhere")


@pytest.fixture(autouse=True)
def _registered(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path_factory.getbasetemp() / "cache"))
    ASKED.clear()
    for cls in (Plain, Valued, Unsure):
        polyfold.register("policies", cls.__name__.lower(), cls, "a test's policy")
    yield
    for kind, name in plugins.by_hand():
        plugins.unregister(kind, name)


def run(out, *policies, pictures="all"):
    study = polyfold.Study(**SMALL, base={"agent": "fold-lines"})
    return polyfold.run(
        polyfold.ablate(study, "policy", list(policies)), out, pictures=pictures, progress=False
    ).records


def opened(out, record):
    with Image.open(out / record.picture) as picture:
        return np.asarray(picture.convert("RGB")).astype(int)


def coloured(picture, colour, tolerance=40):
    return int((np.abs(picture - colour).max(-1) < tolerance).sum())


def test_the_report_shows_the_values_of_policies_that_have_some_and_says_so(tmp_path):
    plain, valued, unsure = run(tmp_path / "both", "plain", "valued", "unsure")
    assert plain.metrics == valued.metrics, "the same folds"
    pictures = [opened(tmp_path / "both", record) for record in (plain, valued, unsure)]
    folds, results = [p[:, :264] for p in pictures], [p[:, 268:] for p in pictures]
    assert coloured(folds[1], MAP[-1]) > 20 > coloured(folds[0], MAP[-1])
    assert np.abs(results[1] - results[0]).mean() < 1
    assert np.abs(folds[2] - folds[0]).mean() < 1, "no values, no map, and no harm"
    assert "values picks" in write_report(tmp_path / "both").read_text("utf-8")

    run(tmp_path / "plain", "plain")
    assert "values picks" not in write_report(tmp_path / "plain").read_text("utf-8")


def test_values_are_not_asked_for_without_a_picture(tmp_path):
    run(tmp_path, "valued", pictures="none")
    assert not ASKED
    episode = attempt("fold it in half", polyfold.garment("square", seed=2000, edge_length=0.03), 0, experiment())
    assert episode.steps
    assert not ASKED
    episode.show()
    assert [step.fold_line for step in episode.steps] == ASKED


def test_the_filmstrip_shows_the_values_of_the_fold():
    cloth = polyfold.garment("square", seed=2000, edge_length=0.03)
    strips = [
        attempt("fold it in half", cloth, 0, experiment(policy=policy)).show().astype(int)
        for policy in ("plain", "valued")
    ]
    assert [coloured(strip, MAP[-1]) > 50 for strip in strips] == [False, True]


def test_picks_that_the_planner_chose_carry_no_values_of_the_policy():
    cloth = polyfold.garment("square", seed=2000, edge_length=0.03)
    episode = attempt("fold it in half", cloth, 0, experiment(planner="direct-2arm"))
    assert episode.steps
    episode.show()
    assert not ASKED


@pytest.mark.parametrize(("holding", "by_policy"), [([], True), ([1], False)], ids=["both miss", "one misses"])
def test_a_repeated_fold_has_values_only_where_the_policy_chose_again(holding, by_policy):
    cloth = polyfold.garment("tshirt", seed=2000, edge_length=0.025)
    episode = run_episode(experiment(), cloth, "fold the hem up to the shoulders", 2000, FirstMisses(holding))
    first, again = episode.steps[:2]
    assert again.retry
    assert first.action_map is not None
    assert (again.action_map is not None) == by_policy


class FirstMisses:
    """The simulator, but in the first fold only some arms take hold."""

    def __init__(self, holding):
        self._inner = plugins.create("simulators", "xpbd")
        self._holding = holding

    def __getattr__(self, name):
        return getattr(self._inner, name)

    def execute(self, action):
        holding, self._holding = self._holding, None
        if holding == []:
            return self._inner.observe()
        held = action if holding is None else Action(action.picks[holding], action.places[holding])
        return self._inner.execute(held)


def experiment(**components):
    return polyfold.Experiment.of(**{"policy": "valued", **components})
