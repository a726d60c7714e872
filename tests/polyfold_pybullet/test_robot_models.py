"""Robots as data: what is read from a URDF, and what is said of one that can't be used."""

import importlib.util

import numpy as np
import pytest
from polyfold_pybullet.robots import Arm, panda, read_chain, robot_model

from polyfold.errors import ConfigError

URDF = """
<robot name="crane">
  <link name="world"/>
  <link name="mast"/>
  <link name="boom"/>
  <link name="hook"/>
  <joint name="foot" type="fixed"><parent link="world"/><child link="mast"/><origin xyz="0 0 1"/></joint>
  <joint name="swing" type="revolute">
    <parent link="mast"/><child link="boom"/><axis xyz="0 0 2"/>
    <limit lower="-2" upper="2" velocity="1.5"/><safety_controller soft_lower_limit="-1.5" soft_upper_limit="3"/>
  </joint>
  <joint name="trolley" type="prismatic">
    <parent link="boom"/><child link="hook"/><origin xyz="0.5 0 0"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.4" velocity="0.2"/>
  </joint>
</robot>
"""


@pytest.fixture
def crane(tmp_path):
    """Makes the arm of a crane with a turning and a sliding joint."""
    path = tmp_path / "crane.urdf"
    path.write_text(URDF)

    def make(**changed):
        usual = {
            "name": "crane",
            "urdf": str(path),
            "joints": ("swing", "trolley"),
            "tool_link": "hook",
            "home": (0.0, 0.1),
            "acceleration": (1.0, 1.0),
        }
        return Arm(**{**usual, **changed})

    return make


def test_a_chain_has_the_narrower_of_hard_and_soft_limits_and_unit_axes(crane):
    chain = read_chain(crane())
    np.testing.assert_allclose(chain.lower, [-1.5, 0.0])
    np.testing.assert_allclose(chain.upper, [2.0, 0.4])
    np.testing.assert_allclose(chain.velocity, [1.5, 0.2])
    np.testing.assert_allclose(chain.axes, [[0, 0, 1], [1, 0, 0]])
    assert chain.prismatic.tolist() == [False, True]
    assert chain.origins[0][2, 3] == pytest.approx(1.0), "fixed joints are part of what follows them"


def test_an_arm_overrides_what_its_urdf_says(crane):
    chain = read_chain(crane(lower=(-1.0, 0.05), upper=(1.0, 0.3), velocity=(0.5, 0.1)))
    assert (chain.lower[1], chain.upper[0], chain.velocity[0]) == (0.05, 1.0, 0.5)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"urdf": "nowhere.urdf"}, "there is no URDF nowhere.urdf; check the path"),
        ({"tool_link": "hok"}, "did you mean 'hook'"),
        ({"joints": ("swing", "troley")}, "did you mean 'trolley'"),
        ({"joints": ("trolley", "swing")}, "write swing, trolley"),
        ({"home": (0.0, 0.5)}, "give a value from 0 to 0.4"),
        ({"lower": (1.0, 0.0), "upper": (-1.0, 0.4)}, "has no range"),
    ],
)
def test_what_can_not_be_used_is_said_with_what_to_do(crane, changed, said):
    with pytest.raises(ConfigError, match=said):
        read_chain(crane(**changed))


def test_each_joint_needs_a_value(crane):
    with pytest.raises(ValueError, match="home has 1 values for 2 joints; give one for each"):
        crane(home=(0.0,))


def test_a_broken_urdf_is_refused(crane, tmp_path):
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot>")
    with pytest.raises(ConfigError, match="is no URDF"):
        read_chain(crane(urdf=str(broken)))


def test_a_limit_that_is_no_number_is_named(crane, tmp_path):
    odd = tmp_path / "odd.urdf"
    odd.write_text(URDF.replace('upper="0.4"', 'upper="wide"'))
    with pytest.raises(ConfigError, match="upper='wide' of the joint 'trolley' is no number; correct the URDF"):
        read_chain(crane(urdf=str(odd)))


def test_pandas_stand_side_by_side_and_mirror_each_other():
    left, right = panda().arms
    assert left.base_position[0] == -right.base_position[0] < 0
    chain = read_chain(left)
    assert chain.upper[3] == pytest.approx(-0.0698), "Franka's own limit, not the wider one"


def test_an_unknown_robot_is_answered_with_a_near_name():
    with pytest.raises(ConfigError, match="did you mean 'panda'"):
        robot_model("pandas")


def test_a_yumi_that_is_not_installed_is_answered_with_the_pip_command(monkeypatch):
    monkeypatch.setattr("polyfold_pybullet.robots.bundled.find_spec", lambda name: None)
    with pytest.raises(ConfigError, match=r"pip install 'polyfold\[yumi\]'"):
        robot_model("yumi")


@pytest.mark.skipif(importlib.util.find_spec("rtbdata") is None, reason="rtb-data is not installed")
def test_the_yumi_has_two_arms_of_seven_joints_before_its_torso():
    model = robot_model("yumi")
    assert [len(read_chain(arm)) for arm in model.arms] == [7, 7]
    assert model.table.y[0] >= -0.26
