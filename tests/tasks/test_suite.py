import re
from collections import Counter

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from laid_flat import SUITE, lay

from polyfold.errors import ConfigError
from polyfold.geometry import FoldLine, rotate
from polyfold.tasks import fold_lines, load_suite, mirror_line
from polyfold.tasks._lines import recognise

coordinate = st.floats(0, 400)
point = st.tuples(coordinate, coordinate)
tasks = pytest.mark.parametrize("task", SUITE.tasks, ids=lambda task: task.id)

# By type: single-step and multi-step tasks (paper, Table I).
COUNTS = {
    "S-Corner": (4, 7),
    "S-Triangle": (4, 8),
    "R-Edge-to-Middle": (4, 4),
    "R-Edge-to-Opposite": (4, 8),
    "T-Sleeve": (4, 8),
    "T-Half": (3, 0),
    "T-Block": (0, 2),
    "P-Half": (4, 2),
    "P-Block": (0, 4),
}


def test_the_suite_has_the_paper_s_seventy_tasks():
    single = Counter(task.type for task in SUITE.tasks if len(task.steps) == 1)
    multi = Counter(task.type for task in SUITE.tasks if len(task.steps) > 1)
    assert {kind: (single[kind], multi[kind]) for kind in single | multi} == COUNTS
    assert (single.total(), multi.total()) == (27, 43)


@tasks
@pytest.mark.parametrize("degrees", [-20, 0, 13])
def test_every_task_has_lines_that_cut_the_flat_garment(task, degrees):
    garment, state = lay(task.garment, 2001, degrees)
    lines = fold_lines(task, state.keypoint_pixels())
    assert len(lines) == len(task.steps)
    outline = state.camera.to_pixels(state.positions[garment.mesh.boundary])
    for line in lines:
        lifted = line.lifts(outline)
        assert 0.03 < lifted.mean() < 0.97
        assert line.length > 40


@tasks
def test_each_line_lifts_the_named_part_onto_its_target(task):
    pixels = lay(task.garment, 2002, -11)[1].keypoint_pixels()
    span = max(np.ptp(np.array(list(pixels.values())), axis=0))

    def position(weights):
        return sum(weight * pixels[name] for name, weight in weights.items())

    for fold, line in zip(task.steps, fold_lines(task, pixels), strict=True):
        if fold.pairs is None:
            assert line.lifts(position(fold.lift))
            assert np.abs([line.distance(position(end)) for end in fold.crease]).max() < 1e-9
            continue
        for source, target in fold.pairs:
            assert line.lifts(position(source))
            assert np.hypot(*(line.mirror(position(source)) - position(target))) < 0.12 * span


@pytest.mark.parametrize(
    ("task_id", "lifted", "kept"),
    [
        ("square-corner-top_left", {"top_left"}, {"top_right", "bottom_left", "bottom_right"}),
        ("rectangle-middle-left", {"top_left", "bottom_left"}, {"top_right", "bottom_right"}),
        ("rectangle-half-bottom", {"bottom_left", "bottom_right"}, {"top_left", "top_right"}),
        ("tshirt-sleeve-left-straight", {"sleeve_top_left", "sleeve_bottom_left"}, {"neck_left", "hem_left"}),
        ("tshirt-sleeve-right-slanted", {"sleeve_top_right", "shoulder_right"}, {"neck_left", "hem_right"}),
        ("tshirt-half-left", {"hem_left", "sleeve_top_left"}, {"hem_right", "sleeve_top_right"}),
        ("tshirt-half-hem", {"hem_left", "hem_right"}, {"neck_left", "shoulder_right", "armpit_left"}),
        ("pants-half-left", {"waist_left", "leg_outer_left"}, {"waist_right", "leg_inner_right"}),
        ("pants-half-bottom", {"leg_inner_left", "leg_outer_right"}, {"waist_left", "waist_right"}),
        ("pants-half-waist", {"waist_left", "waist_right"}, {"leg_inner_left", "leg_outer_right"}),
    ],
)
@given(seed=st.integers(2000, 2100))
@settings(max_examples=5)
def test_the_part_in_the_name_is_the_part_that_moves(task_id, lifted, kept, seed):
    task = SUITE.task(task_id)
    pixels = lay(task.garment, seed, 7, 0.03)[1].keypoint_pixels()
    line = fold_lines(task, pixels)[0]
    assert all(line.lifts(pixels[name]) for name in lifted)
    assert not any(line.lifts(pixels[name]) for name in kept)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_slanted_sleeve_points_to_the_hem(side):
    pixels = lay("tshirt", 2003)[1].keypoint_pixels()
    cuff = (pixels[f"sleeve_top_{side}"] + pixels[f"sleeve_bottom_{side}"]) / 2
    slanted, straight = (
        fold_lines(SUITE.task(f"tshirt-sleeve-{side}-{way}"), pixels)[0].mirror(cuff) for way in ("slanted", "straight")
    )
    assert slanted[1] > straight[1] + 20


