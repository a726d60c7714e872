"""Dynamics of visible cloth: nodes of what is seen, which are joined, where they go, and the drag that is best."""

import json

import numpy as np
import pytest
import torch
from polyfold_baselines.agents.searching.shooting import best_drag, chamfer
from polyfold_baselines.agents.searching.vcd import Vcd
from polyfold_baselines.demos.store import Demos
from polyfold_baselines.demos.window import SIDE, in_view, on_table
from polyfold_baselines.learning import learner
from polyfold_baselines.learning.dynamics.graphs import NODES, nearest_of, nodes_of
from polyfold_baselines.learning.dynamics.network import VisibleDynamics, evenly
from polyfold_baselines.learning.dynamics.training import DynamicsConfig, _varied, fit_dynamics
from polyfold_baselines.learning.dynamics.transitions import make_transitions
from polyfold_baselines.learning.weights import load

import polyfold
from polyfold import plugins
from polyfold.api import attempt
from polyfold.cli import main
from polyfold.errors import ConfigError, GroundingError

EXTENT = 0.5
SMALL = {"row": "vcd", "batch": 8, "width": 32, "depth": 2, "learning_rate": 5e-3}


@pytest.fixture(scope="module")
def transitions(dragged):
    return make_transitions(Demos.read(dragged), progress=False)


@pytest.fixture(scope="module")
def fitted(dragged, tmp_path_factory):
    config = DynamicsConfig(demos=str(dragged), passes=1200, **SMALL)
    return fit_dynamics(config, Vcd, tmp_path_factory.mktemp("vcd"), "cpu", progress=False)


def square(low, high):
    mask = np.zeros((SIDE, SIDE), bool)
    mask[low:high, low:high] = True
    return mask


def test_nodes_lie_on_the_cloth_spread_out_and_as_high_as_it_is():
    mask = square(20, 100)
    heights = np.where(np.arange(SIDE) > 60, 0.01, 0.001) * mask
    nodes = nodes_of(heights, mask, EXTENT)
    assert nodes.shape == (NODES, 3)
    column, row = in_view(nodes[:, :2], EXTENT).round().astype(int).T
    assert mask[row, column].all()
    assert set(nodes[:, 2]) == {0.001, 0.01}
    apart = np.linalg.norm(nodes[:, None, :2] - nodes[None, :, :2], axis=-1)[
        np.arange(NODES)[:, None], nearest_of(nodes)
    ]
    even = 80 * EXTENT / SIDE / np.sqrt(NODES)
    assert (apart[:, 0] > 0.6 * even).all()
    assert (np.diff(apart, axis=1) >= -1e-3).all()
    one = nodes_of(heights, square(64, 65), EXTENT)
    assert np.allclose(one[:, :2], on_table([64, 64], EXTENT))
    with pytest.raises(GroundingError, match="no cloth is left in the view"):
        nodes_of(heights, square(0, 0), EXTENT)


def test_what_lies_flat_is_joined_and_what_is_gripped_goes_along(transitions, dragged):
    learned, held = transitions
    columns = Demos.read(dragged).columns
    assert len(learned) + len(held) == len(columns["step"])
    flat = (learned.nodes[..., 2] < 0.001).all(1)
    assert 3 <= flat.sum() < len(learned)
    assert learned.joined[flat].all()
    assert 0.5 < float(learned.joined[~flat].float().mean()) < 0.97
    gripped = VisibleDynamics.gripped(learned.nodes, learned.picks)
    assert gripped.any(1).all()
    carried = (learned.ends - learned.nodes)[..., :2] - (learned.places - learned.picks)[:, None]
    assert carried[gripped].norm(dim=-1).median() < 0.03
    assert carried[~gripped].norm(dim=-1).median() > 2 * carried[gripped].norm(dim=-1).median()


def test_joined_cloth_is_as_far_apart_as_its_way_over_the_seam(tmp_path, dragged):
    from polyfold_baselines.demos.cloths import Cloth

    mesh = plugins.generate_garment("tshirt", 1, 0.05).mesh
    shard = {"particles": np.zeros((2, len(mesh.vertices), 3)), "rest": mesh.vertices, "extent": np.array(1.0)}
    cloth = Cloth.of(slice(0, 1), {**shard, "layer": mesh.layer, "seam": mesh.seam})
    front = np.flatnonzero((mesh.layer == 1) & ~mesh.seam)
    back = np.flatnonzero((mesh.layer == 0) & ~mesh.seam)
    there = np.array([back[np.argmin(np.hypot(*(mesh.vertices[back] - mesh.vertices[k]).T))] for k in front])
    to_seam = np.linalg.norm(mesh.vertices[front][:, None] - mesh.vertices[mesh.seam], axis=-1).min(1)
    assert (cloth.apart_at_rest(front, there) > 2 * to_seam - 0.05).all()
    assert cloth.apart_at_rest(front, there).max() > 0.2
    assert np.allclose(
        cloth.apart_at_rest(front[:1], front), np.hypot(*(mesh.vertices[front] - mesh.vertices[front[0]]).T)
    )


