"""ABB's arms through the real client, against a controller of this machine."""

import threading
import time

import numpy as np
import pytest
from loopback_irc5 import Irc5, as_abb, serve
from polyfold_pybullet.planning import FoldPlan

from polyfold import plugins
from polyfold.errors import ConfigError, RobotError
from polyfold.plugins.hardware import Robot

PICKS, PLACES = [[-0.12, -0.08, 0.0], [0.12, -0.08, 0.0]], [[-0.12, 0.08, 0.002], [0.12, 0.08, 0.002]]


@pytest.fixture
def irc5(pandas):
    from polyfold_pybullet.robots import panda

    return Irc5([as_abb(arm.park or arm.home) for arm in panda().arms])


@pytest.fixture
def arms(irc5):
    with serve(irc5) as url:
        made = plugins.create("robots", "abb", {"url": url, "robot": "panda"})
        assert isinstance(made, Robot)
        yield made
        made.close()


def test_connecting_moves_nothing_and_reads_where_the_arms_are(arms, irc5):
    arms.connect()
    *axes, seventh = irc5.joints["ROB_1"]
    assert np.degrees(arms.joint_state(0)) == pytest.approx(np.insert(axes, 2, seventh))
    assert not irc5.ran
    assert not irc5.signals
    assert not irc5.stopped
    assert arms.tcp_pose(0)[2, 3] > 0.1


def test_a_fold_runs_as_programs_of_both_arms_in_step(arms, irc5):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    assert isinstance(plan, FoldPlan)
    irc5.ran.clear()
    told = []
    arms.execute(plan, told.append)
    assert len(irc5.ran) == len(plan.motions)
    for motion, programs in zip(plan.motions, irc5.ran, strict=True):
        assert len(programs[0]) == len(programs[1]), "both have a point for each point of the other"
        for joints, rows in zip(motion.joints, programs, strict=True):
            assert rows[-1][0][:7] == pytest.approx(as_abb(joints[-1]), abs=1e-3)
            assert [row[2][0] for row in rows] == [0.0] * (len(rows) - 1) + [1.0], "only the last point is a stop"
            assert all(1.0 <= row[1][0] <= 260.0 for row in rows), "no tool is faster than 0.25 m/s and a rounding"
    assert set(irc5.signals) == {"polyfold_close_1", "polyfold_close_2"}
    assert set(irc5.signals.values()) == {"0"}, "the hands are open at the end"
    assert told


def test_speeds_bring_a_move_to_its_planned_time(arms, irc5):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    motion = max(plan.motions, key=lambda motion: motion.duration)
    left, _ = arms._link.programs(motion)
    kinematics = arms._ready()[1].kinematics[0]
    spent = 0.0
    poses = [kinematics.forward(motion.joints[0][0])]
    for command in left._commands[1:-1]:
        joints = np.radians(np.insert(command.to_joint_pos.robax, 2, command.to_joint_pos.extax[0]))
        poses.append(kinematics.forward(joints))
        way = 1000 * np.linalg.norm(poses[-1][:3, 3] - poses[-2][:3, 3])
        spent += way / command.speed.v_tcp
    assert spent == pytest.approx(motion.duration, rel=0.25)


@pytest.mark.parametrize(
    ("trouble", "says"),
    [("motoroff", r"motors .* are off"), ("running", "a program runs"), ("away", "said: .*check the address")],
)
def test_a_controller_that_is_not_ready_is_told_so(irc5, trouble, says):
    with serve(irc5) as url:
        if trouble == "motoroff":
            irc5.motors = "motoroff"
        if trouble == "running":
            irc5.running = True
        there = "http://127.0.0.1:9" if trouble == "away" else url
        made = plugins.create("robots", "abb", {"url": there, "robot": "panda"})
        with pytest.raises(RobotError, match=says):
            made.connect()
        assert not irc5.stopped, "what others run is left alone"


