"""Motions of both arms that touch nothing: to and from the cloth, along a line, and how fast."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice, product

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.plugins.hardware import Infeasible
from polyfold_pybullet.cell import Cell, Near
from polyfold_pybullet.kinematics import Kinematics
from polyfold_pybullet.planning.carrying import STEP, ArmWays, coarse_first
from polyfold_pybullet.planning.grasping import straight
from polyfold_pybullet.planning.plans import Motion
from polyfold_pybullet.planning.timing import Path, Together, least_duration, run

Floats = NDArray[np.float64]

TRANSITS = 3
"""How many transits of each arm are tried with those of the other."""
STAGES = ("reach", "carry", "together", "transit")
RESTARTS = 60
"""Of inverse kinematics: poses that take more are near the end of what can be reached, where nothing can be carried."""
MARGIN = 0.02
"""What postures keep from the joints' limits, so that smooth curves through them don't pass those [rad]."""
LIFTS = (1.0, 0.5, 0.2, 0.1)
"""Shares of the height over the cloth to which a hand that presses on the table is lifted, the highest that can be."""


class PlannerConfig(BaseModel):
    """How the arms move."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    speed: float = Field(default=1.0, gt=0, le=1, description="share of the joints' limits of velocity that is used")
    carry_speed: float = Field(default=0.5, gt=0, description="fastest move of a tool that carries [m/s]")
    transit_speed: float = Field(default=1.0, gt=0, description="fastest move of a tool that does not [m/s]")
    hover: float = Field(default=0.06, gt=0.01, le=0.3, description="height over the cloth where hands turn to it [m]")


class Failure:
    """The attempt that came farthest, as an index of ``STAGES``, and what stood in its way."""

    def __init__(self) -> None:
        self.stage, self.why = -1, ""

    def note(self, stage: int, why: str) -> None:
        """Keep this if nothing came as far."""
        if why and stage > self.stage:
            self.stage, self.why = stage, why

    def infeasible(self) -> Infeasible:
        """As the answer to whoever asked."""
        return Infeasible(self.why, STAGES[max(0, self.stage)])


