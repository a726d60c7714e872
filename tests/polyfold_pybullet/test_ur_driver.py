"""Two UR arms: stand-ins for the library's controllers, and hands that really talk over a socket."""

import socketserver
import sys
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from polyfold_pybullet.drivers.robotiq import RobotiqHand
from polyfold_pybullet.drivers.ur import UrArms
from polyfold_pybullet.planning import FoldPlan
from polyfold_pybullet.robots import panda

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
    server.state = {"STA": 3, "POS": 0, "asked": 0, "slow": 2}
    threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


class Controller:
    """One arm: it is where it was last sent."""

    def __init__(self, joints):
        self.joints, self.sent, self.stops, self.trouble = np.array(joints, float), [], 0, None
        self.open = False


@pytest.fixture
def controllers(monkeypatch):
    arms = {host: Controller(arm.park or arm.home) for host, arm in zip((LEFT, RIGHT), panda().arms, strict=True)}

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

    def servo(self, joints, speed, acceleration, interval, lookahead, gain):
        self.arm.sent.append(np.array(joints))
        if self.arm.trouble != "stuck":
            self.arm.joints = np.array(joints)
        if self.arm.trouble == "touches" and len(self.arm.sent) == 5:
            self.arm.trouble = "protective"

    def stop(self, deceleration):
        self.arm.stops += 1

    def leave(self):
        self.arm.open = False

    # The library's names are not Python's usual ones.
    for name, method in {"servoJ": servo, "servoStop": stop, "stopScript": leave}.items():
        setattr(Control, name, method)
    Receive = type("Receive", (Interface,), {
        "getActualQ": lambda self: self.arm.joints.tolist(),
        "isEmergencyStopped": lambda self: self.arm.trouble == "emergency",
        "isProtectiveStopped": lambda self: self.arm.trouble == "protective",
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


@pytest.fixture(autouse=True)
def _no_waiting(monkeypatch):
    monkeypatch.setattr("polyfold_pybullet.drivers.ur.time.sleep", lambda seconds: None)


def test_both_arms_follow_the_plan_in_step_and_the_hands_close_between(arms, controllers, hand):
    assert isinstance(arms, Robot)
    arms.connect()
    assert not any(arm.sent for arm in controllers.values()), "connecting moves nothing"
    plan = arms.plan(PICKS, PLACES)
    assert isinstance(plan, FoldPlan)
    arms.execute(plan)
    left, right = controllers[LEFT], controllers[RIGHT]
    assert len(left.sent) == len(right.sent)
    assert np.abs(np.diff(left.sent, axis=0)).max() < 0.1 * 3.0, "no joint is faster than its limit"
    for joints, arm in zip(plan.motions[-1].joints, (left, right), strict=True):
        assert arm.joints == pytest.approx(joints[-1])
    assert hand.state["asked"] == 4, "each hand closed and opened once"
    assert hand.state["POS"] == 0


@pytest.mark.parametrize(
    ("trouble", "says"),
    [
        ("touches", "to protect itself"),
        ("emergency", "emergency stop"),
        ("lost", "is lost"),
        ("stuck", "rad from where"),
    ],
)
def test_trouble_of_one_arm_stops_both(arms, controllers, trouble, says):
    arms.connect()
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


def test_a_watcher_can_stop_it(arms, controllers):
    arms.connect()
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
