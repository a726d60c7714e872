import json

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from polyfold.errors import GarmentError, PlanError
from polyfold.geometry import FoldLine, polygon_area
from polyfold.polygon import FoldedModel
from polyfold.polygon._covering import overlap_area, shapes, solid_parts

SQUARE = np.array([(100.0, 300.0), (100.0, 100.0), (300.0, 100.0), (300.0, 300.0)])
CORNERS = ("bottom_left", "top_left", "top_right", "bottom_right")
WORDS = {name: f"{name} corner" for name in CORNERS}

LEGS = np.array(
    [(180.0, 350.0), (110.0, 350.0), (120.0, 50.0), (280.0, 50.0), (290.0, 350.0), (220.0, 350.0), (200.0, 150.0)]
)
LEG_NAMES = ("inner_left", "outer_left", "waist_left", "waist_right", "outer_right", "inner_right", "crotch")


def square():
    return FoldedModel(SQUARE, CORNERS, WORDS, kind="square")


def legs():
    return FoldedModel(LEGS, LEG_NAMES, {}, kind="pants")


def area(model):
    return sum(facet.area for facet in model.facets())


coordinates = st.floats(60, 340)
apart = st.tuples(coordinates, coordinates, coordinates, coordinates).filter(lambda c: c[:2] != c[2:])
lines = apart.map(lambda c: FoldLine(c[:2], c[2:]))
models = st.sampled_from([square(), legs()])


def folded(model, line):
    """The fold, unless the line doesn't fold this model or leaves slivers, whose loss is tested on its own."""
    try:
        return model.fold(line)
    except PlanError:
        assume(False)


@given(models, st.lists(lines, min_size=1, max_size=3))
def test_folding_keeps_the_area_of_the_cloth(model, folds):
    before, pieces = area(model), 1
    for line in folds:
        model = folded(model, line)
        pieces += 2 * len(model.facets())
    assert area(model) == pytest.approx(before, abs=15.0 * pieces)


@given(models, lines)
def test_after_a_fold_all_cloth_lies_right_of_the_line(model, line):
    after = folded(model, line)
    for facet in after.facets():
        assert line.distance(facet.polygon).max() < 1e-6
    assert line.distance(after.outline()).max() < 0.01


@given(models, lines)
def test_points_right_of_the_line_stay_and_points_left_are_mirrored(model, line):
    after = folded(model, line)
    for name, rest in zip(model.names, model.rest, strict=True):
        if abs(line.distance(rest)) < 3.0:  # close enough to the line to belong to the crease
            continue
        expected = line.mirror(rest) if line.lifts(rest) else rest
        np.testing.assert_allclose(after.vertices()[name].point, expected, atol=1e-6)


@given(models, st.lists(lines, min_size=1, max_size=3))
def test_the_outline_is_the_border_of_the_union(model, folds):
    for line in folds:
        model = folded(model, line)
    pieces = [shapely.Polygon(facet.polygon).buffer(0) for facet in model.facets()]
    union = shapely.union_all(pieces, grid_size=1e-3)
    outline = shapely.Polygon(model.outline())
    assert outline.area >= max(piece.area for piece in pieces) - 1.0
    assert outline.exterior.distance(union.boundary) < 0.01
    for piece in pieces:
        if union.geom_type == "Polygon":
            assert outline.buffer(0.01).contains(piece)


@given(models, lines)
def test_facets_keep_the_way_back_to_the_flat_garment(model, line):
    rest = shapely.Polygon(model.rest).buffer(1e-6)
    for facet in folded(model, line).facets():
        flat = (facet.polygon - facet.motion[:, 2]) @ facet.motion[:, :2]
        assert rest.contains(shapely.Polygon(flat).buffer(-1e-6))
        assert np.sign(np.linalg.det(facet.motion[:, :2])) == (-1 if facet.flipped else 1)


@given(models, lines, st.floats(-3.1, 3.1), coordinates, coordinates)
def test_moving_and_folding_commute(model, line, angle, x, y):
    after = folded(model, line)
    moved = after.transformed(angle, (x - 200, y - 200), centre=(200, 200))
    again = model.transformed(angle, (x - 200, y - 200), centre=(200, 200)).fold(moved.folds[0])
    for name, state in again.vertices().items():
        np.testing.assert_allclose(state.point, moved.vertices()[name].point, atol=1e-5)
        back = moved.transformed(-angle, (200 - x, 200 - y), centre=(x, y)).vertices()[name].point
        np.testing.assert_allclose(back, after.vertices()[name].point, atol=1e-5)


@given(lines, st.lists(st.tuples(coordinates, coordinates), min_size=1))
def test_mirroring_twice_changes_nothing(line, points):
    assume(line.length > 1)
    np.testing.assert_allclose(line.mirror(line.mirror(points)), points, atol=1e-6)


