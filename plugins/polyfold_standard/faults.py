"""The ``faulty`` simulator: another simulator with faults injected, so that recovery has something to do."""

from __future__ import annotations

import zlib
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from polyfold.garments import Garment
from polyfold.plugins import create
from polyfold.plugins.interfaces import RecordsMotion
from polyfold.types import Action, Observation, SimState


class FaultySimulator:
    """Runs another simulator; grasps miss, cloth slips from the grippers, the garment is displaced between folds."""

    class Config(BaseModel):
        """Parameters: probabilities per grasp or per fold."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        inner: str = Field(default="xpbd", description="the simulator that faults are injected into")
        inner_params: dict[str, Any] = Field(default_factory=dict, description="its parameters")
        miss: float = Field(default=0.0, ge=0, le=1, description="probability that a grasp takes no cloth, per arm")
        slip: float = Field(
            default=0.0, ge=0, le=1, description="probability that the cloth is dropped on the way, per fold"
        )
        displace: float = Field(
            default=0.0, ge=0, le=1, description="probability that the garment is moved after a fold"
        )
        shift_m: float = Field(default=0.03, ge=0, description="largest displacement [m]")
        turn_deg: float = Field(default=10.0, ge=0, description="largest turn of a displaced garment [deg]")

    @classmethod
    def reference_config(cls, config: Config) -> tuple[str, dict[str, Any]]:
        """The simulator that references are made in: they must not have the faults."""
        return config.inner, dict(config.inner_params)

    def __init__(self, config: Config) -> None:
        self._config = config
        self._inner: Any = create("simulators", config.inner, config.inner_params)
        self._grasped: tuple[int, ...] | None = None
        self._short: tuple[float, ...] | None = None
        self._slipped: tuple[float, ...] | None = None

    def reset(self, garment: Garment, seed: int) -> Observation:
        """Lay the garment flat; the faults follow from the seed and from all that is done.

        Agents that act alike meet the same faults, and different tasks on one garment meet different ones.
        """
        self._history = zlib.crc32(str(seed).encode())
        self._histories: dict[int, int] = {}
        self._grasped = self._short = self._slipped = None
        return self._inner.reset(garment, seed)

    def observe(self) -> Observation:
        """Take a picture."""
        return self._inner.observe()

    def execute(self, action: Action) -> Observation:
        """Do the fold with whatever goes wrong."""
        action.check_inside(self.observe().camera)
        done = np.rint(np.vstack([action.picks, action.places])).astype(int).tolist()
        self._history = zlib.crc32(str(done).encode(), self._history)
        self._rng = np.random.default_rng([self._history, 7])
        holds = self._rng.random(action.arms) >= self._config.miss
        slips, displaced = self._rng.random(2) < (self._config.slip, self._config.displace)
        share = self._rng.uniform(0.3, 0.8) if slips else 1.0
        self._grasped, self._short, self._slipped = (0,) * action.arms, (0.0,) * action.arms, (0.0,) * action.arms
        if holds.any():
            picks, places = action.picks[holds], action.places[holds]
            heights = None if action.heights is None else action.heights[holds]
            self._inner.execute(Action(picks, picks + share * (places - picks), heights))
            after = self._inner.state()
            self._grasped, self._short = _among(holds, after.grasped), _among(holds, after.short)
            self._slipped = _among(holds, after.slipped)
        if displaced:
            self._displace()
        return self.observe()

    def _displace(self) -> None:
        state = self._inner.state()
        angle = np.radians(self._rng.uniform(-1, 1) * self._config.turn_deg)
        shift = self._rng.uniform(-1, 1, 2) * self._config.shift_m
        centre = state.positions[:, :2].mean(axis=0)
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        positions = state.positions.copy()
        positions[:, :2] = (positions[:, :2] - centre) @ turn + centre + shift
        self._inner.restore(replace(state, positions=positions))

    def record(self, recorder: Any, frames_per_second: float = 15.0) -> None:
        """Pass on pictures of the motion, if the inner simulator can."""
        if isinstance(self._inner, RecordsMotion):
            self._inner.record(recorder, frames_per_second)

    def state(self) -> SimState:
        """Privileged state."""
        state = replace(self._inner.state(), grasped=self._grasped, short=self._short, slipped=self._slipped)
        self._histories[_mark(state)] = self._history
        return state

    def restore(self, state: SimState) -> None:
        """Return to a state of this garment; what is done from there meets the faults that it met before."""
        self._history = self._histories.get(_mark(state), self._history)
        self._grasped, self._short, self._slipped = state.grasped, state.short, state.slipped
        self._inner.restore(state)

    def close(self) -> None:
        """Release what is held."""
        self._inner.close()


def _mark(state: SimState) -> int:
    return zlib.crc32(state.positions.tobytes())


_Told = TypeVar("_Told", int, float)


def _among(holds: NDArray[np.bool_], told: tuple[_Told, ...] | None) -> tuple[_Told, ...] | None:
    """What is told of all arms, where the simulator was told of those that hold alone, bool, shape (arms,)."""
    if told is None:
        return None
    of_those = iter(told)
    return tuple(next(of_those) if held else type(told[0])(0) for held in holds)
