"""Planning a fold: both arms at once if they can, else one after the other, else the reason why not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice, product

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import ActionError
from polyfold_pybullet.cell import Cell
from polyfold_pybullet.kinematics import Kinematics
from polyfold_pybullet.planning.carrying import STEP, ArmWays, Carry, coarse_first, parts
from polyfold_pybullet.planning.grasping import wide_sides
from polyfold_pybullet.planning.plans import FoldPlan, Infeasible, Motion
from polyfold_pybullet.planning.timing import Path, Together, least_duration, run

Floats = NDArray[np.float64]

CARRIES, TRANSITS = 4, 3
"""How many carries are tried for each turn of the hands, and how many transits of each arm with those of the other."""
PAIRS, GLIMPSE = 100, 4
"""How many pairs of carries are looked at, and every how manieth of their rows at first."""
RESTARTS = 60
"""Of inverse kinematics: poses that take more are near the end of what can be reached, where nothing can be carried."""
MARGIN = 0.02
"""What postures keep from the joints' limits, so that smooth curves through them don't pass those [rad]."""
STAGES = ("reach", "carry", "together", "transit")


class PlannerConfig(BaseModel):
    """How the arms move."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    speed: float = Field(default=1.0, gt=0, le=1, description="share of the joints' limits of velocity that is used")
    carry_speed: float = Field(default=0.5, gt=0, description="fastest move of a tool that carries [m/s]")
    transit_speed: float = Field(default=1.0, gt=0, description="fastest move of a tool that does not [m/s]")
    hover: float = Field(default=0.06, gt=0.01, le=0.3, description="height over the cloth where hands turn to it [m]")


class _Failure:
    """The attempt that came farthest."""

    def __init__(self) -> None:
        self.stage, self.why = -1, ""

    def note(self, stage: int, why: str) -> None:
        if stage > self.stage:
            self.stage, self.why = stage, why

    def infeasible(self) -> Infeasible:
        return Infeasible(self.why, STAGES[max(0, self.stage)])


