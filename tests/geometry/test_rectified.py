"""A photo at an angle is measured by what lies beside the cloth: pixels become metres."""

import numpy as np
import pytest

from polyfold.errors import GarmentError
from polyfold.geometry._homography import homography, mapped
from polyfold.geometry._masks import fill_polygon
from polyfold.geometry._rectified import SHEETS, rectify

WIDTH, HEIGHT = 1200, 900
PER_METRE = 1500
CLOTH = np.array([[0.75, 0.35], [1.25, 0.35], [1.25, 1.0], [0.75, 1.0]])


def seen_from(tilt, yaw, focal=1.1, distance=1.9):
    """Metres on the table to pixels: a camera tilted by so many degrees, focal length in picture widths."""
    a, b = np.radians(tilt), np.radians(yaw)
    turn = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    turn = turn @ np.array([[np.cos(b), -np.sin(b), 0], [np.sin(b), np.cos(b), 0], [0, 0, 1]])
    shift = np.array([0, 0, distance]) - turn @ [0.8, 0.62, 0]
    matrix = np.array([[focal * WIDTH, 0, (WIDTH - 1) / 2], [0, focal * WIDTH, (HEIGHT - 1) / 2], [0, 0, 1]])
    return matrix @ np.column_stack([turn[:, :2], shift])


def photographed(table, view, noise=3.0):
    """A picture of the table, PER_METRE pixels a metre, as the camera sees it."""
    import cv2

    pixels = view @ np.array([[1 / PER_METRE, 0, 0.5 / PER_METRE], [0, 1 / PER_METRE, 0.5 / PER_METRE], [0, 0, 1]])
    blurred = cv2.GaussianBlur(table.astype(np.float32), (0, 0), 1.2)
    seen = cv2.warpPerspective(blurred, pixels, (WIDTH, HEIGHT), borderMode=cv2.BORDER_REPLICATE)
    return (seen + np.random.default_rng(0).normal(0, noise, seen.shape)).clip(0, 255).astype(np.uint8)


def table_with(quad, colour=(236, 236, 233)):
    table = np.full((round(1.3 * PER_METRE), round(1.6 * PER_METRE), 3), (150, 115, 80), np.uint8)
    for corners, paint in ((quad, colour), (CLOTH, (60, 80, 150))):
        table[fill_polygon(corners * PER_METRE - 0.5, *table.shape[:2])] = paint
    return table


def sheet_at(name, angle, middle=(0.38, 0.4)):
    longer, shorter = SHEETS[name]
    a = np.radians(angle)
    turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    corners = np.array([[-longer, -shorter], [longer, -shorter], [longer, shorter], [-longer, shorter]]) / 2
    return corners @ turn.T + middle


def sides(corners):
    return np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)


@pytest.mark.parametrize("name", ["a4", "letter", "a5"])
@pytest.mark.parametrize(
    ("tilt", "yaw", "angle"), [(0, 5, 10), (25, -20, 80), (-35, 25, 30), (42, 10, 0), (-42, 0, 90)]
)
def test_a_sheet_gives_corners_within_half_a_pixel_and_sizes_within_a_percent(name, tilt, yaw, angle):
    view, quad = seen_from(tilt, yaw), sheet_at(name, angle)
    found = rectify(photographed(table_with(quad), view), name)
    truth = mapped(view, quad)
    assert np.linalg.norm(found.corners[:, None] - truth, axis=2).min(axis=1).max() < 0.5
    np.testing.assert_allclose(
        sides(found.on_table(mapped(view, CLOTH))), sides(CLOTH), rtol=0.01 if name != "a5" else 0.02
    )


def test_a_board_gives_sizes_within_half_a_percent_even_where_its_middle_is_hidden():
    import cv2

    board = cv2.aruco.CharucoBoard((7, 5), 0.04, 0.03, cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    picture = board.generateImage((round(0.28 * PER_METRE), round(0.20 * PER_METRE)))
    table = table_with(sheet_at("a4", 0) * 0)
    table[450:750, 300:720] = picture[..., None]
    table[560:620, 450:560] = (200, 160, 130)
    view = seen_from(30, 12)
    found = rectify(photographed(table, view), "charuco:7x5:40:30")
    assert found.residual < 0.5
    np.testing.assert_allclose(sides(found.on_table(mapped(view, CLOTH))), sides(CLOTH), rtol=0.005)


def test_pixels_and_places_are_each_others_inverse_and_the_scale_is_of_the_place():
    view = seen_from(30, 0)
    found = rectify(photographed(table_with(sheet_at("a4", 0)), view), "a4")
    pixels = mapped(view, CLOTH)
    np.testing.assert_allclose(found.in_photo(found.on_table(pixels)), pixels, atol=1e-6)
    far, near = (found.pixels_per_metre(mapped(view, CLOTH[side])) for side in ([0, 1], [2, 3]))
    assert abs(far / near - 1) > 0.1


def test_no_sheet_or_a_coloured_one_or_one_of_another_shape_is_refused():
    view = seen_from(10, 0)
    square = np.array([[0.2, 0.3], [0.5, 0.3], [0.5, 0.6], [0.2, 0.6]])
    for table in (table_with(square * 0), table_with(sheet_at("a4", 0), (230, 120, 60)), table_with(square)):
        with pytest.raises(GarmentError, match="no sheet of a4 is to be seen"):
            rectify(photographed(table, view), "a4")


@pytest.mark.parametrize(
    ("sheet", "says"),
    [
        ("a6", "there is no sheet 'a6'"),
        ("charuco", "for example charuco:7x5:40:30"),
        ("charuco:7x5:30:40", "smaller markers"),
        ("charuco:7x5:4.0.0:3", "can't be"),
        ("charuco:7x5:40:30:DICT_9X9", "no markers 'DICT_9X9'"),
        ("charuco:20x20:40:30", "do not suffice"),
        ("charuco:7x5:40:30", "0 corners are seen"),
    ],
)
def test_what_can_not_be_found_or_read_says_what_to_do(sheet, says):
    with pytest.raises(GarmentError, match=says):
        rectify(np.full((200, 300, 3), 90, np.uint8), sheet)


def test_what_lies_beyond_the_horizon_is_on_no_table():
    found = homography([[0, 0], [100, 0], [80, 50], [20, 50]], [[0, 0], [1, 0], [1, 1], [0, 1]])
    with pytest.raises(GarmentError, match="horizon"):
        mapped(found, np.array([[50.0, 10.0], [50.0, 20.0], [50.0, 5000.0]]))
