"""Plans of folds: who does what, from parked to parked, within limits and without touching anything."""

from itertools import pairwise

import numpy as np
import pytest
from polyfold_pybullet.cell import Cell
from polyfold_pybullet.planning import FoldPlan, Infeasible

from polyfold.errors import ActionError

Z = 0.004
HALF = [[-0.2, -0.15, Z], [0.2, -0.15, Z]], [[-0.2, 0.15, Z], [0.2, 0.15, Z]]


@pytest.fixture(scope="module")
def half(planner):
    """A cloth of 40 cm, folded in half away from the robot."""
    plan = planner.plan(*HALF)
    assert isinstance(plan, FoldPlan), plan
    return plan


def motion(plan, name):
    return next(motion for motion in plan.motions if motion.name == name)


def tool(planner, arm, joints):
    return planner.kinematics[arm].forward(joints)


def test_a_fold_in_half_is_done_by_both_arms_at_once_each_at_its_own_side(half):
    assert half.mode == "at once"
    assert half.arms == (0, 1)


def test_it_begins_and_ends_parked_and_never_leaps(half, planner):
    for arm, kinematics in enumerate(planner.kinematics):
        rows = [moved.joints[arm] for moved in half.motions]
        np.testing.assert_allclose(rows[0][0], kinematics.park, atol=1e-6)
        np.testing.assert_allclose(rows[-1][-1], kinematics.park, atol=1e-6)
        for before, after in pairwise(rows):
            np.testing.assert_allclose(before[-1], after[0], atol=1e-6)


def test_tools_are_at_picks_when_hands_close_and_at_places_when_they_open(half, planner):
    picks, places = map(np.array, HALF)
    carry = motion(half, "carry")
    assert carry.closed == (True, True)
    assert [moved.closed for moved in half.motions if moved is not carry] == [(False, False)] * (len(half.motions) - 1)
    for pick, place, arm in zip(picks, places, half.arms, strict=True):
        rows = carry.joints[arm]
        assert np.linalg.norm(tool(planner, arm, rows[0])[:3, 3] - pick) < 1e-3
        assert np.linalg.norm(tool(planner, arm, rows[-1])[:3, 3] - place) < 1e-3
        heights = [tool(planner, arm, row)[2, 3] for row in rows]
        assert max(heights) == pytest.approx(Z + 0.4 * 0.3, abs=0.01), "cloth is lifted on its way"


def test_the_wide_side_of_each_hand_is_across_the_line_between_the_tools(half, planner):
    for arm in (0, 1):
        for row in motion(half, "carry").joints[arm][[0, -1]]:
            wide = tool(planner, arm, row)[:3, 1]
            assert abs(wide[0]) < 0.02, "the line between these tools is along x"


def test_no_joint_passes_its_limits(half, planner):
    for moved in half.motions:
        for kinematics, joints in zip(planner.kinematics, moved.joints, strict=True):
            chain = kinematics.chain
            assert (joints >= chain.lower).all()
            assert (joints <= chain.upper).all()
            speed = np.gradient(joints, moved.times, axis=0)
            change = np.gradient(speed, moved.times, axis=0)[2:-2]
            assert (np.abs(speed) <= chain.velocity * 1.01).all()
            assert (np.abs(change) <= np.array(kinematics.arm.acceleration) * 1.03).all()


def test_nothing_is_touched_in_between_either(half):
    from polyfold_pybullet.robots import panda

    with Cell(panda()) as fresh:
        for moved in half.motions:
            times = np.linspace(0, moved.duration, 150)
            for left, right in zip(*moved.at(times), strict=True):
                assert fresh.near_obstacles(0, left) is None
                assert fresh.near_obstacles(1, right) is None
                near = fresh.near_each_other(left, right)
                assert near is None or near.distance > 0.01


def test_crossed_picks_are_taken_by_the_arms_they_are_near(planner):
    picks, places = (np.array(points)[::-1] for points in HALF)
    plan = planner.plan(picks, places)
    assert plan.arms == (1, 0)


def test_what_both_arms_can_not_do_at_once_they_do_one_after_the_other(planner):
    plan = planner.plan([[0.05, 0.05, Z], [0.05, 0.08, Z]], [[-0.15, 0.05, Z], [-0.15, 0.08, Z]])
    assert plan.mode == "in sequence"
    closed = [moved.closed for moved in plan.motions if moved.name == "carry"]
    assert len(closed) == 2
    assert all(sum(hands) == 1 for hands in closed)


def test_one_pick_is_done_by_the_nearer_arm_while_the_other_stays_parked(planner):
    plan = planner.plan([[0.25, 0.0, Z]], [[0.05, 0.0, Z]])
    assert (plan.mode, plan.arms) == ("one arm", (1,))
    for moved in plan.motions:
        np.testing.assert_allclose(moved.joints[0], np.tile(planner.kinematics[0].park, (len(moved.times), 1)))


def test_a_place_beyond_reach_is_an_answer_with_its_reason_and_no_error(planner):
    answer = planner.plan([[0.2, 0.0, Z]], [[0.2, 0.9, Z]])
    assert isinstance(answer, Infeasible)
    assert answer.stage == "reach"
    assert "can't reach (0.200, 0.900, 0.0" in answer.reason
    assert "\n" not in answer.reason


def test_the_same_fold_is_planned_alike(half, planner):
    again = planner.plan(*HALF)
    for one, other in zip(half.motions, again.motions, strict=True):
        np.testing.assert_array_equal(one.joints[0], other.joints[0])


@pytest.mark.parametrize("picks", [[[0.1, 0.1]], [[0.1, 0.1, Z]] * 3, [[np.nan, 0.0, Z]]])
def test_picks_that_are_no_points_are_refused(planner, picks):
    with pytest.raises(ActionError, match="in metres"):
        planner.plan(picks, picks)


def test_tools_that_are_near_to_each_other_lean_apart(planner):
    picks, places = [[-0.05, 0.02, 0.0], [0.05, 0.02, 0.0]], [[-0.05, 0.16, 0.0], [0.05, 0.16, 0.0]]
    plan = planner.plan(picks, places)
    assert isinstance(plan, FoldPlan)
    assert plan.mode == "at once"
    carry = next(motion for motion in plan.motions if motion.name == "carry")
    wrists = []
    for arm, joints in enumerate(carry.joints):
        tool = planner.kinematics[arm].forward(joints[0])
        lean = np.degrees(np.arccos(-tool[2, 2]))
        assert lean == pytest.approx(20, abs=2)
        wrists.append(tool[:3, 3] - 0.1 * tool[:3, 2])
    tips = [planner.kinematics[arm].forward(joints[0])[:3, 3] for arm, joints in enumerate(carry.joints)]
    assert np.linalg.norm(wrists[0] - wrists[1]) > np.linalg.norm(tips[0] - tips[1]) + 0.05