@given(models, st.lists(lines, min_size=1, max_size=3))
def test_every_vertex_is_named_placed_and_layered(model, folds):
    for line in folds:
        model = folded(model, line)
    creases = [f"fold{k}_{end}" for k in range(1, len(folds) + 1) for end in ("start", "end")]
    states = model.vertices()
    assert list(states) == [*model.names, *creases]
    top = max(facet.layer for facet in model.facets())
    for name, state in states.items():
        assert np.isfinite(state.point).all()
        assert state.description
        assert list(state.layers) == sorted(set(state.layers))
        assert 0 <= min(state.layers) <= max(state.layers) <= top
        assert state.visible or max(state.layers) < top, name


def test_a_corner_folded_over_lies_reversed_on_top():
    model = square().fold(FoldLine((100, 250), (150, 300)).reversed())
    corner = model.vertices()["bottom_left"]
    assert corner.layers == (1,)
    assert corner.visible
    assert corner.reversed
    assert "reverse side" in corner.description
    np.testing.assert_allclose(corner.point, (150, 250))
    start, end = model.vertices()["fold1_start"], model.vertices()["fold1_end"]
    assert start.layers == end.layers == (0, 1)
    np.testing.assert_allclose([start.point, end.point], [(150, 300), (100, 250)])


def test_lifted_stacks_are_turned_over_and_laid_on_top():
    half = square().fold(FoldLine((200, 300), (200, 100)))  # left half onto the right
    assert {facet.layer for facet in half.facets()} == {0, 1}
    quarter = half.fold(FoldLine((100, 200), (300, 200)))  # what lies above onto what lies below
    layers = {facet.layer: facet for facet in quarter.facets()}
    assert sorted(layers) == [0, 1, 2, 3]
    assert [layers[k].flipped for k in range(4)] == [False, True, False, True]
    assert "top_left" in {name for names in layers[2].names for name in names}
    assert "top_right" in {name for names in layers[3].names for name in names}
    assert not quarter.vertices()["bottom_left"].visible


def test_a_line_across_both_legs_lifts_two_pieces():
    model = legs().fold(FoldLine((350, 250), (50, 250)))
    lifted = [facet for facet in model.facets() if facet.layer == 1]
    assert len(lifted) == 2
    assert area(model) == pytest.approx(abs(polygon_area(LEGS)))
    assert model.vertices()["fold1_start"].point[0] > model.vertices()["fold1_end"].point[0]


@pytest.mark.parametrize("line", [FoldLine((100, 100), (300, 300)), FoldLine((300, 300), (100, 100))])
def test_a_line_through_corners_gives_them_to_both_sides(line):
    model = square().fold(line)
    assert area(model) == pytest.approx(200.0**2)
    assert len(model.facets()) == 2
    assert model.vertices()["top_left"].layers == (0, 1)
    assert model.vertices()["top_left"].visible
    np.testing.assert_allclose(model.vertices()["top_left"].point, (100, 100), atol=1e-9)


def test_a_line_along_an_inner_corner_and_nearly_along_an_edge():
    through_crotch = legs().fold(FoldLine((200, 400), (200, 0)))
    assert area(through_crotch) == pytest.approx(abs(polygon_area(LEGS)))
    assert len(through_crotch.facets()) == 2
    with pytest.raises(PlanError):  # the strip left of it is a sliver
        square().fold(FoldLine((100.05, 300), (100.05, 100)))


@pytest.mark.parametrize("line", [FoldLine((350, 150), (50, 150)), FoldLine((50, 150), (350, 150))])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_line_that_touches_an_inner_corner_cuts_cleanly(line, mirrored):
    rest = LEGS * (-1, 1) + (400, 0) if mirrored else LEGS
    model = FoldedModel(rest, LEG_NAMES, {}).fold(line)
    pieces = [shapely.make_valid(shapely.Polygon(facet.polygon)) for facet in model.facets()]
    assert sum(piece.area for piece in pieces) == pytest.approx(abs(polygon_area(LEGS)))
    assert area(model) == pytest.approx(abs(polygon_area(LEGS)))
    assert shapely.Polygon(model.outline()).area > 15_000


