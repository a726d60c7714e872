"""Two UR arms: stand-ins for the library's controllers, and hands that really talk over a socket."""

import socketserver
import sys
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from polyfold_pybullet.drivers.robotiq import RobotiqHand
from polyfold_pybullet.drivers.ur import LATE, UrArms
from polyfold_pybullet.planning import FoldPlan
from polyfold_pybullet.robots import panda
from pydantic import ValidationError

from polyfold.errors import RobotError
from polyfold.plugins.hardware import Robot

PICKS, PLACES = [[-0.12, -0.08, 0.0], [0.12, -0.08, 0.0]], [[-0.12, 0.08, 0.002], [0.12, 0.08, 0.002]]
LEFT, RIGHT = "127.0.0.1", "localhost"


class Hand(socketserver.StreamRequestHandler):
    """The URCap's side of the protocol; it takes a moment to take over a position, and cloth stops it at 200."""

    def handle(self):
        state = self.server.state
        while line := self.rfile.readline():
            verb, *words = line.decode().split()
            if verb == "SET":
                told = dict(zip(words[::2], map(int, words[1::2]), strict=True))
                state.update(told)
                state["asked"] += "POS" in told
                self.wfile.write(b"ack\n")
                continue
            (name,) = words
            if name == "OBJ":
                state["slow"] = max(0, state["slow"] - 1)
            value = {
                "FLT": state["FLT"],
                "STA": state["STA"],
                "PRE": state["POS"],
                "POS": min(state["POS"], 200),
                "OBJ": 0 if state["slow"] else 3,
            }[name]
            self.wfile.write(f"{name} {value}\n".encode())


@pytest.fixture
def hand():
    server = socketserver.ThreadingTCPServer(("127.0.0.1", 0), Hand)
    server.daemon_threads = True
    server.state = {"STA": 3, "POS": 0, "FLT": 0, "GTO": 0, "asked": 0, "slow": 2}
    threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


class Controller:
    """One arm: it is where it was last sent."""

    def __init__(self, joints):
        self.joints, self.sent, self.stops, self.trouble = np.array(joints, float), [], 0, None
        self.open, self.listens, self.opened, self.times = False, True, 0, []
        self.clock = None


class Clock:
    """Time that passes only while somebody waits."""

    def __init__(self):
        self.now = 0.0

    def monotonic(self):
        return self.now

    def sleep(self, seconds):
        self.now += seconds


@pytest.fixture
def controllers(monkeypatch):
    time = Clock()
    monkeypatch.setattr("polyfold_pybullet.drivers.ur.time", time)
    arms = {host: Controller(arm.park or arm.home) for host, arm in zip((LEFT, RIGHT), panda().arms, strict=True)}

    for arm in arms.values():
        arm.clock = time

    class Interface:
        def __init__(self, host):
            self.arm = arms[host]
            if self.arm.trouble == "away":
                raise RuntimeError("Connection refused")

        def disconnect(self):
            pass

    class Control(Interface):
        def __init__(self, host):
            super().__init__(host)
            self.arm.open = True
            self.arm.opened += 1

    def servo(self, joints, speed, acceleration, interval, lookahead, gain):
        self.arm.sent.append(np.array(joints))
        self.arm.times.append(self.arm.clock.monotonic())
        if self.arm.trouble != "stuck":
            self.arm.joints = np.array(joints)
        if self.arm.trouble == "touches" and len(self.arm.sent) == 5:
            self.arm.trouble = "protective"
        return self.arm.trouble != "deaf"

    def stop(self, deceleration):
        if self.arm.trouble == "lost":
            raise RuntimeError("no connection")
        self.arm.stops += 1

    def upload(self):
        self.arm.listens = True
        return True

    def leave(self):
        self.arm.open = False

    # The library's names are not Python's usual ones.
    for name, method in {"servoJ": servo, "servoStop": stop, "stopScript": leave, "reuploadScript": upload}.items():
        setattr(Control, name, method)
    Control.isProgramRunning = lambda self: self.arm.listens
    Receive = type("Receive", (Interface,), {
        "getActualQ": lambda self: self.arm.joints.tolist(),
        "getSafetyMode": lambda self: {"emergency": 7, "protective": 3, "guard": 5}.get(self.arm.trouble, 1),
        "isConnected": lambda self: self.arm.trouble != "lost",
    })  # fmt: skip
    monkeypatch.setitem(sys.modules, "rtde_control", SimpleNamespace(RTDEControlInterface=Control))
    monkeypatch.setitem(sys.modules, "rtde_receive", SimpleNamespace(RTDEReceiveInterface=Receive))
    return arms


