"""The simulator that agents fold in: garment in, pictures out."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import SimulationError
from polyfold.garments import Garment, Mesh, name_by_pose
from polyfold.geometry import Camera
from polyfold.types import Action, Observation, SimState
from polyfold_xpbd.compiling import interruptible

if TYPE_CHECKING:
    from polyfold_xpbd.solver import Solver


class XpbdSimulator:
    """Cloth on a table under a camera. Implements :class:`polyfold.plugins.interfaces.Simulator`.

    The garment is laid with its bounding circle in the middle of the image, turned by an angle drawn from the seed.
    Grippers hold all layers within 15 mm of a pick, or farther on a coarser mesh, and lay them down at the place
    along an arc; an action may say how deep the fingers go, and plies below then stay. A pick off the cloth grasps
    nothing: its arm moves empty, and if no arm holds cloth the fold changes nothing. Two arms that hold the same cloth
    part no farther than it reaches, and stop short of their places then; what is stretched by a quarter slips out of a
    grip. The state says how many plies each arm held, how far short it stopped and what share slipped. With
    ``guaranteed``, plies that did not at reset never pass through each other, however the grippers pull; one that would
    have to drag cloth through cloth lags behind.
    """

    class Config(BaseModel):
        """Parameters of the simulation."""

        model_config = ConfigDict(extra="forbid", frozen=True)

        rotation_deg: float = Field(
            default=20.0, ge=0.0, le=180.0, description="the pose is turned by up to this angle [deg]"
        )
        fill: float = Field(
            default=0.8, gt=0.1, le=1.0, description="share of the image that the garment's circle fills"
        )
        elevation: float = Field(default=2.0, gt=0.3, le=10.0, description="height of the camera above the table [m]")
        order: int = Field(
            default=1,
            ge=0,
            description="seed of the order in which particles and contacts are visited; 0 is the mesh's own",
        )
        max_strain: float = Field(
            default=0.1,
            ge=0.0,
            le=0.25,
            description="two arms give way before the cloth between them is stretched by more than this share; the "
            "limit that Provot sets for woven cloth (Graphics Interface 1995)",
        )
        guaranteed: bool = Field(
            default=False,
            description="no ply ever passes through another, if none did at reset; up to 6 times slower",
        )

    moved: ClassVar[dict[str, str]] = {
        "thickness": "fabric.thickness",
        "bending_length": "fabric.bending_length_warp and fabric.bending_length_weft",
        "table_friction": "fabric.table_friction",
        "cloth_friction": "fabric.cloth_friction",
    }

    @classmethod
    def reference_config(cls, config: Config) -> tuple[str, dict[str, Any]]:
        """The simulator that references are made in: the same cloth, visited in the usual order."""
        return "xpbd", config.model_dump(exclude_unset=True, exclude={"order"})

    def __init__(self, config: Config | None = None) -> None:
        self.config = config or self.Config()
        self._solver: Solver | None = None
        self._garment: Garment | None = None
        self._grasped: tuple[int, ...] | None = None
        self._short: tuple[float, ...] | None = None
        self._slipped: tuple[float, ...] | None = None
        self._recorder: tuple[Callable[[Observation], None], float] | None = None

    @interruptible()
    def reset(self, garment: Garment, seed: int) -> Observation:
        """Lay the garment flat, as it says or in a pose drawn from ``seed``, and return the first picture."""
        from polyfold_xpbd.solver import Solver

        drawn = np.random.default_rng(seed).uniform(-1.0, 1.0) * self.config.rotation_deg
        angle = np.deg2rad(drawn if garment.angle_deg is None else garment.angle_deg)
        flat = np.asarray(garment.mesh.vertices, float)[:, :2]
        centre = (flat.min(axis=0) + flat.max(axis=0)) / 2
        radius = float(np.hypot(*(flat - centre).T).max())
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        self._garment, self._seed, self._actions = garment, seed, []
        self._grasped = self._short = self._slipped = None
        self._camera = Camera.framing(2 * radius / self.config.fill, elevation=self.config.elevation)
        self._order, mesh = _renumbered(garment.mesh, self.config.order)
        self._rank = np.argsort(self._order)
        self._solver = Solver(mesh, ((flat - centre) @ turn)[self._order], garment.fabric, self.config.guaranteed)
        if not self._solver.settle(0.3):
            raise SimulationError(f"the garment {garment.name!r} can't be laid flat; check its mesh")
        self._keypoints = name_by_pose(garment.cyclic, garment.keypoints, self._solver.positions()[self._rank])
        self._two_layers = garment.mesh.layers == 2
        self._outside_up = (garment.mesh.panel == 1) | (not self._two_layers)
        return self.observe()

    @interruptible()
    def observe(self) -> Observation:
        """Take a picture."""
        from polyfold_xpbd.camera import take_picture

        solver, garment = self._ready()
        return take_picture(
            self._camera, solver.x, solver.surface_normals(), solver.triangles, self._outside_up, garment.colours
        )

    @interruptible()
    def execute(self, action: Action) -> Observation:
        """Do one fold, let the cloth settle and take a picture.

        Raises:
            ActionError: for pixels outside the image.
            SimulationError: if the cloth diverges; the state before the fold is restored first.
        """
        solver, garment = self._ready()
        action.check_inside(self._camera)
        before = self.state()
        self._actions.append(np.concatenate([action.picks, action.places]).round(3).tolist())
        grip = solver.grip(action, self._camera, self.config.max_strain)
        self._grasped = (0,) * action.arms if grip is None else tuple(grip.grasp.plies.tolist())
        if grip is not None and not self._undone_if_broken_off(before, lambda: solver.fold(grip, *self._frames())):
            reproduction = (
                f"garment {garment.name!r} (seed {garment.seed}), reset seed {self._seed}, {self.config!r}, "
                f"picks and places so far {self._actions}"
            )
            self.restore(before)
            raise SimulationError(
                f"the cloth diverged and the state before this fold was restored; reproduce with {reproduction}. "
                "Go on with another action, or report it"
            )
        nothing = (0.0,) * action.arms
        self._short, self._slipped = (nothing, nothing) if grip is None else (solver.short, solver.slipped)
        return self.observe()

    @interruptible()
    def wait(self, seconds: float) -> Observation:
        """Let simulated time pass without touching the cloth and take a picture."""
        solver, _ = self._ready()
        if not solver.wait(seconds, *self._frames()):
            raise SimulationError("the cloth diverged while waiting; call reset() and report the episode")
        return self.observe()

    def record(self, recorder: Callable[[Observation], None] | None, frames_per_second: float = 15.0) -> None:
        """Hand every frame of the coming motion to ``recorder``, by simulated time; None stops recording."""
        self._recorder = None if recorder is None else (recorder, frames_per_second)

    def state(self) -> SimState:
        """Privileged state: particles, keypoints and the contact memory that :meth:`restore` needs."""
        solver, _ = self._ready()
        extra: dict[str, Any] = {
            **solver.memory(), "actions": tuple(self._actions), "guaranteed": self.config.guaranteed,
        }  # fmt: skip
        positions, velocities = solver.positions()[self._rank], solver.velocities()[self._rank]
        return SimState(
            positions, velocities, self._keypoints, self._camera, extra, self._grasped, self._short, self._slipped
        )

    def restore(self, state: SimState) -> None:
        """Return to a state of this garment, so that several picks can be tried from one."""
        solver, garment = self._ready()
        if len(state.positions) != len(garment.mesh.vertices):
            raise SimulationError(
                f"the state has {len(state.positions)} particles, the garment {len(garment.mesh.vertices)}; "
                "restore only states of the garment given to reset()"
            )
        if self.config.guaranteed and not state.extra.get("guaranteed", False):
            raise SimulationError(
                "the state was made without the guarantee, and plies may pass through each other in it; restore "
                "a state of a guaranteed simulator, or reset() this one and fold again"
            )
        solver.set_state(state.positions[self._order], state.velocities[self._order], state.extra)
        self._camera, self._keypoints = state.camera, state.keypoints
        self._actions = list(state.extra.get("actions", ()))
        self._grasped, self._short, self._slipped = state.grasped, state.short, state.slipped

    def close(self) -> None:
        """Release the solver; call :meth:`reset` to go on."""
        self._solver = self._garment = None

    def _undone_if_broken_off(self, before: SimState, motion: Callable[[], bool]) -> bool:
        """Whether the cloth didn't diverge; a recorder's error or Ctrl-C leaves the state before."""
        try:
            return motion()
        except BaseException:
            self.restore(before)
            raise

    def _ready(self) -> tuple[Solver, Garment]:
        if self._solver is None or self._garment is None:
            raise SimulationError("there is no cloth on the table; call reset(garment, seed) first")
        return self._solver, self._garment

    def _frames(self) -> tuple[Callable[[], None] | None, float]:
        if self._recorder is None:
            return None, 0.0
        recorder, rate = self._recorder
        return lambda: recorder(self.observe()), 1.0 / rate


@lru_cache(maxsize=4)
def _renumbered(mesh: Mesh, order: int) -> tuple[NDArray[np.int64], Mesh]:
    """Which vertex of the mesh each particle of the solver is, shape (N,), and the mesh numbered so.

    Meshes are numbered row by row. Corrections made in that order all push the same way and twist thick packets. A
    random order brings trousers 6 mm nearer to the ideal fold (mean over their tasks), at a tenth more time; other
    kinds hardly change. Kept for the next reset of the same garment, whose constraints then need not be made again.
    """
    count = len(mesh.vertices)
    numbering = np.arange(count) if order == 0 else np.random.default_rng(order).permutation(count)
    return numbering, mesh.renumbered(numbering)
