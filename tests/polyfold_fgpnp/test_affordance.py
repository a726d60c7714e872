"""The affordance score: exact, independent of how the cloth lies, and never a reason to pick off the cloth."""

import numpy as np
import pytest
from drawn_scenes import CENTRE, SQUARE, TSHIRT, model_of, near, scene_of
from hypothesis import given, settings
from hypothesis import strategies as st
from polyfold_fgpnp.policies.actions import PickConfig, to_action
from polyfold_fgpnp.policies.affordance import GAP_PX, best_pair, coupled_pick, quadrilateral_area, second_pick, slide
from polyfold_fgpnp.policies.region import fold_region
from shapely import MultiPoint

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine, rotate

coordinate = st.floats(-200, 200, allow_nan=False, width=32)
point = st.tuples(coordinate, coordinate)


@given(point, point, point, point)
@settings(max_examples=200, deadline=None)
def test_area_is_that_of_the_convex_hull(a, b, c, d):
    hull = MultiPoint([a, b, c, d]).convex_hull
    assert quadrilateral_area(a, b, c, d) == pytest.approx(hull.area, rel=1e-4, abs=1e-3)


def test_crossed_corners_still_span_an_area():
    # In the order start, end, first, second these four corners of a square cross over.
    assert quadrilateral_area((0, 0), (0, 10), (10, 0), (10, 10)) == pytest.approx(100)


def all_pairs(region, gamma):
    points, line, root = region.points, region.fold_line, np.sqrt(region.box_area)
    areas = quadrilateral_area(line.start, line.end, points[:, None], points[None])
    return areas / region.box_area + gamma * (region.distances[:, None] + region.distances) / root


@given(st.floats(0, 6.28), st.floats(-60, 60), st.floats(0, 0.3))
@settings(max_examples=10, deadline=None)
def test_best_pair_is_the_best_of_all_contour_pixels(angle, offset, gamma):
    direction = np.array([np.cos(angle), np.sin(angle)])
    middle = np.array(CENTRE) + offset * np.array([-direction[1], direction[0]])
    region = fold_region(FoldLine.between(middle - 50 * direction, middle + 50 * direction), scene_of(model_of(TSHIRT)))
    scores = all_pairs(region, gamma)
    first, second = best_pair(region, gamma)
    i, j = (int(np.argmin(((region.points - p) ** 2).sum(1))) for p in (first, second))
    assert scores[i, j] == pytest.approx(scores.max(), abs=1e-6)


def test_second_pick_is_the_best_partner_of_the_first():
    region = fold_region(FoldLine((200, 350), (200, 50)), scene_of(model_of(SQUARE)))
    assert near([second_pick(region, (100, 300), 0.04)], (100, 100))
    assert near([second_pick(region, (100, 100), 0.04)], (100, 300))


def slid_one_by_one(region, pick, towards, share):
    """Walk from one contour point towards another, step by step in both directions; the end that is nearer."""
    distance = share * np.hypot(*(towards - pick))
    start = int(np.argmin(((region.points - pick) ** 2).sum(1)))
    ends = []
    for step in (1, -1):
        at, gone = start, 0.0
        for _ in range(len(region.points) - 1):
            onwards = (at + step) % len(region.points)
            length = np.hypot(*(region.points[onwards] - region.points[at]))
            if gone + length > distance + 1e-9 or length > GAP_PX:
                break
            at, gone = onwards, gone + length
        ends.append(region.points[at])
    return min(ends, key=lambda end: np.hypot(*(end - towards)))


@given(st.floats(0, 6.28), st.floats(-60, 60), st.floats(0, 0.45), st.sampled_from([SQUARE, TSHIRT]))
@settings(max_examples=20, deadline=None)
def test_partners_of_many_picks_are_those_of_each(angle, offset, share, corners):
    direction = np.array([np.cos(angle), np.sin(angle)])
    middle = np.array(CENTRE) + offset * np.array([-direction[1], direction[0]])
    region = fold_region(
        FoldLine.between(middle - 50 * direction, middle + 50 * direction), scene_of(model_of(corners))
    )
    firsts = region.points[::7]
    together = coupled_pick(region, firsts, PickConfig(), share)
    line, root = region.fold_line, np.sqrt(region.box_area)
    for first, partner in zip(firsts, together, strict=True):
        assert (partner == coupled_pick(region, first, PickConfig(), share)).all()
        second = second_pick(region, first, PickConfig().gamma)
        areas = quadrilateral_area(line.start, line.end, first, region.points)
        scores = areas / region.box_area + PickConfig().gamma * region.distances / root
        at = int(np.argmin(((region.points - second) ** 2).sum(1)))
        assert scores[at] == pytest.approx(scores.max(), abs=1e-6)
        assert (partner == slid_one_by_one(region, second, first, share)).all()


def test_region_shrinks_the_line_to_the_lifted_cloth():
    region = fold_region(FoldLine((200, 900), (200, -900)), scene_of(model_of(SQUARE)))
    assert region.fold_line.start == pytest.approx((200, 300), abs=2)
    assert region.fold_line.end == pytest.approx((200, 100), abs=2)
    assert region.box_area == pytest.approx(100 * 201, rel=0.03)
    assert region.mask[:, 202:].sum() == 0
    assert region.mask[200, 110]


