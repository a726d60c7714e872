"""``polyfold calibrate``, as someone uses it who has pictures of a board in an arm's hand."""

import json

import numpy as np
import pytest
from PIL import Image

from polyfold.cli import main


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A folder of views, calibrated once."""
    folder = tmp_path_factory.mktemp("cell") / "views"
    assert main(["calibrate", str(folder), "--simulate", "8", "--intrinsics", "910,910,639.5,359.5"]) == 0
    return folder


@pytest.fixture
def views(recorded, tmp_path):
    """A copy that may be spoilt."""
    for path in recorded.glob("view-*.png"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "poses.json").write_text((recorded / "poses.json").read_text("utf-8"), "utf-8")
    return tmp_path


def told(folder, capsys, *options):
    status = main(["calibrate", str(folder), *options])
    streams = capsys.readouterr()
    return status, streams.out + streams.err


def test_views_of_the_simulated_cell_tell_where_its_camera_is(recorded):
    found = json.loads((recorded / "camera.json").read_text("utf-8"))
    assert np.array(found["pose"])[:3, 3] == pytest.approx([0, 0, 0.9], abs=0.01)
    assert found["error_px"] < 3
    assert set(found["errors_px"]) == {f"view-{number:02}.png" for number in range(8)}
    with Image.open(recorded / "camera.png") as picture:
        assert picture.width > 800


def test_the_pictures_that_were_left_out_are_named(views, capsys):
    poses = json.loads((views / "poses.json").read_text("utf-8"))
    poses["view-02.png"][0][3] += 0.1
    (views / "poses.json").write_text(json.dumps(poses), "utf-8")
    status, text = told(views, capsys)
    assert status == 0
    assert "left out view-02.png: corners are" in text
    assert "view-02.png" in json.loads((views / "camera.json").read_text("utf-8"))["left_out"]


def test_nothing_is_overwritten_by_simulated_views(views, capsys):
    assert told(views, capsys, "--simulate", "6") == (
        1,
        f"polyfold: {views} is not empty; give a new folder for simulated views\n",
    )


@pytest.mark.parametrize(
    ("poses", "message"),
    [
        ("{", "is no JSON"),
        ("[]", "names no pictures"),
        ('{"view-00.png": [[1, 2], [3, 4]]}', "four rows of four numbers"),
        ('{"view-00.png": "here"}', "four rows of four numbers"),
        ('{"view-00.png": [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}', "are no rotation"),
        ('{"view-00.png": [[1, 0, 0, 300], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}', "300 m away; give metres"),
        ('{"view-77.png": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}', "there is no picture"),
        ('{"poses.json": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}', "no picture that can be read"),
    ],
)
def test_what_is_wrong_with_poses_is_said(views, capsys, poses, message):
    (views / "poses.json").write_text(poses, "utf-8")
    status, text = told(views, capsys)
    assert status == 1
    assert message in text
    assert not (views / "camera.json").exists()


def test_a_folder_without_poses_and_wrong_options_are_refused(views, capsys, tmp_path_factory):
    assert "holds no poses.json; write into it" in told(tmp_path_factory.mktemp("empty"), capsys)[1]
    assert "is not FX,FY,CX,CY" in told(views, capsys, "--intrinsics", "1,2,3")[1]
    assert "is not FX,FY,CX,CY" in told(views, capsys, "--intrinsics", "nan,1,2,3")[1]
    assert "does not read charuco" in told(views, capsys, "--board", "chess")[1]


@pytest.mark.parametrize("name", ["poses.json", "view-00.json", "camera.png", "camera"])
def test_the_result_takes_the_place_of_nothing_that_was_given(views, capsys, name):
    before = {path.name: path.read_bytes() for path in views.iterdir()}
    status, text = told(views, capsys, "--out", str(views / name))
    assert status == 1
    assert "--out" in text
    assert {path.name: path.read_bytes() for path in views.iterdir()} == before


def test_too_few_views_are_not_even_made(tmp_path, capsys):
    assert "needs 5 views and more, not 3" in told(tmp_path / "few", capsys, "--simulate", "3")[1]
    assert not (tmp_path / "few").exists()
