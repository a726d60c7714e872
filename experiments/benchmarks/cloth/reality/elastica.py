"""Heavy strips by the theory of the elastica, and Peirce's formulas for them.

A strip of weight w per area and flexural rigidity B per width has the bending length c = (B / (w g))^(1/3). Along its
arc length s, with the angle a from the horizontal, c³ a'' = h sin a - v cos a and v' = 1: (h, v) is the force across a
cut, per width and in metres of strip. Peirce, The "handle" of cloth as a measurable quantity, J. Text. Inst. Trans.
21(9), 1930, doi 10.1080/19447023008661529.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

RIGHT_ANGLE = np.pi / 2
UNDISTORTED = 0.1337
"""Height of a weightless heart loop as a share of its strip (Peirce 1930)."""
SOFTER = 1.6
"""Factor by which a solution's load is raised to get to the next: Newton's method needs a guess not too far off."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A strip in equilibrium, from its clamp on.

    Attributes:
        along: arc length [m], shape (K,).
        across, up: position relative to the clamp [m], shape (K,) each.
    """

    along: Floats
    across: Floats
    up: Floats

    def at(self, along: Floats) -> tuple[Floats, Floats]:
        """(across, up) [m] at arc lengths [m], any shape."""
        return np.interp(along, self.along, self.across), np.interp(along, self.along, self.up)


def cantilever(overhang: float, bending_length: float) -> Shape:
    """A strip clamped level whose end hangs over an edge by ``overhang`` [m]."""

    def slopes(t: Floats, y: Floats, load: float) -> Floats:
        return np.vstack([y[1], load * (1.0 - t) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])])

    def ends(start: Floats, end: Floats) -> Floats:
        return np.array([start[0], end[1], start[2], start[3]])

    t = np.linspace(0.0, 1.0, 40)
    guess: Any = (t, np.vstack([0 * t, 0 * t, t, 0 * t]))
    for load in _loads((overhang / bending_length) ** 3):
        solution = _solve(lambda t, y, load=load: slopes(t, y, load), ends, *guess)
        guess = (solution.x, solution.y)
    return Shape(overhang * guess[0], overhang * guess[1][2], overhang * guess[1][3])


def heart_loop(strip: float, bending_length: float, gap: float = 0.0) -> Shape:
    """Half of a hanging heart loop, from the clamp to its lowest point.

    Both ends of a strip of length ``strip`` [m] leave the clamp straight up, ``gap`` [m] apart, turn over and hang.
    """
    half = strip / 2

    def slopes(t: Floats, y: Floats, p: Floats, load: float) -> Floats:
        bend = p[0] * np.sin(y[0]) - load * (t - 1.0) * np.cos(y[0])
        return np.vstack([y[1], bend, np.cos(y[0]), np.sin(y[0])])

    def ends(start: Floats, end: Floats, p: Floats) -> Floats:
        del p
        return np.array([start[0] - RIGHT_ANGLE, start[2] - gap / 2 / half, start[3], end[0] + np.pi, end[2]])

    t = np.linspace(0.0, 1.0, 60)
    turn = np.vstack([RIGHT_ANGLE - 1.5 * np.pi * t, 0 * t - 1.5 * np.pi, 0 * t, 0 * t])
    guess: Any = (t, turn, np.zeros(1))
    for load in _loads((half / bending_length) ** 3):
        solution = _solve(lambda t, y, p, load=load: slopes(t, y, p, load), ends, *guess)
        guess = (solution.x, solution.y, solution.p)
    return Shape(half * guess[0], half * guess[1][2], half * guess[1][3])


def chord_angle(overhang: float, bending_length: float) -> float:
    """Angle below the horizontal [rad] of the line from the edge to the tip of a cantilever."""
    tip = cantilever(overhang, bending_length)
    return float(np.arctan2(-tip.up[-1], tip.across[-1]))


def bending_length_of(angle: float, overhang: float) -> float:
    """Bending length [m] of a strip whose tip hangs at this angle [rad], by the elastica."""
    softness, angles = _chord_angles()
    return overhang / float(np.exp(np.interp(angle, angles, softness)))


def peirce_cantilever(angle: float, overhang: float) -> float:
    """Bending length [m] by Peirce's formula for the same; half the overhang at 41.5°."""
    return overhang * float(np.cos(angle / 2) / (8 * np.tan(angle))) ** (1 / 3)


def peirce_heart_loop(height: float, strip: float) -> float:
    """Bending length [m] by Peirce's formula for a heart loop of this height [m], clamp to lowest point."""
    undistorted = UNDISTORTED * strip
    angle = np.radians(32.85 * (height - undistorted) / undistorted)
    return undistorted * float(np.cos(angle) / np.tan(angle)) ** (1 / 3)


@lru_cache(maxsize=1)
def _chord_angles() -> tuple[Floats, Floats]:
    """Logarithms of overhang over bending length, and the chord's angle [rad] at each."""
    softness = np.linspace(np.log(0.5), np.log(12.0), 60)
    return softness, np.array([chord_angle(float(np.exp(value)), 1.0) for value in softness])


def _loads(last: float) -> list[float]:
    """From nothing to the load of the question, in steps that the solver can follow."""
    steps = int(np.ceil(np.log(max(last, 1.0)) / np.log(SOFTER)))
    return [0.0, *(last / SOFTER ** np.arange(steps, -1, -1)).tolist()]


def _solve(slopes: Any, ends: Any, *guess: Any) -> Any:
    from scipy.integrate import solve_bvp

    solution = solve_bvp(slopes, ends, *guess, tol=1e-6, max_nodes=20_000)
    if not solution.success:
        raise RuntimeError(f"no equilibrium of the strip was found ({solution.message}); try a stiffer or shorter one")
    return solution