@pytest.mark.parametrize("seed", range(2000, 2006))
def test_the_second_diagonal_brings_the_corner_from_where_the_first_left_it(seed):
    pixels = lay("square", seed)[1].keypoint_pixels()
    first, second = fold_lines(SUITE.task("square-triangle-bottom_left-then-top_left"), pixels)
    corner, target = (
        first.mirror(pixels[name]) if first.distance(pixels[name]) > 0 else pixels[name]
        for name in ("top_left", "bottom_right")
    )
    assert second.mirror(corner) == pytest.approx(target, abs=1e-6)


def test_lines_turn_with_the_garment():
    task = SUITE.task("pants-block-left-thirds")
    pixels = lay("pants", 2004)[1].keypoint_pixels()
    turned = {name: rotate(xy, 0.3, (200, 200)) for name, xy in pixels.items()}
    for line, other in zip(fold_lines(task, pixels), fold_lines(task, turned), strict=True):
        np.testing.assert_allclose(rotate([line.start, line.end], 0.3, (200, 200)), [other.start, other.end], atol=1e-6)


class TestMirrorLine:
    @given(points=st.lists(point, min_size=1, max_size=6), start=point, end=point)
    def test_recovers_the_line_that_made_the_targets(self, points, start, end):
        assume(np.hypot(*np.subtract(end, start)) > 1)
        line = FoldLine.between(start, end)
        distance = line.distance(points)
        assume((np.abs(distance) > 1).all())
        points = np.where(distance[:, None] > 0, points, line.mirror(points))
        found = mirror_line(points, line.mirror(points))
        np.testing.assert_allclose(found.mirror(points), line.mirror(points), atol=1e-4)
        assert found.lifts(points).all()

    @given(
        pairs=st.lists(st.tuples(point, point), min_size=2, max_size=5),
        angle=st.floats(0, np.pi),
        shift=st.floats(-40, 40),
    )
    def test_no_other_line_does_better(self, pairs, angle, shift):
        sources, targets = np.array(pairs).transpose(1, 0, 2)
        assume(np.abs((sources - targets).sum(0)).max() > 1)

        def error(line):
            return np.square(line.mirror(sources) - targets).sum()

        normal = np.array([np.cos(angle), np.sin(angle)])
        through = (sources + targets).mean(0) / 2 + shift * normal
        other = FoldLine.between(through, through + np.array([-normal[1], normal[0]]))
        assert error(mirror_line(sources, targets)) <= error(other) * (1 + 1e-9) + 1e-6

    def test_points_that_need_not_move_give_no_line(self):
        with pytest.raises(ValueError, match="already lie"):
            mirror_line([[1, 2]], [[1, 2]])


class TestRecognise:
    @tasks
    def test_a_task_s_own_lines_are_that_task(self, task):
        pixels = lay(task.garment, 2006, 9)[1].keypoint_pixels()
        assert recognise(SUITE.for_garment(task.garment), pixels, fold_lines(task, pixels)) == task.id

    def test_small_errors_are_forgiven_and_large_ones_not(self):
        candidates, pixels = SUITE.for_garment("tshirt"), lay("tshirt", 2006)[1].keypoint_pixels()
        (line,) = fold_lines(SUITE.task("tshirt-half-hem"), pixels)

        def moved(degrees, shift):
            ends = rotate([line.start, line.end], np.radians(degrees), np.add(line.start, line.end) / 2)
            return FoldLine.between(*(ends + np.array([0, shift])))

        assert recognise(candidates, pixels, [moved(6, 5)]) == "tshirt-half-hem"
        assert recognise(candidates, pixels, [moved(14, 0)]) is None
        assert recognise(candidates, pixels, [moved(0, 40)]) is None
        assert recognise(candidates, pixels, [line.reversed()]) is None
        assert recognise(candidates, pixels, [line, line]) is None
        assert recognise(candidates, pixels, []) is None

    def test_order_matters(self):
        candidates, pixels = SUITE.for_garment("tshirt"), lay("tshirt", 2006)[1].keypoint_pixels()
        lines = fold_lines(SUITE.task("tshirt-block-left-first"), pixels)
        assert recognise(candidates, pixels, [lines[1], lines[0], lines[2]]) == "tshirt-block-right-first"


