"""Ways of one arm: to take cloth at a pick and carry it to its place, and between there and where it is parked."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from polyfold_pybullet.cell import Cell
from polyfold_pybullet.kinematics import Kinematics, OutOfReach
from polyfold_pybullet.planning.grasping import LEAN, away_from, carried, leaning
from polyfold_pybullet.planning.timing import Path

Floats = NDArray[np.float64]

ROWS = 13
"""Poses in each of going down, carrying, and going up."""
STEP = 0.04
"""Largest move of a joint between two checks of a path [rad]."""
LEANING = (-1.4, -0.7, 0.7, 1.4)
"""How far elbows lean to either side, to keep out of each other's way [rad]."""
ALIKE = 0.25
"""Carries whose joints nowhere differ by more are tried once [rad]."""
RAISED = (0.10, 0.20)
"""How much higher than where it hovers a hand may pass on its way to and from the cloth [m]."""


@dataclass(frozen=True, eq=False)
class Carry:
    """One arm's way from hovering over a pick to hovering over its place.

    Attributes:
        arm: 0 or 1.
        rows: joint angles [rad, m], shape (3 * ROWS, N): down, carry, up.
        away: how far from home a joint goes at most [rad].
    """

    arm: int
    rows: Floats
    away: float


class ArmWays:
    """Finds ways of one arm that are clear of everything but the other arm.

    Args:
        cell: the loaded cell.
        arm: 0 or 1.
        kinematics: of the arm.
        hover: height above picks and places where transits end [m].
    """

    def __init__(self, cell: Cell, arm: int, kinematics: Kinematics, hover: float) -> None:
        self._cell, self._arm, self._kinematics, self._hover = cell, arm, kinematics, hover
        self.why, self.stage = "", 0
        self._known: dict[Carry, bool] = {}

    def carries(
        self, pick: Floats, place: Floats, yaws: tuple[float, float], inwards: Floats | None = None
    ) -> list[Carry]:
        """Ways to carry, those nearest to home first, with the hand as asked or turned by half a turn.

        Args:
            pick, place: [m], shape (3,).
            yaws: how the hand is turned at pick and place [rad].
            inwards: where a hand that leans points, unit vectors, shape (3 * ROWS, 2); by default hands lean only where
                they would not reach otherwise.

        They are not yet looked at for collisions: :meth:`clear` does. After none, ``why`` says what stood in the way.
        """
        found: list[Carry] = []
        self.why, self.stage = "", 0
        base = self._kinematics.chain.origins[0][:3, 3]
        for half in (0.0, np.pi):
            down = carried(pick, place, (yaws[0] + half, yaws[1] + half), self._hover, ROWS)
            leant = leaning(down, away_from(down, base) if inwards is None else inwards, LEAN)
            for poses in (down, leant) if inwards is None else (leant,):
                reach = self._out_of_reach(poses)
                if reach is not None:
                    self.why = self.why or reach
                    continue
                found += self._followed(poses)
                break
        if not found and not self.why:
            self._note(1, f"the {self._name} arm can't carry from pick to place without a leap of its joints")
        return sorted(found, key=lambda carry: carry.away)

    def _followed(self, poses: Floats) -> list[Carry]:
        """Carries along poses, from different postures over the pick."""
        found = []
        for posture in self._kinematics.postures(poses[0], most=4):
            for start in (posture, *self._kinematics.leaning(poses[0], posture, LEANING)):
                rows = self._kinematics.follow(poses, start)
                if rows is None or any(np.abs(rows - other.rows).max() < ALIKE for other in found):
                    continue
                found.append(Carry(self._arm, rows, float(np.abs(rows - self._kinematics.home).max())))
        return found

    def clear(self, carry: Carry) -> bool:
        """Whether nothing but perhaps the other arm is in the way of a carry."""
        if carry not in self._known:
            near = self._near(np.vstack([part.sampled(STEP) for part in parts(carry.rows)]), pressing=True)
            if near is not None:
                self._note(1, f"{near} while it carries")
            self._known[carry] = near is None
        return self._known[carry]

    def forget(self) -> None:
        """Forget which carries are clear, and why others are not."""
        self._known.clear()
        self.why, self.stage = "", 0

    def transits(self, hovering: Floats) -> Iterator[Path]:
        """Ways from parked to joint angles over the cloth, shape (N,), straight or through via-points."""
        kin = self._kinematics
        vias: list[list[Floats]] = [[]]
        over = kin.forward(hovering)
        raised = []
        for higher in RAISED:
            lifted = over.copy()
            lifted[2, 3] += higher
            rows = kin.follow(np.array([_between(over, lifted, share) for share in np.linspace(0.25, 1, 4)]), hovering)
            if rows is not None:
                raised.append(rows[-1])
        vias += [[row] for row in raised]
        vias += [[kin.home], *([kin.home, row] for row in raised)]
        for via in vias:
            path = Path(np.array([kin.park, *via, hovering]))
            near = self._near(path.sampled(STEP))
            if near is None:
                yield path
            else:
                self._note(2, f"{near} on the way there")

    @property
    def _name(self) -> str:
        return self._kinematics.arm.name

    def _out_of_reach(self, poses: Floats) -> str | None:
        """Why the ends can't be reached; the cheapest test comes first."""
        for index in (ROWS - 1, 2 * ROWS - 1, 0, 3 * ROWS - 1):
            answer = self._kinematics.inverse(poses[index])
            if isinstance(answer, OutOfReach):
                return answer.reason
        return None

    def _near(self, rows: Floats, pressing: bool = False) -> object | None:
        chain = self._kinematics.chain
        if (rows < chain.lower - 1e-6).any() or (rows > chain.upper + 1e-6).any():
            return f"a joint of the {self._name} arm would pass its limit"
        for row in coarse_first(rows):
            near = self._cell.near_obstacles(self._arm, row, pressing)
            if near is not None:
                return near
        return None

    def _note(self, stage: int, why: str) -> None:
        if stage > self.stage or not self.why:
            self.stage, self.why = stage, why


def parts(rows: Floats) -> tuple[Path, Path, Path]:
    """Down, carry and up, from rows of joint angles of a carry, or of both arms' beside each other."""
    return Path(rows[:ROWS]), Path(rows[ROWS : 2 * ROWS]), Path(rows[2 * ROWS :])


def coarse_first(rows: Floats) -> Floats:
    """The rows in an order in which a collision is soon found: every eighth first."""
    index = np.arange(len(rows))
    return rows[np.argsort(index % 8 != 0, kind="stable")]


def _between(one: Floats, other: Floats, share: float) -> Floats:
    """A pose that is turned like ``one`` on the line to ``other``."""
    pose = one.copy()
    pose[:3, 3] += share * (other - one)[:3, 3]
    return pose
