"""Photographs on the command line: at an angle with a sheet, on wood, with a segmenter of one's choice."""

import json

import numpy as np
import pytest
from PIL import Image

import polyfold as root
from polyfold.geometry._masks import fill_polygon

PER_METRE = 1000
TOWEL = np.array([[0.55, 0.2], [1.0, 0.2], [1.0, 0.8], [0.55, 0.8]])
SHEET = np.array([[0.12, 0.25], [0.33, 0.25], [0.33, 0.547], [0.12, 0.547]])


@pytest.fixture
def at_an_angle(tmp_path):
    """A photo, 1000 x 750 px, of a table with a towel of 0.45 x 0.6 m and a sheet of A4, from 30 degrees aside."""
    import cv2

    rng = np.random.default_rng(0)
    table = rng.normal((150, 115, 80), 3, (1000, 1200, 3))
    for corners, colour in ((SHEET, (238, 238, 234)), (TOWEL, (60, 80, 150))):
        table[fill_polygon(corners * PER_METRE, 1000, 1200)] = colour
    tilt = np.radians(30)
    turn = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    shift = np.array([0, 0, 1.6]) - turn @ [0.6, 0.5, 0]
    camera = np.array([[1050, 0, 500], [0, 1050, 375], [0, 0, 1]])
    view = camera @ np.column_stack([turn[:, :2], shift]) @ np.diag([1 / PER_METRE, 1 / PER_METRE, 1])
    photo = cv2.warpPerspective(cv2.GaussianBlur(table, (0, 0), 1), view, (1000, 750), borderMode=cv2.BORDER_REPLICATE)
    photo += rng.normal(0, 3, photo.shape)
    Image.fromarray(photo.clip(0, 255).astype(np.uint8)).save(tmp_path / "photo.jpg", quality=92)
    return tmp_path / "photo.jpg"


def test_a_sheet_beside_it_makes_a_photo_at_an_angle_metric(polyfold, at_an_angle, tmp_path):
    common = ("ground", at_an_angle, "--garment", "rectangle", "--json", "--out", tmp_path / "p.png")
    plain = json.loads(polyfold(*common).out)
    measured = json.loads(polyfold(*common, "--sheet", "a4").out)
    assert "size_m" not in plain
    assert measured["size_m"] == pytest.approx(0.6, rel=0.03)
    # A table seen aslant is no rectangle; straightened it fits better. Keypoints stay in the photo's pixels.
    assert measured["residual_px"] < plain["residual_px"]
    for name, place in measured["keypoints"].items():
        assert np.hypot(*np.subtract(place, plain["keypoints"][name])) < 25
    shown = polyfold(*common[:4], "--out", tmp_path / "p.png", "--sheet", "a4").out
    assert f"{measured['size_m']:.3f} m, by the a4 beside it" in shown


def test_the_twin_has_the_size_that_the_sheet_tells(at_an_angle):
    towel = root.garment("rectangle", image=at_an_angle, sheet="a4")
    assert np.sort(np.ptp(towel.mesh.vertices, axis=0)) == pytest.approx([0.45, 0.6], rel=0.04)
    assert np.ptp(root.garment("rectangle", image=at_an_angle, sheet="a4", size=0.3).mesh.vertices, axis=0).max() < 0.31


def test_a_photo_without_the_sheet_says_so_with_its_name(polyfold, tmp_path):
    photo = np.full((300, 400, 3), (150, 115, 80), np.uint8)
    photo[80:220, 100:300] = (60, 80, 150)
    Image.fromarray(photo).save(tmp_path / "photo.png")
    result = polyfold("ground", tmp_path / "photo.png", "--garment", "rectangle", "--sheet", "a4")
    assert (result.status, result.out) == (1, "")
    assert "photo.png: no sheet of a4 is to be seen" in result.err


@pytest.mark.parametrize("option", [("--sheet", "a4"), ("--segmenter", "grabcut")])
def test_what_belongs_to_photos_is_refused_for_masks(polyfold, tmp_path, option):
    mask = np.zeros((100, 100), np.uint8)
    mask[20:80, 20:80] = 255
    Image.fromarray(mask).save(tmp_path / "mask.png")
    result = polyfold("ground", tmp_path / "mask.png", "--garment", "square", *option)
    assert result.status == 1
    assert "photo; give one as image" in result.err


def test_the_segmenter_of_photos_can_be_chosen_and_told(polyfold, tmp_path):
    rng = np.random.default_rng(0)
    empty = rng.normal((150, 115, 80), 4, (300, 500, 3))
    photo = empty.copy()
    photo[60:240, 40:220] = photo[60:240, 280:460] = (60, 80, 150)
    for name, picture in (("photo.png", photo), ("empty.png", np.where(photo[:, ::-1] < 90, photo, empty))):
        Image.fromarray(picture.clip(0, 255).astype(np.uint8)).save(tmp_path / name)
    common = ("ground", tmp_path / "photo.png", "--garment", "square", "--json", "--out", tmp_path / "p.png")
    assert "several things" in polyfold(*common).err
    boxed = polyfold(*common, "--segmenter", "grabcut", "--set", "segmenter.box=[0.5, 0.1, 0.98, 0.9]")
    assert boxed.status == 0, boxed.err
    assert all(x > 270 for x, _ in json.loads(boxed.out)["keypoints"].values())
    (tmp_path / "c.toml").write_text('segmenter = {name = "grabcut", params = {box = [0.02, 0.1, 0.5, 0.9]}}\n')
    configured = polyfold(*common, "--config", tmp_path / "c.toml")
    assert all(x < 230 for x, _ in json.loads(configured.out)["keypoints"].values()), configured.err


def test_fold_takes_the_picture_of_an_empty_table(polyfold, tmp_path):
    rng = np.random.default_rng(0)
    empty = rng.normal((150, 115, 80), 4, (300, 400, 3))
    photo = empty * 0.85
    photo[60:240, 110:290] = (60, 80, 150)
    for name, picture in (("photo.png", photo), ("empty.png", empty)):
        Image.fromarray(picture.clip(0, 255).astype(np.uint8)).save(tmp_path / name)
    said = ("fold", "fold it in half", "--garment", "square", "--image", tmp_path / "photo.png", "--json")
    quick = ("--edge-length", "0.03", "--photo-segmenter")
    for chosen in (
        f"background:{tmp_path / 'empty.png'}",
        f'{{name = "background", params = {{picture = "{(tmp_path / "empty.png").as_posix()}"}}}}',
    ):
        result = polyfold(*said, *quick, chosen)
        assert result.status == 0, result.err
        assert json.loads(result.out)["fidelity"]["iou"] > 0.8
    refused = polyfold(*said, *quick, f"background:{tmp_path / 'nowhere.png'}")
    assert refused.status == 1
    assert "nowhere.png" in refused.err
