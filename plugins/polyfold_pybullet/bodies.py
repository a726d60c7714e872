"""Bodies of the cell in PyBullet: read from files that hold what the robot's model names."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from polyfold.errors import ConfigError
from polyfold_pybullet.robots import Arm


@dataclass(frozen=True)
class Body:
    """A body of PyBullet: its number, the names of its links by index, and the joints that are set."""

    number: int
    links: dict[int, str]
    joints: tuple[int, ...] = ()
    fingers: tuple[int, ...] = ()
    tips: frozenset[int] = frozenset()
    pairs: tuple[tuple[int, int], ...] = ()


def load_body(bullet: Any, client: int, path: Path, arm: Arm) -> Body:
    """The body of a URDF, standing where the arm does, with what of the arm's model it holds."""
    turned = bullet.getQuaternionFromEuler(arm.base_rpy)
    number = bullet.loadURDF(str(path), arm.base_position, turned, useFixedBase=True, physicsClientId=client)
    joints = [
        bullet.getJointInfo(number, joint, physicsClientId=client)
        for joint in range(bullet.getNumJoints(number, physicsClientId=client))
    ]
    links = {info[0]: info[12].decode() for info in joints}
    index = {info[1].decode(): info[0] for info in joints}
    return Body(
        number,
        links,
        tuple(index[name] for name in arm.joints if name in index),
        tuple(index[name] for name in arm.fingers if name in index),
        frozenset(link for link, name in links.items() if name in arm.tips),
    )


def readable(path: Path) -> Path:
    """The path of a URDF; PyBullet ends the process over some that are none."""
    from xml.etree import ElementTree

    try:
        ElementTree.fromstring(path.read_bytes())
    except (OSError, ElementTree.ParseError) as error:
        raise ConfigError(f"{path} is no URDF that can be read ({error}); give the path of the arm's file") from error
    return path


def check_names(arm: Arm, body: Body) -> None:
    """Raise ConfigError if a joint or link of the model is not in its file."""
    found = {"joints": len(body.joints), "fingers": len(body.fingers), "tips": len(body.tips)}
    for name, count in found.items():
        if count != len(getattr(arm, name)):
            named, known = ", ".join(getattr(arm, name)), ", ".join(sorted(body.links.values()))
            raise ConfigError(f"{arm.urdf} lacks some of the {arm.name} arm's {name} {named}; its links are {known}")


def imported() -> Any:
    """PyBullet, without the line about its build that version 3.2.7 writes to standard error when it is imported."""
    if (known := sys.modules.get("pybullet")) is not None:
        return known
    sys.stderr.flush()
    kept = os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        import pybullet
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)
    return pybullet