class Moves:
    """Makes motions of both arms. Rows of joints are the left arm's beside the right one's.

    Args:
        cell: the loaded cell.
        config: how the arms move.
    """

    def __init__(self, cell: Cell, config: PlannerConfig) -> None:
        self.config = config
        left, right = (Kinematics(arm, restarts=RESTARTS, margin=MARGIN) for arm in cell.model.arms)
        self.kinematics = (left, right)
        self.ways = [ArmWays(cell, arm, kin, config.hover) for arm, kin in enumerate(self.kinematics)]
        self._cell = cell

    def apart(self, row: Floats) -> tuple[Floats, Floats]:
        """Each arm's joints of a row, shape (2 N,), or of rows, shape (T, 2 N)."""
        count = len(self.kinematics[0].chain)
        return row[..., :count], row[..., count:]

    def near(self, rows: Floats) -> Near | None:
        """Where the arms are too near to each other in rows, shape (T, 2 N)."""
        for row in coarse_first(rows):
            near = self._cell.near_each_other(*self.apart(row))
            if near is not None:
                return near
        return None

    def transit(self, row: Floats, works: tuple[bool, bool], failure: Failure) -> list[Together] | None:
        """Paths one after the other from parked to a row, straight or through via-points, of the arms that work."""
        ends = self.apart(row)
        ways: list[list[Path]] = []
        for arm, end in enumerate(ends):
            found = list(islice(self.ways[arm].transits(end), TRANSITS)) if works[arm] else [Path(end[None])]
            if not found:
                failure.note(3, self.ways[arm].why)
                return None
            ways.append(found)
        parked = [Path(kin.park[None]) for kin in self.kinematics]
        there = [Path(end[None]) for end in ends]
        for left, right in product(*ways):
            for paths in _orders(left, right, parked, there):
                near = None
                for path in paths:
                    near = near or self.near(path.sampled(STEP))
                if near is None:
                    return [path for path in paths if not path.still]
                failure.note(3, f"{near} on the way to or from the cloth")
        return None

    def parking(self, row: Floats) -> list[Motion] | Infeasible:
        """From a row to where both arms are parked: off the table first, then ways there that are gone backwards."""
        lifted = self._off_the_table(row)
        if isinstance(lifted, Infeasible):
            return lifted
        if lifted:
            row = np.hstack([joints[-1] for joints in lifted[-1].joints])
        failure = Failure()
        works = [np.abs(end - kin.park).max() > 1e-6 for end, kin in zip(self.apart(row), self.kinematics, strict=True)]
        if not any(works):
            return lifted
        back = self.transit(row, (works[0], works[1]), failure)
        if back is None:
            return failure.infeasible()
        return [*lifted, *(backwards(self.motion("park", path, (False, False))) for path in reversed(back))]

    def _off_the_table(self, row: Floats) -> list[Motion] | Infeasible:
        """Straight up with every hand whose tips press on the table, as after a stop while it takes cloth."""
        motions: list[Motion] = []
        for arm, kinematics in enumerate(self.kinematics):
            joints = self.apart(row)[arm]
            free, free_but_for_tips = (
                self._cell.near_obstacles(arm, joints, pressing) is None for pressing in (False, True)
            )
            if free or not free_but_for_tips:
                continue
            lifts = self._lifted(row, arm, kinematics.forward(joints))
            if isinstance(lifts, Infeasible):
                return lifts
            motions += lifts
            row = np.hstack([joints[-1] for joints in lifts[-1].joints])
        return motions

    def _lifted(self, row: Floats, arm: int, pose: Floats) -> list[Motion] | Infeasible:
        """A tool straight up from a pose, as far as the arm can follow, but off the table."""
        found: list[Motion] | Infeasible = Infeasible("the hand can't be lifted off the table", "transit")
        for way in LIFTS:
            above = pose.copy()
            above[2, 3] += way * self.config.hover
            found = self.along(row, arm, above, self.config.carry_speed)
            if not isinstance(found, Infeasible):
                break
        return found

    def along(self, row: Floats, arm: int, pose: Floats, speed: float) -> list[Motion] | Infeasible:
        """From a row with one tool on a straight line to a pose, at most at ``speed`` [m/s]."""
        kinematics, joints = self.kinematics[arm], list(self.apart(row))
        poses = straight(kinematics.forward(joints[arm]), pose)
        path = kinematics.follow(poses, joints[arm])
        if path is None:
            return Infeasible(
                f"the {kinematics.arm.name} arm can't follow this line without a leap of its joints", "reach"
            )
        waits = np.tile(joints[1 - arm], (len(path), 1))
        both = Path(np.hstack([path, waits] if arm == 0 else [waits, path]))
        rows = both.sampled(STEP)
        for one in self.apart(rows)[arm]:
            if (near := self._cell.near_obstacles(arm, one, pressing=True)) is not None:
                return Infeasible(f"{near} on this line", "carry")
        if (near := self.near(rows)) is not None:
            return Infeasible(f"{near} on this line", "together")
        return [self.motion("line", both, (False, False), speed)]

    def motion(
        self, name: str, path: Path | Together, closed: tuple[bool, bool], tool_speed: float | None = None
    ) -> Motion:
        """A path as fast as the joints and a tool's speed [m/s], by default that of transits, allow."""
        left, right = self.kinematics
        velocity = np.concatenate([left.chain.velocity, right.chain.velocity])
        acceleration = np.concatenate([left.arm.acceleration, right.arm.acceleration])

        def tools(rows: Floats) -> Floats:
            both = [kin.along(joints) for kin, joints in zip((left, right), self.apart(rows), strict=True)]
            return np.stack([poses[:, :3, 3] for poses in both], axis=1)

        fastest = least_duration(path, velocity, acceleration) / self.config.speed
        limit = tool_speed or self.config.transit_speed
        times, rows = run(path, max(fastest, least_duration(path, velocity, acceleration, tools, limit)))
        return Motion(name, times, self.apart(rows), closed)


def backwards(motion: Motion) -> Motion:
    """The same motion the other way: it is as fast, since the quintic is symmetric."""
    left, right = motion.joints
    return Motion(motion.name, motion.times, (left[::-1], right[::-1]), motion.closed)


def _orders(left: Path, right: Path, parked: Sequence[Path], there: Sequence[Path]) -> Iterator[list[Together]]:
    """Both arms at once, or one first and then the other."""
    yield [Together(left, right)]
    if not (left.still or right.still):
        yield [Together(left, parked[1]), Together(there[0], right)]
        yield [Together(parked[0], right), Together(left, there[1])]