@pytest.fixture
def arms(controllers, hand):
    fast = {"interval": 0.1, "speed": 1.0, "carry_speed": 1.0, "transit_speed": 1.0}
    made = UrArms(UrArms.Config(hosts=(LEFT, RIGHT), model=panda(), hand_port=hand.server_address[1], **fast))
    yield made
    made.close()


def test_both_arms_follow_the_plan_in_step_and_the_hands_close_between(arms, controllers, hand):
    assert isinstance(arms, Robot)
    arms.connect()
    arms.connect()
    assert [arm.opened for arm in controllers.values()] == [1, 1], "connected once"
    assert not any(arm.sent for arm in controllers.values()), "connecting moves nothing"
    assert not hand.state["asked"], "nor the hands"
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    assert isinstance(plan, FoldPlan)
    arms.execute(plan)
    left, right = controllers[LEFT], controllers[RIGHT]
    assert len(left.sent) == len(right.sent)
    assert np.abs(np.diff(left.sent, axis=0)).max() < 0.1 * 3.0, "no joint is faster than its limit"
    for joints, arm in zip(plan.motions[-1].joints, (left, right), strict=True):
        assert arm.joints == pytest.approx(joints[-1])
    assert hand.state["asked"] == 6, "each hand was opened, closed and opened"
    assert hand.state["POS"] == 0


@pytest.mark.parametrize(
    ("trouble", "says"),
    [
        ("touches", "to protect itself"),
        ("guard", "by a safeguard"),
        ("emergency", "emergency stop"),
        ("stuck", "behind its set points"),
        ("deaf", "takes no more set points"),
    ],
)
def test_trouble_of_one_arm_stops_both(arms, controllers, trouble, says):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    controllers[RIGHT].trouble = trouble
    with pytest.raises(RobotError, match=says):
        arms.execute(plan)
    assert controllers[LEFT].stops
    assert controllers[RIGHT].stops
    sent = len(controllers[LEFT].sent)
    with pytest.raises(RobotError, match="call park"):
        arms.execute(plan)
    assert len(controllers[LEFT].sent) == sent
    assert sent < 60, "the other arm was not sent on to the end"


def test_an_arm_that_can_not_be_told_to_stop_does_not_keep_the_other_from_it(arms, controllers):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    controllers[LEFT].trouble = "lost"
    with pytest.raises(RobotError, match="may still move; press the emergency stop"):
        arms.execute(plan)
    assert controllers[RIGHT].stops
    with pytest.raises(RobotError, match="may still move"):
        arms.close()
    assert not controllers[RIGHT].open, "it was released all the same"
    controllers[LEFT].trouble = None


def test_hands_that_may_hold_something_are_opened_before_anything_else(arms, hand):
    hand.state["POS"] = 255
    arms.connect()
    plan = arms.plan(PICKS, PLACES)
    with pytest.raises(RobotError, match="nobody knows what the hands hold; call park first"):
        arms.execute(plan)
    arms.park()
    assert hand.state["POS"] == 0
    hand.state["FLT"] = 9
    with pytest.raises(RobotError, match="reports the fault 9"):
        arms.park()
    hand.state["FLT"] = 0


@pytest.mark.parametrize("said", [[np.nan] * 7, [0.0] * 6])
def test_joints_that_are_none_are_refused(arms, controllers, said):
    arms.connect()
    controllers[RIGHT].joints = np.array(said)
    with pytest.raises(RobotError, match="check which arm is connected"):
        arms.park()
    assert not controllers[LEFT].sent