VALID = """
schema_version = 1
name = "mine"
[points.square]
center = { bottom_left = 0.5, top_right = 0.5 }
[[task]]
id = "fold-it"
garment = "square"
type = "Own"
steps = [{ pairs = [["top_left", "center"]] }]
"""


class TestFile:
    def write(self, tmp_path, text):
        path = tmp_path / "mine.toml"
        path.write_text(text)
        return path

    def test_named_points_stand_for_their_weights(self, tmp_path):
        suite = load_suite(self.write(tmp_path, VALID))
        assert suite.tasks[0].steps[0].pairs == (({"top_left": 1.0}, {"bottom_left": 0.5, "top_right": 0.5}),)

    def test_weights_may_stand_in_place(self, tmp_path):
        text = VALID.replace('"center"', "{ bottom_left = 0.5, top_right = 0.5 }")
        assert load_suite(self.write(tmp_path, text)) == load_suite(self.write(tmp_path, VALID))

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            ("pairs", "pears", r"mine\.toml: task fold-it has no setting 'steps\.0\.pears'"),
            ("[[\"top_left\", \"center\"]]", "[]", r"task fold-it has a bad value for 'steps\.0\.pairs'"),
            ("bottom_left = 0.5", "bottom_left = 0.9", "weights of a point must sum to 1"),
            ('type = "Own"', "", "task fold-it has no 'type'; add it"),
            ('id = "fold-it"', 'id = "Fold It!"', "task Fold It! has a bad value for 'id'"),
            ("pairs = [[\"top_left\", \"center\"]]", 'crease = ["top_left", "center"]', "exactly one of the two"),
            ("schema_version = 1", "schema_version = 2", "the suite has a bad value for 'schema_version'"),
            ("steps = [", "steps = 3 #", "task fold-it has a bad value for 'steps'"),
            ("name = \"mine\"", "name = ", "not valid TOML"),
        ],
    )  # fmt: skip
    def test_mistakes_are_named_by_file_task_and_field(self, tmp_path, old, new, words):
        with pytest.raises(ConfigError, match=words) as caught:
            load_suite(self.write(tmp_path, VALID.replace(old, new)))
        assert "mine.toml" in str(caught.value)

    def test_an_id_is_used_once(self, tmp_path):
        twice = VALID + VALID[VALID.index("[[task]]") :]
        with pytest.raises(ConfigError, match="'fold-it' is used twice"):
            load_suite(self.write(tmp_path, twice))

    @pytest.mark.parametrize("source", ["nowhere.toml", "no_package:tasks.toml", "polyfold_standard:tasks/none.toml"])
    def test_a_missing_file_is_named(self, source):
        with pytest.raises(ConfigError, match=re.escape(source)):
            load_suite(source)

    def test_an_unknown_id_offers_the_nearest(self):
        with pytest.raises(ConfigError, match=r"did you mean.*tshirt-half-hem"):
            SUITE.task("tshirt-half-hen")

    def test_a_missing_keypoint_names_task_and_step(self):
        with pytest.raises(ConfigError, match="square-corners-all, step 1 needs the keypoint 'top_left'"):
            fold_lines(SUITE.task("square-corners-all"), {"bottom_left": (0, 0)})

    def test_coinciding_points_name_task_and_step(self, tmp_path):
        task = load_suite(self.write(tmp_path, VALID.replace('"center"', '"top_left"'))).tasks[0]
        with pytest.raises(ConfigError, match="fold-it, step 1"):
            fold_lines(task, {"top_left": (0, 0), "top_right": (9, 0)})