def test_a_dropped_sliver_leaves_its_vertices_a_position():
    # The line takes a corner off the right leg and a fraction of a pixel off the left one.
    line = FoldLine((290, 330), (175, 350.2))
    sliver = LEGS[LEG_NAMES.index("inner_left")]
    assert 0 < line.distance(sliver) < 1
    model = legs().fold(line)
    assert len(model.facets()) == 2
    np.testing.assert_allclose(model.vertices()["inner_left"].point, sliver, atol=2.0)
    again = model.fold(FoldLine((200, 400), (200, 0)))
    np.testing.assert_allclose(again.vertices()["inner_left"].point, (400 - sliver[0], sliver[1]), atol=2.0)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        (FoldLine((150, 150), (150, 150.2)), "0 px long"),
        (FoldLine((150, 150), (155, 155)), "at least 10 px"),
        (FoldLine((50, 400), (50, 0)), "nothing would be lifted"),
        (FoldLine((50, 0), (50, 400)), "turned over"),
    ],
)
def test_lines_that_do_not_fold_are_refused_with_the_reason(line, says):
    with pytest.raises(PlanError, match=says):
        square().fold(line)


def test_vertices_must_be_finite_and_one_per_name():
    with pytest.raises(GarmentError, match="one row per name"):
        FoldedModel(SQUARE[:3], CORNERS, {})
    with pytest.raises(GarmentError, match="finite"):
        FoldedModel(np.full((4, 2), np.nan), CORNERS, {})


def test_a_model_is_a_value():
    model = square()
    with pytest.raises(ValueError, match="read-only"):
        model.rest[0] = 0
    model.fold(FoldLine((200, 300), (200, 100)))
    assert model.folds == ()


def test_the_last_fold_can_be_replaced():
    once = square().fold(FoldLine((200, 300), (200, 100)))
    moved = once.with_last_fold(FoldLine((180, 300), (180, 100)))
    assert moved.folds == (FoldLine((180, 300), (180, 100)),)
    with pytest.raises(GarmentError, match="no fold"):
        square().with_last_fold(FoldLine((180, 300), (180, 100)))


def test_text_is_strict_json_in_a_stable_order():
    model = square().fold(FoldLine((200, 300), (200, 100)))
    text = model.to_text((400, 400))
    content = json.loads(text, parse_constant=lambda name: pytest.fail(name))
    assert list(content) == ["garment", "image", "vertices", "flat", "outlines"]
    assert content["image"] == {"width": 400, "height": 400}
    assert list(content["vertices"]) == [*CORNERS, "fold1_start", "fold1_end"]
    assert content["vertices"]["top_left"] == {"at": [300, 100], "layers": [1]}
    assert content["vertices"]["top_right"] == {"at": [300, 100], "hidden": True}
    assert content["vertices"]["fold1_start"]["layers"] == [0, 1]
    assert content["flat"] == {"bottom_left": [100, 300], "top_left": [100, 100]}
    assert {frozenset(piece) for piece in content["outlines"]["1"]} == {
        frozenset({"bottom_left", "top_left", "fold1_start", "fold1_end"})
    }
    assert text == square().fold(FoldLine((200, 300), (200, 100))).to_text((400, 400))


def test_the_text_of_flat_cloth_says_where_its_vertices_lie_and_no_more():
    content = json.loads(square().to_text((400, 400), pixels_per_metre=512.3))
    assert content["image"] == {"width": 400, "height": 400, "px_per_cm": 5.12}
    assert content["vertices"]["top_left"] == [100, 100]
    assert set(content) == {"garment", "image", "vertices"}
    odd = FoldedModel(square().rest, ("a", "b", "c", "d"), {"a": "left strap", "b": "b", "c": "c", "d": "d"})
    assert json.loads(odd.to_text((400, 400)))["vertices"]["a"] == {"at": [100, 300], "is": "left strap"}


@pytest.mark.parametrize("allowance", [12.0, 0.0, -8.0])
def test_a_crease_uses_up_cloth_and_the_flap_lies_on_its_mirror_image(allowance):
    line = FoldLine((200, 300), (200, 100))
    model = square().fold(line, allowance)
    plain = square().fold(line)
    assert model.allowances == (allowance,)
    assert model.outline()[:, 0].min() == pytest.approx(200 + allowance / 2)
    for name in CORNERS:
        np.testing.assert_allclose(model.points()[name], plain.points()[name], atol=1e-9)
    for end in ("fold1_start", "fold1_end"):
        assert model.points()[end][0] == pytest.approx(200 + allowance / 2)
        assert len(model.vertices()[end].layers) == 2


def test_a_vertex_in_a_bend_lies_at_its_edge():
    line = FoldLine((100, 130), (300, 104))
    model = square().fold(line, 10.0)
    assert 0.0 < line.distance(SQUARE[2]) < 5.0
    assert line.distance(model.points()["top_right"]) == pytest.approx(-5.0)
    assert line.distance(model.points()["top_left"]) == pytest.approx(-line.distance(SQUARE[1]))