def test_a_move_begins_where_the_arm_is_and_not_where_it_was(arms, controllers):
    arms.connect()
    arms.park()
    controllers[LEFT].joints[0] += 0.3
    pose = arms.tcp_pose(0)
    sent = len(controllers[LEFT].sent)
    pose[2, 3] += 0.02
    arms.move_linear(0, pose)
    assert np.abs(controllers[LEFT].sent[sent] - controllers[LEFT].sent[sent + 1]).max() < 0.1
    assert controllers[LEFT].sent[sent][0] == pytest.approx(panda().arms[0].park[0] + 0.3, abs=0.05)


def test_set_points_are_not_sent_in_a_burst_after_a_pause(arms, controllers):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    paused = []

    def pause(at):
        if at > 0.5 and not paused:
            paused.append(at)
            controllers[LEFT].clock.sleep(1.0)

    began = len(controllers[LEFT].times)
    arms.execute(plan, pause)
    gaps = np.diff(controllers[LEFT].times[began:])
    assert gaps.max() > 1.0
    assert (gaps < 0.05).sum() <= LATE + 1
    assert np.median(gaps) == pytest.approx(0.1)


def test_a_stop_while_it_looks_before_parking_counts(arms, controllers, monkeypatch):
    arms.connect()
    look, stopped = arms._link.joints, []

    def stopping(arm):
        if not stopped:
            stopped.append(arm)
            arms.stop()
        return look(arm)

    monkeypatch.setattr(arms._link, "joints", stopping)
    controllers[LEFT].joints = controllers[LEFT].joints + 0.1
    with pytest.raises(RobotError, match="were stopped"):
        arms.park()
    assert not controllers[LEFT].sent


def test_a_controller_that_stopped_listening_is_woken_by_parking(arms, controllers):
    arms.connect()
    controllers[RIGHT].listens = False
    arms.park()
    assert controllers[RIGHT].listens


def test_two_arms_at_one_address_are_refused():
    with pytest.raises(ValidationError, match="each controller has its own"):
        UrArms.Config(hosts=(LEFT, LEFT), model=panda())


def test_a_watcher_can_stop_it(arms, controllers):
    arms.connect()
    arms.park()
    plan = arms.plan(PICKS, PLACES)
    with pytest.raises(RobotError, match="were stopped"):
        arms.execute(plan, lambda time: arms.stop() if time > 1.0 else None)
    assert controllers[LEFT].stops
    assert not np.allclose(controllers[LEFT].joints, plan.motions[-1].joints[0][-1])
    arms.park()
    assert controllers[LEFT].joints == pytest.approx(panda().arms[0].park or panda().arms[0].home, abs=1e-6)


def test_a_controller_that_can_not_be_reached_is_named(arms, controllers):
    controllers[RIGHT].trouble = "away"
    with pytest.raises(RobotError, match=r"localhost can't be reached .*remote control"):
        arms.connect()
    assert not controllers[LEFT].open, "the other one is released"


def test_a_hand_says_how_wide_it_is_when_cloth_stops_it(hand):
    one = RobotiqHand(LEFT, 0.085, hand.server_address[1])
    one.connect()
    assert one.grip(True) == pytest.approx(0.085 * (1 - 200 / 255))
    assert one.grip(False) == pytest.approx(0.085)
    one.close()
    with pytest.raises(RobotError, match="is not connected"):
        one.grip(True)


def test_a_hand_that_is_not_activated_or_not_there_is_told_so(hand):
    hand.state["STA"] = 0
    with pytest.raises(RobotError, match="is not activated; activate it at the pendant"):
        RobotiqHand(LEFT, 0.085, hand.server_address[1]).connect()
    with pytest.raises(RobotError, match="does not answer"):
        RobotiqHand(LEFT, 0.085, 9, patience=0.5).connect()
