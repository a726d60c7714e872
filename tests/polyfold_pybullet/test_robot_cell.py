"""The cell in PyBullet: what is too near is found, and what it looks like."""

import numpy as np
import pytest
from polyfold_pybullet.cell import Cell
from polyfold_pybullet.kinematics import Kinematics
from polyfold_pybullet.planning.grasping import top_down
from polyfold_pybullet.robots import Arm, RobotModel, panda

from polyfold.errors import SimulationError

LEFT, RIGHT = (Kinematics(arm) for arm in panda().arms)

ARM = """
  <link name="{side}_upper"/>
  <link name="{side}_fore">
    <collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.04 0.04"/></geometry></collision>
  </link>
  <joint name="{side}_shoulder" type="revolute">
    <parent link="body"/><child link="{side}_upper"/><origin xyz="0 {y} 0.3"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="1"/>
  </joint>
  <joint name="{side}_elbow" type="revolute">
    <parent link="{side}_upper"/><child link="{side}_fore"/><origin xyz="0.3 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="1"/>
  </joint>
"""
TORSO = '<link name="body"><collision><geometry><box size="0.2 0.2 0.8"/></geometry></collision></link>'


@pytest.fixture
def two_armed(tmp_path):
    """A torso with two arms of two joints in one URDF."""
    path = tmp_path / "two.urdf"
    sides = {"left": 0.25, "right": -0.25}
    arms = "".join(ARM.format(side=side, y=y) for side, y in sides.items())
    path.write_text(f'<robot name="two">{TORSO}{arms}</robot>')
    made = [
        Arm(
            name=side,
            urdf=str(path),
            joints=(f"{side}_shoulder", f"{side}_elbow"),
            tool_link=f"{side}_fore",
            home=(0.0, 0.0),
            acceleration=(1.0, 1.0),
            has_torso=True,
        )
        for side in sides
    ]
    with Cell(RobotModel(name="two", arms=(made[0], made[1]), stands=False, table={"x": (2, 3)})) as cell:
        yield cell


def test_arms_at_home_and_parked_are_near_nothing(pandas):
    for name in ("home", "park"):
        left, right = getattr(LEFT, name), getattr(RIGHT, name)
        assert pandas.near_obstacles(0, left) is None
        assert pandas.near_obstacles(1, right) is None
        assert pandas.near_each_other(left, right) is None


def test_hands_in_the_same_place_overlap(pandas):
    poses = [top_down([x, 0.0, 0.2], np.pi / 2) for x in (-0.02, 0.02)]
    near = pandas.near_each_other(*(kin.inverse(pose).joints for kin, pose in zip((LEFT, RIGHT), poses, strict=True)))
    assert near.distance < 0
    assert "the left arm's" in str(near)
    assert "overlap by" in str(near)


@pytest.mark.parametrize(
    ("height", "pressing", "fits"),
    [(0.001, True, True), (-0.001, True, True), (-0.001, False, False), (-0.01, True, False)],
)
def test_fingertips_may_press_on_the_table_where_they_take_cloth_and_not_sink_into_it(pandas, height, pressing, fits):
    joints = RIGHT.inverse(top_down([0.2, 0.0, height], 0.3)).joints
    near = pandas.near_obstacles(1, joints, pressing)
    assert (near is None) == fits
    if not fits:
        assert near.other == "the table"


def test_an_arm_folded_onto_itself_is_found(pandas):
    folded = np.array([0.0, -1.7, 0.0, -3.0, 0.0, 0.0, 0.0])
    near = pandas.near_obstacles(0, folded)
    assert near is not None
    assert near.one.startswith("the left arm's")
    assert near.other.startswith("the left arm's")


def test_arms_of_one_urdf_meet_the_torso_and_each_other(two_armed):
    assert two_armed.near_obstacles(0, [0.0, 0.0]) is None
    assert two_armed.near_each_other([0.0, 0.0], [0.0, 0.0]) is None
    assert two_armed.near_obstacles(0, [0.0, -2.4]).other == "the torso"
    assert two_armed.near_each_other([-0.5, -1.0], [0.5, 1.0]).distance < 0


def test_a_closed_cell_says_so_and_closing_twice_is_nothing():
    cell = Cell(panda())
    cell.close()
    with pytest.raises(SimulationError, match="open it first"):
        cell.set_arm(0, LEFT.home)


def test_a_urdf_that_pybullet_can_not_load_is_refused_and_leaves_nothing_open(tmp_path):
    bad = tmp_path / "bad.urdf"
    bad.write_text("<robot name='bad'/>")
    arm = panda().arms[0].model_copy(update={"urdf": str(bad)})
    cell = Cell(panda().model_copy(update={"arms": (arm, arm)}))
    with pytest.raises(SimulationError, match="check its URDF"):
        cell.open()
    with pytest.raises(SimulationError, match="open it first"):
        _ = cell.client


def test_the_picture_shows_the_arms_over_the_table(pandas):
    for arm, kinematics in enumerate((LEFT, RIGHT)):
        pandas.set_arm(arm, kinematics.park)
    away = pandas.picture(160, 120)
    for arm, kinematics in enumerate((LEFT, RIGHT)):
        pandas.set_arm(arm, kinematics.home)
    here = pandas.picture(160, 120)
    assert here.shape == (120, 160, 3)
    assert here.dtype == np.uint8
    assert (here != away).any(axis=2).mean() > 0.02


def test_cloth_is_shown_where_it_is_and_stands_in_nothing_s_way():
    corners = np.array([[-0.2, 0.0, 0.01], [0.2, 0.0, 0.01], [0.2, 0.2, 0.01], [-0.2, 0.2, 0.01]])
    shown = []
    with Cell(panda()) as cell:
        bare = cell.picture(160, 120).astype(int)
        for height in (0.0, 0.1):
            cell.drape(corners + np.array([0.0, 0.0, height]), [[0, 2, 1], [0, 3, 2]], (0.9, 0.1, 0.1))
            seen = cell.picture(160, 120).astype(int)
            red = seen[..., 0] - seen[..., 1:].max(axis=-1) > 60
            shown.append(red & (np.abs(seen - bare).max(axis=-1) > 60))
            assert cell.near_obstacles(0, cell.model.arms[0].home) is None
    assert min(shown[0].sum(), shown[1].sum()) > 150
    assert (shown[0] & ~shown[1]).sum() > 30