def test_a_program_that_fails_stops_everything_and_says_what_the_controller_says(arms, irc5):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    irc5.fails = "joint out of range"
    with pytest.raises(RobotError, match="joint out of range"):
        arms.execute(plan)
    with pytest.raises(RobotError, match="call park"):
        arms.gripper(0, True)


def test_a_stop_from_another_thread_ends_the_program_and_park_goes_on(arms, irc5):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    irc5.seconds = 60.0

    def stop():
        while not irc5.running:
            time.sleep(0.01)
        arms.stop()

    threading.Thread(target=stop, daemon=True).start()
    clock = time.monotonic()
    with pytest.raises(RobotError, match="were stopped"):
        arms.execute(plan)
    assert time.monotonic() - clock < irc5.seconds / 2
    assert irc5.stopped
    irc5.seconds = 0.0
    arms.park()


def test_an_arm_that_does_not_arrive_is_noticed(arms, irc5):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    irc5.blocked = {1}
    with pytest.raises(RobotError, match="rad from where its motion ends"):
        arms.execute(plan)


def test_arms_that_are_elsewhere_do_not_begin(arms, irc5):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    irc5.joints["ROB_2"][1] += 5.0
    ran = len(irc5.ran)
    with pytest.raises(RobotError, match="call park first"):
        arms.execute(plan)
    assert len(irc5.ran) == ran


@pytest.mark.parametrize("trouble", ["watcher", "deaf"])
def test_whatever_goes_wrong_the_program_is_stopped(arms, irc5, trouble):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    irc5.seconds = 5.0

    def watch(time):
        if trouble == "watcher":
            raise KeyError("watch")
        irc5.silent = {"GET"}

    with pytest.raises(KeyError if trouble == "watcher" else RobotError):
        arms.execute(plan, watch)
    irc5.silent = set()
    assert irc5.stopped or not irc5.started
    assert not irc5.running


def test_a_stop_during_the_upload_keeps_the_program_from_starting(arms, irc5):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    started = irc5.started
    irc5.on_upload = arms.stop
    with pytest.raises(RobotError, match="were stopped"):
        arms.execute(plan)
    assert irc5.started == started


def test_a_stop_just_before_the_controller_begins_stops_what_it_begins(arms, irc5):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    irc5.seconds, irc5.on_start = 5.0, arms.stop
    with pytest.raises(RobotError, match="were stopped"):
        arms.execute(plan)
    assert irc5.stopped == 2, "once too early, and once it ran"
    assert not irc5.running


def test_a_controller_that_falls_silent_is_given_up_and_said_to_move_on(arms, irc5, monkeypatch):
    monkeypatch.setattr("polyfold_pybullet.drivers.abb.ANSWERS", 0.2)
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    irc5.seconds = 5.0

    def watch(time):
        irc5.silent = {"GET", "POST"} if irc5.running else set()

    with pytest.raises(RobotError, match="may still move; press the emergency stop"):
        arms.execute(plan, watch)
    irc5.silent = set()


def test_a_hand_is_as_wide_as_its_signal_says(irc5):
    with serve(irc5) as url:
        settings = {"url": url, "robot": "panda", "width_signals": ["width_1", "width_2"]}
        made = plugins.create("robots", "abb", settings)
        made.connect()
        irc5.signals["width_2"] = "31.5"
        assert made.gripper(1, True) == pytest.approx(0.0315)
        assert irc5.signals["polyfold_close_2"] == "1"
        made.close()


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"url": "192.168.125.1"}, "begins with http"),
        ({"units": ["ROB_1", "ROB_1"]}, "each has its own"),
        ({"close_signals": ["close", "close"]}, "each has its own"),
    ],
)
def test_settings_that_fit_no_cell_are_refused(wrong, says):
    with pytest.raises(ConfigError, match=says):
        plugins.create("robots", "abb", {"url": "http://x", **wrong})


def test_names_of_tasks_that_would_share_a_file_are_refused():
    with pytest.raises(ConfigError, match="end in a number of their own"):
        plugins.create("robots", "abb", {"url": "http://x", "tasks": ["T_ROB_L", "T_ROB_R"]})
