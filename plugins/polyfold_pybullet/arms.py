"""The robot ``pybullet``: two arms that move as planned, in PyBullet, without dynamics."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import RobotError
from polyfold.plugins.hardware import ArmLimits, Infeasible, RobotPlan
from polyfold_pybullet.robots import RobotModel, robot_model

if TYPE_CHECKING:
    from polyfold_pybullet.cell import Cell
    from polyfold_pybullet.planning import FoldPlan, FoldPlanner, Motion

Floats = NDArray[np.float64]


class PybulletArms:
    """Two arms at a table. Implements :class:`polyfold.plugins.hardware.Robot`.

    Plans keep the arms 15 mm apart and 10 mm from torso, posts and table. What a plan says is where the joints are:
    there are no dynamics, so a controller's errors are none. Hands are as wide as they were told to be.
    """

    class Config(BaseModel):
        """Which arms, and how they move."""

        model_config = ConfigDict(extra="forbid", frozen=True)

        robot: str = Field(default="panda", description="panda, or yumi (pip install 'polyfold[yumi]')")
        model: RobotModel | None = Field(
            default=None, description="other arms: their URDF, base, joints, tool, home posture and limits"
        )
        speed: float = Field(default=1.0, ge=0.01, le=1, description="share of the joints' limits of velocity")
        carry_speed: float = Field(default=0.5, ge=0.01, le=5, description="fastest move of a tool that carries [m/s]")
        transit_speed: float = Field(
            default=1.0, ge=0.01, le=5, description="fastest move of a tool that does not [m/s]"
        )
        interval: float = Field(default=0.02, ge=0.001, le=1, description="time between two steps of a motion [s]")

    _there: ClassVar[float] = 1e-3
    """How far joints may be from where a plan begins [rad]."""

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()
        self._cell: Cell | None = None
        self._planner: FoldPlanner | None = None
        self._joints: list[Floats] = []
        self._closed = [False, False]
        self._stopped = threading.Event()

    @property
    def arms(self) -> tuple[str, ...]:
        """What the arms are called."""
        return tuple(arm.name for arm in self._model().arms)

    @property
    def cell(self) -> Cell:
        """The loaded cell, as for pictures of it. Raises RobotError if the robot is not connected."""
        return self._ready()[0]

    def connect(self) -> None:
        """Load the cell, with the arms parked and the hands open. Raises ConfigError for a robot that can't be read."""
        if self._cell is not None:
            return
        from polyfold_pybullet.cell import Cell
        from polyfold_pybullet.planning import FoldPlanner, PlannerConfig

        cell = Cell(self._model()).open()
        try:
            chosen = self.config.model_dump(include={"speed", "carry_speed", "transit_speed"})
            planner = FoldPlanner(cell, PlannerConfig(**chosen))
        except Exception:
            cell.close()
            raise
        self._cell, self._planner = cell, planner
        self._joints = [kinematics.park.copy() for kinematics in planner.kinematics]
        self._closed = [False, False]
        self._stopped.clear()
        self._show()

    def close(self) -> None:
        """Release the cell; nothing if it is not loaded."""
        self.stop()
        if self._cell is not None:
            self._cell.close()
        self._cell = self._planner = None

    def limits(self, arm: int) -> ArmLimits:
        """How an arm may move."""
        kinematics = self._ready()[1].kinematics[arm]
        chain = kinematics.chain
        return ArmLimits(chain.lower, chain.upper, chain.velocity, np.array(kinematics.arm.acceleration))

    def tcp_pose(self, arm: int) -> Floats:
        """Where an arm's tool is now, shape (4, 4)."""
        return self._ready()[1].kinematics[arm].forward(self._joints[arm])

    def joint_state(self, arm: int) -> Floats:
        """An arm's joint angles now [rad, m], shape (N,)."""
        self._ready()
        return self._joints[arm].copy()

    def plan(self, picks: ArrayLike, places: ArrayLike) -> FoldPlan | Infeasible:
        """How to take cloth at picks and lay it at places [m], shape (1 or 2, 3); moves nothing."""
        _, planner = self._ready()
        try:
            return planner.plan(picks, places)
        finally:
            self._show()  # planning tries postures in the same cell

    def execute(self, plan: RobotPlan, watch: Callable[[float], None] | None = None) -> None:
        """Do what was planned, from parked to parked. Raises RobotError if it was stopped or the arms are elsewhere."""
        from polyfold_pybullet.planning import FoldPlan

        self._sync()
        if not isinstance(plan, FoldPlan):
            raise RobotError("this is no plan of these arms; give one that their plan method returned")
        self._refuse_after_a_stop()
        for joints, now in zip(plan.motions[0].joints, self._joints, strict=True):
            if np.abs(joints[0] - now).max() > self._there:
                raise RobotError("the arms are not where the plan begins; call park first")
        clock = 0.0
        for motion in plan.motions:
            if list(motion.closed) != self._closed:
                self._set_hands(motion.closed)
                clock += plan.settling
            clock = self._run(motion, clock, watch)

    def film(
        self,
        plan: FoldPlan,
        step: float = 0.5,
        size: tuple[int, int] = (420, 320),
        before: Callable[[float], None] | None = None,
        **view: Any,
    ) -> Iterator[NDArray[np.uint8]]:
        """Pictures of what a plan would do; nothing moves but what is drawn.

        Args:
            plan: of these arms.
            step: time between two pictures [s].
            size: of a picture, (width, height) [px].
            before: called before each picture with the share of the carrying that is done, for what else is drawn.
            view: where it is seen from, as of the cell's ``picture``.

        Yields:
            Pictures, uint8, shape (H, W, 3).
        """
        cell, _ = self._ready()
        carrying = sum(motion.duration for motion in plan.motions if any(motion.closed))
        done = 0.0
        try:
            for motion in plan.motions:
                carries = any(motion.closed)
                for time in np.arange(0.0, motion.duration, step):
                    for arm, joints in enumerate(motion.at(np.array([time]))):
                        cell.set_arm(arm, joints[0])
                        cell.set_hand(arm, self._width_if(arm, motion.closed[arm]))
                    if before is not None:
                        before((done + carries * time) / carrying if carrying else 0.0)
                    yield cell.picture(*size, **view)
                done += carries * motion.duration
        finally:
            self._show()

    def move_linear(self, arm: int, pose: ArrayLike, speed: float = 0.1) -> None:
        """Move a tool on a straight line to a pose, at most at ``speed`` [m/s], while the other arm rests."""
        self._sync()
        _, planner = self._ready()
        self._refuse_after_a_stop()
        if not (np.isfinite(speed) and speed > 0):
            raise RobotError(f"a tool can't move at {speed} m/s; give a speed above 0")
        moved = planner.moves.along(np.hstack(self._joints), arm, np.asarray(pose, float), speed)
        self._do(moved, "choose another pose")

    def gripper(self, arm: int, closed: bool) -> float:
        """Close or open a hand, and say how wide it is then [m]."""
        self._ready()
        self._refuse_after_a_stop()
        self._closed[arm] = closed
        self._show()
        return 2 * self._width(arm)

    def park(self) -> None:
        """Open the hands and bring the arms to where they wait; allowed after a stop."""
        _, planner = self._ready()
        self._stopped.clear()
        self._sync()
        self._open_hands()
        moved = planner.moves.parking(np.hstack(self._joints))
        self._do(moved, "move the arms apart with move_linear first")

    def stop(self) -> None:
        """Stop all arms where they are, from any thread; until parked they do nothing else."""
        self._stopped.set()

    def _sync(self) -> None:
        """Make sure of where the arms are before they move."""
        self._ready()

    def _open_hands(self) -> None:
        self._set_hands((False, False))

    def _set_hands(self, closed: Sequence[bool]) -> None:
        self._closed = list(closed)
        self._show()

    def _do(self, moved: list[Motion] | Infeasible, advice: str) -> None:
        self._show()
        if isinstance(moved, Infeasible):
            raise RobotError(f"{moved.reason}; {advice}")
        for motion in moved:
            self._run(motion, 0.0, None)

    def _run(self, motion: Motion, clock: float, watch: Callable[[float], None] | None) -> float:
        """Step through a motion that begins at ``clock`` [s]; returns when it ends."""
        steps = max(2, int(np.ceil(motion.duration / self.config.interval)) + 1)
        times = np.linspace(0.0, motion.duration, steps)
        for time, left, right in zip(times, *motion.at(times), strict=True):
            self._refuse_after_a_stop()
            self._joints = [left, right]
            self._show()
            if watch is not None:
                watch(clock + float(time))
        return clock + motion.duration

    def _refuse_after_a_stop(self) -> None:
        if self._stopped.is_set():
            raise RobotError("the arms were stopped and rest where they are; look, then call park")

    def _show(self) -> None:
        """Put the cell's arms and hands where the robot's are."""
        cell, _ = self._ready()
        for arm, joints in enumerate(self._joints):
            cell.set_arm(arm, joints)
            cell.set_hand(arm, self._width(arm))

    def _width(self, arm: int) -> float:
        return self._width_if(arm, self._closed[arm])

    def _width_if(self, arm: int, closed: bool) -> float:
        """How far each finger of a hand is from its middle, closed or open [m]."""
        chosen = self._model().arms[arm]
        return chosen.closed_width if closed else chosen.open_width

    def _model(self) -> RobotModel:
        return self.config.model or robot_model(self.config.robot)

    def _ready(self) -> tuple[Cell, FoldPlanner]:
        if self._cell is None or self._planner is None:
            raise RobotError("the robot is not connected; call connect first")
        return self._cell, self._planner
