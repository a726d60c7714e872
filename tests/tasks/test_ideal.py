from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from laid_flat import KINDS, SUITE, lay

from experiments.benchmarks.loop import SUITE as LOOP_TASKS
from polyfold.geometry import FoldLine, iou
from polyfold.geometry._masks import fill_polygon
from polyfold.tasks import fold_lines, load_suite
from polyfold.tasks._ideal import fidelity, fold_ideally, fold_step_by_step
from polyfold.types import SimState

pixel = st.floats(60, 340)
fold_line = st.tuples(pixel, pixel, pixel, pixel).filter(lambda p: np.hypot(p[2] - p[0], p[3] - p[1]) > 20)
every_kind = pytest.mark.parametrize("kind", KINDS)
tasks = pytest.mark.parametrize("task", SUITE.tasks, ids=lambda task: task.id)


def as_line(numbers):
    return FoldLine(numbers[:2], numbers[2:])


def moved_to(state, positions):
    return SimState(positions, state.velocities, state.keypoints, state.camera)


@every_kind
def test_without_folds_nothing_moves(kind):
    garment, state = lay(kind)
    ideal = fold_ideally(state, garment, [])
    np.testing.assert_allclose(ideal.positions, state.positions, atol=1e-9)
    outline = state.camera.to_pixels(state.positions[garment.mesh.boundary])
    assert iou(ideal.mask, fill_polygon(outline, 400, 400)) > 0.99


@every_kind
@given(lines=st.lists(fold_line, min_size=1, max_size=3))
@settings(max_examples=8)
def test_the_covered_area_never_grows(kind, lines):
    garment, state = lay(kind, edge_length=0.03)
    areas = [
        fold_ideally(state, garment, [as_line(line) for line in lines[:count]]).area for count in range(len(lines) + 1)
    ]
    assert np.all(np.diff(areas) <= 1e-6 * areas[0])
    assert areas[-1] > 0


@every_kind
@given(line=fold_line)
@settings(max_examples=8)
def test_folding_keeps_every_distance_on_either_side(kind, line):
    garment, state = lay(kind, edge_length=0.03)
    line = as_line(line)
    lifted = line.lifts(state.camera.to_pixels(state.positions[:, :2]))
    assume(5 < lifted.sum() < len(lifted) - 5)
    ideal = fold_ideally(state, garment, [line])
    np.testing.assert_allclose(ideal.positions[~lifted, :2], state.positions[~lifted, :2], atol=1e-9)
    before, after = (np.linalg.norm(np.diff(p[lifted, :2], axis=0), axis=1) for p in (state.positions, ideal.positions))
    np.testing.assert_allclose(after, before, atol=1e-9)


@tasks
def test_every_task_makes_the_garment_smaller_and_higher(task):
    garment, state = lay(task.garment, 2007, -8)
    lines = fold_lines(task, state.keypoint_pixels())
    flat, ideal = fold_ideally(state, garment, []), fold_ideally(state, garment, lines)
    assert ideal.area < 0.96 * flat.area
    assert ideal.layer.max() >= 2 * garment.mesh.layers - 1
    assert ideal.layer.max() <= garment.mesh.layers * 2 ** len(lines) - 1
    assert abs(ideal.mask.sum() / ideal.area - 1) < 0.12, "the mask is the area, seen a little nearer"


def test_step_by_step_gives_the_ideal_of_every_prefix():
    garment, state = lay("tshirt", 2008, 12)
    lines = fold_lines(SUITE.task("tshirt-block-left-first"), state.keypoint_pixels())
    for count, ideal in enumerate(fold_step_by_step(state, garment, lines), start=1):
        prefix = fold_ideally(state, garment, lines[:count])
        np.testing.assert_array_equal(ideal.positions, prefix.positions)
        np.testing.assert_array_equal(ideal.layer, prefix.layer)
        np.testing.assert_array_equal(ideal.mask, prefix.mask)
        assert ideal.area == prefix.area


