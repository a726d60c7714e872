"""What the ``xpbd`` simulator promises, seen from outside, on coarse meshes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from experiments.benchmarks.cloth.measures import crossing_edges, layer_order, strain
from polyfold import plugins
from polyfold.config import ComponentSpec
from polyfold.errors import ActionError, ConfigError, SimulationError
from polyfold.geometry import FoldLine
from polyfold.types import Action

SEED = 2002
EDGE = 0.022


@pytest.fixture(scope="module")
def garments():
    return {kind: plugins.generate_garment(kind, SEED, EDGE) for kind in ("square", "rectangle", "tshirt", "pants")}


@pytest.fixture
def simulator():
    simulator = plugins.create("simulators", "xpbd")
    yield simulator
    simulator.close()


def fold_over(simulator, picks: list[str], places: list[str]) -> Action:
    pixels = simulator.state().keypoint_pixels()
    return Action(np.array([pixels[name] for name in picks]), np.array([pixels[name] for name in places]))


def half_of_square(simulator) -> Action:
    return fold_over(simulator, ["bottom_left", "bottom_right"], ["top_left", "top_right"])


def test_picture_shows_the_whole_garment_on_a_table_of_another_colour(simulator, garments):
    for garment in garments.values():
        picture = simulator.reset(garment, 3)
        cloth = picture.depth < picture.camera.elevation - garment.fabric.thickness / 4
        assert picture.rgb.shape == (400, 400, 3)
        assert picture.rgb.dtype == np.uint8
        assert picture.depth.dtype == np.float32
        assert np.isfinite(picture.depth).all()
        border = np.concatenate([cloth[0], cloth[-1], cloth[:, 0], cloth[:, -1]])
        assert not border.any()
        assert 0.05 < cloth.mean() < 0.6
        table = np.abs(picture.rgb.astype(int) - picture.rgb[0, 0].astype(int)).sum(axis=2) < 12
        assert (table == ~cloth).mean() > 0.98


def test_garment_is_laid_within_the_rotation_and_follows_the_seed(garments):
    straight = plugins.create("simulators", "xpbd", {"rotation_deg": 0.0})
    straight.reset(garments["square"], 5)
    corners = straight.state().keypoint_positions()
    bottom = corners["bottom_right"] - corners["bottom_left"]
    assert abs(np.degrees(np.arctan2(bottom[1], bottom[0]))) < 3
    turned = plugins.create("simulators", "xpbd", {"rotation_deg": 20.0})
    angles = []
    for seed in range(8):
        turned.reset(garments["square"], seed)
        corners = turned.state().keypoint_positions()
        bottom = corners["bottom_right"] - corners["bottom_left"]
        angles.append(np.degrees(np.arctan2(bottom[1], bottom[0])))
    assert np.ptp(angles) > 5
    assert np.abs(angles).max() < 23


def test_top_of_a_square_is_the_edge_nearest_the_top_of_the_image(garments):
    simulator = plugins.create("simulators", "xpbd", {"rotation_deg": 180.0})
    for seed in range(6):
        simulator.reset(garments["square"], seed)
        y = {name: pixel[1] for name, pixel in simulator.state().keypoint_pixels().items()}
        assert y["top_left"] + y["top_right"] == min(
            y[a] + y[b]
            for a, b in (
                ("bottom_left", "top_left"),
                ("top_left", "top_right"),
                ("top_right", "bottom_right"),
                ("bottom_right", "bottom_left"),
            )
        )


def test_half_fold_lands_on_the_other_half_without_strain(simulator, garments):
    mesh = garments["square"].mesh
    simulator.reset(garments["square"], 1)
    before = simulator.state()
    action = half_of_square(simulator)
    simulator.execute(action)
    after = simulator.state()
    corners = after.keypoint_positions()
    assert np.linalg.norm(corners["bottom_left"] - before.keypoint_positions()["top_left"]) < 0.02
    line = FoldLine.moving(action.picks.mean(axis=0), action.places.mean(axis=0))
    distance = line.distance(before.camera.to_pixels(before.positions)) / before.camera.pixels_per_metre
    assert layer_order(after.positions, distance > 0, distance > 2 * EDGE, 0.5 * EDGE) > 0.98
    assert np.percentile(np.abs(strain(mesh, after.positions)), 99) < 0.2
    assert crossing_edges(mesh, after.positions) < 0.05
    assert np.isfinite(after.positions).all()
    assert (after.positions[:, 2] >= 0).all()


@pytest.mark.parametrize(
    ("kind", "picks", "places"),
    [
        ("tshirt", ["hem_left", "hem_right"], ["shoulder_left", "shoulder_right"]),
        ("pants", ["leg_outer_left", "waist_left"], ["leg_outer_right", "waist_right"]),
    ],
)
def test_two_layered_garments_fold_without_piercing_themselves(simulator, kind, picks, places):
    # Fine enough to show a crease: how many edges pierce the other layer depends on the mesh.
    garment = plugins.generate_garment(kind, SEED, 0.0155)
    simulator.reset(garment, 1)
    simulator.execute(fold_over(simulator, picks, places))
    positions = simulator.state().positions
    assert np.percentile(np.abs(strain(garment.mesh, positions)), 99) < 0.2
    assert crossing_edges(garment.mesh, positions) < 0.06
    rested = simulator.state()
    simulator.wait(0.5)
    assert np.linalg.norm(simulator.state().positions - rested.positions, axis=1).mean() < 0.005


def test_same_seed_gives_the_same_bytes(garments):
    def run():
        simulator = plugins.create("simulators", "xpbd")
        simulator.reset(garments["square"], 7)
        picture = simulator.execute(half_of_square(simulator))
        return picture.rgb.tobytes(), picture.depth.tobytes(), simulator.state().positions.tobytes()

    assert run() == run()


def test_restore_repeats_a_fold_exactly(simulator, garments):
    simulator.reset(garments["square"], 2)
    simulator.execute(half_of_square(simulator))
    start = simulator.state()
    second = fold_over(simulator, ["bottom_left"], ["top_right"])
    first_time = simulator.execute(second).rgb
    ended = simulator.state().positions
    simulator.restore(start)
    np.testing.assert_array_equal(simulator.state().positions, start.positions)
    assert (simulator.execute(second).rgb == first_time).all()
    np.testing.assert_array_equal(simulator.state().positions, ended)


def test_recording_changes_nothing_and_sees_the_motion(simulator, garments):
    simulator.reset(garments["square"], 2)
    start, action = simulator.state(), half_of_square(simulator)
    simulator.execute(action)
    unseen = simulator.state().positions
    simulator.restore(start)
    frames = []
    simulator.record(frames.append, frames_per_second=10)
    simulator.execute(action)
    simulator.record(None)
    np.testing.assert_array_equal(simulator.state().positions, unseen)
    assert len(frames) >= 8
    assert min(frame.depth.min() for frame in frames) < frames[0].camera.elevation - 0.05


def test_a_fold_that_is_broken_off_leaves_the_state_before_it(simulator, garments):
    simulator.reset(garments["square"], 3)
    before, frames = simulator.state().positions, []

    def break_off(picture):
        frames.append(picture)
        if len(frames) == 5:
            raise KeyboardInterrupt

    simulator.record(break_off, frames_per_second=10)
    with pytest.raises(KeyboardInterrupt):
        simulator.execute(half_of_square(simulator))
    simulator.record(None)
    assert np.array_equal(simulator.state().positions, before)
    simulator.wait(0.5)
    assert simulator.state().positions[:, 2].max() < 0.002, "nothing hangs where a gripper was"


def test_pick_off_the_cloth_changes_nothing(simulator, garments):
    simulator.reset(garments["square"], 2)
    before = simulator.state().positions
    simulator.execute(Action(np.array([[5.0, 5.0]]), np.array([[200.0, 200.0]])))
    np.testing.assert_array_equal(simulator.state().positions, before)


def test_the_state_says_how_many_plies_each_arm_held(simulator, garments):
    simulator.reset(garments["tshirt"], 2)
    assert simulator.state().grasped is None
    hem = simulator.state().keypoint_pixels()["hem_left"]
    simulator.execute(Action(np.array([hem, [5.0, 5.0]]), np.array([[hem[0], hem[1] - 60.0], [60.0, 5.0]])))
    after = simulator.state()
    assert after.grasped == (2, 0)
    simulator.reset(garments["tshirt"], 2)
    simulator.restore(after)
    assert simulator.state().grasped == (2, 0)


def test_fingers_that_close_above_a_ply_leave_it_where_it_is(simulator, garments):
    square = garments["square"]
    simulator.reset(square, 2)
    simulator.execute(half_of_square(simulator))
    folded = simulator.state()
    corner, below = (folded.positions[folded.keypoints[name]] for name in ("bottom_left", "top_left"))
    pick = folded.camera.to_pixels(np.array([corner]))
    back = pick + np.array([0.0, 80.0])
    for height, plies in ((square.fabric.thickness, 1), (0.0, 2), (0.01, 0)):
        simulator.restore(folded)
        simulator.execute(Action(pick, back, np.array([height])))
        after = simulator.state()
        assert after.grasped == (plies,)
        stayed = np.linalg.norm(after.positions[after.keypoints["top_left"]] - below)
        went = np.linalg.norm(after.positions[after.keypoints["bottom_left"]] - corner)
        assert (went > 0.05) == (plies > 0)
        assert (stayed > 0.05) == (plies > 1)


def test_arms_that_hold_the_same_cloth_part_no_farther_than_it_reaches(simulator, garments):
    simulator.reset(garments["square"], 2)
    simulator.execute(half_of_square(simulator))
    assert simulator.state().short == (0.0, 0.0)
    simulator.reset(garments["square"], 2)
    rest = strain(garments["square"].mesh, simulator.state().positions)
    corners = simulator.state().keypoint_pixels()
    middle = (corners["top_left"] + corners["top_right"]) / 2
    beside = np.array([[-40.0, 0.0], [40.0, 0.0]])
    simulator.execute(Action(middle + beside, np.array([[5.0, 5.0], [395.0, 5.0]])))
    after = simulator.state()
    assert after.short is not None
    assert min(after.short) > 0.05
    assert np.abs(strain(garments["square"].mesh, after.positions) - rest).max() < 0.25
    simulator.restore(after)
    assert simulator.state().short == after.short


def test_two_grips_on_one_spot_go_together(simulator, garments):
    simulator.reset(garments["pants"], 2)
    pick = simulator.state().keypoint_pixels()["crotch"] - [0.0, 12.0]
    simulator.execute(Action(np.array([pick, pick + 3.0]), np.array([[10.0, 390.0], [390.0, 390.0]])))
    after = simulator.state()
    assert after.short is not None
    assert min(after.short) > 0.2
    assert np.abs(strain(garments["pants"].mesh, after.positions)).max() < 0.25


def test_cloth_that_is_dragged_to_the_corners_of_the_table_keeps_its_size_on_the_way_too(simulator):
    square = plugins.generate_garment("square", 5008, 0.0155)
    simulator.reset(square, 5008)
    seen = []
    simulator.record(lambda _: seen.append(strain(square.mesh, simulator.state().positions).max()), 20.0)
    simulator.execute(Action(np.array([[183.0, 211.0], [228.0, 142.0]]), np.array([[395.0, 4.0], [4.0, 395.0]])))
    assert max(seen) < 0.25
    assert seen[-1] < 0.17


def test_arms_stand_still_where_they_would_tear_the_cloth(simulator):
    towel = plugins.generate_garment("rectangle", 5029, 0.0155)
    simulator.reset(towel, 5029)
    simulator.execute(half_of_square(simulator))
    assert simulator.state().short == (0.0, 0.0)
    simulator.reset(towel, 5029)
    picks, places = np.array([[166.0, 162.0], [204.0, 121.0]]), np.array([[160.5, 4.0], [4.0, 307.3]])
    seen = []
    simulator.record(lambda _: seen.append(strain(towel.mesh, simulator.state().positions).max()), 60.0)
    simulator.execute(Action(picks, places))
    after = simulator.state()
    assert after.short is not None
    assert max(after.short) > 0.05
    assert 0.2 < max(seen) < 0.26


def test_cloth_that_would_be_torn_all_the_same_slips_out_of_the_grip(simulator):
    towel = plugins.generate_garment("square", 5096, 0.0155)
    simulator.reset(towel, 5096)
    simulator.execute(half_of_square(simulator))
    assert simulator.state().slipped == (0.0, 0.0)
    simulator.reset(towel, 5096)
    before = simulator.state()
    picks, places = np.array([[195.0, 236.0], [285.0, 105.0]]), np.array([[49.9, 43.92], [226.06, 49.71]])
    simulator.execute(Action(picks, places))
    after = simulator.state()
    assert max(after.slipped) > 0.0
    assert strain(towel.mesh, after.positions).max() < 0.25
    simulator.restore(before)
    assert simulator.state().slipped is None


def test_cloth_that_is_stretched_where_it_lies_can_be_lifted_all_the_same(simulator):
    towel = plugins.generate_garment("rectangle", 5029, 0.0155)
    simulator.reset(towel, 5029)
    state = simulator.state()
    stretched = state.positions.copy()
    corner = np.linalg.norm(stretched[:, :2] - stretched[:, :2].min(axis=0), axis=1).argmin()
    stretched[corner, :2] -= 0.01
    simulator.restore(replace(state, positions=stretched))
    simulator.execute(half_of_square(simulator))
    assert simulator.state().short == (0.0, 0.0)


@pytest.mark.parametrize("edge_length", [0.03, 0.05])
def test_a_pick_on_the_cloth_is_never_empty_however_coarse_the_mesh(simulator, edge_length):
    square = plugins.generate_garment("square", SEED, edge_length)
    rng = np.random.default_rng(0)
    for _ in range(20):
        simulator.reset(square, 2)
        corners = np.array(list(simulator.state().keypoint_pixels().values()))
        pick = rng.dirichlet(np.ones(len(corners))) @ corners
        before = simulator.state().positions
        simulator.execute(Action(pick[None], pick[None] + [0.0, 40.0]))
        assert simulator.state().grasped == (1,)
        assert np.linalg.norm(simulator.state().positions - before, axis=1).max() > 0.02


def test_action_outside_the_image_is_refused_and_changes_nothing(simulator, garments):
    simulator.reset(garments["square"], 2)
    before = simulator.state().positions
    with pytest.raises(ActionError, match="outside"):
        simulator.execute(Action(np.array([[200.0, 200.0]]), np.array([[500.0, 200.0]])))
    np.testing.assert_array_equal(simulator.state().positions, before)


def test_divergence_is_reported_with_what_reproduces_it_and_undone(simulator, garments):
    simulator.reset(garments["square"], 2)
    action = half_of_square(simulator)
    good = simulator.state()
    broken = good.velocities.copy()
    broken[3] = np.nan
    simulator.restore(type(good)(good.positions, broken, good.keypoints, good.camera, good.extra))
    with pytest.raises(SimulationError, match=r"seed 2002.*picks and places"):
        simulator.execute(action)
    np.testing.assert_array_equal(simulator.state().positions, good.positions)


def test_state_of_another_garment_is_refused(simulator, garments):
    simulator.reset(garments["tshirt"], 2)
    other = simulator.state()
    simulator.reset(garments["square"], 2)
    with pytest.raises(SimulationError, match="particles"):
        simulator.restore(other)


def test_nothing_works_before_reset_or_after_close(simulator, garments):
    with pytest.raises(SimulationError, match="reset"):
        simulator.observe()
    simulator.reset(garments["square"], 2)
    simulator.close()
    with pytest.raises(SimulationError, match="reset"):
        simulator.state()


def test_two_identical_picks_hold_the_cloth_once(simulator, garments):
    simulator.reset(garments["square"], 2)
    pixels = simulator.state().keypoint_pixels()
    pick, place = pixels["bottom_left"], pixels["top_right"]
    simulator.execute(Action(np.stack([pick, pick]), np.stack([place, place])))
    assert np.isfinite(simulator.state().positions).all()


def test_pick_equal_to_place_leaves_the_cloth_flat(simulator, garments):
    simulator.reset(garments["square"], 2)
    before = simulator.state()
    pick = before.keypoint_pixels()["bottom_left"][None]
    simulator.execute(Action(pick, pick))
    moved = np.linalg.norm(simulator.state().positions - before.positions, axis=1)
    assert moved.mean() < 0.005


@pytest.mark.parametrize("fabric", ["jersey", "felt"])
def test_plies_lie_as_high_as_the_fabric_is_thick(simulator, fabric):
    shirt = plugins.generate_garment("tshirt", SEED, EDGE, ComponentSpec(name=fabric))
    simulator.reset(shirt, 0)
    inner = ~shirt.mesh.seam
    heights = simulator.state().positions[inner, 2] / shirt.fabric.thickness
    front = shirt.mesh.layer[inner] == 1
    assert np.median(heights[~front]) == pytest.approx(0.5, abs=0.1)
    assert np.median(heights[front]) == pytest.approx(1.5, abs=0.2)


def test_what_the_fabric_decides_is_no_parameter_of_the_simulator():
    for name, says in (("thickness", "use fabric.thickness"), ("bending_length", "fabric.bending_length_warp")):
        with pytest.raises(ConfigError, match=says):
            plugins.create("simulators", "xpbd", {name: 0.002})