def test_region_leaves_out_a_sliver_that_the_line_cuts_off_elsewhere():
    scene = scene_of(model_of(TSHIRT))  # its hem is wider than its armpits
    region = fold_region(FoldLine.between(TSHIRT["armpit_left"], TSHIRT["shoulder_left"]), scene)
    assert region.points[:, 1].max() < 240
    assert region.fold_line.start[1] < 200


def test_stray_pixels_are_no_cloth():
    scene = scene_of(model_of(SQUARE))
    clean = best_pair(fold_region(FoldLine((200, 350), (200, 50)), scene), 0.04)
    scene.mask[195:205, 2:8] = True
    assert near(best_pair(fold_region(FoldLine((200, 350), (200, 50)), scene), 0.04), *clean, within=1)


def test_region_keeps_both_of_two_legs():
    legs = {
        "a": (100, 350), "b": (100, 50), "c": (300, 50), "d": (300, 350), "e": (230, 350), "f": (200, 150),
        "g": (170, 350),
    }  # fmt: skip
    region = fold_region(FoldLine((350, 200), (50, 200)), scene_of(model_of(legs)))
    assert near(best_pair(region, 0.04), (100, 350), (300, 350))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (FoldLine((310, 350), (310, 50)), "misses the cloth"),
        (FoldLine((297, 50), (297, 350)), "swap its start and end"),
    ],
)
def test_nothing_to_fold_is_an_error_that_says_what_to_do(line, message):
    with pytest.raises(PlanError, match=message):
        fold_region(line, scene_of(model_of(SQUARE)))


def region_of_half_square():
    return fold_region(FoldLine((200, 350), (200, 50)), scene_of(model_of(SQUARE)))


def test_close_picks_become_one_arm_at_their_mean():
    region = region_of_half_square()
    far = to_action(region, (100, 190), (100, 230), PickConfig(one_arm_px=30, inset_px=0))
    close = to_action(region, (100, 190), (100, 210), PickConfig(one_arm_px=30, inset_px=0))
    assert far.arms == 2
    assert close.arms == 1
    assert near(close.picks, (100, 200), within=1)
    assert near(close.places, (300, 200), within=1)


def test_arms_are_ordered_along_the_line():
    region = region_of_half_square()
    one_way = to_action(region, (100, 120), (100, 280), PickConfig())
    other_way = to_action(region, (100, 280), (100, 120), PickConfig())
    assert (one_way.picks == other_way.picks).all()
    assert one_way.picks[0, 1] > one_way.picks[1, 1]


@pytest.mark.parametrize("inset", [0.0, 2.5, 5.0])
def test_picks_lie_that_deep_in_the_cloth(inset):
    action = to_action(region_of_half_square(), (100, 120), (100, 280), PickConfig(inset_px=inset))
    assert action.picks[:, 0] == pytest.approx(100 + inset, abs=1.5)


def test_a_place_outside_the_image_is_pulled_back_on_its_way():
    # The line is so near the right edge of the cloth that the mirrored corners leave the image.
    line = FoldLine((290, 350), (290, 50))
    action = to_action(fold_region(line, scene_of(model_of(SQUARE))), (100, 102), (100, 298), PickConfig(inset_px=0))
    wide = to_action(
        fold_region(FoldLine((270, 350), (290, 50)), scene_of(model_of(SQUARE))), (100, 102), (100, 298), PickConfig()
    )
    for moved in (action, wide):
        assert moved.places.min() >= 0
        assert moved.places.max() <= 399
    assert action.places[:, 0] == pytest.approx(399)
    assert action.places[:, 1] == pytest.approx(action.picks[:, 1])
    way = wide.places - wide.picks
    cross = way[0, 0] * way[1, 1] - way[0, 1] * way[1, 0]
    assert abs(cross) < 1e-6 * np.hypot(*way[0]) * np.hypot(*way[1])  # both still go straight across the line


def test_sliding_follows_the_contour_towards_the_other_pick():
    region = region_of_half_square()
    assert near([slide(region, (100, 300), (100, 100), 0.1)], (100, 280), within=3)
    assert near([slide(region, (100, 100), (100, 300), 0.1)], (100, 120), within=3)
    assert near([slide(region, (100, 100), (100, 300), 0.0)], (100, 100), within=2)


def test_choice_turns_with_the_cloth():
    line = np.array([(330.0, 200.0), (70.0, 200.0)])
    upright = best_pair(fold_region(FoldLine.between(*line), scene_of(model_of(TSHIRT))), 0.04)
    for angle in (0.4, 1.3, 2.9):
        turned = FoldLine.between(*rotate(line, angle, CENTRE))
        picks = best_pair(fold_region(turned, scene_of(model_of(TSHIRT, angle))), 0.04)
        assert near(picks, *rotate(np.array(upright), angle, CENTRE), within=4)
