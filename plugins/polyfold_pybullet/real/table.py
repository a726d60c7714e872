"""The simulator ``real-cell``, which is none: cloth on a table, a depth camera over it and two arms beside it."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.config import ComponentSpec
from polyfold.errors import GroundingError, RobotError, SimulationError
from polyfold.garments import Garment
from polyfold.geometry import Camera
from polyfold.plugins import create
from polyfold.plugins.hardware import DepthCamera, Infeasible, RgbdFrame, Robot, RobotPlan
from polyfold.types import Action, Observation, SimState
from polyfold_pybullet.arms import PybulletArms
from polyfold_pybullet.looking import Surface
from polyfold_pybullet.planning.plans import FoldPlan
from polyfold_pybullet.real.asking import Asks, agreed, endings_raise
from polyfold_pybullet.real.overhead import Overhead, read_eye

Floats = NDArray[np.float64]

_log = logging.getLogger(__name__)

ELEVATION = 2.0
"""Height of the pinhole that pictures are as seen by [m]."""
LEVEL = 0.01
"""A table that is measured farther than this from the robot's plane z = 0, at the middle or a corner of the view, is
not where the robot thinks [m]: the camera's pose is wrong, or the robot's world."""
CHANGED, BY = 0.01, 40
"""Share of the picture that may differ, and by how many grey levels, between planning and moving."""


class RealCell:
    """Folds real cloth. Implements :class:`polyfold.plugins.interfaces.Simulator` as far as anybody can.

    Nothing is opened or moved before :meth:`reset`, and nothing moves before a person has agreed at the terminal. What
    is measured becomes a picture from straight above; picks and places go back from there into the robot's world, of
    which the table's top is the plane z = 0. A fold that can't be planned, or a pick without depth, leaves the cloth as
    it is and says why. Whatever goes wrong, the arms are stopped first.
    """

    unattended: ClassVar[bool] = False

    class Config(BaseModel):
        """The cell: its camera and arms, what part of the table is looked at, and who agrees to what."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        camera: ComponentSpec = Field(description="a registered camera, for example realsense")
        robot: ComponentSpec = Field(description="registered arms, for example ur")
        calibration: str | None = Field(
            default=None, description="camera.json of 'polyfold calibrate'; by default the camera says where it is"
        )
        extent: float = Field(default=0.8, gt=0.1, le=3, description="side of the square that is looked at [m]")
        centre: tuple[float, float] = Field(
            default=(0.0, 0.0), description="its middle in the robot's world: x and y [m]"
        )
        turn_deg: float = Field(
            default=0.0, ge=-180, le=180, description="how far the picture's right is turned from the world's x [deg]"
        )
        frames: int = Field(default=5, ge=1, le=100, description="pictures averaged")
        bite: float = Field(
            default=0.004, ge=0, le=0.05, description="how far below the measured surface the fingers close [m]"
        )
        confirm: Asks = Field(
            default="each", description="whether a person agrees to each fold, to the start, or never"
        )
        picture: str | None = Field(
            default=None,
            description="where a picture of the next fold is left before it is asked for, such as next.png",
        )
        film: str | None = Field(
            default=None, description="where a film of the arms doing it is left besides, such as next.gif"
        )
        dry_run: bool = Field(default=False, description="look and plan the first fold, and move nothing")

    def __init__(self, config: Config) -> None:
        self.config = config
        self._eye, self._size = None, None
        if config.calibration is not None:
            self._eye, self._size = read_eye(Path(config.calibration).expanduser())
        view = Camera.framing(config.extent, elevation=ELEVATION)
        self._overhead = Overhead(view, config.centre, float(np.radians(config.turn_deg)))
        self.camera: DepthCamera = create("cameras", config.camera.name, config.camera.params)
        self.robot: Robot = create("robots", config.robot.name, config.robot.params)

    def reset(self, garment: Garment, seed: int) -> Observation:
        """Have somebody lay the garment out, park the arms and take the first picture; ``seed`` decides nothing."""
        self.camera.connect()
        self.robot.connect()
        if not self.config.dry_run:
            self.park(
                f"Lay the {garment.kind} flat in the square of {self.config.extent:g} m around "
                f"{self.config.centre} and step back: the hands open, and the arms go to where they wait."
            )
        seen = self.observe()
        self._refuse_a_table_elsewhere(seen)
        return seen

    def park(self, what: str) -> None:
        """Open the hands and bring the arms to where they wait, once a person has agreed to what they are told.

        Raises:
            RobotError: if nobody agrees, or the arms fail; they are stopped then.
        """
        if self.config.confirm != "never":
            agreed(what)
        self._moving(self.robot.park)

    def observe(self) -> Observation:
        """Look, averaging so many pictures."""
        return self.seen(self.camera.get_rgbd(self.config.frames))

    def seen(self, frame: RgbdFrame) -> Observation:
        """What the camera measured, as seen from above. Raises RobotError if it is not known where the camera is."""
        height, width = frame.depth.shape
        if self._size is not None and self._size != (width, height):
            raise RobotError(
                f"the camera's pictures are {width} x {height}, those that it was calibrated with "
                f"{self._size[0]} x {self._size[1]}; use that size, or calibrate with this one"
            )
        return self._overhead.observe(frame, self._eye)

    def execute(self, action: Action) -> Observation:
        """Plan the fold and, if a person agrees, do it."""
        action.check_inside(self._overhead.camera)
        seen = self.observe()
        try:
            picks, places = self._located(action, seen)
        except GroundingError as error:
            return self._left_out(str(error))
        plan = self.robot.plan(picks, places)
        if isinstance(plan, Infeasible):
            return self._left_out(plan.reason)
        told = ", ".join(
            f"({1000 * x:.0f}, {1000 * y:.0f}) to ({1000 * u:.0f}, {1000 * v:.0f}) mm"
            for (x, y, _), (u, v, _) in zip(picks, places, strict=True)
        )
        self._show(seen, action, plan)
        if self.config.dry_run:
            raise RobotError(
                f"dry run, nothing moved: it would fold {plan.mode} in {plan.duration:.1f} s, {told}; "
                "to do it, set dry_run to false"
            )
        if self.config.confirm == "each":
            agreed(f"Next fold, {plan.mode}, {plan.duration:.0f} s: {told}.")
            if _differs(seen, self.observe()):
                return self._left_out("the picture changed while you were asked, so that the plan is of no use")
        self._moving(lambda: self.robot.execute(plan))
        return self.observe()

    def state(self) -> SimState:
        """Nobody knows it."""
        return SimState.of_real_cloth(self._overhead.camera)

    def restore(self, state: SimState) -> None:
        """Real cloth can't be put back. Raises SimulationError."""
        raise SimulationError("real cloth can't be put back as it lay; fold on, or lay it out anew")

    def close(self) -> None:
        """Stop and release the arms and the camera."""
        try:
            self.robot.close()
        finally:
            self.camera.close()

    def _located(self, action: Action, seen: Observation) -> tuple[Floats, Floats]:
        """Where the fingers close and where they let go in the robot's world [m], shape (arms, 3) each."""
        surface = Surface.of(seen.depth)
        found = []
        for pixels in (action.picks, action.places):
            above = np.maximum([surface.at(pixel)[0] for pixel in pixels], 0.0)
            found.append((self._overhead.places(pixels, above), above))
        (picks, on_picks), (places, on_places) = found
        closes = np.maximum(on_picks - self.config.bite, 0.0) if action.heights is None else action.heights
        picks[:, 2], places[:, 2] = closes, on_places + closes
        return picks, places

    def _refuse_a_table_elsewhere(self, seen: Observation) -> None:
        """Raises RobotError if the table is not measured where the robot's world has it."""
        heights = table_heights(seen)
        worst = float(heights[np.argmax(np.abs(heights))])
        if abs(worst) > LEVEL:
            raise RobotError(
                f"the table is measured {1000 * worst:.0f} mm from where the robot's world has it (z = 0); calibrate "
                "the camera in that world, or correct the world"
            )

    def _show(self, seen: Observation, action: Action, plan: RobotPlan) -> None:
        """Leave a picture of the next fold, and a film of it where the arms can show themselves."""
        from polyfold import viz

        if self.config.picture is not None:
            viz.save(viz.overlay(seen, action=action, zoom=2.0), _place(self.config.picture))
            print(f"the next fold is drawn in {self.config.picture}", file=sys.stderr)
        if self.config.film is not None:
            if not isinstance(self.robot, PybulletArms) or not isinstance(plan, FoldPlan):
                raise RobotError(
                    f"the robot {self.config.robot.name!r} can't show itself; leave film out, or use one that plans in "
                    "PyBullet"
                )
            viz.gif(list(self.robot.film(plan)), _place(self.config.film), fps=4)
            print(f"the arms are shown doing it in {self.config.film}", file=sys.stderr)

    def _left_out(self, reason: str) -> Observation:
        _log.warning("a fold is left out: %s", reason)
        return self.observe()

    def _moving(self, motion: Callable[[], None]) -> None:
        """Do what moves; whatever goes wrong, Ctrl-C included, the arms are stopped before it is passed on."""
        try:
            with endings_raise():
                motion()
        except BaseException:
            self.robot.stop()
            raise


def table_heights(seen: Observation) -> Floats:
    """How high the table is measured at the view's middle and corners [m], shape (5,)."""
    camera = seen.camera
    across, down = camera.width - 1, camera.height - 1
    places = np.array(
        [[1.0, x, y] for x, y in ((across / 2, down / 2), (0, 0), (across, 0), (0, down), (across, down))]
    )
    return camera.elevation - places @ Surface.of(seen.depth).table


def _place(path: str) -> Path:
    """A file's path, its folder made."""
    found = Path(path).expanduser()
    found.parent.mkdir(parents=True, exist_ok=True)
    return found


def _differs(before: Observation, after: Observation) -> bool:
    """Whether more of a picture changed than a camera's noise does."""
    change = np.abs(before.rgb.astype(int) - after.rgb).max(axis=2) > BY
    return float(change.mean()) > CHANGED
