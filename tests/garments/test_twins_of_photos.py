"""The twin of a garment in a photograph looks as that does: its colour, how it lies, and the photograph beside it."""

from importlib.resources import files

import numpy as np
import pytest
from PIL import Image

import polyfold
from polyfold import plugins
from polyfold.api._looks import CLEAR, colours_in
from polyfold.garments import find_cloth
from polyfold.geometry import iou
from polyfold.viz._draw._cloth import TABLE
from polyfold.viz._values import picture_of

SAMPLE = files("polyfold") / "samples" / "tshirt.jpg"


@pytest.fixture(scope="module")
def twin():
    return polyfold.garment("tshirt", image=str(SAMPLE), edge_length=0.03)


def laid(garment, seed):
    """What the camera sees of it, and where it is."""
    simulator = plugins.create("simulators", "xpbd")
    rgb = simulator.reset(garment, seed).rgb
    simulator.close()
    return rgb, find_cloth(rgb)


def cut_to(mask, side=200):
    """The part of a mask that holds it, at a common size."""
    import cv2

    y, x = np.nonzero(mask)
    part = mask[y.min() : y.max() + 1, x.min() : x.max() + 1].astype(np.uint8)
    return cv2.resize(part, (side, side), interpolation=cv2.INTER_NEAREST) > 0


@pytest.mark.parametrize("seed", [0, 1])
def test_it_lies_as_it_lay_and_in_its_colour_whatever_the_seed(twin, seed):
    from polyfold.api import ground

    rgb, mask = laid(twin, seed)
    found = ground("tshirt", image=str(SAMPLE))
    assert iou(cut_to(mask), cut_to(found.scene.mask)) > 0.93
    seen, real = (np.median(picture[where], axis=0) for picture, where in ((rgb, mask), (found.rgb, found.scene.mask)))
    assert np.abs(seen - real).max() < 30


def test_a_photograph_that_is_turned_turns_it(twin, tmp_path):
    turned = np.rot90(np.asarray(Image.open(SAMPLE)))
    Image.fromarray(turned).save(tmp_path / "turned.png")
    other = polyfold.garment("tshirt", image=tmp_path / "turned.png", edge_length=0.03)
    assert (other.angle_deg - twin.angle_deg) % 360 == pytest.approx(90, abs=6)


@pytest.mark.parametrize("colour", [(255, 255, 255), (240, 238, 230), (20, 20, 24), (200, 30, 40)])
def test_its_colour_stands_out_from_the_simulated_table_and_is_kept_where_it_does(colour):
    picture = np.full((40, 40, 3), colour, np.uint8)
    sides = colours_in(picture, np.ones((40, 40), bool))
    assert all(np.linalg.norm(np.subtract(side, TABLE)) >= CLEAR for side in sides)
    if np.linalg.norm(np.subtract(colour, TABLE)) > CLEAR:
        assert np.abs(np.subtract(sides[0], colour)).max() <= 1


def test_a_white_shirt_is_found_on_the_table(twin):
    from dataclasses import replace

    white = replace(twin, colours=colours_in(np.full((40, 40, 3), 250, np.uint8), np.ones((40, 40), bool)))
    _, mask = laid(white, 0)
    assert iou(mask, laid(twin, 0)[1]) > 0.98


def test_its_picture_and_its_filmstrip_show_the_photograph(twin):
    assert picture_of(twin).shape[1] > picture_of(polyfold.garment("tshirt", 0, edge_length=0.03)).shape[1] + 300
    episode = polyfold.fold("fold it in half", twin)
    without = polyfold.fold("fold it in half", polyfold.garment("square", 0, edge_length=0.05))
    assert episode.show().shape[1] > without.show().shape[1] + 300, "a panel more"
