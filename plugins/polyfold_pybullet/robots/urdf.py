"""Reading URDF: the chain of joints from the base to a tool, and a part of a robot as a URDF of its own."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import ConfigError, did_you_mean
from polyfold_pybullet.robots.models import Arm

Floats = NDArray[np.float64]
Element = ElementTree.Element

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True, eq=False)
class Chain:
    """N joints in a row, from the world to a tool.

    Attributes:
        names: of the joints.
        origins: pose of each joint's frame in that of the joint before it, the first in the world, shape (N, 4, 4).
        axes: unit axis of each joint in its frame, shape (N, 3).
        prismatic: whether it slides, shape (N,).
        tool: pose of the tool in the frame of the last joint, shape (4, 4).
        lower, upper: limits [rad, m], shape (N,).
        velocity: limits [rad/s, m/s], shape (N,).
    """

    names: tuple[str, ...]
    origins: Floats
    axes: Floats
    prismatic: NDArray[np.bool_]
    tool: Floats
    lower: Floats
    upper: Floats
    velocity: Floats

    def __len__(self) -> int:
        return len(self.names)


def pose(position: ArrayLike = (0.0, 0.0, 0.0), rpy: ArrayLike = (0.0, 0.0, 0.0)) -> Floats:
    """Pose with a position [m] and URDF's roll, pitch and yaw about fixed axes [rad], shape (4, 4)."""
    roll, pitch, yaw = (float(angle) for angle in np.asarray(rpy, float))
    (cr, cp, cy), (sr, sp, sy) = ([f(angle) for angle in (roll, pitch, yaw)] for f in (math.cos, math.sin))
    made = np.eye(4)
    made[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    made[:3, 3] = np.asarray(position, float)
    return made


def read_chain(arm: Arm) -> Chain:
    """The joints of an arm in the world, with their limits: the arm's own where it gives any, else the URDF's.

    Joints between that the arm does not name, such as those of another axis, stay at zero.

    Raises:
        ConfigError: the file can't be read, or has no such joint or link, or no limit where one is needed.
    """
    robot = _parsed(arm.urdf)
    joints = _joints_to(robot, arm)
    origins, axes, prismatic, limits = [], [], [], []
    before = pose(arm.base_position, arm.base_rpy)
    for joint in joints:
        before = before @ _origin(joint)
        if joint.get("name") in arm.joints:
            origins.append(before)
            axes.append(_axis(joint))
            prismatic.append(joint.get("type") == "prismatic")
            limits.append(_limits(joint))
            before = np.eye(4)
    lower, upper, velocity = np.array(limits, float).T
    chain = Chain(
        arm.joints,
        np.array(origins),
        np.array(axes),
        np.array(prismatic),
        before @ pose(arm.tool_position, arm.tool_rpy),
        lower,
        upper,
        velocity,
    )
    own = {name: np.array(getattr(arm, name)) for name in ("lower", "upper", "velocity") if getattr(arm, name)}
    return _checked(replace(chain, **own), arm)


def _checked(chain: Chain, arm: Arm) -> Chain:
    for index, name in enumerate(chain.names):
        low, high = chain.lower[index], chain.upper[index]
        if not low < high:
            raise ConfigError(f"the joint {name!r} has no range ({low:g} to {high:g}); give the arm lower and upper")
        if not np.isfinite(chain.velocity[index]) or chain.velocity[index] <= 0:
            raise ConfigError(f"the joint {name!r} has no limit of velocity in its URDF; give the arm its velocity")
        for what in ("home", "park"):
            posture = getattr(arm, what)
            if posture is not None and not low <= posture[index] <= high:
                raise ConfigError(
                    f"{what} of the arm {arm.name!r} puts {name!r} at {posture[index]:g}, outside of its limits; "
                    f"give a value from {low:.4g} to {high:.4g}"
                )
    return chain


def _joints_to(robot: Element, arm: Arm) -> list[Element]:
    """The joints from the root to the arm's tool, which must hold the arm's own in their order."""
    links = {str(link.get("name")) for link in robot.findall("link")}
    if arm.tool_link not in links:
        raise ConfigError(
            f"{arm.urdf} has no link {arm.tool_link!r} for a tool; {did_you_mean(arm.tool_link, sorted(links))}"
        )
    above = {_child(joint): joint for joint in robot.findall("joint")}
    found: list[Element] = []
    link = arm.tool_link
    while link in above:
        found.insert(0, above[link])
        link = _parent(above[link])
    known = [str(joint.get("name")) for joint in found if joint.get("type") in MOVING]
    if unknown := [name for name in arm.joints if name not in known]:
        raise ConfigError(
            f"{arm.urdf} has no moving joint {unknown[0]!r} on the way to {arm.tool_link!r}; "
            f"{did_you_mean(unknown[0], known)}"
        )
    order = [name for name in known if name in arm.joints]
    if list(arm.joints) != order:
        raise ConfigError(f"the joints of the arm {arm.name!r} stand in another order; write {', '.join(order)}")
    return found


def _parent(joint: Element) -> str:
    return str(_part(joint, "parent").get("link"))


def _child(joint: Element) -> str:
    return str(_part(joint, "child").get("link"))


def _part(joint: Element, tag: str) -> Element:
    part = joint.find(tag)
    if part is None:
        raise ConfigError(f"the joint {joint.get('name')!r} of a URDF has no {tag}; correct the file")
    return part


def _origin(element: Element) -> Floats:
    origin = element.find("origin")
    return np.eye(4) if origin is None else pose(_numbers(origin, "xyz"), _numbers(origin, "rpy"))


def _axis(joint: Element) -> Floats:
    axis = joint.find("axis")
    vector = np.array([1.0, 0.0, 0.0]) if axis is None else _numbers(axis, "xyz")
    length = np.linalg.norm(vector)
    if length < 1e-9:
        raise ConfigError(f"the joint {joint.get('name')!r} of a URDF has no axis; correct the file")
    return vector / length


def _numbers(element: Element, name: str) -> Floats:
    text = element.get(name)
    if text is None:
        return np.zeros(3)
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != 3:
        raise ConfigError(f"{name}={text!r} in a URDF is no vector of three numbers; correct the file")
    return np.array(values)


def _limits(joint: Element) -> tuple[float, float, float]:
    """Lower and upper limit, the narrower of hard and soft ones, and that of velocity; infinite where none is given."""
    hard, soft = joint.find("limit"), joint.find("safety_controller")

    def value(element: Element | None, name: str, otherwise: float) -> float:
        given = otherwise if element is None else element.get(name, otherwise)
        try:
            return float(given)
        except ValueError:
            named = joint.get("name")
            raise ConfigError(f"{name}={given!r} of the joint {named!r} is no number; correct the URDF") from None

    turns = joint.get("type") == "continuous"
    low = -2 * math.pi if turns else value(hard, "lower", 0.0)
    high = 2 * math.pi if turns else value(hard, "upper", 0.0)
    return (
        max(low, value(soft, "soft_lower_limit", -math.inf)),
        min(high, value(soft, "soft_upper_limit", math.inf)),
        value(hard, "velocity", math.inf),
    )


def _parsed(path: str) -> Element:
    try:
        return ElementTree.parse(path).getroot()
    except OSError:
        raise ConfigError(f"there is no URDF {path}; check the path") from None
    except ElementTree.ParseError as error:
        raise ConfigError(f"{path} is no URDF ({error}); correct it") from None


def written_part(arms: Iterable[Arm], which: str | None, into: Path) -> Path:
    """Write a URDF that holds only a part of the one that arms share, with absolute paths of its meshes.

    Args:
        arms: all that the file holds.
        which: name of the arm to keep, without the geometry of what it hangs on; or None for the torso, which is what
            is no arm.
        into: folder to write to.

    Returns:
        Path of the file written.

    Raises:
        ConfigError: the URDF has no such link.
    """
    arms = list(arms)
    robot = _parsed(arms[0].urdf)
    joints = {str(joint.get("name")): joint for joint in robot.findall("joint")}
    parts = {arm.name: _hanging_on(joints, arm) for arm in arms}
    if which is None:
        dropped = set().union(*parts.values())
    else:
        # The way from the root stays, so that the arm's base stands where it stands in the whole robot.
        chosen = next(arm for arm in arms if arm.name == which)
        dropped = set(joints) - parts[which] - {str(joint.get("name")) for joint in _joints_to(robot, chosen)}
    gone = {_child(joints[name]) for name in dropped}
    folder = Path(arms[0].urdf).resolve().parent
    root = ElementTree.Element("robot", {"name": f"{robot.get('name')}-{which or 'torso'}"})
    of_arm = None if which is None else {_child(joints[name]) for name in parts[which]}
    for link in robot.findall("link"):
        if link.get("name") not in gone:
            bare = of_arm is not None and link.get("name") not in of_arm
            root.append(_link(link, bare, which is None, Path(arms[0].package or folder), folder))
    root.extend(joint for name, joint in joints.items() if name not in dropped)
    path = into / f"{root.get('name')}.urdf"
    ElementTree.ElementTree(root).write(path)
    return path


def _hanging_on(joints: dict[str, Element], arm: Arm) -> set[str]:
    """Names of an arm's first joint and of all behind it, fingers included."""
    if arm.joints[0] not in joints:
        raise ConfigError(f"{arm.urdf} has no joint {arm.joints[0]!r}; {did_you_mean(arm.joints[0], joints)}")
    found: set[str] = set()
    ahead = [arm.joints[0]]
    while ahead:
        name = ahead.pop()
        found.add(name)
        ahead += [other for other, joint in joints.items() if _parent(joint) == _child(joints[name])]
    return found


def _link(link: Element, bare: bool, solid: bool, package: Path, folder: Path) -> Element:
    """A copy of a link with absolute paths of meshes; a bare one without any geometry.

    What has no mass gets one, which PyBullet asks for and a cell without dynamics does not use.
    """
    copy = ElementTree.fromstring(ElementTree.tostring(link))
    if bare:
        copy = ElementTree.Element("link", {"name": str(link.get("name"))})
    if copy.find("inertial") is None:
        inertial = ElementTree.SubElement(copy, "inertial")
        ElementTree.SubElement(inertial, "mass", {"value": "1"})
        ElementTree.SubElement(inertial, "inertia", dict.fromkeys(("ixx", "iyy", "izz"), "1"))
    if not bare and solid:
        # PyBullet takes the convex hull of a mesh otherwise, which fills the space before a torso.
        for shape in copy.iter("collision"):
            shape.set("concave", "yes")
    for mesh in copy.iter("mesh"):
        name = str(mesh.get("filename"))
        # A path that is absolute already stays so.
        mesh.set(
            "filename", str((package if name.startswith("package://") else folder) / name.removeprefix("package://"))
        )
    return copy
