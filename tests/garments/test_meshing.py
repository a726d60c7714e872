import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import assert_sound, edges, rims, triangle_areas

from polyfold.errors import GarmentError
from polyfold.garments import Outline, curved_outline, mesh_panels
from polyfold.geometry import polygon_area

circle_angles = np.linspace(0, 2 * np.pi, 200, endpoint=False)
CIRCLE = 0.1 * np.column_stack([np.cos(circle_angles), np.sin(circle_angles)])


@given(
    sides=st.integers(4, 8),
    stretch=st.floats(0.7, 1.4),
    edge_length=st.floats(0.008, 0.02),
    layers=st.sampled_from([1, 2]),
    clockwise=st.booleans(),
)
@settings(max_examples=25)
def test_any_convex_outline_is_tiled_by_well_shaped_triangles(sides, stretch, edge_length, layers, clockwise):
    angles = -2 * np.pi * np.arange(sides) / sides
    corners = {f"c{k}": (0.15 * np.cos(a), 0.15 * stretch * np.sin(a)) for k, a in enumerate(angles)}
    outline = curved_outline(corners)
    if not clockwise:
        outline = outline.counter_clockwise()
    mesh, vertices = mesh_panels(outline, layers, edge_length)
    assert_sound(mesh, edge_length, least_angle=12.0)
    assert triangle_areas(mesh).sum() == pytest.approx(layers * abs(polygon_area(outline.points)), rel=1e-3)
    for name, vertex in vertices.items():
        np.testing.assert_allclose(mesh.vertices[vertex], outline.points[outline.corners[name]], atol=1e-12)


def test_boundary_runs_counter_clockwise_along_the_silhouette():
    mesh, _ = mesh_panels(Outline(CIRCLE[::-1], {}), 1, 0.01)
    ring = mesh.vertices[mesh.boundary]
    assert polygon_area(ring) == pytest.approx(np.pi * 0.01, rel=0.01)
    np.testing.assert_allclose(np.hypot(*ring.T), 0.1, atol=2e-4)


def test_two_layers_share_their_seam_and_nothing_else():
    corners = {"a": (0, 0), "b": (0, 0.2), "c": (0.3, 0.2), "d": (0.3, 0)}
    outline = curved_outline(corners, openings=(("b", "c"),))
    mesh, vertices = mesh_panels(outline, 2, 0.02)
    front, back = (set(np.unique(mesh.triangles[mesh.panel == panel])) for panel in (1, 0))
    assert front & back == set(np.flatnonzero(mesh.seam))
    top_edge = outline.points[outline.corners["b"], 1]
    strictly_inside = (mesh.vertices[:, 1] > top_edge - 1e-9) & (np.abs(mesh.vertices[:, 0]) < 0.149)
    assert strictly_inside.sum() == 2 * 14
    assert not mesh.seam[strictly_inside].any()
    assert mesh.seam[[vertices["b"], vertices["c"]]].all(), "an opening ends where its seams begin"
    assert rims(mesh) == 1
    np.testing.assert_allclose(
        np.sort(mesh.vertices[mesh.layer == 1], axis=0),
        np.sort(mesh.vertices[(mesh.layer == 0) & ~mesh.seam], axis=0),
    )


def test_a_bag_without_openings_has_no_rim():
    mesh, _ = mesh_panels(Outline(CIRCLE, {}), 2, 0.012)
    assert (edges(mesh)[1] == 2).all()


def test_sharp_corners_do_not_weld_the_panels():
    corners = {"a": (0, 0), "b": (0.15, 0.1), "c": (0.3, 0), "d": (0.15, -0.1)}
    mesh, _ = mesh_panels(curved_outline(corners), 2, 0.02)
    pairs, owners = edges(mesh)
    assert owners.max() == 2
    ring = set(map(tuple, np.sort(np.column_stack([mesh.boundary, np.roll(mesh.boundary, -1)]), axis=1)))
    sewn = {tuple(pair) for pair in pairs[mesh.seam[pairs].all(1)]}
    assert sewn <= ring


def test_legs_that_nearly_touch_stay_apart():
    corners = {
        **{"leg_inner_left": (-0.004, 0), "leg_outer_left": (-0.2, 0), "waist_left": (-0.2, 0.7)},
        **{"waist_right": (0.2, 0.7), "leg_outer_right": (0.2, 0), "leg_inner_right": (0.004, 0), "crotch": (0, 0.45)},
    }
    outline = curved_outline(corners)
    mesh, _ = mesh_panels(outline, 1, 0.02)
    assert triangle_areas(mesh).sum() == pytest.approx(abs(polygon_area(outline.points)), rel=1e-3)
    middle = mesh.vertices[mesh.triangles].mean(1)
    assert not ((np.abs(middle[:, 0]) < 0.001) & (middle[:, 1] < 0.05)).any()


@pytest.mark.parametrize(
    ("outline", "layers", "edge_length", "words"),
    [
        (Outline(CIRCLE, {}), 3, 0.01, "1 or 2 layers"),
        (Outline(CIRCLE[[0, 120, 60, 180]], {"a": 0, "b": 1, "c": 2, "d": 3}), 1, 0.01, "crosses itself"),
        (Outline(CIRCLE, {"a": 0, "b": 50}, (("a", "z"),)), 2, 0.01, "no corner 'z'"),
    ],
)
def test_bad_outlines_are_refused_with_what_to_do(outline, layers, edge_length, words):
    with pytest.raises(GarmentError, match=words):
        mesh_panels(outline, layers, edge_length)


@pytest.mark.parametrize("edge_length", [0.0, -0.01, float("nan"), 1e-6, 0.2])
def test_an_edge_length_that_does_not_suit_the_garment_is_refused(edge_length):
    with pytest.raises(GarmentError, match=r"choose one between 0\.0003 and 0\.05"):
        mesh_panels(Outline(CIRCLE, {}), 1, edge_length)


def test_a_rounding_larger_than_its_edge_is_refused():
    with pytest.raises(GarmentError, match="make it smaller"):
        curved_outline({"a": (0, 0), "b": (0, 1), "c": (1, 0)}, rounding={"a": 0.8})
