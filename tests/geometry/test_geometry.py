import re

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from polyfold import geometry
from polyfold.errors import PlanError
from polyfold.geometry import FoldLine
from polyfold.geometry._areas import covered
from polyfold.geometry._masks import fill_polygon

coordinate = st.floats(-500, 500, allow_nan=False).map(lambda value: round(value, 3))
point = st.tuples(coordinate, coordinate)
cloud = arrays(float, st.tuples(st.integers(1, 30), st.just(2)), elements=coordinate)


@st.composite
def lines(draw):
    start, end = draw(point), draw(point)
    assume(np.hypot(end[0] - start[0], end[1] - start[1]) > 1)
    return FoldLine(start, end)


@pytest.mark.parametrize(
    ("start", "end", "says"),
    [
        ("a", "b", "the start of a fold line is a pixel (x, y), not 'a'; give two numbers"),
        ((1, 2), None, "the end of a fold line is a pixel (x, y), not None; give two numbers"),
        ((1, 2, 3), (4, 5, 6), "the start of a fold line is a pixel (x, y), not (1, 2, 3); give two numbers"),
        ((1, 2), (np.nan, 5), "the end of a fold line is a finite pixel (x, y), not (nan, 5); give two numbers"),
        ((1, 2), (1.0, 2.0), "goes from one pixel to another, and both are (1, 2); choose two points apart"),
    ],
)
@pytest.mark.parametrize("make", [FoldLine, FoldLine.between])
def test_what_is_no_line_is_refused_when_it_is_made(make, start, end, says):
    with pytest.raises(PlanError, match=re.escape(says)):
        make(start, end)


def test_nothing_is_carried_from_where_it_lies_to_the_same_place():
    with pytest.raises(PlanError, match=r"pick and place are both at \(5, 6\), so no line lies between them"):
        FoldLine.moving((5, 6), [5.0, 6.0])
    with pytest.raises(PlanError, match=r"the place of a fold line is a pixel \(x, y\), not None"):
        FoldLine.moving((5, 6), None)


def test_a_line_of_numpy_s_numbers_is_the_line_of_python_s():
    line = FoldLine(np.array([1, 2]), np.float32([3.5, 4]))
    assert line == FoldLine((1.0, 2.0), (3.5, 4.0))
    assert repr(line) == "FoldLine(start=(1.0, 2.0), end=(3.5, 4.0))"


def test_left_is_left_as_seen_in_the_image():
    to_the_right = FoldLine((0, 0), (10, 0))
    assert to_the_right.lifts([(5, -1)])[0], "above a line that points right (y down) is its left"
    up = FoldLine((0, 10), (0, 0))
    assert up.lifts([(-1, 5)])[0], "left of a line that points up is its left"


@given(lines(), cloud)
def test_mirroring_twice_is_the_identity_and_changes_side(line, points):
    assert np.allclose(line.mirror(line.mirror(points)), points, atol=1e-6)
    assert np.allclose(line.distance(line.mirror(points)), -line.distance(points), atol=1e-6)


@given(lines(), cloud)
def test_reversed_line_lifts_the_other_side(line, points):
    off = np.abs(line.distance(points)) > 1e-6
    assert (line.lifts(points)[off] != line.reversed().lifts(points)[off]).all()


@given(point, point)
def test_moving_line_carries_pick_onto_place_and_lifts_it(pick, place):
    assume(np.hypot(place[0] - pick[0], place[1] - pick[1]) > 0.01)
    line = FoldLine.moving(pick, place)
    assert np.allclose(line.mirror(pick), place, atol=1e-6)
    assert line.lifts(pick)


def test_coinciding_points_are_refused():
    with pytest.raises(ValueError, match="coincide"):
        geometry.signed_distance([(0, 0)], (1, 1), (1, 1))


@given(cloud, st.floats(-7, 7), point)
def test_rotation_keeps_distances_and_returns(points, angle, centre):
    turned = geometry.rotate(points, angle, centre)
    assert np.allclose(np.linalg.norm(turned - centre, axis=1), np.linalg.norm(points - centre, axis=1), atol=1e-6)
    assert np.allclose(geometry.rotate(turned, -angle, centre), points, atol=1e-6)


