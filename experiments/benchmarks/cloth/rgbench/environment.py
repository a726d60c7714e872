"""Our simulator behind RGBench's interface of a simulator (``rgbench.envs.base.BaseEnvWrapper``), pinned grippers.

Register it in RGBench's ``rgbench/envs/__init__.py``::

    if "polyfold" in env_name:
        from experiments.benchmarks.cloth.rgbench.environment import Environment
        return Environment(cfg=env_cfg, **kwargs)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.reality.bench import Cloth, fabric_named
from experiments.benchmarks.cloth.rgbench.capture import Trajectory, read_trajectory
from experiments.benchmarks.cloth.rgbench.garments import lying, read_garment
from polyfold.errors import ConfigError
from polyfold.garments import Fabric

Floats = NDArray[np.float64]

ARMS = ("left", "right")
STEP = 0.01
"""Time that :meth:`Environment.step` lets pass [s]."""
CLOSING = 0.1
"""A pinned vertex comes from where it lies onto its gripper's path in this time [s]."""
LIKE = "jersey"
"""Fabric whose thickness and bending length stand in: RGBench's own bending constants have no unit of ours."""
LYING_POSE = (0.1, 0.0, 0.01, 1.0, 0.0, 0.0, 0.0)


class Grip:
    """Where one gripper has its vertex, by the simulator's time.

    Args:
        trajectory: recorded path.
        origin: absolute time [s] of the simulator's zero.
        vertex: where the vertex lies before [m], shape (3,).
        grab_time: simulator's time from which it follows [s].
        preparation: for flings, times [s] to bring the vertex to the path's start and to let it hang there.
    """

    def __init__(
        self,
        trajectory: Trajectory,
        origin: float,
        vertex: Floats,
        grab_time: float,
        preparation: tuple[float, float] | None = None,
    ) -> None:
        self._trajectory, self._origin, self._vertex = trajectory, origin, vertex
        self._grab_time, self._preparation = grab_time, preparation

    def at(self, time: float) -> Floats:
        """Position [m] of the vertex, shape (3,)."""
        if self._preparation is not None:
            return self._prepared(time, *self._preparation)
        if time < self._grab_time:
            return self._vertex
        closed = min((time - self._grab_time) / CLOSING, 1.0)
        return self._vertex + closed * (self._trajectory.at(self._origin + time) - self._vertex)

    def _prepared(self, time: float, lifting: float, hanging: float) -> Floats:
        first = self._trajectory.at(self._origin)
        if time < lifting:
            return self._vertex + time / lifting * (first - self._vertex)
        return self._trajectory.at(self._origin + max(time - lifting - hanging, 0.0))


class Environment:
    """A garment on the table whose two gripped vertices follow the recorded grippers.

    Args:
        cfg: RGBench's ``active_run``: a mapping, an ``omegaconf.DictConfig`` or a namespace.
        fabric: overrides the fabric that is made from ``cfg.cloth_params``.
        unused: what else RGBench's factory passes on.
    """

    def __init__(self, cfg: Any, fabric: Fabric | None = None, **unused: Any) -> None:
        del unused
        self.cfg = cfg
        self._fabric = fabric or fabric_of(_value(cfg, "cloth_params", {}))
        pose = np.asarray(_value(cfg, "cloth.init_pose", LYING_POSE), float)
        mesh = read_garment(_needed(cfg, "cloth.model_path"), pose)
        self._cloth = Cloth(mesh, self._fabric, lying(mesh, self._fabric.thickness))
        self._time = 0.0
        paths = {arm: _value(cfg, f"data.robot_joints.{arm}_arm_csv_path", None) for arm in ARMS}
        trajectories = {arm: read_trajectory(path, arm) for arm, path in paths.items() if path}
        if not trajectories:
            raise ConfigError("no gripper has a path; set data.robot_joints.left_arm_csv_path, right_arm_csv_path")
        offset = float(_value(cfg, "data.sim_start_time", 0.0))
        self._origin = min(float(trajectory.times[0]) for trajectory in trajectories.values()) + offset
        self._cloth.wait(0.2)
        vertices = self._gripped(trajectories)
        lies = self._cloth.positions()
        self._grips = [
            Grip(trajectory, self._origin, lies[vertex], self._grab_time, self._preparation)
            for trajectory, vertex in zip(trajectories.values(), vertices, strict=True)
        ]
        self._cloth.pin(np.array(vertices))

    def step(self) -> None:
        """Let a hundredth of a second pass."""
        self.step_to_time(self._time + STEP)

    def step_to_time(self, target_time: float) -> None:
        """Let time pass until ``target_time`` [s] after the start."""
        substep = self._cloth.substep
        count = round((target_time - self._time) / substep)
        if count < 1:
            return
        times = self._time + substep * np.arange(1, count + 1)
        self._cloth.carry(np.array([[grip.at(time) for grip in self._grips] for time in times.tolist()]))
        self._time = float(times[-1])

    def get_sim_vertices(self) -> Floats:
        """The garment's vertices in the world [m], shape (N, 3)."""
        return self._cloth.positions()

    def get_master_start_time(self) -> float:
        """Absolute time of the start [s]."""
        return self._origin

    def get_current_sim_time(self) -> float:
        """Time since the start [s]."""
        return self._time

    def close(self) -> None:
        """Nothing is held open."""

    @property
    def _grab_time(self) -> float:
        return float(_value(self.cfg, "evaluate.start_calculate_time", 0.0))

    @property
    def _preparation(self) -> tuple[float, float] | None:
        if _value(self.cfg, "action.type", "grasp") != "fling":
            return None
        prepare, wait = (_value(self.cfg, f"action.fling_{name}_time", 5.0) for name in ("prepare", "wait"))
        return float(prepare), float(wait)

    def _gripped(self, trajectories: Mapping[str, Trajectory]) -> list[int]:
        """Vertex of each arm: the shoulders for a fling, else the one nearest to where the gripper closes."""
        if self._preparation is not None:
            shoulders = _needed(self.cfg, "cloth_params.shoulder_index")
            return [int(shoulders[ARMS.index(arm)]) for arm in trajectories]
        now = self._cloth.positions()
        places = [trajectory.at(self._origin + self._grab_time) for trajectory in trajectories.values()]
        return [int(np.linalg.norm(now - place, axis=1).argmin()) for place in places]


def fabric_of(constants: Any) -> Fabric:
    """Fabric with the area weight and frictions of RGBench's ``cloth_params``, the rest as :data:`LIKE`."""
    like = fabric_named(LIKE)
    return replace(
        like,
        name=str(_value(constants, "name", "garment")),
        weight=float(_value(constants, "density", 1000 * like.weight)) / 1000,
        cloth_friction=float(_value(constants, "friction", like.cloth_friction)),
        table_friction=float(_value(constants, "ground_friction", like.table_friction)),
    )


def _value(node: Any, path: str, default: Any) -> Any:
    """What stands at a dotted path of a nested configuration, or the default."""
    for name in path.split("."):
        node = node.get(name) if isinstance(node, Mapping) else getattr(node, name, None)
        if node is None:
            return default
    return node


def _needed(node: Any, path: str) -> Any:
    value = _value(node, path, None)
    if value is None:
        raise ConfigError(f"RGBench's configuration has no {path}; start from its configs/main.yaml")
    return value
