"""Scenes drawn from polygons, so that picks can be judged without a simulator."""

import numpy as np

from polyfold.geometry import contour_of, rotate
from polyfold.geometry._masks import fill_polygon
from polyfold.polygon import FoldedModel
from polyfold.types import Scene

CENTRE = (199.5, 199.5)

SQUARE = {"bottom_left": (100, 300), "top_left": (100, 100), "top_right": (300, 100), "bottom_right": (300, 300)}
TSHIRT = {
    "hem_left": (120, 330),
    "armpit_left": (135, 180),
    "sleeve_bottom_left": (70, 230),
    "sleeve_top_left": (40, 170),
    "shoulder_left": (130, 85),
    "neck_left": (165, 70),
    "neck_center": (200, 95),
    "neck_right": (235, 70),
    "shoulder_right": (270, 85),
    "sleeve_top_right": (360, 170),
    "sleeve_bottom_right": (330, 230),
    "armpit_right": (265, 180),
    "hem_right": (280, 330),
}


def model_of(corners, angle=0.0, kind="cloth"):
    """A model at rest, turned about the image's centre [rad]."""
    points = rotate(np.array(list(corners.values()), float), angle, CENTRE)
    return FoldedModel(points, tuple(corners), {}, kind=kind)


def scene_of(model, size=400):
    """The scene that a perfect grounding would make of a model."""
    mask = np.zeros((size, size), bool)
    for facet in model.facets():
        mask |= fill_polygon(facet.polygon, size, size)
    return Scene(model.kind, (size, size), mask, contour_of(mask), model, "{}")


def near(points, *expected, within=6.0):
    """Whether the points, in any order, are the expected ones within a distance [px]."""
    points, expected = np.asarray(points, float), np.asarray(expected, float)
    if len(points) != len(expected):
        return False
    distance = np.hypot(*(points[:, None] - expected[None]).transpose(2, 0, 1))
    return bool((distance.min(0) <= within).all() and (distance.min(1) <= within).all())
