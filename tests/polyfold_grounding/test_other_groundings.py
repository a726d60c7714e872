"""Groundings with less structure than the polygon: keypoints, pictures, and both."""

import json

import numpy as np
import pytest
from drawn_garments import flat_garment, mask_of, seen

from polyfold import plugins
from polyfold.geometry import FoldLine

ANGLE = 0.2


def template_of(kind):
    return plugins.create("garments", kind).template()


def ground(name, mask, kind, previous=None, line=None, **config):
    return plugins.create("groundings", name, config).ground(seen(mask), mask, template_of(kind), previous, line)


def points_of(scene):
    return json.loads(scene.text)["keypoints"]


@pytest.fixture(scope="module")
def shirt():
    return flat_garment("tshirt", 2004, ANGLE)


def test_a_flat_garment_has_the_templates_keypoints_by_name_and_nothing_else(shirt):
    mask, truth = shirt
    scene = ground("keypoints", mask, "tshirt")
    assert set(json.loads(scene.text)) == {"garment", "image", "keypoints"}
    assert list(points_of(scene)) == list(template_of("tshirt").names)
    assert np.hypot(*(np.array(list(points_of(scene).values())) - truth).T).mean() < 6
    assert scene.model is None
    assert scene.shown == ("keypoints",)


def test_a_folded_garment_has_nameless_corners_of_its_outline(shirt):
    mask, truth = shirt
    points = dict(zip(template_of("tshirt").names, truth, strict=True))
    line = FoldLine.between(points["shoulder_left"], points["armpit_left"])
    line = line if line.lifts(points["sleeve_top_left"]) else line.reversed()
    folded = mask_of(template_of("tshirt").model(truth).fold(line))
    scene = ground("keypoints", folded, "tshirt", ground("keypoints", mask, "tshirt"), line)
    corners = np.array(points_of(scene))
    assert corners.shape[1] == 2
    assert 7 <= len(corners) <= 14
    for name in ("hem_left", "hem_right", "sleeve_top_right", "shoulder_left"):
        assert np.hypot(*(corners - points[name]).T).min() < 8, name
    assert np.hypot(*(corners - points["sleeve_top_left"]).T).min() > 20
    assert all("sleeve" not in name for name in json.loads(scene.text) if name != "flat")
    flat = json.loads(scene.text)["flat"]
    assert flat == points_of(ground("keypoints", mask, "tshirt")), "where they lay before the fold stays known"


def test_names_stay_while_nothing_is_folded(shirt):
    mask, _ = shirt
    first = ground("keypoints", mask, "tshirt")
    assert ground("keypoints", mask, "tshirt", first, None).text == first.text


def test_a_finer_tolerance_keeps_more_corners(shirt):
    mask, truth = shirt
    folded = mask_of(template_of("tshirt").model(truth).fold(FoldLine((200.0, 20.0), (200.0, 380.0))))
    first, line = ground("keypoints", mask, "tshirt"), FoldLine((200.0, 20.0), (200.0, 380.0))
    coarse = ground("keypoints", folded, "tshirt", first, line, tolerance_px=8.0)
    fine = ground("keypoints", folded, "tshirt", first, line, tolerance_px=1.0)
    assert len(points_of(fine)) > len(points_of(coarse))


def test_a_picture_alone_says_nothing_of_the_shape(shirt):
    mask, _ = shirt
    scene = ground("image", mask, "tshirt")
    assert json.loads(scene.text) == {"garment": "tshirt", "image": {"width": 400, "height": 400}}
    assert (scene.picture == seen(mask).rgb).all()
    assert scene.model is None


@pytest.mark.parametrize("words", ["keypoints", "polygon"])
def test_words_and_picture_are_the_words_with_the_picture(shirt, words):
    mask, _ = shirt
    plain, both = ground(words, mask, "tshirt"), ground(f"{words}+image", mask, "tshirt")
    assert both.text == plain.text
    assert plain.picture is None
    assert (both.picture == seen(mask).rgb).all()
    assert both.shown == (words, "image")
    assert (both.model is None) == (words == "keypoints")
