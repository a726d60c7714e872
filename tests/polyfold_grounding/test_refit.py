import numpy as np
import pytest
from drawn_garments import SIZE, flat_garment, mask_of
from polyfold_grounding.polygon import PolygonGrounding

from polyfold import plugins
from polyfold.geometry import Camera, FoldLine
from polyfold.types import Observation


@pytest.fixture(scope="module")
def grounding():
    return PolygonGrounding()


def seen():
    """A picture from a camera at 2 m; what it shows stands in the mask."""
    return Observation(np.zeros((SIZE, SIZE, 3), np.uint8), np.full((SIZE, SIZE), 2.0, np.float32), Camera(SIZE, SIZE))


def template_of(kind):
    return plugins.create("garments", kind).template()


def start(grounding, kind, seed, angle=0.1):
    """A grounded flat garment and its true model under the same names."""
    mask, truth = flat_garment(kind, seed, angle)
    template = template_of(kind)
    scene = grounding.ground(seen(), mask, template)
    if template.cyclic:
        truth = min(
            (np.roll(truth, k, axis=0) for k in range(len(truth))), key=lambda v: np.abs(v - scene.model.rest).sum()
        )
    return scene, template.model(truth)


def mean_error(scene, truth):
    found, true = scene.model.points(), truth.points()
    return np.mean([np.hypot(*(found[name] - true[name])) for name in truth.names])


def sleeve_line(model, side):
    p = model.points()
    line = FoldLine.between(p[f"armpit_{side}"], p[f"shoulder_{side}"])
    return line if line.lifts(p[f"sleeve_top_{side}"]) else line.reversed()


def test_a_tshirt_is_followed_through_three_folds(grounding):
    scene, truth = start(grounding, "tshirt", 2011)
    p = truth.points()
    hem, shoulders = (p["hem_left"] + p["hem_right"]) / 2, (p["shoulder_left"] + p["shoulder_right"]) / 2
    for line in (sleeve_line(truth, "left"), sleeve_line(truth, "right"), FoldLine.moving(hem, shoulders)):
        truth = truth.fold(line)
        scene = grounding.ground(seen(), mask_of(truth), template_of("tshirt"), scene, line)
        assert mean_error(scene, truth) < 6.0
        assert scene.notes == ()
    assert len(scene.model.folds) == 3
    assert "fold3_end" in scene.text


@pytest.mark.parametrize("kind", ["square", "rectangle", "pants"])
def test_a_fold_executed_beside_its_line_is_found(grounding, kind):
    scene, truth = start(grounding, kind, 2012)
    low, high = truth.rest.min(0), truth.rest.max(0)
    middle = (low + high) / 2
    planned = FoldLine((low[0], middle[1] + 20), (high[0], middle[1] + 20))
    executed = FoldLine((low[0], middle[1] + 27), (high[0], middle[1] + 23))
    truth = truth.fold(executed).transformed(np.radians(2), (5, -4), middle)
    scene = grounding.ground(seen(), mask_of(truth), template_of(kind), scene, planned)
    assert mean_error(scene, truth) < 8.0


@pytest.mark.parametrize("kind", ["square", "rectangle", "tshirt", "pants"])
def test_corners_that_a_fold_brings_together_are_at_one_place_in_the_scene(grounding, kind):
    scene, truth = start(grounding, kind, 2021)
    pairs = {"tshirt": ("hem_left", "hem_right"), "pants": ("waist_left", "waist_right")}
    pair = pairs.get(kind, ("top_left", "top_right"))
    planned = FoldLine.moving(*(scene.model.points()[name] for name in pair))
    middle = truth.rest.mean(0)
    executed = FoldLine.between(*np.add([planned.start, planned.end], [2.5, 1.0]))
    truth = truth.fold(executed).transformed(np.radians(1), (3, -4), middle)
    scene = grounding.ground(seen(), mask_of(truth), template_of(kind), scene, planned)
    a, b = (scene.model.points()[name] for name in pair)
    assert np.hypot(*(a - b)) < 1.0
    assert mean_error(scene, truth) < 6.0


