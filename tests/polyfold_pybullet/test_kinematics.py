"""Kinematics: where the tool is, how it moves, and joint angles for where it is wanted."""

import importlib.util

import numpy as np
import pybullet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from polyfold_pybullet.kinematics import Kinematics, OutOfReach, Reached
from polyfold_pybullet.planning.grasping import top_down
from polyfold_pybullet.robots import panda, robot_model

LEFT, RIGHT = (Kinematics(arm) for arm in panda().arms)
SEEDS = st.integers(0, 2**32 - 1)


def drawn(kinematics, seed, count=1):
    chain = kinematics.chain
    return np.random.default_rng(seed).uniform(chain.lower, chain.upper, (count, len(chain)))


def angle_between(one, other):
    return np.arccos(np.clip((np.trace(one[:3, :3].T @ other[:3, :3]) - 1) / 2, -1, 1))


def within_limits(kinematics, joints):
    return (joints >= kinematics.chain.lower).all() and (joints <= kinematics.chain.upper).all()


@pytest.mark.parametrize("arm", [0, 1])
def test_the_tool_is_where_pybullet_has_it(pandas, arm):
    kinematics, body = (LEFT, RIGHT)[arm], pandas.arms[arm]
    hand = next(link for link, name in body.links.items() if name == kinematics.arm.tool_link)
    for joints in drawn(kinematics, 1, 20):
        pandas.set_arm(arm, joints)
        state = pybullet.getLinkState(body.number, hand, computeForwardKinematics=1, physicsClientId=pandas.client)
        turned = np.reshape(pybullet.getMatrixFromQuaternion(state[5]), (3, 3))
        tool = kinematics.forward(joints)
        np.testing.assert_allclose(tool[:3, :3], turned, atol=1e-5)
        np.testing.assert_allclose(tool[:3, 3], state[4] + turned @ kinematics.arm.tool_position, atol=1e-5)


@given(SEEDS)
@settings(max_examples=30, deadline=None)
def test_the_jacobian_is_the_derivative_of_the_pose(seed):
    joints, step = drawn(LEFT, seed)[0], 1e-6
    jacobian, here = LEFT.jacobian(joints), LEFT.forward(joints)
    for index in range(len(joints)):
        moved = joints.copy()
        moved[index] += step
        there = LEFT.forward(moved)
        turn = (there[:3, :3] @ here[:3, :3].T - np.eye(3)) / step
        np.testing.assert_allclose(jacobian[:3, index], (there - here)[:3, 3] / step, atol=1e-5)
        np.testing.assert_allclose(jacobian[3:, index], [turn[2, 1], turn[0, 2], turn[1, 0]], atol=1e-5)


@given(SEEDS)
@settings(max_examples=60, deadline=None)
def test_every_pose_of_joints_within_limits_is_reached(seed):
    pose = RIGHT.forward(drawn(RIGHT, seed)[0])
    answer = RIGHT.inverse(pose)
    assert isinstance(answer, Reached)
    found = RIGHT.forward(answer.joints)
    assert np.linalg.norm(found[:3, 3] - pose[:3, 3]) <= 1e-3
    assert angle_between(found, pose) <= 0.02
    assert within_limits(RIGHT, answer.joints)


@given(
    st.floats(-0.3, 0.3), st.floats(-0.25, 0.15), st.floats(0.0, 0.2), st.floats(-np.pi, np.pi), st.sampled_from([0, 1])
)
@settings(max_examples=60, deadline=None)
def test_hands_that_point_down_reach_the_middle_of_the_table_on_their_side(x, y, z, yaw, arm):
    kinematics = (LEFT, RIGHT)[arm]
    pose = top_down([abs(x) * (1 if arm else -1), y, z], yaw)
    answer = kinematics.inverse(pose)
    assert isinstance(answer, Reached), answer
    assert kinematics.error(answer.joints, pose) == pytest.approx((answer.position_error, answer.rotation_error))
    assert answer.position_error <= 1e-3


def test_the_free_joint_is_drawn_towards_home():
    pose = LEFT.forward(LEFT.home)
    lean = LEFT.leaning(pose, LEFT.home, [1.0])[0]
    assert np.abs(lean - LEFT.home).max() > 0.5, "another posture of the same pose"
    back = LEFT.inverse(pose, near=lean)
    assert np.abs(back.joints - LEFT.home).max() < np.abs(lean - LEFT.home).max() / 2


def test_the_same_pose_is_answered_alike():
    pose = LEFT.forward(drawn(LEFT, 5)[0])
    np.testing.assert_array_equal(LEFT.inverse(pose).joints, LEFT.inverse(pose).joints)


def test_what_is_too_far_away_is_said_to_be():
    answer = LEFT.inverse(top_down([2.0, 2.0, 0.1], 0.0))
    assert isinstance(answer, OutOfReach)
    assert "the left arm can't reach (2.000, 2.000, 0.100) m" in answer.reason
    assert "from its shoulder" in answer.reason


def test_what_only_the_limits_of_joints_forbid_is_said_to_be_so():
    under = LEFT.forward(LEFT.home)
    under[:3, 3] = *LEFT.chain.origins[0][:2, 3], 0.05  # within its own base
    answer = LEFT.inverse(under)
    assert isinstance(answer, OutOfReach)
    assert "limits of its joints" in answer.reason


def test_a_path_without_leaps_is_followed_and_one_with_leaps_is_not():
    start = LEFT.home
    poses = np.repeat(LEFT.forward(start)[None], 12, axis=0)
    poses[:, 2, 3] -= np.linspace(0, 0.2, 12)
    path = LEFT.follow(poses, start)
    assert np.abs(np.diff(path, axis=0)).max() < 0.2
    assert max(LEFT.error(row, pose)[0] for row, pose in zip(path, poses, strict=True)) < 1e-3
    assert LEFT.follow(poses[[0, 0]] + np.array([np.zeros((4, 4)), 0.5 * np.eye(4, k=3)]), start) is None


@pytest.mark.skipif(importlib.util.find_spec("rtbdata") is None, reason="rtb-data is not installed")
@pytest.mark.parametrize("arm", [0, 1])
def test_the_yumi_reaches_what_its_joints_allow(arm):
    kinematics = Kinematics(robot_model("yumi").arms[arm])
    for pose in kinematics.along(drawn(kinematics, 3, 50)):
        assert isinstance(kinematics.inverse(pose), Reached)
