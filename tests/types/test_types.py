import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from polyfold import Action, Camera
from polyfold.errors import ActionError


@given(st.floats(0.2, 2.0), st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(0, 0.3))
def test_camera_projects_and_returns(extent, x, y, z):
    camera = Camera.framing(extent)
    point = np.array([x, y, z])
    assert np.allclose(camera.to_world(camera.to_pixels(point), z), point, atol=1e-9)


def test_camera_frames_the_extent_with_y_down_and_the_origin_in_the_middle():
    camera = Camera.framing(1.0, width=400, height=400)
    assert np.allclose(camera.to_pixels([0, 0]), (199.5, 199.5))
    assert np.allclose(camera.to_pixels([0.5, 0.5]), (399.5, -0.5))
    assert camera.pixels_per_metre == pytest.approx(400)


@pytest.mark.parametrize(
    ("picks", "places", "says"),
    [
        ([1, 2], [3, 4], "shape"),
        ([[1, 2]], [[1, 2], [3, 4]], "shape"),
        ([[1, 2]] * 3, [[3, 4]] * 3, "shape"),
        ([[np.nan, 2]], [[3, 4]], "finite"),
        ([[1, 2]], [[np.inf, 4]], "finite"),
    ],
)
def test_bad_actions_are_refused(picks, places, says):
    with pytest.raises(ActionError, match=says):
        Action(picks, places)


def test_pixels_outside_the_image_are_refused_by_name():
    with pytest.raises(ActionError, match=r"\(500, 10\)"):
        Action([[10, 10]], [[500, 10]]).check_inside(Camera())
    Action([[0, 0]], [[399, 399]]).check_inside(Camera())
