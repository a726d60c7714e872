"""Masks that are spoilt on purpose: by as much as asked, alike each time, and in one piece."""

import numpy as np
import pytest
from scipy import ndimage

import polyfold
from polyfold import plugins
from polyfold.api import attempt
from polyfold.errors import GroundingError
from polyfold.geometry import Camera
from polyfold.types import Observation

CLOTH = np.zeros((400, 400), bool)
CLOTH[100:300, 90:310] = True


def segmented(cloth=CLOTH, name="noisy", **config):
    rgb = np.where(cloth[..., None], [200, 30, 60], [90, 90, 90]).astype(np.uint8)
    picture = Observation(rgb, np.ones(cloth.shape, np.float32), Camera())
    return plugins.create("segmenters", name, config).segment(picture)


def edge_error(mask):
    """How far the outline is from the true one, root mean square [px]."""
    away = ndimage.distance_transform_edt(CLOTH) + ndimage.distance_transform_edt(~CLOTH)
    outline = mask & ~ndimage.binary_erosion(mask)
    return float(np.sqrt((away[outline] ** 2).mean()))


def test_without_noise_the_mask_stays_as_it_is():
    assert (segmented() == segmented(name="colour")).all()


@pytest.mark.parametrize("edge_px", [2.0, 5.0])
def test_the_outline_wavers_by_so_much_and_alike_each_time(edge_px):
    mask = segmented(edge_px=edge_px)
    assert 0.6 * edge_px < edge_error(mask) < 1.6 * edge_px + 1
    assert (mask == segmented(edge_px=edge_px)).all()
    assert ndimage.label(mask)[1] == 1


def test_tears_take_cloth_from_the_edge_only():
    mask = segmented(tears=10, tear_px=8.0)
    assert not (mask & ~CLOTH).any()
    assert 0.5 * 10 * 100 < (CLOTH & ~mask).sum() < 10 * 201, "half a disk each, if they don't overlap"
    deep = ndimage.binary_erosion(CLOTH, iterations=10)
    assert mask[deep].all()


def test_a_coarse_mask_is_made_of_squares():
    mask = segmented(coarse_px=16)
    assert (mask.reshape(25, 16, 25, 16).all(axis=(1, 3)) == mask.reshape(25, 16, 25, 16).any(axis=(1, 3))).all()
    assert (mask != CLOTH).any()


def test_more_noise_than_cloth_is_refused():
    ribbon = np.zeros_like(CLOTH)
    ribbon[195:205, 100:300] = True
    with pytest.raises(GroundingError, match="less noise"):
        segmented(ribbon, tears=50, tear_px=50.0)


def test_what_was_folded_by_a_spoilt_mask_is_measured_by_a_true_one():
    cloth = polyfold.garment("square", seed=3, edge_length=0.03)
    spoilt = {"name": "noisy", "params": {"coarse_px": 40}}
    experiment = polyfold.Experiment.of(agent="oracle", segmenter=spoilt)
    episode = attempt("", cloth, 3, experiment, task="square-corner-top_left")
    assert episode.fidelity.iou > 0.95
    assert episode.fidelity.iou > iou_of_squares(episode) + 0.02


def iou_of_squares(episode):
    from polyfold.geometry import iou

    true, spoilt = (
        plugins.create("segmenters", name, config).segment(episode.final)
        for name, config in (("colour", {}), ("noisy", {"coarse_px": 40}))
    )
    return iou(true, spoilt)
