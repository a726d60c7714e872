"""Rewards: an ideal fold gets 1, doing nothing 0, by silhouette and by particles."""

import numpy as np
import pytest
from drawn_scenes import SQUARE, TSHIRT, model_of, scene_of
from polyfold_fgpnp.data.outcomes import contour_reward, expect, particle_reward
from polyfold_fgpnp.policies.region import fold_region

from polyfold.geometry import Camera, FoldLine
from polyfold.types import SimState

CAMERA = Camera()


def laid_out(mask):
    """Particles on a grid over a mask."""
    y, x = np.nonzero(mask)
    kept = (x % 6 == 0) & (y % 6 == 0)
    return state_at(np.column_stack([x, y])[kept].astype(float))


def state_at(pixels):
    return SimState(CAMERA.to_world(pixels), np.zeros((len(pixels), 3)), {}, CAMERA)


CASES = {
    "square, half": (SQUARE, FoldLine((200, 350), (200, 50))),
    "square, slanted": (SQUARE, FoldLine((120, 350), (260, 50))),
    "t-shirt, sleeve": (TSHIRT, FoldLine((135, 180), (130, 85))),
    "t-shirt, hem": (TSHIRT, FoldLine((280, 230), (120, 230))),
}


@pytest.mark.parametrize(("corners", "line"), CASES.values(), ids=CASES)
def test_ideal_fold_gets_1_and_doing_nothing_0(corners, line):
    scene = scene_of(model_of(corners))
    region = fold_region(line, scene)
    before = laid_out(scene.mask)
    expectation = expect(region, scene.mask, before)
    pixels = CAMERA.to_pixels(before.positions)
    x, y = pixels.round().astype(int).T
    flap = line.lifts(pixels) & region.mask[y, x]
    ideal = expectation.judge(expectation.mask, state_at(np.where(flap[:, None], line.mirror(pixels), pixels)))
    nothing = expectation.judge(scene.mask, before)
    assert ideal.iou == 1
    assert particle_reward(ideal.error_mm, expectation.travel_mm) == pytest.approx(1, abs=1e-6)
    assert particle_reward(nothing.error_mm, expectation.travel_mm) == pytest.approx(0, abs=1e-6)
    assert contour_reward(ideal.chamfer_px, expectation.idle_chamfer_px) == pytest.approx(1, abs=1e-6)
    assert contour_reward(nothing.chamfer_px, expectation.idle_chamfer_px) == pytest.approx(0, abs=1e-6)
    assert ideal.rest_mm == pytest.approx(0, abs=1e-6)


def test_dragged_cloth_counts_as_displacement_of_the_rest():
    scene = scene_of(model_of(SQUARE))
    before = laid_out(scene.mask)
    expectation = expect(fold_region(CASES["square, half"][1], scene), scene.mask, before)
    dragged = CAMERA.to_pixels(before.positions) + np.array([12, 0])
    after = expectation.judge(scene.mask, state_at(dragged))
    assert after.rest_mm == pytest.approx(1000 * 12 / CAMERA.pixels_per_metre)


def test_cloth_that_left_the_picture_is_as_bad_as_can_be():
    scene = scene_of(model_of(SQUARE))
    before = laid_out(scene.mask)
    expectation = expect(fold_region(CASES["square, half"][1], scene), scene.mask, before)
    gone = expectation.judge(np.zeros_like(scene.mask), before)
    assert contour_reward(gone.chamfer_px, expectation.idle_chamfer_px) < -5
