import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapes import KINDS

from polyfold.errors import GarmentError
from polyfold.garments import name_by_pose
from polyfold.geometry import polygon_area, rotate

CYCLIC = ("bottom_left", "top_left", "top_right", "bottom_right")


@given(angle=st.floats(-np.pi, np.pi), kind=st.sampled_from(["square", "rectangle"]))
def test_the_edge_nearest_the_image_s_top_becomes_the_top(angle, kind):
    garment = KINDS[kind].generate(2000, 0.03)
    positions = rotate(garment.mesh.vertices, angle)
    named = name_by_pose(garment.cyclic, garment.keypoints, positions)
    corners = positions[[named[name] for name in CYCLIC]]
    middles = (corners + np.roll(corners, -1, axis=0)) / 2
    assert middles[1, 1] == middles[:, 1].max()
    assert polygon_area(corners) < 0, "still clockwise"
    assert sorted(named.values()) == sorted(garment.keypoints.values())
    assert name_by_pose(garment.cyclic, named, positions) == named


def test_an_upright_cloth_keeps_its_names():
    garment = KINDS["square"].generate(2001, 0.03)
    assert name_by_pose(garment.cyclic, garment.keypoints, garment.mesh.vertices) == garment.keypoints


def test_garments_with_fixed_names_keep_them():
    garment = KINDS["pants"].generate(2001, 0.03)
    turned = -garment.mesh.vertices
    assert name_by_pose(garment.cyclic, garment.keypoints, turned) == garment.keypoints


def test_a_missing_corner_is_named():
    with pytest.raises(GarmentError, match="top_left"):
        name_by_pose(CYCLIC, {"bottom_left": 0}, np.zeros((1, 2)))
