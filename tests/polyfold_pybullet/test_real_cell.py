"""Real cloth: a tilted camera, planned arms, a person who agrees, and no state that anybody knows."""

import io
import json
import logging
import os
import signal

import numpy as np
import pytest
from PIL import Image
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


class Terminal(io.StringIO):
    """Somebody who types, at a terminal."""

    def isatty(self):
        return True


def says(monkeypatch, *lines, stdin=Terminal):
    monkeypatch.setattr("sys.stdin", stdin("".join(f"{line}\n" for line in lines)))


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


@pytest.mark.parametrize("turn", [0.0, 0.7, -2.0])
def test_pixels_go_to_the_robots_world_where_a_camera_sees_them(turn):
    """By a ray of its own: what lies at the place that a pixel stands for is seen at the pixel of the tilted camera."""
    view = Overhead(Camera.framing(0.4), (0.03, 0.02), turn)
    places = view.places([[199.5, 199.5], [300.0, 120.0]], [0.0, 0.02])
    assert np.allclose(places[0], [0.03, 0.02, 0.0])
    across, up, _ = view.camera.to_world([300.0, 120.0], 0.02)
    x, y = across * np.cos(turn) - up * np.sin(turn), across * np.sin(turn) + up * np.cos(turn)
    assert np.allclose(places[1], [0.03 + x, 0.02 + y, 0.02])


@pytest.mark.parametrize("height", [0.0, 0.04])
def test_what_stands_high_is_found_where_it_is(height):
    """A square block under a tilted camera: each ray is followed down until it meets the block's top or side."""
    pose, half = tilted(20.0), 0.06
    rows, columns = np.indices((480, 640))
    rays = np.stack([columns, rows, np.ones_like(rows)], axis=-1) @ np.linalg.inv(INTRINSICS).T @ pose[:3, :3].T

    measured, met = -pose[2, 3] / rays[..., 2], np.zeros((480, 640), bool)
    for level in np.linspace(height, 0.0, 81):
        depth = (level - pose[2, 3]) / rays[..., 2]
        points = pose[:3, 3] + rays * depth[..., None]
        meets = (np.abs(points[..., :2] - CENTRE) <= half).all(axis=-1) & ~met
        measured[meets], met = depth[meets], met | meets
    rgb = np.where(met[..., None], np.uint8(20), np.uint8(220)).repeat(3, axis=-1)
    view = Overhead(Camera.framing(0.4), CENTRE, 0.0)
    seen = view.observe(RgbdFrame(rgb, measured.astype(np.float32), INTRINSICS, pose))
    block = seen.rgb[..., 0] < 100
    scale = view.camera.focal / (view.camera.elevation - height)
    found = np.argwhere(block)
    assert np.ptp(found, axis=0) == pytest.approx([2 * half * scale] * 2, abs=4.0)
    assert found.mean(axis=0) == pytest.approx([199.5, 199.5], abs=2.0)
    heights = view.camera.elevation - seen.depth
    assert np.nanmedian(heights[block]) == pytest.approx(height, abs=1e-4)


@pytest.mark.parametrize("stdin", [io.StringIO, Terminal])
def test_nothing_moves_before_a_person_agrees(world, monkeypatch, capsys, stdin):
    says(monkeypatch, *(["y", "y"] if stdin is io.StringIO else ["", "y"]), stdin=stdin)
    with pytest.raises(RobotError, match="nobody is at a terminal" if stdin is io.StringIO else "not agreed to"):
        folded(world, confirm="each")
    assert ("Lay the rectangle flat" in capsys.readouterr().err) == (stdin is Terminal)
    assert not world.moves
    assert not world.parked


def test_no_terminal_at_all_is_no_consent(world, monkeypatch):
    monkeypatch.setattr("sys.stdin", None)
    with pytest.raises(RobotError, match="nobody is at a terminal"):
        folded(world, confirm="start")


def test_each_fold_is_shown_and_asked_for(world, monkeypatch, capsys, tmp_path):
    says(monkeypatch, "y", "hm", "y")
    folded(world, confirm="each", picture=str(tmp_path / "next.png"), film=str(tmp_path / "new" / "next.gif"))
    assert world.moves == ["at once"]
    assert (tmp_path / "next.png").stat().st_size > 1000
    with Image.open(tmp_path / "new" / "next.gif") as film:
        assert film.n_frames > 10
    assert "y or q" in capsys.readouterr().err
    says(monkeypatch, "y", "q")
    with pytest.raises(RobotError, match="not agreed to"):
        folded(world, confirm="each")
    assert len(world.moves) == 1


