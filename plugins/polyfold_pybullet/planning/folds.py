"""Planning a fold: both arms at once if they can, else one after the other, else the reason why not."""

from __future__ import annotations

from itertools import islice, product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import ActionError
from polyfold.plugins.hardware import Infeasible
from polyfold_pybullet.cell import Cell
from polyfold_pybullet.planning.carrying import ROWS, STEP, Carry, parts
from polyfold_pybullet.planning.grasping import towards_each_other, wide_sides
from polyfold_pybullet.planning.moves import Failure, Moves, PlannerConfig, backwards
from polyfold_pybullet.planning.plans import FoldPlan, Motion

Floats = NDArray[np.float64]

NEAR = 0.25
"""Tools so near to each other [m] may lean apart, for the wrists are wider than the fingers."""
CARRIES = 4
"""How many carries are tried for each turn of the hands."""
PAIRS, GLIMPSE = 100, 4
"""How many pairs of carries are looked at, and every how manieth of their rows at first."""


class FoldPlanner:
    """Plans folds in a loaded cell; it moves nothing but the cell's own picture of the arms.

    Args:
        cell: the loaded cell.
        config: how the arms move.
    """

    def __init__(self, cell: Cell, config: PlannerConfig | None = None) -> None:
        self.config = config or PlannerConfig()
        self.moves = Moves(cell, self.config)
        self.kinematics = self.moves.kinematics
        self._cell = cell

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
        for arm, made in enumerate(self._cell.model.arms):
            self._cell.set_hand(arm, made.open_width)  # an open hand is the larger one
        failure = Failure()
        orders = self._nearest_first(picks, places)
        if len(picks) == 2:
            near = max(float(np.linalg.norm(points[0] - points[1])) for points in (picks, places)) < NEAR
            for lean, arms in product((False, True) if near else (False,), orders):
                if (plan := self._at_once(picks, places, arms, failure, lean)) is not None:
                    return plan
        done: list[tuple[int, list[Motion]]] = []
        alone = Failure()
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

    def _at_once(
        self, picks: Floats, places: Floats, arms: tuple[int, ...], failure: Failure, lean: bool
    ) -> FoldPlan | None:
        """A fold by both arms, the wrists upright or, where tools are near to each other, leaning apart."""
        inwards = towards_each_other(picks, places, ROWS) if lean else (None, None)
        for yaws in islice(wide_sides(picks, places), 1 if lean else None):
            carries: list[list[Carry]] = [[], []]
            for arm, pick, place, towards in zip(arms, picks, places, inwards, strict=True):
                ways = self.moves.ways[arm]
                ways.forget()
                carries[arm] = ways.carries(pick, place, yaws, towards)
                if not carries[arm]:
                    failure.note(ways.stage, ways.why)
                    break
            pairs = sorted(product(*carries), key=lambda pair: max(pair[0].away, pair[1].away))
            tried = 0
            for left, right in pairs[:PAIRS]:
                rows = np.hstack([left.rows, right.rows])
                if (near := self.moves.near(rows[::GLIMPSE])) is not None:
                    failure.note(2, f"{near} while both arms carry")
                    continue
                if not all(ways.clear(carry) for ways, carry in zip(self.moves.ways, (left, right), strict=True)):
                    continue
                moves = self._together(rows, (True, True), failure)
                if moves is not None:
                    return FoldPlan("at once", arms, tuple(moves))
                tried += 1
                if tried == CARRIES:
                    break
            for ways in self.moves.ways:
                failure.note(ways.stage, ways.why)
        return None

    def _alone(self, pick: Floats, place: Floats, failure: Failure) -> tuple[int, list[Motion]] | None:
        """A fold with one pick, by the nearer arm or else the other, while the other is parked."""
        for (arm,) in self._nearest_first(pick, place):
            other = self.kinematics[1 - arm].park
            for yaws in wide_sides(pick, place):
                ways = self.moves.ways[arm]
                ways.forget()
                tried = 0
                for carry in ways.carries(pick[0], place[0], yaws):
                    waits = np.tile(other, (len(carry.rows), 1))
                    rows = np.hstack([carry.rows, waits] if arm == 0 else [waits, carry.rows])
                    if (near := self.moves.near(rows[::GLIMPSE])) is not None:
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

    def _together(self, rows: Floats, works: tuple[bool, bool], failure: Failure) -> list[Motion] | None:
        """The motions of a fold whose carry, both arms' joints beside each other, is given; None if they collide."""
        carry = parts(rows)
        for part in carry:
            if (near := self.moves.near(part.sampled(STEP))) is not None:
                failure.note(2, f"{near} while they carry")
                return None
        there = self.moves.transit(rows[0], works, failure)
        back = self.moves.transit(rows[-1], works, failure) if there is not None else None
        if there is None or back is None:
            return None
        opened, config = (False, False), self.config
        approach = [self.moves.motion("approach", path, opened, config.transit_speed) for path in there]
        down, across, up = (
            self.moves.motion(name, part, closed, config.carry_speed)
            for name, part, closed in zip(("down", "carry", "up"), carry, (opened, works, opened), strict=True)
        )
        retreat = [
            backwards(self.moves.motion("return", path, opened, config.transit_speed)) for path in reversed(back)
        ]
        return [*approach, down, across, up, *retreat]


def _checked(picks: ArrayLike, places: ArrayLike) -> tuple[Floats, Floats]:
    picks, places = np.array(picks, float), np.array(places, float)
    if picks.shape != places.shape or picks.shape not in ((1, 3), (2, 3)):
        raise ActionError(
            f"picks and places have shapes {picks.shape} and {places.shape}; give (1, 3) or (2, 3) in metres"
        )
    if not (np.isfinite(picks).all() and np.isfinite(places).all()):
        raise ActionError("a pick or place is not finite; give numbers in metres")
    return picks, places
