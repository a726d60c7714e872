"""Paths as smooth curves, and how fast they may be run: quintic in time, within the limits of every joint.

Ruckig (Berscheid and Kröger 2021, 10.48550/arXiv.2105.04830) needs 78 % of that time for straight moves from rest to
rest (a Panda, n = 300), but its free version goes through no points between, as transits and carries must.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Path:
    """A smooth curve through rows of joint angles: a line through two, a natural cubic spline through more.

    Args:
        rows: joint angles to pass through [rad, m], shape (K, N); rows that repeat the one before are left out.
    """

    def __init__(self, rows: Floats) -> None:
        rows = np.asarray(rows, float)
        steps = np.abs(np.diff(rows, axis=0)).max(axis=1, initial=0.0)
        rows = rows[np.concatenate([[True], steps > 1e-9])]
        self._rows = rows
        self._spline = None
        if len(rows) > 2:
            from scipy.interpolate import CubicSpline

            # Centripetal: no loops between rows at uneven distances (Lee 1989, 10.1016/0010-4485(89)90003-1).
            lengths = np.sqrt(np.linalg.norm(np.diff(rows, axis=0), axis=1))
            at = np.concatenate([[0.0], np.cumsum(lengths)])
            self._spline = CubicSpline(at / at[-1], rows, bc_type="natural")

    @property
    def still(self) -> bool:
        """Whether it goes nowhere."""
        return len(self._rows) == 1

    def __call__(self, shares: Floats, derivative: int = 0) -> Floats:
        """Joint angles, or a derivative by the share of the way, at shares from 0 to 1, shape (S,): shape (S, N)."""
        if self._spline is not None:
            return self._spline(shares, derivative)
        first, last = self._rows[0], self._rows[-1]
        if derivative == 0:
            return first + np.multiply.outer(shares, last - first)
        return np.broadcast_to((last - first) * (derivative == 1), (len(shares), len(first))).copy()

    def sampled(self, step: float) -> Floats:
        """Rows so near each other that no joint moves by more than about ``step`` between them, shape (S, N)."""
        if self.still:
            return self._rows
        coarse = self(np.linspace(0, 1, 65))
        longest = np.abs(np.diff(coarse, axis=0)).max(axis=1).sum()
        return self(np.linspace(0, 1, max(2, int(np.ceil(longest / step)) + 1)))


class Together:
    """Paths that are run at once: at each share of the way, the joints of all beside each other."""

    def __init__(self, *paths: Path) -> None:
        self._paths = paths

    @property
    def still(self) -> bool:
        """Whether all go nowhere."""
        return all(path.still for path in self._paths)

    def __call__(self, shares: Floats, derivative: int = 0) -> Floats:
        """As for a path."""
        return np.hstack([path(shares, derivative) for path in self._paths])

    def sampled(self, step: float) -> Floats:
        """As for a path."""
        return self(np.linspace(0, 1, max(len(path.sampled(step)) for path in self._paths)))


def quintic(times: Floats) -> tuple[Floats, Floats, Floats]:
    """The polynomial from 0 to 1 that starts and ends without velocity and acceleration, and its two derivatives.

    Args:
        times: from 0 to 1, shape (T,).
    """
    t = np.asarray(times, float)
    return t**3 * (10 - 15 * t + 6 * t**2), 30 * t**2 * (1 - t) ** 2, 60 * t * (1 - t) * (1 - 2 * t)


def least_duration(
    path: Path | Together,
    velocity: Floats,
    acceleration: Floats,
    tools: Callable[[Floats], Floats] | None = None,
    tool_speed: float | None = None,
) -> float:
    """The shortest time for a path that is run quintically without passing any limit [s].

    Args:
        path: the path of N joints.
        velocity, acceleration: limits of the joints [rad/s, rad/s²], shape (N,).
        tools: positions of the tools [m], shape (S, tools, 3), for rows of joints, shape (S, N).
        tool_speed: how fast any tool may move [m/s].
    """
    if path.still:
        return 0.0
    share, speed, change = quintic(np.linspace(0, 1, 1001))
    first, second = path(share, 1), path(share, 2)
    fastest = np.abs(first * speed[:, None]) / velocity
    # For a duration T velocities fall with T and accelerations with its square.
    hardest = np.abs(second * speed[:, None] ** 2 + first * change[:, None]) / acceleration
    duration = max(float(fastest.max()), float(np.sqrt(hardest.max())))
    if tools is not None and tool_speed is not None:
        positions = tools(path(share[::5]))
        ways = np.linalg.norm(np.diff(positions, axis=0), axis=-1)
        duration = max(duration, float(ways.max()) * 200 / tool_speed)
    return duration


def run(path: Path | Together, duration: float, interval: float = 0.01) -> tuple[Floats, Floats]:
    """Times [s], shape (T,), about ``interval`` apart, and the joints then, shape (T, N), of a path that is run."""
    count = 1 if path.still else max(3, int(np.ceil(duration / interval)) + 1)
    times = np.linspace(0.0, duration, count)
    share = quintic(times / duration)[0] if duration > 0 else np.zeros(count)
    return times, path(share)
