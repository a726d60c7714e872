"""Flat garments drawn as masks with their true keypoints, without a simulator."""

import numpy as np

from polyfold import plugins
from polyfold.geometry import Camera, rotate
from polyfold.geometry._masks import fill_polygon
from polyfold.types import Observation

SIZE = 400


def flat_garment(kind, seed, angle):
    """Mask, shape (400, 400), and vertices in the template's order [px]; the garment's circle fills 80 %."""
    garment = plugins.create("garments", kind).generate(seed, 0.02)
    points = garment.mesh.vertices * (1, -1)
    centre = (points.min(0) + points.max(0)) / 2
    scale = 0.4 * SIZE / np.hypot(*(points - centre).T).max()
    points = rotate((points - centre) * scale, angle) + (SIZE - 1) / 2
    mask = fill_polygon(points[garment.mesh.boundary], SIZE, SIZE)
    names = plugins.create("garments", kind).template().names
    return mask, points[[garment.keypoints[name] for name in names]]


def mask_of(model):
    """The silhouette of a folded model."""
    mask = np.zeros((SIZE, SIZE), bool)
    for facet in model.facets():
        mask |= fill_polygon(facet.polygon, SIZE, SIZE)
    return mask


def seen(mask):
    """A picture of cloth that covers a mask."""
    rgb = np.where(mask[..., None], [200, 30, 60], [90, 90, 90]).astype(np.uint8)
    return Observation(rgb, np.ones(mask.shape, np.float32), Camera())