def test_it_matters_neither_where_the_cloth_lies_nor_which_way_it_is_dragged(transitions):
    torch.manual_seed(0)
    network, drags = VisibleDynamics(16, 2), transitions[0].of(np.arange(4), torch.device("cpu"))
    turn = torch.tensor([[0.8, 0.6], [-0.6, 0.8]])
    shift = torch.tensor([0.05, -0.1])

    def elsewhere(points):
        return torch.cat([points[..., :2] @ turn + shift, points[..., 2:]], dim=-1)

    joined = drags.joined.float()
    near = drags.near.long()
    here = network.ends(drags.nodes, near, joined, drags.picks, drags.places, drags.extents)
    moved = elsewhere(drags.nodes), near, joined, elsewhere(drags.picks), elsewhere(drags.places), drags.extents
    assert torch.allclose(elsewhere(here), network.ends(*moved), atol=1e-5)
    assert (here - drags.nodes).abs().max() > 1e-3


def test_drags_are_varied_as_a_whole(transitions):
    drags = transitions[0].of(np.arange(6), torch.device("cpu"))
    varied = _varied(drags, np.random.default_rng(0))
    sizes = (varied.places - varied.picks).norm(dim=-1) / (drags.places - drags.picks).norm(dim=-1)
    assert sizes.min() > 0.7
    assert sizes.max() < 1.3
    assert sizes.std() > 0.05
    for name in ("nodes", "ends"):
        there, here = (
            torch.cdist(getattr(kept, name)[..., :2], kept.picks[:, None]) for kept in (varied, drags)
        )  # fmt: skip
        assert torch.allclose(there, here * sizes[:, None, None], atol=1e-4)
        assert torch.equal(getattr(varied, name)[..., 2], getattr(drags, name)[..., 2])


def test_it_learns_where_nodes_go_and_tells_plies_apart(fitted, transitions):
    learned, _ = transitions
    weights = load(fitted, "vcd", Vcd.network)
    with torch.inference_mode():
        logits, ends = weights.network.predicted(learned)
    still, wrong = ((where - learned.ends).norm(dim=-1).mean() for where in (learned.nodes, ends))
    assert wrong < 0.5 * still
    right = ((logits > 0) == learned.joined).float()
    assert evenly(right, learned.joined) > 0.7
    assert logits[learned.joined].mean() > logits[~learned.joined].mean() + 1.0
    assert weights.measured["node_error_mm"] < 0.7 * weights.measured["nothing_moves_mm"]
    assert weights.measured["nothing_moves_mm"] > 20


def test_many_drags_are_predicted_as_one_would_be(fitted, transitions):
    network = load(fitted, "vcd", Vcd.network).network
    drags = transitions[1].of(np.arange(1), torch.device("cpu"))
    nodes = drags.nodes[0].double().numpy()
    rng = np.random.default_rng(0)
    picks, places = rng.uniform(-0.2, 0.2, (2, 70, 2))
    picks[66], places[66] = drags.picks[0], drags.places[0]
    with torch.inference_mode():
        _, alone = network.predicted(drags)
    together = network.lands(nodes, picks, places, float(drags.extents[0]))
    assert together.shape == (70, NODES, 3)
    # Of neighbours that are equally far the last may be another, in the other precision.
    assert np.linalg.norm(together[66] - alone[0].numpy(), axis=1).mean() < 1e-3
    assert np.linalg.norm(together[65] - alone[0].numpy(), axis=1).mean() > 1e-2


def fold_of(nodes):
    """A model in which whatever lies before the middle of the drag is turned over it."""

    def lands(picks, places):
        way = (places - picks)[:, None]
        beyond = ((nodes[:, :2] - (picks + places)[:, None] / 2) * way).sum(-1, keepdims=True)
        over = nodes[:, :2] - 2 * np.minimum(beyond, 0.0) / (way**2).sum(-1, keepdims=True).clip(1e-9) * way
        return np.concatenate([over, np.broadcast_to(nodes[:, 2:], (*over.shape[:2], 1))], axis=-1)

    return lands


