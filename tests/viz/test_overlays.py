"""Overlays: the right things in the right places, and nothing else touched."""

import subprocess
import sys

import numpy as np
import pytest

from polyfold import viz
from polyfold.geometry import Camera, FoldLine
from polyfold.types import Action, Observation
from polyfold.viz._draw._polygons import polygon_picture
from polyfold.viz._draw._style import ARMS, FOLD_LINE


def changed(before, after):
    return (before != after).any(axis=-1)


def shows(picture, colour, near, within=8):
    """Whether a colour appears within some pixels of a place."""
    x, y = (round(value) for value in near)
    patch = picture[max(0, y - within) : y + within + 1, max(0, x - within) : x + within + 1].astype(int)
    return bool((np.abs(patch - colour).max(-1) < 12).any())


def test_pictures_are_needed_by_nobody_who_only_imports():
    loaded = "import sys, polyfold.viz; print([m for m in ('PIL', 'matplotlib', 'cv2', 'shapely') if m in sys.modules])"
    out = subprocess.run([sys.executable, "-c", loaded], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_nothing_to_draw_leaves_the_picture_as_it_is(rgb):
    before = rgb.copy()
    assert (viz.overlay(rgb) == before).all()
    viz.overlay(rgb, action=Action([(50, 50)], [(150, 60)]))
    assert (rgb == before).all()


def test_an_observation_will_do_for_a_picture(rgb):
    observation = Observation(rgb, np.zeros((400, 400), np.float32), Camera())
    assert (viz.overlay(observation) == rgb).all()


def test_everything_is_drawn_where_it_belongs(rgb, scene, fold_line, action):
    picture = viz.overlay(rgb, scene, fold_line, action)
    assert picture.shape == rgb.shape
    assert picture.dtype == np.uint8
    for pick, place, colour in zip(action.picks, action.places, ARMS, strict=True):
        assert shows(picture, colour, pick)
        assert shows(picture, colour, place)
    assert shows(picture, FOLD_LINE, (270, 200))
    assert not changed(rgb, picture)[:60].any()
    assert not changed(rgb, picture)[:, 380:].any()


def test_teeth_and_tint_are_on_the_lifted_side(rgb, scene, fold_line):
    lifted_right = changed(rgb, viz.overlay(rgb, fold_line=fold_line))
    lifted_left = changed(rgb, viz.overlay(rgb, fold_line=fold_line.reversed()))
    assert lifted_right[:, 276:].sum() > 50 > lifted_right[130:270, :264].sum()
    assert lifted_left[:, :264].sum() > 50 > lifted_left[130:270, 276:].sum()
    tinted = changed(rgb, viz.overlay(rgb, scene, fold_line))
    assert tinted[200, 300]
    assert not tinted[200, 240]
    assert not tinted[200, 370]


def test_a_line_is_drawn_across_the_cloth_however_short_it_was_given(rgb, scene):
    picture = viz.overlay(rgb, scene, FoldLine((270, 199), (270, 201)))
    assert shows(picture, FOLD_LINE, (270, 125), within=3)
    assert shows(picture, FOLD_LINE, (270, 275), within=3)


def test_hidden_vertices_are_hollow(rgb, scene):
    picture = viz.overlay(rgb, scene)
    hidden = {name for name, state in scene.model.vertices().items() if not state.visible}
    for name, state in scene.model.vertices().items():
        x, y = state.point.round().astype(int)
        assert (picture[y, x].astype(int).sum() > 600) == (name in hidden)


@pytest.mark.parametrize("zoom", [0.5, 1.5, 2.0])
def test_zoom_scales_the_picture(rgb, scene, fold_line, action, zoom):
    picture = viz.overlay(rgb, scene, fold_line, action, zoom=zoom)
    assert picture.shape == (400 * zoom, 400 * zoom, 3)
    assert shows(picture, ARMS[0], action.picks[0] * zoom)


def test_odd_actions_are_drawn_too(rgb):
    for action in (
        Action([(50, 50)], [(50, 50)]),
        Action([(50, 50)], [(53, 51)]),
        Action([(0, 0), (399, 399)], [(399, 399), (0, 0)]),
    ):
        assert changed(rgb, viz.overlay(rgb, action=action)).any()


def test_an_outline_is_dashed(rgb):
    square = np.array([(20, 20), (380, 20), (380, 100), (20, 100)], float)
    along = viz.overlay(rgb, outline=square)[20, 30:370].astype(int)
    red = along[:, 0] - along[:, 2] > 80
    assert 0.2 < red.mean() < 0.8
    assert np.abs(np.diff(red.astype(int))).sum() > 20


def test_value_map_colours_low_dark_and_high_bright(rgb):
    points = np.array([(50, 50), (100, 50), (150, 50)], float)
    picture = viz.value_map(rgb, points, [0.0, 5.0, 10.0]).astype(int)
    low, middle, high = (picture[50, x].sum() for x in (50, 100, 150))
    assert low < middle < high
    assert (viz.value_map(rgb, points, [1.0, 1.0, 1.0]) != rgb).any()
    some = viz.value_map(rgb, points, [0.0, np.nan, -np.inf])
    assert (some[45:55, 90:] == rgb[45:55, 90:]).all()
    assert changed(rgb, some)[50, 50]
    assert (viz.value_map(rgb, np.zeros((0, 2)), []) == rgb).all()


def test_a_map_has_a_colour_bar_where_there_is_room(rgb):
    points, values = np.array([(50, 50), (100, 50)], float), [0.25, 0.5]
    corner = np.s_[300:, 340:]
    large = viz.value_map(rgb, points, values)
    assert changed(rgb, large)[corner].sum() > 800
    bar = large[310:386, 385].astype(int).sum(axis=-1)
    assert (np.diff(bar) <= 0).all(), "the highest value on top"
    assert bar[0] > bar[-1] + 200
    assert (viz.value_map(rgb, points, values, zoom=0.5)[150:, 170:] == viz.overlay(rgb, zoom=0.5)[150:, 170:]).all()


def test_polygon_pictures_show_both_sides_and_all_names(rgb, model, tmp_path):
    plain = polygon_picture(model)
    assert plain.shape == (400, 400, 3)
    assert plain[200, 180].astype(int).sum() > plain[200, 300].astype(int).sum()  # the reverse side is lighter
    page = viz.grounding_picture(rgb, model, "rectangle, Chamfer distance 0.4 px", tmp_path / "ground.png")
    assert page.shape[1] > page.shape[0] > 560
    assert (tmp_path / "ground.png").stat().st_size > 1000
    margins = np.hstack([page[:, :150], page[:, -150:]])
    assert (margins < 128).any()