@pytest.mark.parametrize(("turn", "shift"), [(0.4, (25, -20)), (2.0, (-15, 10)), (-2.9, (0, 30))])
def test_a_displaced_garment_is_found_again_and_keeps_its_names(grounding, turn, shift):
    scene, truth = start(grounding, "tshirt", 2013)
    line = sleeve_line(truth, "left")
    truth = truth.fold(line)
    scene = grounding.ground(seen(), mask_of(truth), template_of("tshirt"), scene, line)
    truth = truth.transformed(turn, shift, (200, 200))
    scene = grounding.ground(seen(), mask_of(truth), template_of("tshirt"), scene, None)
    assert mean_error(scene, truth) < 8.0
    assert len(scene.model.folds) == 1


def test_a_large_displacement_is_noted(grounding):
    scene, truth = start(grounding, "pants", 2014)
    truth = truth.transformed(3.0, (10, 10), (200, 200))
    scene = grounding.ground(seen(), mask_of(truth), template_of("pants"), scene, None)
    assert any("displaced" in note for note in scene.notes)
    assert mean_error(scene, truth) < 8.0


def test_a_square_keeps_its_names_when_it_turns(grounding):
    scene, truth = start(grounding, "square", 2015, angle=0.0)
    for _ in range(4):
        truth = truth.transformed(np.radians(25), (0, 0), (200, 200))
        scene = grounding.ground(seen(), mask_of(truth), template_of("square"), scene, None)
    assert mean_error(scene, truth) < 6.0


def test_a_fold_that_did_not_happen_is_noticed(grounding):
    scene, truth = start(grounding, "tshirt", 2016)
    p = truth.points()
    line = FoldLine.moving((p["hem_left"] + p["hem_right"]) / 2, p["neck_center"])
    scene = grounding.ground(seen(), mask_of(truth), template_of("tshirt"), scene, line)
    assert any("did not take effect" in note for note in scene.notes)
    assert scene.model.folds == ()
    assert mean_error(scene, truth) < 6.0


def test_a_line_beside_the_cloth_adds_no_fold_and_says_so(grounding):
    scene, truth = start(grounding, "square", 2017)
    scene = grounding.ground(
        seen(), mask_of(truth), template_of("square"), scene, FoldLine((2, 10), (2, 390)).reversed()
    )
    assert scene.model.folds == ()
    assert any("no fold was added" in note for note in scene.notes)


def test_creases_begin_as_thick_as_the_template_says_unless_the_parameter_does(grounding):
    scene, truth = start(grounding, "pants", 2012)
    p = truth.points()
    line = FoldLine.moving((p["leg_outer_left"] + p["leg_outer_right"]) / 2, (p["waist_left"] + p["waist_right"]) / 2)
    mask, thick = mask_of(truth.fold(line)), template_of("pants").of_thickness(0.015)

    def text(grounding, template):
        return grounding.ground(seen(), mask, template, scene, line).text

    told, chosen = (PolygonGrounding(PolygonGrounding.Config(ply_thickness=t)) for t in (0.015, 0.0))
    assert text(grounding, thick) == text(told, template_of("pants"))
    assert text(chosen, thick) == text(chosen, template_of("pants")) != text(grounding, thick)


def test_refitting_is_a_pure_function(grounding):
    scene, truth = start(grounding, "tshirt", 2018)
    line = sleeve_line(truth, "right")
    mask = mask_of(truth.fold(line))
    first = grounding.ground(seen(), mask, template_of("tshirt"), scene, line)
    second = grounding.ground(seen(), mask, template_of("tshirt"), scene, line)
    assert first.text == second.text
    np.testing.assert_array_equal(first.model.rest, second.model.rest)


def test_a_fold_near_the_edge_never_breaks_the_grounding(grounding):
    scene, truth = start(grounding, "rectangle", 2019)
    right = truth.rest[:, 0].max()
    for planned in (right - 8, right - 4, right - 2, right - 1):
        line = FoldLine((planned, 400), (planned, 0)).reversed()
        for executed in (0, 3, 12):
            mask = mask_of(truth.fold(FoldLine((right - 20 + executed, 0), (right - 20 + executed, 400))))
            after = grounding.ground(seen(), mask, template_of("rectangle"), scene, line)
            assert np.isfinite(after.model.rest).all()
