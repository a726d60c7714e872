"""Which corner of a square or rectangle is which, once it lies on the table.

The simulator names the true keypoints here and the grounding the fitted ones, so the two always agree.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from polyfold.errors import GarmentError


def name_by_pose(cyclic: Sequence[str], keypoints: Mapping[str, int], positions: ArrayLike) -> dict[str, int]:
    """Rename cyclic keypoints so that the edge nearest the image's top is the top edge.

    Args:
        cyclic: the garment's names in polygon order, starting at bottom_left: the second and third bound the top
            edge. With no names nothing is renamed.
        keypoints: keypoint name -> vertex, in any of the cyclic namings.
        positions: positions of all vertices, shape (N, 2) or (N, 3), in any unit with +y towards the image's top:
            world positions [m], or pixels with their y negated.

    Returns:
        Keypoint name -> vertex; names outside ``cyclic`` are kept as they are.
    """
    if not cyclic:
        return dict(keypoints)
    missing = [name for name in cyclic if name not in keypoints]
    if missing:
        raise GarmentError(f"the cyclic keypoint {missing[0]!r} is not among the garment's keypoints; name all of them")
    vertices = [keypoints[name] for name in cyclic]
    height = np.asarray(positions, float)[vertices, 1]
    middle = (height + np.roll(height, -1)) / 2
    shift = int(np.argmax(middle)) - 1
    renamed = {name: vertices[(place + shift) % len(vertices)] for place, name in enumerate(cyclic)}
    return {**keypoints, **renamed}
