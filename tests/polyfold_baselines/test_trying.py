"""Learning by trying: what is seen, what an action means, and a training that goes on where it was killed."""

import json

import numpy as np
import pytest
import torch
from polyfold_baselines.agents.ppo import Ppo
from polyfold_baselines.demos.window import Window
from polyfold_baselines.learning.weights import load

import polyfold
from polyfold import plugins
from polyfold.api import attempt
from polyfold.errors import ConfigError
from polyfold.evaluation import suite

pytest.importorskip("stable_baselines3", reason="needs polyfold[baselines]")
from gymnasium.utils.env_checker import check_env
from polyfold_baselines.learning.sampling import farthest_first
from polyfold_baselines.learning.trying import reinforcing
from polyfold_baselines.learning.trying.environment import PARTICLES, SIDE, FoldingTasks, TaskView, goals_of
from polyfold_baselines.learning.trying.reinforcing import TryConfig, reinforce

COARSE = 0.03
TINY = TryConfig(row="ppo", passes=16, round=8, batch=8, epochs=1, seeds=(1000, 1001), edge_length=COARSE)


@pytest.fixture
def env():
    tasks = [suite("polyfold70").task("square-corners-top_left-top_right")]
    made = FoldingTasks(tasks, (1000, 1003), COARSE, 0)
    yield made
    made.close()


def test_gymnasium_s_checker_finds_no_fault(env):
    check_env(env, skip_render_check=True)


def test_the_true_fold_is_rewarded_and_goes_on_and_a_wrong_one_ends_it(env):
    env.reset(seed=1)
    state, goal, window = env._simulator.state(), env._goals[0], env._view.window
    moved = np.linalg.norm(goal[:, :2] - state.positions[:, :2], axis=1)
    corner = int(np.argmax(moved))
    numbers = []
    for positions in (state.positions, goal):
        at = window.to_view(env._seen.camera.to_pixels(positions[corner]))
        numbers.append(at / (SIDE - 1) * 2 - 1)
    true = np.concatenate([*numbers, *numbers]).astype(np.float32)
    _, reward, done, cut, _ = env.step(true)
    assert reward > 0.6
    assert not done
    assert not cut
    _, reward, done, _, _ = env.step(np.zeros(8, np.float32))
    assert reward < 0.6
    assert done


def test_goals_seen_from_above_are_those_of_the_ideal(env):
    task = suite("polyfold70").task("tshirt-block-left-first")
    garment = plugins.generate_garment("tshirt", 1000, COARSE)
    episode = attempt(
        "", garment, 1000, polyfold.Experiment.of(agent="fold-lines", policy="affordance-pair"), task=task.id
    )
    goals = goals_of(task, episode.initial_state)
    assert len(goals) == 3
    apart = np.linalg.norm(goals[-1][:, :2] - episode.final_state.positions[:, :2], axis=1)
    assert np.median(apart) < 0.02


def test_particles_are_spread_and_stand_in_the_same_order_for_every_garment():
    for kind in ("square", "tshirt"):
        mesh = plugins.generate_garment(kind, 0, COARSE).mesh
        chosen = farthest_first(mesh.vertices, PARTICLES)
        assert len(chosen) == PARTICLES
        simulator = plugins.create("simulators", "xpbd")
        seen = simulator.reset(plugins.generate_garment(kind, 0, COARSE), 0)
        mask = plugins.create("segmenters", "colour").segment(seen)
        state = simulator.state()
        view = TaskView(mesh, Window.around(mask))
        shown = view.observation(seen, mask, state, state.positions)
        now, wanted = shown["particles"].reshape(2, PARTICLES, 2)
        assert (now == wanted).all()
        assert np.abs(now).max() < 1.0, "all of the garment is in the window"
        assert now[:10, 1].mean() > now[-10:, 1].mean(), "the bottom first; y points down"
        assert (shown["image"][1] > 0.5).mean() == pytest.approx((shown["image"][2] > 0.5).mean(), abs=0.02)
        simulator.close()


def test_it_trains_goes_on_where_it_was_killed_and_folds(tmp_path, monkeypatch):
    weights = reinforce(TINY, tmp_path / "whole", "cpu", progress=False)
    saved = reinforcing._save

    def killed(model, path, told):
        saved(model, path, told)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(reinforcing, "_save", killed)
        with pytest.raises(KeyboardInterrupt):
            reinforce(TINY, tmp_path / "killed", "cpu", progress=False)
    again = reinforce(TINY, tmp_path / "killed", "cpu", progress=False)
    lines = (tmp_path / "killed" / "metrics.jsonl").read_text().splitlines()
    assert [json.loads(line)["passes"] for line in lines] == [8, 16]
    told = load(again, "ppo", Ppo.network)
    assert told.config["passes"] == 16
    first = load(weights, "ppo", Ppo.network).network.state_dict()
    assert all(torch.isfinite(value).all() for value in first.values())
    with pytest.raises(ConfigError, match="another training"):
        reinforce(TINY.model_copy(update={"seed": 1}), tmp_path / "killed", "cpu", progress=False)
    experiment = polyfold.Experiment.of(agent={"name": "ppo", "weights": str(again)}, guidance="steps")
    cloth = polyfold.garment("square", seed=1001, edge_length=COARSE)
    episode = attempt("", cloth, 1001, experiment, task="square-corner-bottom_left")
    assert episode.privileged
    assert len(episode.steps) == 1
    assert len(episode.steps[0].action.picks) == 2


def test_what_it_takes_and_does_not_take_is_told(tmp_path, capsys):
    from polyfold.cli import main

    assert main(["fit", "ppo", "--demos", "here", "--out", str(tmp_path)]) == 1
    assert "takes no --demos" in capsys.readouterr().err
    assert main(["fit", "bifold", "--out", str(tmp_path)]) == 1
    assert "give their folder with --demos" in capsys.readouterr().err
