"""How far a garment that was found in a picture can be trusted to be one."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.plugins._fabrics import garment_template
from polyfold.types import Scene

DOUBTFUL = 0.5
"""Below this confidence a twin comes with a warning."""

HALF_SURE = 8.0
"""A polygon so far from the outline on average [px at a span of 300 px] is as likely wrong as right."""

AS_WELL = 3.0
"""A simpler polygon that is no farther than this from the outline beside a kind's own [px] explains it as well.

Of 6 real t-shirts the rectangle is 5.2 to 7.8 px farther than their own polygon; of 5 towels at most 3.
"""

CLEAR = 5.5
"""Nothing explains an outline that it is farther from than this [px]; of 5 real towels a rectangle is at most 5.0."""

POOR = 5.0
"""A polygon that is farther than this from an outline [px] fits too badly to be believed without a look: real shorts as
pants are off by 5.9 to 9.1, a t-shirt as pants by 6.5, of 6 real t-shirts none by more than 2.8."""

OTHER_COLOUR = 60.0
"""Colours farther than this from the cloth's [RGB units] are another thing's, or a print's."""

OTHER_SHARE = 0.08
"""... if they cover at least this share of it."""


def plain_kinds(kind: str) -> list[str]:
    """Kinds with four corners or fewer, and fewer than a kind has: plain cloths, which tables and boxes look like."""
    most = min(4, len(garment_template(kind).names) - 1)
    found = []
    for name in plugins.names("garments"):
        with suppress(Exception):  # a plugin's kind that fails is no help here, and no reason to stop
            found += [name] if len(garment_template(name).names) <= most else []
    return found


def doubts(
    kind: str, scene: Scene, rgb: NDArray[np.uint8] | None, ground_as: Callable[[str], Scene]
) -> Iterable[tuple[float, str]]:
    """What speaks against an outline being a kind's, as (factor on the confidence, words).

    Args:
        kind: what it is said to be.
        scene: as it was grounded.
        rgb: the photo that it was found in, uint8, shape (H, W, 3); None for masks and outlines.
        ground_as: grounds the same outline as another kind.
    """
    fits = {}
    for other in plain_kinds(kind):
        with suppress(Exception):
            fits[other] = ground_as(other).residual
    other = min(fits, key=lambda name: fits[name], default="")
    if other and fits[other] < min(scene.residual + AS_WELL, CLEAR):
        beside = f"off by {fits[other]:.1f} px, {kind!r} by {scene.residual:.1f}"
        yield 0.3, f"{other!r} explains the outline as well ({beside}); is it {kind!r} at all?"
    elif scene.residual > POOR:
        yield 0.8, f"the polygon is off by {scene.residual:.1f} px; is it {kind!r}, and does it lie flat?"
    if rgb is not None and (share := _other_share(rgb, scene.mask)) >= OTHER_SHARE:
        yield 0.5, f"{share:.0%} of it have another colour: a large print, or the cloth lies on what was outlined"


def confidence(residual: float, found: Iterable[tuple[float, str]]) -> float:
    """How sure it is, 0 to 1: by the polygon's distance from the outline [px at a span of 300 px], and by doubts."""
    sure = 1.0 / (1.0 + (residual / HALF_SURE) ** 2)
    for factor, _ in found:
        sure *= factor
    return sure


def _other_share(rgb: NDArray[np.uint8], mask: NDArray[np.bool_]) -> float:
    """The share of a mask that its largest patch of another colour covers; its border, which blurs, is left out."""
    import cv2

    inner = cv2.erode(mask.astype(np.uint8), np.ones((9, 9), np.uint8)).astype(bool)
    if not inner.any():
        return 0.0
    usual = np.median(rgb[inner], axis=0)
    other = inner & (np.linalg.norm(rgb - usual, axis=-1) > OTHER_COLOUR)
    _, _, statistics, _ = cv2.connectedComponentsWithStats(other.astype(np.uint8), connectivity=8)
    return float(statistics[1:, cv2.CC_STAT_AREA].max(initial=0) / inner.sum())
