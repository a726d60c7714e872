"""``polyfold cell``: what the camera sees, views to calibrate it by, and parked arms, by one file of settings."""

import io
import json

import numpy as np
import pytest
from PIL import Image
from polyfold_pybullet.views import sensor, synthetic_views
from real_world import World, components, tilted

from polyfold import plugins
from polyfold.cli import main
from polyfold.plugins.hardware import RgbdFrame

TRUE = tilted(15.0)


class Terminal(io.StringIO):
    """Somebody who types, at a terminal."""

    def isatty(self):
        return True


class Board:
    """A camera that sees a board, and the arm that holds it: both go on to the next pose with each picture."""

    def __init__(self):
        pictures, tools = synthetic_views(TRUE, 8, 3)
        blank = np.full_like(pictures[0], 120)
        self.views = [(blank, tools[0]), *zip(pictures, tools, strict=True)]
        self.open, self.tool = set(), np.eye(4)

    def registered(self):
        board = self

        class Sees:
            def connect(self):
                board.open.add("camera")

            def close(self):
                board.open.discard("camera")

            def get_rgbd(self, frames=1):
                picture, board.tool = board.views.pop(0)
                depth = np.full(picture.shape[:2], 0.9, np.float32)
                return RgbdFrame(picture, depth, sensor(), np.full((4, 4), np.nan))

        class Holds(components(World())[1]):
            def connect(self):
                board.open.add("arms")

            def close(self):
                board.open.discard("arms")

            def tcp_pose(self, arm):
                assert "arms" in board.open
                return board.tool

        return Sees, Holds


@pytest.fixture
def world():
    made = World()
    for kind, name, component in zip(("cameras", "robots"), ("tripod", "careful"), components(made), strict=True):
        plugins.register(kind, name, component)
    yield made
    plugins.unregister("cameras", "tripod")
    plugins.unregister("robots", "careful")


def settings(tmp_path, **others):
    file = tmp_path / "cell.toml"
    lines = {
        "name": "real-cell",
        "camera": "tripod",
        "robot": "careful",
        "extent": 0.7,
        "centre": [0.03, 0.02],
        **others,
    }
    file.write_text("[simulator]\n" + "".join(f"{name} = {json.dumps(value)}\n" for name, value in lines.items()))
    return str(file)


def test_look_shows_what_is_measured_and_moves_nothing(world, tmp_path, capsys):
    picture = tmp_path / "new" / "seen.png"
    assert main(["cell", "look", "--config", settings(tmp_path), "--out", str(picture)]) == 0
    said = capsys.readouterr().out
    assert "640 x 480, depth measured in 100.0%" in said
    low, high = (float(said.split(" mm from")[0].split()[place]) for place in (-3, -1))
    assert -1.0 < low <= high < 1.0
    with Image.open(picture) as drawn:
        assert drawn.width > 1000
    assert not world.parked
    assert not world.moves


def test_a_camera_that_does_not_know_where_it_is_is_looked_through_all_the_same(world, tmp_path, capsys):
    world.pose = np.full((4, 4), np.nan)
    world.frame = lambda: RgbdFrame(
        np.zeros((48, 64, 3), np.uint8), np.full((48, 64), np.nan, np.float32), np.eye(3), world.pose
    )
    assert main(["cell", "look", "--config", settings(tmp_path), "--out", str(tmp_path / "seen.png")]) == 0
    said = capsys.readouterr().out
    assert "depth measured in 0.0%" in said
    assert "no view from above: the camera does not know where it is; calibrate it" in said


@pytest.mark.parametrize("agrees", [True, False])
def test_arms_are_parked_once_a_person_agrees(world, tmp_path, monkeypatch, capsys, agrees):
    monkeypatch.setattr("sys.stdin", Terminal("y\n" if agrees else "q\n"))
    status = main(["cell", "park", "--config", settings(tmp_path)])
    said = capsys.readouterr()
    assert "Step back" in said.err
    assert (status == 0) == agrees
    assert world.parked == agrees
    assert ("not agreed to" in said.err) != agrees


def test_views_are_taken_one_by_one_and_calibrate_the_camera(world, tmp_path, monkeypatch, capsys):
    board = Board()
    sees, holds = board.registered()
    plugins.register("cameras", "board", sees)
    plugins.register("robots", "holds", holds)
    file = settings(tmp_path, camera="board", robot="holds", calibration=str(tmp_path / "yet-to-come.json"))
    folder = tmp_path / "views"
    try:
        for enters in (4, 5):  # interrupted once, and gone on with
            monkeypatch.setattr("sys.stdin", Terminal("\n" * enters + "q\n"))
            assert main(["cell", "views", str(folder), "--config", file]) == 0
            assert not board.open
    finally:
        plugins.unregister("cameras", "board")
        plugins.unregister("robots", "holds")
    said = capsys.readouterr().out
    assert "not kept: the board is not seen" in said
    assert "8 views in" in said
    assert main(["calibrate", str(folder)]) == 0
    found = np.array(json.loads((folder / "camera.json").read_text())["pose"])
    assert np.linalg.norm(found[:3, 3] - TRUE[:3, 3]) < 0.006