def test_cloth_that_was_moved_while_the_person_thought_is_not_folded_by_an_old_plan(world, monkeypatch, caplog):
    class Mover(Terminal):
        def readline(self, *_):
            if world.looked == 2:
                world.cloth.execute(Action(np.array([[200.0, 200.0]]), np.array([[240.0, 150.0]])))
            return super().readline()

    says(monkeypatch, *["y"] * 9, stdin=Mover)
    with caplog.at_level(logging.WARNING):
        folded(world, confirm="each")
    assert "the picture changed while you were asked" in caplog.text


def test_a_dry_run_says_what_would_be_done_and_moves_nothing(world):
    with pytest.raises(RobotError, match="dry run, nothing moved: it would fold at once in"):
        folded(world, dry_run=True, confirm="each")
    assert not world.moves
    assert not world.parked


def test_a_table_that_is_not_where_the_robot_thinks_is_refused(world):
    world.pose[2, 3] += 0.03
    told = world.pose.copy()
    told[2, 3] -= 0.03
    true = world.frame

    def off():
        frame = true()
        return RgbdFrame(frame.rgb, frame.depth, frame.intrinsics, told)

    world.frame = off
    with pytest.raises(RobotError, match=r"the table is measured -?\d+ mm from where"):
        folded(world)
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

    monkeypatch.setattr(simulator.robot, "execute", interrupted)
    pixels = simulator.observe().camera.to_pixels(np.array([[0.0, -0.1], [0.0, 0.05]]))
    with pytest.raises(KeyboardInterrupt):
        simulator.execute(Action(pixels[:1], pixels[1:]))
    assert world.stops == 1
    simulator.close()


def test_a_camera_that_looks_elsewhere_is_told_so(world):
    world.pose = tilted(seen=(0.5, 0.4))
    with pytest.raises(RobotError, match=r"the camera sees [\d.]+ % of the view; move the view"):
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


def test_real_cloth_can_not_be_put_back_or_studied(world, tmp_path):
    simulator = cell()
    with pytest.raises(SimulationError, match="can't be put back"):
        simulator.restore(simulator.state())
    study = polyfold.Study(name="s", base={"simulator": {"name": "real-cell", "camera": "tripod", "robot": "careful"}})
    with pytest.raises(ConfigError, match="folds on a real table"):
        polyfold.run(study, tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_the_file_of_a_calibration_is_used_and_a_wrong_one_named(world, tmp_path):
    file = tmp_path / "camera.json"
    told = {"intrinsics": INTRINSICS.tolist(), "pose": world.pose.tolist(), "size": [640, 480]}
    file.write_text(json.dumps(told))
    simulator = cell(calibration=str(file))
    assert simulator.reset(world.garment, 0).rgb.shape == (400, 400, 3)
    simulator.close()
    file.write_text(json.dumps({**told, "size": [1280, 960]}))
    with pytest.raises(RobotError, match="pictures are 640 x 480, those that it was calibrated with 1280 x 960"):
        cell(calibration=str(file)).reset(world.garment, 0)
    upside_down = {**told, "pose": (world.pose @ np.diag([1.0, -1.0, 1.0, 1.0])).tolist()}
    larger = {**told, "pose": (world.pose @ np.diag([1.2, 1.2, 1.2, 1.0])).tolist()}
    no_lens = {**told, "intrinsics": np.zeros((3, 3)).tolist()}
    for content in ("{", "{}", '{"intrinsics": 1, "pose": 2}', *map(json.dumps, (upside_down, larger, no_lens))):
        file.write_text(content)
        with pytest.raises(ConfigError, match=r"is no calibration|a pose is four rows|no rotation"):
            cell(calibration=str(file))
    with pytest.raises(ConfigError, match="can't be read"):
        cell(calibration=str(tmp_path / "missing.json"))


def test_a_camera_that_looks_from_the_side_is_refused(world):
    world.pose = tilted(40.0)
    with pytest.raises(RobotError, match="looks 40 degrees off straight down"):
        folded(world)


def test_a_closed_terminal_stops_the_arms(world, monkeypatch):
    simulator = cell()
    simulator.reset(world.garment, 0)
    pixels = simulator.observe().camera.to_pixels(np.array([[0.0, -0.1], [0.0, 0.05]]))
    monkeypatch.setattr(simulator.robot, "execute", lambda *_: os.kill(os.getpid(), signal.SIGTERM))
    with pytest.raises(SystemExit):
        simulator.execute(Action(pixels[:1], pixels[1:]))
    assert world.stops == 1
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
    simulator.close()
