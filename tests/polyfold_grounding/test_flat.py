import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from drawn_garments import flat_garment
from polyfold_grounding.polygon import PolygonGrounding
from polyfold_standard.templates.quads import towel_template
from polyfold_standard.templates.shorts import shorts_template
from polyfold_standard.templates.tshirt import tshirt_template

from experiments.benchmarks.fitting.real import rasterised
from polyfold import plugins
from polyfold.errors import GroundingError
from polyfold.geometry import Camera, rotate
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins.interfaces import Grounding
from polyfold.polygon import SymmetricGenerator, Template, angle_range, ratio_range

SEEN = SimpleNamespace(camera=Camera())
SAMPLE = Path(__file__).parents[1] / "data" / "artf_sample.jsonl"


@pytest.fixture(scope="module")
def grounding():
    return PolygonGrounding()


def template_of(kind):
    return plugins.create("garments", kind).template()


def renamed(vertices, truth):
    """The cyclic renaming closest to the truth."""
    return min((np.roll(vertices, k, axis=0) for k in range(len(vertices))), key=lambda v: np.abs(v - truth).sum())


@pytest.mark.parametrize("kind", ["square", "rectangle", "tshirt", "pants"])
@pytest.mark.parametrize(("seed", "angle"), [(2001, 0.2), (2002, 1.7), (2003, -2.6)])
def test_flat_garments_are_fitted_at_any_rotation(grounding, kind, seed, angle):
    mask, truth = flat_garment(kind, seed, angle)
    scene = grounding.ground(SEEN, mask, template_of(kind))
    found = renamed(scene.model.rest, truth) if template_of(kind).cyclic else scene.model.rest
    errors = np.hypot(*(found - truth).T)
    assert errors.mean() < 6.0
    assert errors.max() < 25.0
    assert scene.residual < 4.0
    assert scene.model.names == template_of(kind).names


def test_the_scene_is_ready_for_planning(grounding):
    mask, _ = flat_garment("tshirt", 2004, 0.1)
    scene = grounding.ground(SEEN, mask, tshirt_template())
    assert isinstance(grounding, Grounding)
    assert scene.kind == "tshirt"
    assert scene.image_size == (400, 400)
    assert json.loads(scene.text)["vertices"].keys() == set(tshirt_template().names)
    assert scene.text == scene.model.to_text((400, 400), SEEN.camera.pixels_per_metre)
    assert scene.notes == ()
    assert np.array_equal(scene.mask, mask)


def test_the_lines_of_sleeves_are_near_the_true_ones(grounding):
    turns = []
    for seed in range(2020, 2032):
        mask, truth = flat_garment("tshirt", seed, 0.1)
        found = grounding.ground(SEEN, mask, tshirt_template()).model.rest
        for side in ("left", "right"):
            ends = [tshirt_template().names.index(f"{name}_{side}") for name in ("armpit", "shoulder")]
            angles = [np.arctan2(*(points[ends[1]] - points[ends[0]])) for points in (found, truth)]
            turns.append(abs(np.degrees(angles[0] - angles[1])))
    assert np.median(turns) < 2.0


@pytest.mark.parametrize("angle", [-2.0, -0.5, 0.3, 1.2, 3.0])
def test_a_square_is_named_by_the_edge_nearest_the_top(grounding, angle):
    corners = rotate([(-80, 80), (-80, -80), (80, -80), (80, 80)], angle) + 200
    model = grounding.ground(SEEN, fill_polygon(corners, 400, 400), template_of("square")).model
    point = dict(zip(model.names, model.rest, strict=True))
    top = (point["top_left"] + point["top_right"])[1]
    for a, b in (("top_right", "bottom_right"), ("bottom_right", "bottom_left"), ("bottom_left", "top_left")):
        assert (point[a] + point[b])[1] > top
    assert point["top_left"][0] < point["top_right"][0]


def test_the_pattern_search_of_the_paper_comes_to_the_same():
    mask, truth = flat_garment("pants", 2005, 2.2)
    config = PolygonGrounding.Config(optimizer="pattern", rotations=12)
    found = PolygonGrounding(config).ground(SEEN, mask, template_of("pants")).model.rest
    assert np.hypot(*(found - truth).T).mean() < 8.0


def test_a_template_from_elsewhere_needs_nothing_but_the_public_interface(grounding):
    names = ("hem_left", "waist_left", "waist_right", "hem_right")
    hem, waist = ("hem_left", "hem_right"), ("waist_left", "waist_right")
    skirt = Template(
        kind="skirt",
        names=names,
        descriptions={name: name.replace("_", " ") for name in names},
        parts={"hem": hem, "waist": waist},
        canonical_shapes=[[(-0.5, 0.5), (-0.25, -0.5), (0.25, -0.5), (0.5, 0.5)]],
        generator=SymmetricGenerator(names, [hem, waist]),
        penalties=[ratio_range(waist, hem, 0.3, 0.9), angle_range(waist, hem, -15, 15)],
    )
    truth = rotate([(-110, 90), (-60, -80), (55, -85), (120, 80)], 2.4) + 200
    scene = grounding.ground(SEEN, fill_polygon(truth, 400, 400), skirt)
    np.testing.assert_allclose(scene.model.rest, truth, atol=4.0)
    assert json.loads(scene.text)["garment"] == "skirt"


@pytest.mark.parametrize(("garment", "template"), [("tshirt", tshirt_template), ("towel", towel_template)])
def test_real_outlines_are_explained(grounding, garment, template):
    rows = [json.loads(line) for line in SAMPLE.read_text("utf-8").splitlines()]
    residuals = []
    for row in (row for row in rows if row["garment"] == garment):
        mask, _ = rasterised(row)
        residuals.append(grounding.ground(SEEN, mask, template()).residual)
    assert len(residuals) > 2
    assert np.median(residuals) < 5.0


def test_covered_vertices_may_lie_inside_the_cloth(grounding):
    outline = np.array([(-80, 60), (-100, 60), (-70, -70), (70, -70), (100, 60), (0, 62)]) * (1.2, 1.0) + 200
    model = grounding.ground(SEEN, fill_polygon(outline, 400, 400), shorts_template()).model
    crotch = dict(zip(model.names, model.rest, strict=True))["crotch"]
    assert crotch[1] < 255.0  # the closed legs end at 260


def test_too_little_cloth_is_refused_with_advice(grounding):
    for mask in (np.zeros((400, 400), bool), fill_polygon([(5, 5), (15, 5), (15, 15)], 400, 400)):
        with pytest.raises(GroundingError, match="check the segmentation"):
            grounding.ground(SEEN, mask, tshirt_template())
