"""The cell's pictures with texture, light and shadows, and a camera that was pushed."""

import numpy as np
import pytest
from polyfold_pybullet.looking import Eye, Surface, levelled
from polyfold_pybullet.scenery import PaintedCell, Scenery
from scipy.spatial.transform import Rotation

from polyfold import plugins
from polyfold.errors import ConfigError
from polyfold.geometry import Camera, iou
from polyfold.types import Action


@pytest.fixture(scope="module")
def seen():
    simulator = plugins.create("simulators", "xpbd", {"elevation": 0.9})
    return simulator.reset(plugins.generate_garment("rectangle", 2002, 0.03), 1)


def painted(seen, seed=0, **scenery):
    return PaintedCell(Scenery(**scenery), *seen.depth.shape, seed).paint(seen)


def cloth(seen):
    return seen.camera.elevation - seen.depth > 1e-5


def test_nothing_is_changed_unless_asked_for(seen):
    assert painted(seen) is seen


@pytest.mark.parametrize("table", ["wood", "marble", "plain"])
def test_a_table_is_painted_around_the_cloth_and_the_same_in_every_picture(seen, table):
    cell = PaintedCell(Scenery(table=table), *seen.depth.shape, 3)
    first, second = cell.paint(seen), cell.paint(seen)
    assert (first.rgb == second.rgb).all()
    assert (first.rgb[cloth(seen)] == seen.rgb[cloth(seen)]).all()
    assert first.rgb[~cloth(seen)].std() > 1.0
    assert (painted(seen, 4, table=table).rgb != first.rgb).any()


def test_light_falls_off_and_shadows_darken_by_as_much_as_asked(seen):
    table = ~cloth(seen)
    before = seen.rgb[table].astype(float).mean(axis=1)
    for setting in ("uneven", "shadow"):
        after = painted(seen, **{setting: 0.5}).rgb[table].astype(float).mean(axis=1)
        assert 0.48 < (after / before).min() < 0.56
        assert (after / before).max() > 0.97


def test_grain_differs_from_picture_to_picture(seen):
    cell = PaintedCell(Scenery(grain=5.0), *seen.depth.shape, 0)
    first, second = cell.paint(seen), cell.paint(seen)
    middle = (seen.rgb > 40) & (seen.rgb < 215)
    assert (first.rgb.astype(float) - second.rgb)[middle].std() == pytest.approx(5.0 * np.sqrt(2), rel=0.15)


def test_the_segmenter_for_photographs_sees_the_cloth_through_all_of_it(seen):
    worst = painted(seen, table="wood", uneven=0.3, shadow=0.3, grain=5.0)
    mask = plugins.create("segmenters", "photo").segment(worst)
    assert iou(mask, cloth(seen)) > 0.95


def test_a_push_moves_the_camera_by_as_much_as_told():
    eye = Eye.true(Camera(elevation=0.9))
    pushed = eye.after_a_push(0.005, np.radians(1.0), 3)
    assert np.linalg.norm(pushed.pose[:3, 3] - eye.pose[:3, 3]) == pytest.approx(0.005)
    turned = eye.pose[:3, :3].T @ pushed.pose[:3, :3]
    assert np.degrees(np.arccos((np.trace(turned) - 1) / 2)) == pytest.approx(1.0)
    assert np.allclose(eye.after_a_push(0.0, 0.0, 3).pose, eye.pose)


@pytest.mark.parametrize("turn_deg", [1.0, 4.0])
def test_a_tilted_camera_is_levelled_by_the_table_that_it_sees(seen, turn_deg):
    eye = Eye.true(seen.camera)
    surface = Surface.of(seen.depth)
    pixels = np.array([[120.0, 300.0], [280.0, 140.0]])
    depths = surface.table @ np.column_stack([np.ones(2), pixels]).T
    due = eye.places(pixels, depths)
    about = np.array([np.cos(0.7), np.sin(0.7), 0.0])
    off = np.eye(4)
    off[:3, :3] = Rotation.from_rotvec(np.radians(turn_deg) * about).as_matrix()
    off[2, 3] = 0.004
    tilted = Eye(eye.intrinsics, eye.pose @ off)
    assert np.abs(tilted.places(pixels, depths) - due).max() > 0.01
    found, tilt = levelled(tilted, surface, np.radians(0.7))
    assert np.degrees(tilt) == pytest.approx(turn_deg, abs=0.01)
    assert np.abs(found.places(pixels, depths) - due).max() < 0.0005
    assert levelled(eye, surface, np.radians(0.7)) == (eye, pytest.approx(0.0, abs=1e-4))


def test_a_cell_says_that_its_camera_was_tilted_and_folds_all_the_same(caplog):
    exact = {"disparity_noise": 0, "quantum": 0, "bias": 0.0005, "dropouts": 0, "edge_px": 0}
    simulator = plugins.create("simulators", "pybullet", {"views": 0, "noise": exact, "moved_deg": 2.0})
    simulator.reset(plugins.generate_garment("rectangle", 2002, 0.03), 1)
    corners = simulator.state().keypoint_pixels()
    picks = np.array([corners["bottom_left"], corners["bottom_right"]])
    simulator.execute(Action(picks, np.array([corners["top_left"], corners["top_right"]])))
    assert "tilted by" in caplog.text
    (fold,) = simulator.state().extra["cell"]
    simulator.close()
    assert fold["mode"] in ("at once", "in sequence")


def test_a_cell_takes_scenery_and_refuses_what_it_is_not():
    simulator = plugins.create("simulators", "pybullet", {"scenery": {"table": "wood"}, "views": 0})
    seen = simulator.reset(plugins.generate_garment("rectangle", 2002, 0.03), 1)
    assert seen.rgb[:20].std() > 3.0
    simulator.close()
    with pytest.raises(ConfigError, match="table"):
        plugins.create("simulators", "pybullet", {"scenery": {"table": "glass"}})
