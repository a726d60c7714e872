"""Real cloth: a tilted camera, planned arms, a person who agrees, and no state that anybody knows."""

import io
import json
import logging

import numpy as np
import pytest
from polyfold_pybullet.real.overhead import Overhead
from real_world import CENTRE, INTRINSICS, TURN, World, components, tilted

import polyfold
from polyfold import plugins
from polyfold.errors import ConfigError, RobotError, SimulationError
from polyfold.geometry import Camera
from polyfold.plugins.hardware import RgbdFrame
from polyfold.types import Action

VIEW = {"extent": 0.7, "centre": CENTRE, "turn_deg": float(np.degrees(TURN))}


@pytest.fixture
def world():
    made = World()
    tripod, arms = components(made)
    plugins.register("cameras", "tripod", tripod)
    plugins.register("robots", "careful", arms)
    yield made
    plugins.unregister("cameras", "tripod")
    plugins.unregister("robots", "careful")


def cell(**params):
    return plugins.create(
        "simulators", "real-cell", {"camera": "tripod", "robot": "careful", "confirm": "never", **VIEW, **params}
    )


def folded(world, said="fold it in half from bottom to top", **params):
    simulator = {"name": "real-cell", "camera": "tripod", "robot": "careful", **VIEW, "confirm": "never", **params}
    experiment = polyfold.Experiment(simulator=simulator)
    return polyfold.fold(said, world.garment, experiment=experiment)


def says(monkeypatch, *lines):
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in lines)))


def test_a_sentence_folds_cloth_that_only_a_camera_sees(world):
    before = world.cloth.state()
    episode = folded(world)
    assert len(world.moves) == len(episode.steps) == 1
    assert not episode.initial_state.known
    assert episode.fidelity.reference == "outline"
    assert episode.fidelity.iou > 0.93
    assert "nobody measured the cloth itself" in episode.fidelity.in_words()
    places = world.cloth.state().keypoint_positions()
    for bottom, top in (("bottom_left", "top_left"), ("bottom_right", "top_right")):
        meant = before.keypoint_positions()[top]
        assert np.linalg.norm(places[bottom][:2] - meant[:2]) < 0.03
    assert episode.show().ndim == 3


def test_a_tilted_camera_becomes_one_that_looks_straight_down(world):
    simulator = cell()
    seen = simulator.reset(world.garment, 0)
    true = world.cloth.state()
    pixels = true.keypoint_positions()
    mask = plugins.create("segmenters", "colour").segment(seen)
    for point in pixels.values():
        column, row = seen.camera.to_pixels(point)
        near = mask[int(row) - 4 : int(row) + 5, int(column) - 4 : int(column) + 5]
        assert 0.02 < near.mean() < 0.9, "a corner of the towel is at an edge of the mask"
    heights = seen.camera.elevation - seen.depth
    assert np.abs(np.nanmedian(heights[~mask])) < 0.0005
    simulator.close()


@pytest.mark.parametrize("turn", [0.0, 2.0])
def test_points_go_to_the_robots_world_and_back(turn):
    view = Overhead(Camera.framing(0.6), (0.4, -0.1), turn, 0.05)
    pixels, heights = np.array([[199.5, 199.5], [300.0, 120.0]]), np.array([0.0, 0.02])
    found = view.places(pixels, heights)
    assert np.allclose(found[0], [0.4, -0.1, 0.05])
    assert found[1, 2] == pytest.approx(0.07)
    assert np.hypot(*(found[1] - found[0])[:2]) == pytest.approx(np.hypot(*view.camera.to_world(pixels[1], 0.02)[:2]))


def test_nothing_moves_before_a_person_agrees(world, monkeypatch, capsys):
    says(monkeypatch)
    with pytest.raises(RobotError, match="nobody is there to agree"):
        folded(world, confirm="each")
    assert "Lay the rectangle flat" in capsys.readouterr().err
    says(monkeypatch, "", "q")
    with pytest.raises(RobotError, match="stopped by hand"):
        folded(world, confirm="each")
    assert not world.moves


def test_a_fold_that_is_skipped_leaves_the_cloth(world, monkeypatch, caplog):
    says(monkeypatch, "", "s", "s", "s", "s", "s")
    with caplog.at_level(logging.WARNING):
        folded(world, confirm="each")
    assert "it was skipped by hand" in caplog.text
    assert not world.moves


def test_a_dry_run_says_what_would_be_done_and_moves_nothing(world, caplog):
    with caplog.at_level(logging.WARNING):
        folded(world, dry_run=True)
    assert "dry run; it would be done" in caplog.text
    assert not world.moves


def test_a_camera_that_dies_ends_the_episode_with_what_was_done_and_nothing_moving(world):
    world.dies_after = 2
    with pytest.raises(RobotError, match="gave no picture"):
        folded(world)
    assert len(world.moves) == 1
    assert world.stops


def test_an_error_while_moving_stops_the_arms(world, monkeypatch):
    simulator = cell()
    simulator.reset(world.garment, 0)

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(simulator._robot, "execute", interrupted)
    pixels = simulator.observe().camera.to_pixels(np.array([[0.0, -0.1], [0.0, 0.05]]))
    with pytest.raises(KeyboardInterrupt):
        simulator.execute(Action(pixels[:1], pixels[1:]))
    assert world.stops == 1
    simulator.close()


def test_a_camera_that_looks_elsewhere_is_told_so(world):
    world.pose = tilted(seen=(0.5, 0.4))
    with pytest.raises(RobotError, match=r"the camera sees \d+% of the view; move the view"):
        folded(world)
    assert not world.moves


def test_holes_in_the_depth_leave_the_fold_out_and_say_why(world, caplog):
    simulator = cell()
    simulator.reset(world.garment, 0)
    whole = world.frame

    def holed():
        frame = whole()
        depth = frame.depth.copy()
        depth[200:330, 200:440] = np.nan
        return RgbdFrame(frame.rgb, depth, frame.intrinsics, frame.extrinsics)

    world.frame = holed
    with caplog.at_level(logging.WARNING):
        simulator.execute(Action(np.array([[200.0, 200.0]]), np.array([[200.0, 120.0]])))
    assert "there is no depth around the pixel" in caplog.text
    assert not world.moves
    simulator.close()


def test_real_cloth_can_not_be_put_back_or_studied(world):
    simulator = cell()
    with pytest.raises(SimulationError, match="can't be put back"):
        simulator.restore(simulator.state())
    study = polyfold.Study(name="s", base={"simulator": {"name": "real-cell", "camera": "tripod", "robot": "careful"}})
    with pytest.raises(ConfigError, match="folds on a real table"):
        polyfold.run(study, "unused")


def test_the_file_of_a_calibration_is_used_and_a_wrong_one_named(world, tmp_path):
    file = tmp_path / "camera.json"
    file.write_text(json.dumps({"intrinsics": INTRINSICS.tolist(), "pose": world.pose.tolist()}))
    simulator = cell(calibration=str(file))
    assert simulator.reset(world.garment, 0).rgb.shape == (400, 400, 3)
    simulator.close()
    for content in ("{", "{}", '{"intrinsics": 1, "pose": 2}'):
        file.write_text(content)
        with pytest.raises(ConfigError, match="is no calibration"):
            cell(calibration=str(file))
    with pytest.raises(ConfigError, match="can't be read"):
        cell(calibration=str(tmp_path / "missing.json"))