class FoldPlanner:
    """Plans folds in a loaded cell; it moves nothing but the cell's own picture of the arms.

    Args:
        cell: the loaded cell.
        config: how the arms move.
    """

    def __init__(self, cell: Cell, config: PlannerConfig | None = None) -> None:
        self.config = config or PlannerConfig()
        self._cell = cell
        left, right = (Kinematics(arm, restarts=RESTARTS, margin=MARGIN) for arm in cell.model.arms)
        self.kinematics = (left, right)
        self._ways = [ArmWays(cell, arm, kin, self.config.hover) for arm, kin in enumerate(self.kinematics)]

    def plan(self, picks: ArrayLike, places: ArrayLike) -> FoldPlan | Infeasible:
        """How the arms take cloth at picks and lay it at places.

        Tried in this order: each arm at the pick that is nearer to it; the other way round; one after the other. The
        plan goes from parked to parked, and in it nothing comes nearer to anything than the cell's clearances, at rows
        of joint angles at most 0.04 rad apart.

        Args:
            picks, places: where the tools go [m], shape (1 or 2, 3).

        Raises:
            ActionError: the arrays have another shape or are not finite.
        """
        picks, places = _checked(picks, places)
        failure = _Failure()
        orders = self._nearest_first(picks, places)
        if len(picks) == 2:
            for arms in orders:
                if (plan := self._at_once(picks, places, arms, failure)) is not None:
                    return plan
        done: list[tuple[int, list[Motion]]] = []
        alone = _Failure()
        for pick, place in zip(picks, places, strict=True):
            found = self._alone(pick[None], place[None], alone)
            if found is None:
                return alone.infeasible()
            done.append(found)
        mode = "one arm" if len(picks) == 1 else "in sequence"
        return FoldPlan(mode, tuple(arm for arm, _ in done), tuple(motion for _, moves in done for motion in moves))

    def _nearest_first(self, picks: Floats, places: Floats) -> list[tuple[int, ...]]:
        """Which arm does each pick: the assignments by the sum of distances from the arms' shoulders."""
        orders = [(0, 1), (1, 0)] if len(picks) == 2 else [(0,), (1,)]

        def distance(arms: tuple[int, ...]) -> float:
            bases = np.array([self._cell.model.arms[arm].base_position for arm in arms])
            shoulders = np.array([self.kinematics[arm].chain.origins[0][:3, 3] for arm in arms])
            bases[:, :2] = shoulders[:, :2]
            return sum(float(np.linalg.norm((points - bases)[:, :2], axis=1).sum()) for points in (picks, places))

        return sorted(orders, key=distance)

    def _at_once(self, picks: Floats, places: Floats, arms: tuple[int, ...], failure: _Failure) -> FoldPlan | None:
        for yaws in wide_sides(picks, places):
            carries: list[list[Carry]] = [[], []]
            for arm, pick, place in zip(arms, picks, places, strict=True):
                ways = self._ways[arm]
                ways.forget()
                carries[arm] = ways.carries(pick, place, yaws)
                if not carries[arm]:
                    failure.note(ways.stage, ways.why)
                    break
            pairs = sorted(product(*carries), key=lambda pair: max(pair[0].away, pair[1].away))
            tried = 0
            for left, right in pairs[:PAIRS]:
                rows = np.hstack([left.rows, right.rows])
                if (near := self._near(rows[::GLIMPSE])) is not None:
                    failure.note(2, f"{near} while both arms carry")
                    continue
                if not all(ways.clear(carry) for ways, carry in zip(self._ways, (left, right), strict=True)):
                    continue
                moves = self._together(rows, (True, True), failure)
                if moves is not None:
                    return FoldPlan("at once", arms, tuple(moves))
                tried += 1
                if tried == CARRIES:
                    break
            for ways in self._ways:
                failure.note(ways.stage, ways.why)
        return None

    def _alone(self, pick: Floats, place: Floats, failure: _Failure) -> tuple[int, list[Motion]] | None:
        """A fold with one pick, by the nearer arm or else the other, while the other is parked."""
        for (arm,) in self._nearest_first(pick, place):
            other = self.kinematics[1 - arm].park
            for yaws in wide_sides(pick, place):
                ways = self._ways[arm]
                ways.forget()
                tried = 0
                for carry in ways.carries(pick[0], place[0], yaws):
                    waits = np.tile(other, (len(carry.rows), 1))
                    rows = np.hstack([carry.rows, waits] if arm == 0 else [waits, carry.rows])
                    if (near := self._near(rows[::GLIMPSE])) is not None:
                        failure.note(2, f"{near} while one carries and the other is parked")
                        continue
                    if tried == CARRIES:
                        break
                    if not ways.clear(carry):
                        continue
                    tried += 1
                    moves = self._together(rows, (arm == 0, arm == 1), failure)
                    if moves is not None:
                        return arm, moves
                failure.note(ways.stage, ways.why)
        return None

    def _together(self, rows: Floats, works: tuple[bool, bool], failure: _Failure) -> list[Motion] | None:
        """The motions of a fold whose carry, both arms' joints beside each other, is given; None if they collide."""
        carry = parts(rows)
        for part in carry:
            if (near := self._near(part.sampled(STEP))) is not None:
                failure.note(2, f"{near} while they carry")
                return None
        there = self._transit(rows[0], works, failure)
        back = self._transit(rows[-1], works, failure) if there is not None else None
        if there is None or back is None:
            return None
        opened, config = (False, False), self.config
        approach = [self._motion("approach", path, opened, config.transit_speed) for path in there]
        down, across, up = (
            self._motion(name, part, closed, config.carry_speed)
            for name, part, closed in zip(("down", "carry", "up"), carry, (opened, works, opened), strict=True)
        )
        retreat = [_backwards(self._motion("return", path, opened, config.transit_speed)) for path in reversed(back)]
        return [*approach, down, across, up, *retreat]

    def _transit(self, row: Floats, works: tuple[bool, bool], failure: _Failure) -> list[Together] | None:
        """Paths one after the other from parked to a row of both arms' joints, straight or through via-points."""
        count = len(self.kinematics[0].chain)
        ends = (row[:count], row[count:])
        ways: list[list[Path]] = []
        for arm, end in enumerate(ends):
            found = [Path(end[None])] if not works[arm] else list(islice(self._ways[arm].transits(end), TRANSITS))
            if not found:
                failure.note(3, self._ways[arm].why)
                return None
            ways.append(found)
        parked = [Path(kin.park[None]) for kin in self.kinematics]
        there = [Path(end[None]) for end in ends]
        for left, right in product(*ways):
            for paths in _orders(left, right, parked, there):
                near = None
                for path in paths:
                    near = near or self._near(path.sampled(STEP))
                if near is None:
                    return [path for path in paths if not path.still]
                failure.note(3, f"{near} on the way to or from the cloth")
        return None

    def _near(self, rows: Floats) -> object | None:
        count = len(self.kinematics[0].chain)
        for row in coarse_first(rows):
            near = self._cell.near_each_other(row[:count], row[count:])
            if near is not None:
                return near
        return None

    def _motion(self, name: str, path: Path | Together, closed: tuple[bool, bool], tool_speed: float) -> Motion:
        left, right = self.kinematics
        count = len(left.chain)
        velocity = np.concatenate([left.chain.velocity, right.chain.velocity])
        acceleration = np.concatenate([left.arm.acceleration, right.arm.acceleration])

        def tools(rows: Floats) -> Floats:
            both = (left.along(rows[:, :count]), right.along(rows[:, count:]))
            return np.stack([poses[:, :3, 3] for poses in both], axis=1)

        fastest = least_duration(path, velocity, acceleration) / self.config.speed
        duration = max(fastest, least_duration(path, velocity, acceleration, tools, tool_speed))
        times, rows = run(path, duration)
        return Motion(name, times, (rows[:, :count], rows[:, count:]), closed)


def _orders(left: Path, right: Path, parked: Sequence[Path], there: Sequence[Path]) -> Iterator[list[Together]]:
    """Both arms at once, or one first and then the other."""
    yield [Together(left, right)]
    if not (left.still or right.still):
        yield [Together(left, parked[1]), Together(there[0], right)]
        yield [Together(parked[0], right), Together(left, there[1])]


def _backwards(motion: Motion) -> Motion:
    left, right = motion.joints
    return Motion(motion.name, motion.times, (left[::-1], right[::-1]), motion.closed)


def _checked(picks: ArrayLike, places: ArrayLike) -> tuple[Floats, Floats]:
    picks, places = np.array(picks, float), np.array(places, float)
    if picks.shape != places.shape or picks.shape not in ((1, 3), (2, 3)):
        raise ActionError(
            f"picks and places have shapes {picks.shape} and {places.shape}; give (1, 3) or (2, 3) in metres"
        )
    if not (np.isfinite(picks).all() and np.isfinite(places).all()):
        raise ActionError("a pick or place is not finite; give numbers in metres")
    return picks, places