def test_allowances_are_kept_when_the_model_moves_or_loses_a_fold():
    model = square().fold(FoldLine((200, 300), (200, 100)), 6.0).fold(FoldLine((250, 300), (250, 100)), 4.0)
    assert model.transformed(0.3, (5, 5)).allowances == (6.0, 4.0)
    assert model.before(1).allowances == (6.0,)
    assert model.without(1).allowances == (4.0,)
    with pytest.raises(GarmentError, match="one per fold"):
        FoldedModel(model.rest, model.names, {}, model.folds, "square", (1.0,))


def test_creases_keep_their_numbers_when_an_earlier_flap_comes_open():
    twice = square().fold(FoldLine((200, 300), (200, 100))).fold(FoldLine((100, 200), (400, 200)))
    opened = twice.without(1)
    assert opened.numbers == (2,)
    assert {name for name in opened.points() if name.startswith("fold")} == {"fold2_start", "fold2_end"}
    again = opened.fold(FoldLine((200, 300), (200, 100)))
    assert again.numbers == (2, 3)
    assert {"fold2_start", "fold3_end"} <= set(again.points())
    assert again.transformed(0.1).numbers == again.before(2).numbers == (2, 3)


def test_plies_are_counted_at_the_crease():
    once = square().fold(FoldLine((200, 300), (200, 100)))
    assert square().plies(FoldLine((200, 300), (200, 100))) == pytest.approx(1.0)
    assert once.plies(FoldLine((250, 300), (250, 100))) == pytest.approx(2.0)
    assert once.plies(FoldLine((20, 300), (20, 100))) == 0.0


def test_vertices_that_a_fold_brings_onto_each_other_stay_together_when_it_comes_to_lie_elsewhere():
    planned = FoldLine.moving(SQUARE[1], SQUARE[2])
    model = square().fold(FoldLine((202, 300), (203, 100)), 3.0, planned)
    found = model.points()
    for a, b in (("top_left", "top_right"), ("bottom_left", "bottom_right")):
        np.testing.assert_array_equal(found[a], found[b])
    shown = json.loads(model.to_text((400, 400)))["vertices"]
    assert shown["top_left"]["at"] == shown["top_right"]["at"]
    apart = square().fold(FoldLine((202, 300), (203, 100))).points()
    assert np.hypot(*(apart["top_left"] - apart["top_right"])) > 4.0
    np.testing.assert_allclose(found["top_right"], (apart["top_left"] + apart["top_right"]) / 2, atol=1e-9)


def test_vertices_that_were_meant_to_meet_and_lie_far_apart_do_not():
    planned = FoldLine.moving(SQUARE[1], SQUARE[2])
    once = square().fold(FoldLine((197, 300), (197, 100)), planned=planned)
    assert once.meetings == ((("bottom_left", "bottom_right"), ("top_left", "top_right")),)
    twice = once.fold(FoldLine((250, 300), (250, 100)).reversed())
    assert twice.before(1).meetings == once.meetings
    assert twice.without(1).meetings == ((),)
    np.testing.assert_array_equal(twice.points()["top_left"], twice.points()["top_right"])
    parted = FoldedModel(once.rest, CORNERS, {}, (FoldLine((180, 300), (180, 100)),), "square", (), once.meetings)
    assert np.hypot(*(parted.points()["top_left"] - parted.points()["top_right"])) == pytest.approx(40.0)


def test_a_corner_folded_in_keeps_the_edges_of_its_flap_where_the_bend_uses_up_cloth():
    corners = np.array([[100.0, 300.0], [100.0, 100.0], [300.0, 100.0], [300.0, 300.0]])
    names = ("bottom_left", "top_left", "top_right", "bottom_right")
    flat = FoldedModel(corners, names, {}, kind="square")
    for allowance in (-6.0, 0.0, 6.0):
        folded = flat.fold(FoldLine.moving(corners[0], corners.mean(axis=0)), allowance)
        outlines = json.loads(folded.to_text((400, 400)))["outlines"]
        for layer in ("0", "1"):
            (piece,) = outlines[layer]
            assert abs(piece.index("fold1_start") - piece.index("fold1_end")) in (1, len(piece) - 1), "the crease"
        assert {"bottom_left"} < set(outlines["1"][0])


def test_cloth_under_both_turns_of_an_outline_counts_as_covered():
    """A strip that lies on its own beginning, and a patch on just that place."""
    strip = 10.0 * np.array([(0, 0), (4, 0), (4, 3), (1, 3), (1, 1), (3, 1), (3, 4), (0, 4)])
    patch = 10.0 * np.array([(1, 1), (3, 1), (3, 3), (1, 3)])
    assert overlap_area(shapes([patch]), shapes([strip])) == pytest.approx(400.0)
    assert sum(abs(polygon_area(part)) for part in solid_parts(strip)) == pytest.approx(1500.0)
