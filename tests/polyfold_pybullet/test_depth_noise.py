"""The noise of a stereo depth camera, as it is seen in its pictures."""

import numpy as np
import pytest
from polyfold_pybullet.depth_noise import DepthNoise, NoisyDepth

SIZE = (240, 320)
EXACT = {"disparity_noise": 0, "quantum": 0, "bias": 0, "edge_px": 0, "dropouts": 0}


def flat(depth):
    return np.full(SIZE, depth, np.float32)


def camera(seed=0, **constants):
    return NoisyDepth(DepthNoise(**constants), *SIZE, seed)


def test_without_any_noise_depth_stays_as_it_is():
    depth = np.random.default_rng(0).uniform(0.5, 1.5, SIZE).astype(np.float32)
    np.testing.assert_allclose(camera(**EXACT).measure(depth), depth, rtol=1e-6)


@pytest.mark.parametrize(("depth", "deviation"), [(1.0, 0.0025), (0.7, 0.0012), (2.0, 0.01)])
def test_noise_grows_with_the_square_of_the_distance(depth, deviation):
    measured = camera(bias=0, dropouts=0).measure(flat(depth))
    assert measured.std() == pytest.approx(deviation, rel=0.15)
    assert measured.mean() == pytest.approx(depth, abs=deviation / 3)
    assert DepthNoise().deviation(depth) == pytest.approx(deviation, rel=0.05)


def test_disparity_comes_in_steps_of_a_32nd_of_a_pixel():
    steps = 32 * 640 * 0.05 / camera(bias=0, dropouts=0).measure(flat(0.9)).astype(float)
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-3)
    assert len(np.unique(np.round(steps))) > 5


def test_neighbours_err_alike_and_distant_pixels_do_not():
    error = camera(bias=0, dropouts=0).measure(flat(1.0)) - 1.0
    assert np.corrcoef(error[:, :-1].ravel(), error[:, 1:].ravel())[0, 1] > 0.6
    assert abs(np.corrcoef(error[:, :-20].ravel(), error[:, 20:].ravel())[0, 1]) < 0.1


def test_the_part_that_stays_is_not_averaged_away():
    made = camera(bias=0, dropouts=0, fixed_share=0.4)
    one, other = (made.measure(flat(1.0)) - 1.0 for _ in range(2))
    assert np.corrcoef(one.ravel(), other.ravel())[0, 1] == pytest.approx(0.4, abs=0.08)
    assert made.measure(flat(1.0), frames=30).std() == pytest.approx(np.sqrt(0.4) * 0.0025, rel=0.2)


def test_a_plane_is_off_by_a_plane_that_stays_with_the_camera():
    constants = {**EXACT, "bias": 0.0015}
    errors = [camera(seed, **constants).measure(flat(1.0)) - 1.0 for seed in range(40)]
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(0.0015, rel=0.3)
    first = errors[0].astype(float)
    np.testing.assert_allclose(np.diff(first, n=2, axis=0), 0, atol=1e-6)
    np.testing.assert_allclose(np.diff(first, n=2, axis=1), 0, atol=1e-6)


def test_depth_is_missing_along_steps_and_here_and_there_and_where_nothing_is_seen():
    depth = flat(1.0)
    depth[:, 160:] = 0.9
    depth[100:110, 10:20] = 0.0
    missing = np.isnan(camera(dropouts=0.005).measure(depth))
    assert missing[:, 158:162].all()
    assert missing[100:110, 10:20].all()
    assert missing[:, 200:].mean() == pytest.approx(0.005, rel=0.4)
    cloth = flat(1.0)
    cloth[:, 160:] -= 0.003
    assert not np.isnan(camera(dropouts=0).measure(cloth)).any(), "a ply of cloth is no edge"


def test_the_same_seed_gives_the_same_pictures():
    one, other = (camera(seed=7).measure(flat(1.0)) for _ in range(2))
    np.testing.assert_array_equal(one, other)
    assert np.nanmax(np.abs(one - camera(seed=8).measure(flat(1.0)))) > 0.001
