"""What closed lines cover, as shapes of shapely."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry


def covered(polygon: ArrayLike) -> BaseGeometry:
    """The area that a closed line covers, shape (N, 2); what it goes around twice is covered as well.

    An outline of folded cloth, or one that was traced with an overlap, crosses itself. ``shapely.make_valid`` leaves
    out what such a line encloses twice unless asked for ``method="structure"`` (shapely 2.2, GEOS 3.14).
    """
    import shapely

    shape = shapely.Polygon(np.asarray(polygon, float))
    return shape if shape.is_valid else shapely.make_valid(shape, method="structure")
