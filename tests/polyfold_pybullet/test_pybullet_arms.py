"""The robot ``pybullet``, as whoever drives a robot uses it."""

import numpy as np
import pytest

from polyfold import plugins
from polyfold.errors import ConfigError, RobotError
from polyfold.plugins.hardware import Infeasible, Robot, RobotPlan

Z = 0.004
PICKS, PLACES = [[-0.2, -0.15, Z], [0.2, -0.15, Z]], [[-0.2, 0.1, Z], [0.2, 0.1, Z]]


@pytest.fixture
def robot():
    made = plugins.create("robots", "pybullet")
    made.connect()
    yield made
    made.close()


def test_it_is_a_robot_that_opens_and_moves_nothing_when_it_is_made(monkeypatch):
    import pybullet

    monkeypatch.setattr(pybullet, "connect", lambda *_: pytest.fail("connected on construction"))
    made = plugins.create("robots", "pybullet", {"speed": 0.2})
    assert isinstance(made, Robot)
    assert made.arms == ("left", "right")
    for call in (
        made.park,
        lambda: made.plan(PICKS, PLACES),
        lambda: made.joint_state(0),
        lambda: made.gripper(0, True),
    ):
        with pytest.raises(RobotError, match="call connect first"):
            call()
    made.close()


def test_a_fold_is_planned_without_moving_and_executed_from_parked_to_parked(robot):
    parked = [robot.joint_state(arm) for arm in (0, 1)]
    plan = robot.plan(PICKS, PLACES)
    assert isinstance(plan, RobotPlan)
    np.testing.assert_array_equal([robot.joint_state(arm) for arm in (0, 1)], parked)

    seen = []
    robot.execute(plan, watch=lambda time: seen.append((time, robot.tcp_pose(0)[:3, 3], robot.tcp_pose(1)[:3, 3])))
    times, left, right = (np.array(column) for column in zip(*seen, strict=True))
    assert (np.diff(times) >= 0).all()
    assert times[-1] == pytest.approx(plan.duration, abs=0.01)
    for tool, points in ((left, (PICKS[0], PLACES[0])), (right, (PICKS[1], PLACES[1]))):
        for point in points:
            assert np.linalg.norm(tool - point, axis=1).min() < 1e-3
    np.testing.assert_allclose([robot.joint_state(arm) for arm in (0, 1)], parked, atol=1e-6)


def test_half_the_speed_takes_about_twice_as_long(robot):
    slow = plugins.create("robots", "pybullet", {"speed": 0.25})
    slow.connect()
    fast, slowly = robot.plan(PICKS, PLACES).duration, slow.plan(PICKS, PLACES).duration
    slow.close()
    assert 2 < slowly / fast <= 4


def test_stop_leaves_the_arms_where_they_are_until_they_are_parked(robot):
    plan = robot.plan(PICKS, PLACES)

    def watch(time):
        if time > plan.duration / 2:
            robot.stop()

    with pytest.raises(RobotError, match="then call park"):
        robot.execute(plan, watch)
    rests = robot.joint_state(0)
    for call in (lambda: robot.execute(plan), lambda: robot.gripper(0, True), lambda: robot.move_linear(0, np.eye(4))):
        with pytest.raises(RobotError, match="were stopped"):
            call()
    np.testing.assert_array_equal(robot.joint_state(0), rests)
    robot.park()
    robot.execute(robot.plan(PICKS, PLACES))


def test_arms_that_were_stopped_while_their_tips_press_on_the_table_can_be_parked(robot):
    parked = [robot.joint_state(arm) for arm in (0, 1)]
    on_the_table = np.array(PICKS) * [1, 1, 0]
    plan = robot.plan(on_the_table, PLACES)
    assert isinstance(plan, RobotPlan)

    def stop(time):
        if robot.tcp_pose(0)[2, 3] < 0.001:
            robot.stop()

    with pytest.raises(RobotError, match="were stopped"):
        robot.execute(plan, watch=stop)
    assert robot.tcp_pose(0)[2, 3] < 0.001
    robot.park()
    np.testing.assert_allclose([robot.joint_state(arm) for arm in (0, 1)], parked, atol=1e-6)


def test_a_plan_from_elsewhere_is_not_begun(robot):
    plan = robot.plan(PICKS, PLACES)
    up = robot.tcp_pose(0)
    up[2, 3] += 0.05
    robot.move_linear(0, up)
    np.testing.assert_allclose(robot.tcp_pose(0), up, atol=2e-3)
    with pytest.raises(RobotError, match="call park first"):
        robot.execute(plan)
    with pytest.raises(RobotError, match="no plan of these arms"):
        robot.execute(object())


def test_a_line_through_the_table_is_refused_and_nothing_moves(robot):
    before = robot.joint_state(1)
    under = robot.tcp_pose(1)
    under[:3, 3] = 0.3, 0.0, -0.1
    with pytest.raises(RobotError, match="; choose another pose"):
        robot.move_linear(1, under)
    np.testing.assert_array_equal(robot.joint_state(1), before)


def test_a_fold_beyond_reach_is_an_answer(robot):
    answer = robot.plan([[0.0, 0.0, Z]], [[0.0, 1.0, Z]])
    assert isinstance(answer, Infeasible)
    assert answer.stage == "reach"


def test_hands_say_how_wide_they_are_and_limits_are_those_of_the_joints(robot):
    assert robot.gripper(0, True) == 0.0
    assert robot.gripper(0, False) == pytest.approx(0.04)
    limits = robot.limits(1)
    assert limits.lower.shape == limits.velocity.shape == limits.acceleration.shape == (7,)
    assert (limits.lower < robot.joint_state(1)).all()


def test_an_unknown_robot_is_told_on_connecting():
    made = plugins.create("robots", "pybullet", {"robot": "yummi"})
    with pytest.raises(ConfigError, match="did you mean 'yumi'"):
        made.connect()


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan"), float("inf")])
def test_a_speed_that_is_none_moves_nothing(robot, speed):
    before = robot.joint_state(0)
    with pytest.raises(RobotError, match="give a speed above 0"):
        robot.move_linear(0, robot.tcp_pose(0), speed=speed)
    np.testing.assert_array_equal(robot.joint_state(0), before)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"urdf": "/"}, "no URDF that can be read"),
        ({"urdf": "/nowhere.urdf"}, "/nowhere.urdf is no URDF"),
        ({"tips": ("nope",)}, "lacks some of the left arm's tips nope; its links are"),
        ({"fingers": ("nope",)}, "lacks some of the left arm's fingers"),
        ({"joints": tuple(f"joint{k}" for k in range(7))}, "joint0"),
    ],
)
def test_what_a_model_s_file_does_not_hold_is_named(change, message):
    from polyfold_pybullet.robots import panda

    model = panda()
    arms = (model.arms[0].model_copy(update=change), model.arms[1])
    made = plugins.create("robots", "pybullet", {"model": model.model_copy(update={"arms": arms}).model_dump()})
    with pytest.raises(ConfigError, match=message):
        made.connect()


@pytest.mark.parametrize(
    "params", [{"speed": 1e-9}, {"carry_speed": 1e-9}, {"interval": 1e-9}, {"transit_speed": float("inf")}]
)
def test_motions_that_would_never_end_are_refused(params):
    with pytest.raises(ConfigError):
        plugins.create("robots", "pybullet", params)
