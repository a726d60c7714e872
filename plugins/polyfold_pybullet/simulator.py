"""The simulator ``pybullet``: cloth as another simulator has it, seen and folded by a cell as it really would be."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, field_validator

from polyfold.errors import GroundingError
from polyfold.garments import Garment
from polyfold.geometry import Calibration, Camera
from polyfold.plugins import create
from polyfold.plugins.hardware import Infeasible, RobotPlan
from polyfold.plugins.interfaces import RecordsMotion
from polyfold.types import Action, Observation, SimState
from polyfold_pybullet.arms import PybulletArms
from polyfold_pybullet.depth_noise import DepthNoise
from polyfold_pybullet.scenery import PaintedCell, Scenery

if TYPE_CHECKING:
    from polyfold_pybullet.depth_noise import NoisyDepth
    from polyfold_pybullet.looking import Eye

Floats = NDArray[np.float64]

_log = logging.getLogger(__name__)

ELEVATION = 0.9
"""Height of the camera of ``xpbd``, unless its parameters say otherwise [m]."""
SURE = 3.0
"""A tilt of so many times what depth's bias alone looks like is the camera's."""
NEAR_PICK = 0.015
"""Cloth so near to a pick lies between the fingers [m]."""


@dataclass(frozen=True)
class Grip:
    """What became of one arm's grip.

    Attributes:
        tip: height of the fingers' tips when they closed [m].
        taken, left: particles between the fingers that were taken, and that lay lower and stayed.
        off: how far from what was meant the tool was, along the table [m].
    """

    tip: float
    taken: int
    left: int
    off: float


@dataclass(frozen=True)
class CellFold:
    """What became of one fold in the cell.

    Attributes:
        mode: ``at once``, ``in sequence``, ``one arm``, ``infeasible`` or ``not seen``.
        seconds: how long the arms moved [s].
        reason: why it was not done; empty if it was.
        grips: of each arm.
    """

    mode: str
    seconds: float = 0.0
    reason: str = ""
    grips: tuple[Grip, ...] = ()


class CellSimulator:
    """Runs another simulator's cloth in a robot cell. Implements :class:`polyfold.plugins.interfaces.Simulator`.

    Pictures have the depth of a D435i. Picks and places go from pixels and measured depth, through a camera that was
    calibrated with errors of its own, to the arms' world; a fold is planned free of collisions before anything moves,
    by both arms at once or else one after the other. Fingers close a bite below the surface that was measured, but not
    in the table: what was measured too high is missed, and of a thick packet the lower plies stay. A fold that can't be
    planned, or a pick without depth, leaves the cloth as it is; why stands in the log and, with what became of each
    fold, in the state's ``extra["cell"]``.
    """

    class Config(BaseModel):
        """The cell: its cloth, arms, camera and grippers."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        cloth: str = Field(default="xpbd", description="the simulator of the cloth")
        cloth_params: dict[str, Any] = Field(
            default_factory=dict,
            description="its parameters; the camera of xpbd is 0.9 m high unless they say otherwise",
        )
        arms: PybulletArms.Config = Field(default=PybulletArms.Config(), description="which arms, and how they move")
        noise: DepthNoise = Field(default=DepthNoise(), description="errors of the depth camera")
        scenery: Scenery = Field(default=Scenery(), description="what colours suffer from")
        frames: int = Field(default=5, ge=1, le=100, description="pictures averaged before a fold")
        views: int = Field(
            default=20, ge=0, le=200, description="views of a board by which the camera is calibrated; 0: it is exact"
        )
        moved_mm: float = Field(
            default=0.0, ge=0, le=200, description="how far the camera was pushed since it was calibrated [mm]"
        )
        moved_deg: float = Field(
            default=0.0, ge=0, le=20, description="by how much it was turned since then, about any axis [deg]"
        )
        bite: float = Field(
            default=0.01, ge=0, le=0.05, description="how far below the measured surface the fingers close [m]"
        )

        @field_validator("cloth")
        @classmethod
        def _is_no_cell(cls, name: str) -> str:
            if name == "pybullet":
                raise ValueError("a cell holds no cell; name a simulator of cloth, such as xpbd")
            return name

        @field_validator("views")
        @classmethod
        def _are_enough(cls, views: int) -> int:
            if 0 < views < Calibration.fewest:
                raise ValueError(f"calibration needs {Calibration.fewest} views and more; 0 takes the camera as exact")
            return views

        @property
        def inner(self) -> dict[str, Any]:
            """The parameters of the simulator of cloth."""
            return {**({"elevation": ELEVATION} if self.cloth == "xpbd" else {}), **self.cloth_params}

    @classmethod
    def reference_config(cls, config: Config) -> tuple[str, dict[str, Any]]:
        """The simulator that references are made in: its grippers go where they should."""
        return config.cloth, config.inner

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()
        self._cloth: Any = create("simulators", self.config.cloth, self.config.inner)
        self._arms = PybulletArms(self.config.arms)
        self._eye: Eye | None = None
        self._depth: NoisyDepth | None = None
        self._painted: PaintedCell | None = None
        self._folds: tuple[CellFold, ...] = ()
        self._warned = False
        self._told: tuple[tuple[int, ...], tuple[float, ...], tuple[float, ...]] | None = None

    def reset(self, garment: Garment, seed: int) -> Observation:
        """Lay the garment flat in a pose drawn from ``seed``, calibrate the camera, and return the first picture."""
        from polyfold_pybullet.depth_noise import NoisyDepth
        from polyfold_pybullet.views import calibrated_eye

        seen = self._cloth.reset(garment, seed)
        self._arms.connect()
        self._arms.park()
        pushed = self.config.moved_mm / 1000.0, float(np.radians(self.config.moved_deg))
        self._eye = calibrated_eye(seen.camera, self.config.views, seed).after_a_push(*pushed, seed)
        self._painted = PaintedCell(self.config.scenery, seen.camera.height, seen.camera.width, seed)
        self._depth = NoisyDepth(self.config.noise, seen.camera.height, seen.camera.width, seed)
        self._folds, self._told, self._warned = (), None, False
        return self._measured(seen)

    def observe(self) -> Observation:
        """Take a picture, the arms parked out of view."""
        return self._measured(self._cloth.observe())

    def execute(self, action: Action) -> Observation:
        """Plan the fold and do it with whatever goes wrong."""
        seen = self._cloth.observe()
        action.check_inside(seen.camera)
        try:
            picks, places = self._located(action, seen)
        except GroundingError as error:
            return self._not_done(action, CellFold("not seen", reason=str(error)))
        plan = self._arms.plan(picks, places)
        if isinstance(plan, Infeasible):
            return self._not_done(action, CellFold("infeasible", reason=plan.reason))
        self._do(action, plan, picks, places)
        return self.observe()

    def record(self, recorder: Callable[[Observation], Any], frames_per_second: float = 15.0) -> None:
        """Pass on pictures of the cloth's motion, if its simulator can."""
        if isinstance(self._cloth, RecordsMotion):
            self._cloth.record(recorder, frames_per_second)

    def state(self) -> SimState:
        """Privileged state; ``extra["cell"]`` says what became of each fold."""
        state = self._cloth.state()
        extra = {**state.extra, "cell": tuple(asdict(fold) for fold in self._folds)}
        if self._told is None:
            return replace(state, extra=extra)
        grasped, short, slipped = self._told
        return replace(state, extra=extra, grasped=grasped, short=short, slipped=slipped)

    def restore(self, state: SimState) -> None:
        """Return to a state of this garment."""
        self._folds = tuple(_cell_fold(fold) for fold in state.extra.get("cell", ()))
        told = state.grasped, state.short, state.slipped
        self._told = None if None in told else told  # type: ignore[assignment]
        self._cloth.restore(state)
        self._arms.park()

    def close(self) -> None:
        """Release cloth and cell."""
        self._arms.close()
        self._cloth.close()

    def _measured(self, seen: Observation) -> Observation:
        if self._depth is None:
            return seen
        assert self._painted is not None
        return replace(self._painted.paint(seen), depth=self._depth.measure(seen.depth))

    def _located(self, action: Action, seen: Observation) -> tuple[Floats, Floats]:
        """Where the fingers close and where they let go in the arms' world [m], shape (arms, 3) each.

        Heights are counted from the table, which the arms know better than the camera does.
        """
        from polyfold_pybullet.looking import Surface, levelled

        assert self._depth is not None
        assert self._eye is not None
        surface = Surface.of(self._depth.measure(seen.depth, self.config.frames))
        # Three times the tilt that the depth's own bias looks like, over half of the picture.
        half = 0.5 * min(seen.camera.width, seen.camera.height) / seen.camera.pixels_per_metre
        eye, tilt = levelled(self._eye, surface, SURE * self.config.noise.bias / half)
        if eye is not self._eye and not self._warned:
            self._warned = True
            _log.warning(
                "the camera is tilted by %.1f degrees from where it was calibrated; the table sets that right, but "
                "calibrate it again",
                np.degrees(tilt),
            )
        found = []
        for pixels in (action.picks, action.places):
            above, table = np.array([surface.at(pixel) for pixel in pixels]).T
            where = eye.places(pixels, table - above)
            found.append(np.column_stack([where[:, :2], np.maximum(above, 0.0)]))
        picks, places = found
        picks[:, 2] = np.maximum(picks[:, 2] - self.config.bite, 0.0) if action.heights is None else action.heights
        places[:, 2] += picks[:, 2]
        return picks, places

    def _do(self, action: Action, plan: RobotPlan, picks: Floats, places: Floats) -> None:
        """Move the arms as planned, and the cloth with them: at once, or one pick after the other."""
        camera = self._cloth.state().camera
        self._arms.execute(plan)
        grips: list[Grip] = []
        told: list[tuple[int, float, float]] = []
        for chosen in _turns(plan, action.arms):
            tips = picks[chosen, 2]
            moved = Action(
                _inside(camera.to_pixels(picks[chosen]), camera),
                _inside(camera.to_pixels(places[chosen]), camera),
                tips,
            )
            before = self._cloth.state().positions
            self._cloth.execute(moved)
            after = self._cloth.state()
            meant = camera.to_world(action.picks[chosen])
            grips += [
                _grip(before, pick, float(np.hypot(*(pick - goal)[:2])))
                for pick, goal in zip(picks[chosen], meant, strict=True)
            ]
            nothing = (0,) * len(tips)
            told += list(zip(after.grasped or nothing, after.short or nothing, after.slipped or nothing, strict=True))
        self._folds += (CellFold(plan.mode, round(plan.duration, 2), grips=tuple(grips)),)
        grasped, short, slipped = zip(*told, strict=True)
        self._told = grasped, short, slipped

    def _not_done(self, action: Action, fold: CellFold) -> Observation:
        _log.warning("a fold is left out: %s", fold.reason)
        self._folds += (fold,)
        self._told = (0,) * action.arms, (0.0,) * action.arms, (0.0,) * action.arms
        return self.observe()


def _turns(plan: RobotPlan, arms: int) -> Iterator[list[int]]:
    """Which picks are done together, in order."""
    if plan.mode == "in sequence":
        yield from ([k] for k in range(arms))
    else:
        yield list(range(arms))


def _grip(positions: Floats, pick: Floats, off: float) -> Grip:
    """What fingers at a point take of cloth whose particles are at positions [m], shape (N, 3)."""
    between = np.hypot(*(positions - pick)[:, :2].T) <= NEAR_PICK
    taken = positions[between, 2] >= pick[2]
    return Grip(round(float(pick[2]), 5), int(taken.sum()), int((~taken).sum()), round(off, 5))


def _cell_fold(told: dict[str, Any]) -> CellFold:
    return CellFold(**{**told, "grips": tuple(Grip(**grip) for grip in told["grips"])})


def _inside(pixels: Floats, camera: Camera) -> Floats:
    """Pixels no farther out than the picture reaches: what a camera's error puts outside is at its edge."""
    return np.clip(pixels, 0.0, [camera.width - 1.0, camera.height - 1.0])