@pytest.mark.parametrize("corner", [(-1, -1), (1, -1), (1, 1)])
def test_of_a_true_model_it_takes_the_drag_of_the_corner_that_the_goal_moves(corner):
    mask = square(24, 104)
    nodes = nodes_of(mask * 0.001, mask, EXTENT)
    half = np.abs(nodes[:, :2]).max()
    there = half * np.array(corner, float)
    goal = fold_of(nodes)(there[None], np.zeros((1, 2)))[0]
    bounds = np.array([[-1.0, -1.0], [1.0, 1.0]])
    found = best_drag(fold_of(nodes), nodes, goal, 500, EXTENT, bounds, np.random.default_rng(0))
    assert found.cost < 0.4 * chamfer(nodes, goal)
    assert found.cost == pytest.approx(chamfer(fold_of(nodes)(found.pick[None], found.place[None])[0], goal))
    turned, should = ((start + end) / 2 for start, end in ((found.pick, found.place), (there, np.zeros(2))))
    assert np.linalg.norm(turned - should) < 0.4 * half
    assert np.dot(found.place - found.pick, -there) > 0.8 * np.linalg.norm(found.place - found.pick) * np.linalg.norm(
        there
    )


def test_no_place_lies_beyond_its_bounds():
    nodes = nodes_of(square(24, 104) * 0.001, square(24, 104), EXTENT)
    bounds = np.array([[-0.05, -0.05], [0.05, 0.05]])

    def lands(picks, places):
        assert (np.abs(places) <= 0.05).all()
        return np.broadcast_to(nodes, (len(picks), *nodes.shape))

    best_drag(lands, nodes, nodes + np.array([0.1, 0.0, 0.0]), 40, EXTENT, bounds, np.random.default_rng(0))


@pytest.mark.parametrize(("guidance", "folds"), [("steps", 2), ("final", 2)])
def test_it_folds_with_its_picks_on_the_cloth(fitted, guidance, folds):
    agent = {"name": "vcd", "weights": str(fitted), "tries": 60}
    experiment = polyfold.Experiment.of(agent=agent, guidance=guidance)
    cloth = polyfold.garment("square", seed=1001, edge_length=0.022)
    task = "square-triangle-top_left-then-top_right"
    episode, again = (attempt("", cloth, 1001, experiment, task=task) for _ in range(2))
    assert episode.error is None
    assert not episode.privileged
    assert len(episode.steps) == folds
    for step, same in zip(episode.steps, again.steps, strict=True):
        (x, y), *others = step.action.picks.round().astype(int)
        assert not others
        assert plugins.create("segmenters", "colour").segment(step.observation)[y, x]
        assert (step.action.picks == same.action.picks).all()


def test_a_killed_training_goes_on_to_the_same_weights(dragged, tmp_path, monkeypatch):
    monkeypatch.setattr(learner, "LOOK", 2)
    config = DynamicsConfig(demos=str(dragged), passes=48, **{**SMALL, "width": 16})
    straight = fit_dynamics(config, Vcd, tmp_path / "straight", "cpu", progress=False)
    step = learner.Learner._step

    def interrupted(learning, number):
        if number == 3:
            raise KeyboardInterrupt
        return step(learning, number)

    with monkeypatch.context() as patch:
        patch.setattr(learner.Learner, "_step", interrupted)
        with pytest.raises(KeyboardInterrupt):
            fit_dynamics(config, Vcd, tmp_path / "killed", "cpu", progress=False)
    resumed = fit_dynamics(config, Vcd, tmp_path / "killed", "cpu", progress=False)
    one, other = (load(path, "vcd", Vcd.network).network.state_dict() for path in (straight, resumed))
    assert all(torch.equal(one[name], other[name]) for name in one)
    lines = (tmp_path / "killed" / "metrics.jsonl").read_text().splitlines()
    assert [json.loads(line)["passes"] for line in lines] == [16, 32, 48]
    assert json.loads(lines[-1])["edge_accuracy"] > 0


def test_wrong_weights_and_demonstrations_without_particles_are_refused(fitted, demonstrated, tmp_path, capsys):
    segmenter = plugins.create("segmenters", "colour")
    with pytest.raises(ConfigError, match="weights of vcd, not of foldsformer"):
        plugins.create("agents", "foldsformer", {"weights": fitted}, segmenter=segmenter)
    with pytest.raises(ConfigError, match="make them with 'polyfold fit vcd'"):
        plugins.create("agents", "vcd", {"weights": tmp_path / "none"}, segmenter=segmenter)
    (tmp_path / "cut.safetensors").write_bytes(fitted.read_bytes()[:-7])
    with pytest.raises(ConfigError, match="make it again"):
        plugins.create("agents", "vcd", {"weights": tmp_path / "cut.safetensors"}, segmenter=segmenter)
    assert main(["fit", "vcd", "--demos", str(demonstrated), "--out", str(tmp_path / "out")]) == 1
    assert "polyfold demos --agent random-drags" in capsys.readouterr().err
