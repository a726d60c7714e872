"""What a cell is made of, as data: arms with their joints, tool, postures and limits, and the table before them."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, model_validator

Finite = Annotated[float, Field(allow_inf_nan=False)]
Vector = tuple[Finite, Finite, Finite]
Fastest = Annotated[float, Field(ge=0.01, allow_inf_nan=False)]


class Table(BaseModel):
    """The table: its top is the plane z = 0.

    Attributes:
        x, y: from where to where it reaches [m].
        thickness: of its top [m].
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    x: tuple[float, float] = (-0.45, 0.45)
    y: tuple[float, float] = (-0.35, 0.35)
    thickness: float = Field(default=0.04, gt=0)

    @model_validator(mode="after")
    def _has_an_area(self) -> Table:
        if self.x[0] >= self.x[1] or self.y[0] >= self.y[1]:
            raise ValueError("the table has no area; give the smaller bound first")
        return self


class Arm(BaseModel):
    """One arm: a chain of joints within a URDF, the tool at its end, and how it may move.

    The tool frame has its z axis where the hand points (the approach) and its y axis where the fingers open, which is
    the wide side of a two-finger hand.

    Attributes:
        name: what messages and plans call it.
        urdf: path of the file.
        package: folder that ``package://`` in the file stands for; the file's own by default.
        base_position, base_rpy: of the URDF's root link in the world [m], roll, pitch and yaw [rad].
        joints: the joints that move the tool, from the base on.
        tool_link: link that holds the tool.
        tool_position, tool_rpy: of the tool frame in that link [m], [rad]; the position is between the fingertips.
        home: joint angles that inverse kinematics prefers [rad, m if prismatic].
        park: joint angles in which the arm waits, out of the camera's view; ``home`` by default.
        lower, upper: limits of the joints; by default those in the URDF, the narrower of hard and soft ones.
        velocity: limits [rad/s, m/s]; by default those in the URDF.
        acceleration: limits [rad/s²]; no URDF has any.
        has_torso: whether the URDF holds more than this arm: what hangs on the first of ``joints`` is the arm then, and
            what hangs on no arm is the torso, an obstacle. By default the whole file is the arm.
        fingers: joints of the fingers.
        open_width, closed_width: positions of each finger joint with the hand open and closed [m].
        tips: links that may come near the table, and those whose fingers touch cloth.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    urdf: str
    package: str | None = None
    base_position: Vector = (0.0, 0.0, 0.0)
    base_rpy: Vector = (0.0, 0.0, 0.0)
    joints: tuple[str, ...] = Field(min_length=1)
    tool_link: str
    tool_position: Vector = (0.0, 0.0, 0.0)
    tool_rpy: Vector = (0.0, 0.0, 0.0)
    home: tuple[float, ...]
    park: tuple[float, ...] | None = None
    lower: tuple[float, ...] | None = None
    upper: tuple[float, ...] | None = None
    velocity: tuple[Fastest, ...] | None = None
    acceleration: tuple[Fastest, ...]
    has_torso: bool = False
    fingers: tuple[str, ...] = ()
    open_width: float = 0.02
    closed_width: float = 0.0
    tips: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _opens(self) -> Arm:
        if not 0 <= self.closed_width <= self.open_width:
            raise ValueError("a hand's open_width is no smaller than its closed_width, and that not below 0")
        return self

    @model_validator(mode="after")
    def _has_a_value_for_each_joint(self) -> Arm:
        for name in ("home", "park", "lower", "upper", "velocity", "acceleration"):
            values = getattr(self, name)
            if values is not None and len(values) != len(self.joints):
                raise ValueError(f"{name} has {len(values)} values for {len(self.joints)} joints; give one for each")
        return self


class RobotModel(BaseModel):
    """Two arms at a table.

    Attributes:
        name: what it is called.
        arms: the left one first, as seen from behind the robot.
        table: what it stands at.
        stands: whether each arm stands on a post beside the table, which is an obstacle then.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    arms: tuple[Arm, Arm]
    table: Table = Table()
    stands: bool = True
