import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import KINDS, assert_sound, rims, triangle_areas

from polyfold.geometry import iou, polygon_area
from polyfold.geometry._masks import fill_polygon

SEEDS = st.integers(2000, 9999)
OPEN_RIMS = {"square": 1, "rectangle": 1, "tshirt": 4, "pants": 3}
TABLE = np.array([236, 236, 232])

every_kind = pytest.mark.parametrize("kind", KINDS)


@every_kind
@given(seed=SEEDS, edge_length=st.sampled_from([0.01, 0.0125, 0.0155, 0.02, 0.03]))
@settings(max_examples=8)
def test_meshes_are_sound_at_any_seed_and_edge_length(kind, seed, edge_length):
    mesh = KINDS[kind].generate(seed, edge_length).mesh
    assert_sound(mesh, edge_length)
    assert rims(mesh) == OPEN_RIMS[kind]
    silhouette = abs(polygon_area(mesh.vertices[mesh.boundary]))
    assert triangle_areas(mesh).sum() == pytest.approx(mesh.layers * silhouette, rel=1e-9)


@every_kind
@given(seed=SEEDS)
@settings(max_examples=6)
def test_a_seed_is_one_garment_at_any_edge_length(kind, seed):
    garment, again, coarser = (KINDS[kind].generate(seed, h) for h in (0.02, 0.02, 0.03))
    assert garment.name == f"{kind}-{seed:04d}"
    assert garment.colours == coarser.colours
    np.testing.assert_array_equal(garment.mesh.vertices, again.mesh.vertices)
    np.testing.assert_array_equal(garment.mesh.triangles, again.mesh.triangles)
    for name, vertex in garment.keypoints.items():
        np.testing.assert_allclose(
            garment.mesh.vertices[vertex], coarser.mesh.vertices[coarser.keypoints[name]], atol=1e-12
        )


@every_kind
def test_seeds_differ(kind):
    spans = {
        tuple(np.ptp(KINDS[kind].generate(seed, 0.03).mesh.vertices, axis=0).round(6)) for seed in range(2000, 2020)
    }
    assert len(spans) == 20


@every_kind
def test_keypoints_are_the_template_s_vertices_in_its_order(kind):
    names = KINDS[kind].template().names
    assert KINDS[kind].pattern.corners == tuple(names)
    garment = KINDS[kind].generate(2003, 0.02)
    assert set(garment.keypoints) == set(names)
    polygon = np.array([garment.mesh.vertices[garment.keypoints[name]] for name in names])
    assert polygon_area(polygon) < 0, "clockwise seen from above"


@every_kind
def test_the_top_of_a_cloth_is_the_edge_that_naming_by_pose_calls_the_top(kind):
    pattern = KINDS[kind].pattern
    assert not pattern.cyclic or (pattern.cyclic[1:3], {pattern.cyclic[0], pattern.cyclic[3]}) == (
        pattern.top,
        set(pattern.bottom),
    )


@every_kind
def test_keypoints_lie_on_the_silhouette_and_on_top_where_open(kind):
    garment = KINDS[kind].generate(2004, 0.0155)
    assert set(garment.keypoints.values()) <= set(garment.mesh.boundary.tolist())
    if kind == "tshirt":
        assert garment.mesh.layer[garment.keypoints["neck_center"]] == 1
        assert garment.mesh.seam[garment.keypoints["armpit_left"]]


@every_kind
@given(seed=SEEDS)
@settings(max_examples=8)
def test_the_silhouette_is_not_the_template_s_polygon(kind, seed):
    garment = KINDS[kind].generate(seed, 0.0155)
    polygon = np.array([garment.mesh.vertices[garment.keypoints[name]] for name in KINDS[kind].pattern.corners])
    ring = garment.mesh.vertices[garment.mesh.boundary]
    scale = 1000.0
    masks = [fill_polygon(points * scale + 500, 1000, 1000) for points in (polygon, ring)]
    assert 0.88 < iou(*masks) < 0.997


@given(seed=SEEDS)
@settings(max_examples=20)
def test_sizes_keep_to_their_ranges(seed):
    shirt = KINDS["tshirt"].generate(seed, 0.03)
    at = {name: shirt.mesh.vertices[vertex] for name, vertex in shirt.keypoints.items()}
    assert 0.36 < at["armpit_right"][0] - at["armpit_left"][0] < 0.67
    assert 0.60 < at["neck_left"][1] - at["hem_left"][1] < 0.78
    assert at["sleeve_top_left"][0] < at["shoulder_left"][0] < at["neck_left"][0] < at["neck_center"][0]
    square = np.ptp(KINDS["square"].generate(seed, 0.03).mesh.vertices, axis=0)
    assert 0.23 < square.min() < square.max() < 0.48
    assert square.max() / square.min() < 1.1
    sides = np.sort(np.ptp(KINDS["rectangle"].generate(seed, 0.03).mesh.vertices, axis=0))
    assert 0.47 < sides[0] / sides[1] < 0.94
    assert 0.24 < sides[1] < 0.46
    pants = KINDS["pants"].generate(seed, 0.03)
    at = {name: pants.mesh.vertices[vertex] for name, vertex in pants.keypoints.items()}
    assert at["leg_inner_left"][0] < at["crotch"][0] < at["leg_inner_right"][0]
    assert 0.55 < np.ptp(pants.mesh.vertices, axis=0)[1] < 1.0


def test_both_orientations_of_rectangles_occur():
    spans = [np.ptp(KINDS["rectangle"].generate(seed, 0.03).mesh.vertices, axis=0) for seed in range(2000, 2040)]
    upright = sum(height > width for width, height in spans)
    assert 8 <= upright <= 32


@every_kind
@given(seed=SEEDS)
@settings(max_examples=6)
def test_both_sides_of_the_fabric_stand_out_from_the_table(kind, seed):
    for colour in KINDS[kind].generate(seed, 0.03).colours:
        assert np.linalg.norm(TABLE - colour) > 60
