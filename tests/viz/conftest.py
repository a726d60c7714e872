"""A folded rectangle as a camera would see it, drawn without a simulator."""

import numpy as np
import pytest

from polyfold.geometry import FoldLine, contour_of
from polyfold.geometry._masks import fill_polygon
from polyfold.polygon import FoldedModel
from polyfold.types import Action, Scene

CLOTH = (66, 133, 180)
TABLE = (236, 236, 232)


@pytest.fixture
def model():
    """A rectangle whose left quarter is folded over."""
    corners = [(60, 280), (60, 120), (340, 120), (340, 280)]
    names = ("bottom_left", "top_left", "top_right", "bottom_right")
    return FoldedModel(np.array(corners, float), names, {}, kind="rectangle").fold(FoldLine((130, 300), (130, 100)))


@pytest.fixture
def scene(model):
    """What a perfect grounding makes of it."""
    mask = fill_polygon(model.outline(), 400, 400)
    return Scene("rectangle", (400, 400), mask, contour_of(mask), model, "{}")


@pytest.fixture
def rgb(scene):
    """The picture."""
    picture = np.full((400, 400, 3), TABLE, np.uint8)
    picture[scene.mask] = CLOTH
    return picture


@pytest.fixture
def fold_line():
    """The right third is lifted."""
    return FoldLine((270, 110), (270, 290))


@pytest.fixture
def action():
    """Both right corners carried across the line."""
    return Action([(337, 123), (337, 277)], [(203, 123), (203, 277)])