@given(st.floats(20, 150), st.floats(20, 150), st.floats(0, 3.1))
def test_contour_runs_along_the_true_edge(width, height, angle):
    corners = np.array([(-width, -height), (width, -height), (width, height), (-width, height)]) / 2
    polygon = geometry.rotate(corners, angle) + 199.5
    contour = geometry.contour_of(fill_polygon(polygon, 400, 400))
    inside = geometry.rotate(contour - 199.5, -angle)
    beyond = np.maximum(np.abs(inside[:, 0]) - width / 2, np.abs(inside[:, 1]) - height / 2)
    assert np.abs(beyond).max() < 1.5
    # A side along the pixel rows can lie anywhere between two rows of pixel centres.
    assert abs(beyond.mean()) < 0.65


def test_empty_mask_has_no_contour():
    with pytest.raises(ValueError, match="empty"):
        geometry.contour_of(np.zeros((10, 10), bool))


@given(st.integers(3, 50), st.booleans())
def test_resampling_is_even(count, closed):
    square = np.array([(0, 0), (10, 0), (10, 10), (0, 10)], float)
    points = geometry.resample(square, count, closed)
    assert points.shape == (count, 2)
    perimeter = 40 if closed else 30
    gaps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert gaps.max() <= perimeter / (count if closed else count - 1) + 1e-9


@given(cloud)
def test_chamfer_is_zero_to_itself_and_symmetric(points):
    assert geometry.chamfer(points, points) == 0
    assert geometry.chamfer(points, points + 3) == pytest.approx(geometry.chamfer(points + 3, points))


def test_span_on_mask_runs_in_the_direction_of_the_line():
    mask = np.zeros((100, 100), bool)
    mask[20:80, 30:70] = True
    start, end = geometry.span_on_mask(mask, (90, 50), (80, 50))
    assert start[0] == pytest.approx(69.5, abs=1)
    assert end[0] == pytest.approx(29.5, abs=1)
    assert geometry.span_on_mask(mask, (0, 5), (10, 5)) is None


def test_iou_of_empty_masks_is_one_and_of_disjoint_ones_zero():
    a, b = np.zeros((4, 4), bool), np.zeros((4, 4), bool)
    assert geometry.iou(a, b) == 1
    a[0], b[1] = True, True
    assert geometry.iou(a, b) == 0


@given(cloud, st.floats(-3.1, 3.1), point, point)
def test_the_turn_onto_moved_points_is_the_one_they_were_turned_by(points, angle, centre, shift):
    assume(np.ptp(points, axis=0).max() > 1)
    moved = geometry.rotate(points, angle, centre) + shift
    assert geometry.turn_onto(points, moved) == pytest.approx(angle, abs=1e-6)


TWICE = [(0, 0), (4, 0), (4, 3), (1, 3), (1, 1), (3, 1), (3, 4), (0, 4)]
"""A strip that comes round and lies on its own beginning, as the outline of a folded sleeve does: 1 x 2 twice."""


def test_what_a_line_goes_around_twice_is_covered_and_what_it_goes_around_once_too():
    assert covered(TWICE).area == pytest.approx(15.0)
    assert covered(TWICE[::-1]).area == pytest.approx(15.0)
    bow = covered([(0, 0), (2, 2), (2, 0), (0, 2)])
    assert bow.area == pytest.approx(2.0)


@given(st.lists(st.tuples(st.integers(0, 40), st.integers(0, 40)), min_size=3, max_size=9, unique=True))
def test_a_line_covers_all_that_it_goes_around_an_odd_number_of_times(points):
    """By the rule of odd crossings, which what is filled on a raster follows as well."""
    shape = covered(points)
    assert shape.is_valid
    odd = shapely.make_valid(shapely.Polygon(points))
    assert odd.difference(shape.buffer(1e-6)).area < 1e-6
