"""A camera that looks at a board in an arm's hand."""

import numpy as np
import pytest
from polyfold_pybullet import views

from polyfold.errors import GarmentError
from polyfold.geometry import Calibration, Camera

TRUE = np.array([[1.0, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.9], [0, 0, 0, 1]])


@pytest.fixture(scope="module")
def seen():
    return views.synthetic_views(TRUE, 20, seed=3)


def table_error(pose):
    """How far points of the table are from where a camera at a pose takes them for [m]."""
    x, y = np.meshgrid(np.linspace(-0.4, 0.4, 9), np.linspace(-0.3, 0.3, 7))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size), np.ones(x.size)])
    moved = points @ (pose @ np.linalg.inv(TRUE)).T
    return np.linalg.norm((moved - points)[:, :3], axis=1)


def test_twenty_views_tell_where_the_table_is(seen):
    pictures, tools = seen
    found = Calibration.of(pictures, tools, views.BOARD, intrinsics=views.sensor())
    assert table_error(found.pose).mean() < 0.0025
    assert len(found.errors) == 20
    assert len(found.skipped) <= 3
    assert found.error < 2.5


def test_without_intrinsics_they_are_found_as_well(seen):
    pictures, tools = seen
    found = Calibration.of(pictures, tools, views.BOARD)
    assert found.intrinsics[0, 0] == pytest.approx(views.FOCAL, rel=0.01)
    assert found.intrinsics[:2, 2] == pytest.approx([639.5, 359.5], abs=6)


def test_a_wrong_pose_and_a_picture_without_the_board_are_left_out_with_their_reasons(seen):
    pictures, tools = seen
    pictures, tools = list(pictures), tools.copy()
    pictures[4] = np.full_like(pictures[4], 200)
    tools[7, :3, 3] += [0.05, 0.0, 0.0]
    found = Calibration.of(pictures, tools, views.BOARD, intrinsics=views.sensor())
    assert "0 corners are seen" in found.skipped[4]
    assert "was the arm at rest" in found.skipped[7]
    assert table_error(found.pose).mean() < 0.0025


def test_too_few_views_are_refused(seen):
    pictures, tools = seen
    with pytest.raises(GarmentError, match="seen in 4 of 4 pictures, 5 are needed"):
        Calibration.of(pictures[:4], tools[:4], views.BOARD)
    with pytest.raises(GarmentError, match="give one pose for each"):
        Calibration.of(pictures, tools[:4], views.BOARD)
    blank = [np.full_like(pictures[0], 200)] * 6
    with pytest.raises(GarmentError, match=r"seen in 0 of 6 pictures.*the first that is not: of the board"):
        Calibration.of(blank, tools[:6], views.BOARD)


def test_the_camera_of_a_seed_is_always_taken_for_the_same():
    camera = Camera.framing(0.9, elevation=0.9)
    one, again = (views.calibrated_eye.__wrapped__(camera, 12, 5) for _ in range(2))
    assert one.pose.tobytes() == again.pose.tobytes()
    assert views.calibrated_eye(camera, 0, 5).places([[199.5, 199.5]], [0.9])[0] == pytest.approx([0, 0, 0])


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda tools: np.linalg.inv(tools), "explains the views|px from where they should be"),
        (lambda tools: np.roll(tools, 1, axis=0), "explains the views|px from where they should be"),
        (lambda tools: np.tile(tools[:1], (len(tools), 1, 1)), "hardly turned"),
        (lambda tools: tools * 2, "no rotation"),
        (lambda tools: tools[:, :3], "of shape"),
        (lambda tools: np.full_like(tools, np.nan), "finite"),
    ],
)
def test_poses_that_can_not_be_are_answered_with_what_to_check(seen, spoil, message):
    pictures, tools = seen
    with pytest.raises(GarmentError, match=message):
        Calibration.of(pictures, spoil(tools), views.BOARD, intrinsics=views.sensor())


def test_a_wrong_board_or_lens_is_no_calibration(seen):
    pictures, tools = seen
    with pytest.raises(GarmentError, match="px from where they should be at best; check the board's sides"):
        Calibration.of(pictures, tools, "charuco:7x5:60:44", intrinsics=views.sensor())
    wrong = np.array([[2000.0, 0, 639.5], [0, 910, 359.5], [0, 0, 1]])
    with pytest.raises(GarmentError, match="px from where they should be at best"):
        Calibration.of(pictures, tools, views.BOARD, intrinsics=wrong)
    with pytest.raises(GarmentError, match="finite pinhole matrix"):
        Calibration.of(pictures, tools, views.BOARD, intrinsics=np.full((3, 3), np.nan))
    with pytest.raises(GarmentError, match="does not read charuco"):
        Calibration.of(pictures, tools, "a4")
    with pytest.raises(GarmentError, match=r"give uint8, \(H, W, 3\)"):
        Calibration.of([picture[:, :, 0] for picture in pictures], tools, views.BOARD)
