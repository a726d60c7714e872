"""The cloth as a graph, and what points say as a map."""

import pytest
import torch
from polyfold_baselines.learning.networks.nodes import Graph, as_map, spread

SIDE = 64


@pytest.fixture
def cloth():
    mask = torch.zeros(2, SIDE, SIDE, dtype=torch.bool)
    mask[0, 10:50, 20:40] = True
    mask[1, 5:9, 5:60] = True
    return mask


def at(indices):
    return torch.stack([indices % SIDE, indices // SIDE], dim=-1).float()


def test_points_lie_on_the_cloth_spread_out_and_the_same_each_time(cloth):
    found = spread(cloth, 30)
    assert torch.equal(found, spread(cloth, 30))
    assert cloth.flatten(1).gather(1, found).all()
    for places in at(found):
        apart = torch.cdist(places, places) + torch.eye(30) * 1e3
        assert apart.min() > 2.0
    corners = torch.tensor([[20.0, 10], [39, 10], [20, 49], [39, 49]])
    assert torch.cdist(corners, at(found)[0]).min(1).values.max() < 6.0


def test_cloth_that_is_small_or_gone_does_not_stop_it():
    mask = torch.zeros(2, SIDE, SIDE, dtype=torch.bool)
    mask[0, 3, 4] = True
    found = spread(mask, 5)
    assert (found[0] == 3 * SIDE + 4).all()
    assert torch.isfinite(as_map(torch.zeros(2, 1, 5), at(found), mask)).all()


def test_a_map_has_the_points_probabilities_and_is_highest_where_they_are(cloth):
    found = spread(cloth, 20)
    logits = torch.randn(2, 2, 20, generator=torch.Generator().manual_seed(0))
    maps = as_map(logits, at(found), cloth)
    likely = maps.flatten(2).softmax(-1)
    best = logits.argmax(-1)
    assert torch.equal(likely.argmax(-1), found.gather(1, best))
    owner = torch.cdist(at(torch.arange(SIDE * SIDE)), at(found)[0]).argmin(-1)
    summed = torch.zeros(20).scatter_add(0, owner, likely[0, 0])
    assert torch.allclose(summed, logits[0, 0].softmax(-1), atol=1e-3)


def test_the_order_of_points_does_not_matter_to_what_is_said_of_each(cloth):
    torch.manual_seed(0)
    graph = Graph(16)
    places = at(spread(cloth, 12))
    heights = torch.rand(2, 12)
    order = torch.randperm(12)
    there, again = graph(places, heights, SIDE), graph(places[:, order], heights[:, order], SIDE)
    assert torch.allclose(there[:, order], again, atol=1e-5)
