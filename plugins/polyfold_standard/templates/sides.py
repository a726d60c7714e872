"""What the templates of garments with a left and a right side share."""

from __future__ import annotations

from polyfold.polygon import Penalty, angle_range

Place = str | tuple[str, ...]
Vector = tuple[Place, Place]
"""From one vertex, or the middle of several, to another."""


def turned(of: Vector, to: Vector, sign: float, degrees: tuple[float, float], sigma: float) -> Penalty:
    """An :func:`polyfold.polygon.angle_range` that is given for one side of a garment; sign -1 is the other side.

    Args:
        of, to: the two vectors.
        sign: 1 or -1.
        degrees: least and largest angle on the side of sign 1 [deg].
        sigma: how soft the ends of the range are [deg].
    """
    low, high = sorted(sign * angle for angle in degrees)
    return angle_range(of, to, low, high, sigma)
