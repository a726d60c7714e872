"""A plan looked at again, five times as densely as it was planned, by a cell of its own.

Every pair that could touch is measured at every row: the links of one arm with all of the other, with themselves,
table, torso and posts, without the planner's shortcuts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from polyfold_pybullet.cell import TABLE, Cell
from polyfold_pybullet.planning import FoldPlan, Motion
from polyfold_pybullet.planning.carrying import STEP

Floats = NDArray[np.float64]

DENSITY = 5
WITHIN = 0.03
"""Distances beyond this are not measured [m]."""
PRESSED = -0.001
"""How far a finger may press into the table [m]."""


@dataclass
class Swept:
    """What was found along a plan.

    Attributes:
        rows: how many rows of joint angles were looked at.
        arms: least distance between the arms [m]; 0.03 if they never were nearer.
        obstacles: least distance of an arm from table, torso and posts, fingertips over the table left out [m].
        collisions: what overlapped, with the motion.
    """

    rows: int = 0
    arms: float = WITHIN
    obstacles: float = WITHIN
    collisions: list[str] = field(default_factory=list)


def sweep(cell: Cell, plan: FoldPlan) -> Swept:
    """Look at all rows of a plan in a loaded cell that is not the planner's."""
    import pybullet

    found = Swept()
    for motion in plan.motions:
        for left, right in _dense(motion):
            found.rows += 1
            for arm, joints in enumerate((left, right)):
                cell.set_arm(arm, joints)
            for what, far in _distances(cell, pybullet):
                if what == "arms":
                    found.arms = min(found.arms, far)
                elif what != "tips":
                    found.obstacles = min(found.obstacles, far)
                if far < (PRESSED if what == "tips" else 0.0):
                    found.collisions.append(f"{motion.name}: {what} by {-1000 * far:.1f} mm")
    return found


def _dense(motion: Motion) -> Iterator[tuple[Floats, Floats]]:
    """Rows at most a fifth of the planner's step apart, as the controllers would pass them."""
    both = np.hstack(motion.joints)
    steps = np.abs(np.diff(both, axis=0)).max(axis=1, initial=0.0)
    travelled = np.concatenate([[0.0], np.cumsum(steps)])
    count = max(2, int(np.ceil(travelled[-1] * DENSITY / STEP)) + 1)
    times = np.interp(np.linspace(0, travelled[-1], count), travelled, motion.times)
    yield from zip(*motion.at(times), strict=True)


def _distances(cell: Cell, pybullet: Any) -> Iterator[tuple[str, float]]:
    """What is near what in the cell as it stands, and how near [m]."""

    def measured(one: int, other: int, within: float = WITHIN, link: int = -2) -> Any:
        chosen = {} if link == -2 else {"linkIndexA": link}
        return pybullet.getClosestPoints(one, other, within, **chosen, physicsClientId=cell.client) or ()

    left, right = cell.arms
    yield from (("arms", near[8]) for near in measured(left.number, right.number))
    for arm, body in enumerate(cell.arms):
        allowed = set(body.pairs)
        for near in measured(body.number, body.number, 0.0):
            if (near[3], near[4]) in allowed or (near[4], near[3]) in allowed:
                yield "itself", near[8]
        for name, number, links in cell.obstacles(arm):
            for link in links:
                for near in measured(body.number, number, link=link):
                    yield ("tips" if name == TABLE and link in body.tips else name), near[8]
