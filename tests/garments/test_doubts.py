"""What was found in a picture is doubted where something simpler explains it as well, or something lies on it."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw

import polyfold

SAMPLE = Path(__file__).parents[1] / "data" / "artf_sample.jsonl"
REAL = [json.loads(line) for line in SAMPLE.read_text("utf-8").splitlines()]
TABLE = [(150, 120), (640, 100), (700, 480), (110, 500)]
SHIRT = [(300, 200), (500, 200), (560, 260), (510, 290), (500, 420), (300, 420), (290, 290), (240, 260)]


def of_kind(kind):
    found = [np.array(max(entry["mask"], key=len)) for entry in REAL if entry["garment"] == kind]
    assert len(found) >= 4
    return found


@pytest.fixture
def table(tmp_path):
    """A photo of a white table on a dark floor, with or without a blue shirt on it."""

    def photograph(with_shirt):
        picture = Image.new("RGB", (800, 600), (60, 50, 45))
        draw = ImageDraw.Draw(picture)
        draw.polygon(TABLE, fill=(240, 240, 235))
        if with_shirt:
            draw.polygon(SHIRT, fill=(40, 60, 140))
        picture.save(tmp_path / "photo.png")
        return tmp_path / "photo.png"

    return photograph


@pytest.mark.parametrize("outline", of_kind("tshirt"))
def test_real_t_shirts_are_believed(outline):
    found = polyfold.ground("tshirt", outline=outline)
    assert found.confidence > 0.8
    assert found.doubts == ()


@pytest.mark.parametrize("outline", of_kind("towel"))
def test_real_towels_that_are_called_t_shirts_are_not(outline):
    found = polyfold.ground("tshirt", outline=outline)
    assert found.confidence < 0.5
    assert "explains the outline as well" in found.doubts[0]
    assert polyfold.ground("rectangle", outline=outline).confidence > 0.6


@pytest.mark.parametrize("outline", of_kind("shorts"))
def test_real_shorts_are_doubted_for_their_fit_alone(outline):
    (doubt,) = polyfold.ground("pants", outline=outline).doubts
    assert doubt.startswith("the polygon is off by")


def test_a_t_shirt_that_is_called_pants_is_doubted():
    found = polyfold.ground("pants", image=Path(polyfold.__file__).parent / "samples" / "tshirt.jpg")
    assert found.confidence < 0.5
    assert "is it 'pants', and does it lie flat?" in found.doubts[0]


def test_a_kind_that_fails_is_no_reason_to_stop(monkeypatch):
    class Broken:
        @staticmethod
        def template():
            raise ZeroDivisionError

    polyfold.plugins.register("garments", "broken", Broken)
    try:
        assert polyfold.ground("tshirt", outline=of_kind("tshirt")[0]).confidence > 0.8
    finally:
        polyfold.plugins.unregister("garments", "broken")


def test_a_table_that_is_taken_for_a_shirt_is_doubted_and_what_lies_on_it_is_mentioned(table):
    bare = polyfold.ground("tshirt", image=table(with_shirt=False))
    laden = polyfold.ground("tshirt", image=table(with_shirt=True))
    assert bare.confidence < 0.5
    assert laden.confidence < bare.confidence
    assert "the cloth lies on what was outlined" in laden.doubts[-1]


def test_a_doubtful_twin_comes_with_a_warning(table):
    with pytest.warns(UserWarning, match=r"a 'tshirt' with a confidence of 0\.\d\d only"):
        polyfold.garment("tshirt", image=table(with_shirt=True))
