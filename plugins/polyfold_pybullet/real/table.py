"""The simulator ``real-cell``, which is none: cloth on a table, a depth camera over it and two arms beside it."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.config import ComponentSpec
from polyfold.errors import GroundingError, RobotError, SimulationError
from polyfold.garments import Garment
from polyfold.geometry import Camera
from polyfold.plugins import create
from polyfold.plugins.hardware import DepthCamera, Infeasible, Robot
from polyfold.types import Action, Observation, SimState
from polyfold_pybullet.looking import Surface
from polyfold_pybullet.real.asking import Asks, ask
from polyfold_pybullet.real.overhead import Overhead, read_eye

Floats = NDArray[np.float64]

_log = logging.getLogger(__name__)

ELEVATION = 2.0
"""Height of the pinhole that pictures are as seen by [m]."""


class RealCell:
    """Folds real cloth. Implements :class:`polyfold.plugins.interfaces.Simulator` as far as anybody can.

    Nothing is opened or moved before :meth:`reset`, and nothing moves before a person has agreed at the terminal. What
    is measured becomes a picture from straight above; picks and places go back from there into the robot's world. A
    fold that can't be planned, or a pick without depth, leaves the cloth as it is and says why. Whatever goes wrong,
    the arms are stopped first.
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
        table: float = Field(default=0.0, ge=-2, le=2, description="height of the table in the robot's world [m]")
        frames: int = Field(default=5, ge=1, le=100, description="pictures averaged")
        bite: float = Field(
            default=0.004, ge=0, le=0.05, description="how far below the measured surface the fingers close [m]"
        )
        confirm: Asks = Field(
            default="each", description="whether a person agrees to each fold, to the start, or never"
        )
        dry_run: bool = Field(default=False, description="look, plan and ask, but move nothing")

    def __init__(self, config: Config) -> None:
        self.config = config
        self._eye = None if config.calibration is None else read_eye(Path(config.calibration).expanduser())
        view = Camera.framing(config.extent, elevation=ELEVATION)
        self._overhead = Overhead(view, config.centre, float(np.radians(config.turn_deg)), config.table)
        self._camera: DepthCamera = create("cameras", config.camera.name, config.camera.params)
        self._robot: Robot = create("robots", config.robot.name, config.robot.params)

    def reset(self, garment: Garment, seed: int) -> Observation:
        """Have somebody lay the garment out, park the arms and take the first picture; ``seed`` decides nothing."""
        self._camera.connect()
        self._robot.connect()
        if self.config.confirm != "never" and not ask(
            f"Lay the {garment.kind} flat in the square of {self.config.extent:g} m around {self.config.centre} and "
            "step back: the arms go to where they wait."
        ):
            raise RobotError("the start was skipped; run it again once the garment lies there")
        if not self.config.dry_run:
            self._moving(self._robot.park)
        return self.observe()

    def observe(self) -> Observation:
        """Look, averaging so many pictures."""
        return self._overhead.observe(self._camera.get_rgbd(self.config.frames), self._eye)

    def execute(self, action: Action) -> Observation:
        """Plan the fold and, if a person agrees, do it."""
        action.check_inside(self._overhead.camera)
        try:
            picks, places = self._located(action, self.observe())
        except GroundingError as error:
            return self._left_out(str(error))
        plan = self._robot.plan(picks, places)
        if isinstance(plan, Infeasible):
            return self._left_out(plan.reason)
        told = ", ".join(
            f"({1000 * x:.0f}, {1000 * y:.0f}) to ({1000 * u:.0f}, {1000 * v:.0f}) mm"
            for (x, y, _), (u, v, _) in zip(picks, places, strict=True)
        )
        if self.config.confirm == "each" and not ask(f"Next fold, {plan.mode}, {plan.duration:.0f} s: {told}."):
            return self._left_out("it was skipped by hand")
        if self.config.dry_run:
            return self._left_out(f"dry run; it would be done {plan.mode} in {plan.duration:.1f} s: {told}")
        self._moving(lambda: self._robot.execute(plan))
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
            self._robot.close()
        finally:
            self._camera.close()

    def _located(self, action: Action, seen: Observation) -> tuple[Floats, Floats]:
        """Where the fingers close and where they let go in the robot's world [m], shape (arms, 3) each."""
        surface = Surface.of(seen.depth)
        found = []
        for pixels in (action.picks, action.places):
            above = np.maximum([surface.at(pixel)[0] for pixel in pixels], 0.0)
            found.append((self._overhead.places(pixels, above), above))
        (picks, on_picks), (places, on_places) = found
        closes = np.maximum(on_picks - self.config.bite, 0.0) if action.heights is None else action.heights
        picks[:, 2], places[:, 2] = self.config.table + closes, self.config.table + on_places + closes
        return picks, places

    def _left_out(self, reason: str) -> Observation:
        _log.warning("a fold is left out: %s", reason)
        return self.observe()

    def _moving(self, motion: Any) -> None:
        """Do what moves; whatever goes wrong, Ctrl-C included, the arms are stopped before it is passed on."""
        try:
            motion()
        except BaseException:
            self._robot.stop()
            raise