def test_half_and_half_again_leaves_a_quarter_in_four_layers():
    garment, state = lay("rectangle", 2000, edge_length=0.01)
    lines = fold_lines(SUITE.task("rectangle-half-left-then-top"), state.keypoint_pixels())
    ideal = fold_ideally(state, garment, lines)
    assert ideal.area == pytest.approx(0.25 * fold_ideally(state, garment, []).area, rel=0.05)
    counts = np.bincount(ideal.layer) / len(ideal.layer)
    assert len(counts) == 4
    np.testing.assert_allclose(counts, 0.25, atol=0.06)


def test_the_towel_of_the_loop_benchmark_is_folded_in_eight_layers():
    task = load_suite(str(LOOP_TASKS)).task("rectangle-eighths")
    garment, state = lay(task.garment, 2000, edge_length=0.01)
    ideal = fold_ideally(state, garment, fold_lines(task, state.keypoint_pixels()))
    assert ideal.area == pytest.approx(0.125 * fold_ideally(state, garment, []).area, rel=0.08)
    assert ideal.layer.max() == 7


def test_what_was_lowest_of_the_lifted_comes_to_lie_on_top():
    garment, state = lay("tshirt", 2001)
    (line,) = fold_lines(SUITE.task("tshirt-half-left"), state.keypoint_pixels())
    ideal = fold_ideally(state, garment, [line])
    distance = line.distance(state.camera.to_pixels(state.positions[:, :2]))
    lifted, kept = distance > 3, distance < -3
    front, back = garment.mesh.layer == 1, garment.mesh.layer == 0
    assert (ideal.layer[lifted & front] == 2).all()
    assert (ideal.layer[lifted & back] == 3).all()
    assert (ideal.layer[kept & front] == 1).all()
    np.testing.assert_allclose(np.diff(np.unique(ideal.positions[:, 2])), garment.fabric.thickness)


def test_plies_lie_as_high_as_the_fabric_is_thick():
    garment, state = lay("square", 2001)
    (line,) = fold_lines(SUITE.task("square-triangle-bottom_left"), state.keypoint_pixels())
    for thickness in (0.0004, 0.003):
        thick = replace(garment, fabric=replace(garment.fabric, thickness=thickness))
        ideal = fold_ideally(state, thick, [line])
        assert np.ptp(ideal.positions[:, 2]) == pytest.approx(thickness)


def test_flaps_that_do_not_meet_lie_on_the_same_layer():
    garment, state = lay("rectangle", 2003)
    pixels = state.keypoint_pixels()
    corners = np.array([pixels[name] for name in ("bottom_left", "top_left", "top_right", "bottom_right")])
    across = corners[3] - corners[0]
    left = FoldLine.between(corners[0] + 0.2 * across, corners[1] + 0.2 * across)
    right = FoldLine.between(corners[2] - 0.2 * across, corners[3] - 0.2 * across)
    assert fold_ideally(state, garment, [left, right]).layer.max() == 1


class TestFidelity:
    def setup_method(self):
        self.garment, self.state = lay("square", 2004)
        self.lines = fold_lines(SUITE.task("square-triangle-bottom_left"), self.state.keypoint_pixels())
        self.ideal = fold_ideally(self.state, self.garment, self.lines)

    def score(self, mask, positions, lines=None):
        final = moved_to(self.state, positions)
        lines = self.lines if lines is None else lines
        return fidelity(mask, final, self.state, fold_ideally(self.state, self.garment, lines), "task")

    def test_the_ideal_itself_is_perfect(self):
        result = self.score(self.ideal.mask, self.ideal.positions)
        assert (result.iou, result.moved_part_error_mm, result.reference) == (1.0, 0.0, "task")
        assert 0.35 * len(self.state.positions) < result.moved < 0.55 * len(self.state.positions)

    def test_errors_are_measured_in_millimetres_over_the_moved_part(self):
        shifted = self.ideal.positions + np.array([0.003, 0.004, 0.1])
        assert self.score(self.ideal.mask, shifted).moved_part_error_mm == pytest.approx(5.0)

    def test_doing_nothing_does_not_pass(self):
        flat = fold_ideally(self.state, self.garment, [])
        result = self.score(flat.mask, self.state.positions)
        assert result.iou < 0.6
        assert result.moved_part_error_mm > 100

    def test_without_a_moved_part_there_is_no_error(self):
        result = self.score(self.ideal.mask, self.state.positions, lines=[])
        assert np.isnan(result.moved_part_error_mm)
        assert result.moved == 0
