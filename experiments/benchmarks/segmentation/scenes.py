"""Drawn scenes: one garment of the package's own kinds, or a real outline, on a table, and what makes it hard to see.

They were written before the segmenters that are measured on them; what is developed on are scenes from seed 1000 on.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from polyfold_pybullet.scenery.tables import NAMES, smooth_noise, table
from scipy import ndimage

from experiments.benchmarks.segmentation.cloths import PATTERNS, cloth
from polyfold import plugins
from polyfold.geometry import rotate
from polyfold.geometry._masks import fill_polygon

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

HEIGHT, WIDTH = 480, 640
KINDS = ("wood", "marble", "shadows", "hand", "pattern", "sun", "cable")
GARMENTS = ("tshirt", "pants", "rectangle", "square")
SKINS = ((224, 180, 150), (198, 146, 112), (140, 94, 66), (92, 60, 44))


@dataclass(frozen=True, eq=False)
class DrawnScene:
    """One picture with its truth.

    Attributes:
        kind: what makes it hard, one of KINDS.
        rgb: the photograph, uint8, shape (H, W, 3).
        empty: the same table photographed before, in other light, uint8, shape (H, W, 3).
        mask: where the cloth is to be seen, bool, shape (H, W).
    """

    kind: str
    rgb: NDArray[np.uint8]
    empty: NDArray[np.uint8]
    mask: Mask


def drawn_scene(seed: int, outlines: Sequence[Floats] = ()) -> DrawnScene:
    """The scene of a seed; kinds take turns.

    Args:
        seed: which.
        outlines: outlines [px, y down], each of shape (N, 2), to draw instead of generated garments.
    """
    rng = np.random.default_rng([seed, 25])
    kind = KINDS[seed % len(KINDS)]
    outline = outlines[seed % len(outlines)] if len(outlines) else _generated(seed, rng)
    garment = _placed(outline, rng)
    name = kind if kind in NAMES else NAMES[rng.integers(len(NAMES))]
    bare = table(name, HEIGHT, WIDTH, rng)
    pattern = PATTERNS[seed // len(KINDS) % len(PATTERNS)] if kind == "pattern" else None
    fabric = cloth(garment, bare.mean(axis=(0, 1)), pattern, rng)
    picture, mask = bare * _contact_shadow(garment, rng)[..., None], garment
    if kind == "cable":
        picture = _with_cable(picture, garment, rng)
    picture = _over(picture, fabric, garment)
    if kind == "hand":
        picture, mask = _with_hand(picture, garment, rng)
    light = _evenly(rng)
    if kind == "shadows":
        light *= _shadows(rng)[..., None]
    if kind == "sun":
        light *= _sun(rng)
    return DrawnScene(kind, _photographed(picture * light, rng), _photographed(bare * _evenly(rng), rng), mask)


def _generated(seed: int, rng: np.random.Generator) -> Floats:
    kind = GARMENTS[rng.integers(len(GARMENTS))]
    mesh = plugins.generate_garment(kind, 5000 + seed, 0.03).mesh
    return np.asarray(mesh.vertices[mesh.boundary] * [1, -1])


def _placed(outline: Floats, rng: np.random.Generator) -> Mask:
    """The outline turned, 55 to 75 % of the picture's height large and near its middle."""
    turned = rotate(outline, np.radians(rng.uniform(-35, 35)))
    turned = turned * (rng.uniform(0.55, 0.75) * HEIGHT / np.ptp(turned, axis=0).max())
    middle = (turned.min(axis=0) + turned.max(axis=0)) / 2
    place = np.array([WIDTH / 2, HEIGHT / 2]) + rng.uniform(-1, 1, 2) * [70, 30]
    return fill_polygon(turned - middle + place, HEIGHT, WIDTH)


def _over(picture: Floats, above: Floats, mask: Mask) -> Floats:
    """One picture over another where a mask is, its edge as soft as a lens makes it."""
    share = ndimage.gaussian_filter(mask.astype(float), 0.6)[..., None]
    return picture * (1 - share) + above * share


def _contact_shadow(mask: Mask, rng: np.random.Generator) -> Floats:
    """What the garment itself darkens, beside it: up to 40 %."""
    moved = np.roll(mask, rng.integers(-6, 7, 2), axis=(0, 1)).astype(float)
    return 1.0 - rng.uniform(0.15, 0.4) * ndimage.gaussian_filter(moved, rng.uniform(2, 6))


def _evenly(rng: np.random.Generator) -> Floats:
    """A lamp's light: brighter to one side, a little warm or cold, shape (H, W, 3)."""
    rows, columns = np.indices((HEIGHT, WIDTH)) / np.array([HEIGHT, WIDTH]).reshape(2, 1, 1) - 0.5
    slope = rng.uniform(-0.25, 0.25, 2)
    tint = 1.0 + rng.uniform(-0.04, 0.04, 3)
    return (rng.uniform(0.85, 1.05) + slope[0] * rows + slope[1] * columns)[..., None] * tint


def _shadows(rng: np.random.Generator) -> Floats:
    """Two soft shadows of something outside the picture, 25 to 55 % dark."""
    light = np.ones((HEIGHT, WIDTH))
    for _ in range(2):
        field = smooth_noise((HEIGHT, WIDTH), rng.uniform(50, 110), rng)
        shape = ndimage.gaussian_filter((field > rng.uniform(0.2, 0.8)).astype(float), rng.uniform(6, 25))
        light *= 1.0 - rng.uniform(0.25, 0.55) * shape
    return light


def _sun(rng: np.random.Generator) -> Floats:
    """Warm spots of sun through a window, 1.3 to 1.9 times as bright, with edges of 1 to 3 px; shape (H, W, 3)."""
    light = np.full((HEIGHT, WIDTH, 3), 0.75)
    for _ in range(rng.integers(1, 4)):
        across, along = rng.uniform(30, 110, 2)
        corners = np.array([[-across, -along], [across, -along], [across, along], [-across, along]])
        corners[:2, 0] += rng.uniform(-40, 40)
        place = rng.uniform([40, 40], [WIDTH - 40, HEIGHT - 40])
        spot = fill_polygon(rotate(corners, rng.uniform(0, np.pi)) + place, HEIGHT, WIDTH)
        soft = ndimage.gaussian_filter(spot.astype(float), rng.uniform(1, 3))[..., None]
        light = light * (1 - soft) + soft * rng.uniform(1.05, 1.4) * np.array([1.03, 1.0, 0.92])
    return light


def _with_cable(picture: Floats, garment: Mask, rng: np.random.Generator) -> Floats:
    """A cable that comes from the border, runs under the garment and ends beside it."""
    inside = np.argwhere(garment)[:, ::-1]
    under = inside[rng.integers(len(inside))].astype(float)
    side = rng.uniform(0, 2 * np.pi)
    out = np.array([np.cos(side), np.sin(side)])
    start, end = under + 700 * out, under - rng.uniform(0.5, 1.0) * 300 * out
    bends = np.array([-out[1], out[0]]) * rng.uniform(-130, 130, (2, 1))
    t = np.linspace(0, 1, 1500)[:, None]
    path = (1 - t) ** 3 * start + 3 * t * (1 - t) ** 2 * (under + bends[0]) + 3 * t**2 * (1 - t) * (under + bends[1])
    cable = _thick(path + t**3 * end, rng.uniform(2.0, 4.0))
    colour = np.array([(25, 25, 28), (230, 230, 228), (120, 118, 116)][rng.integers(3)], float)
    return _over(picture, np.broadcast_to(colour, picture.shape), cable)


def _thick(path: Floats, radius: float) -> Mask:
    """All pixels within a radius of a path [px], shape (N, 2)."""
    x, y = np.round(path).astype(int).T
    seen = (x >= 0) & (x < WIDTH) & (y >= 0) & (y < HEIGHT)
    far = np.ones((HEIGHT, WIDTH), bool)
    far[y[seen], x[seen]] = False
    return np.asarray(ndimage.distance_transform_edt(far)) <= radius


def _with_hand(picture: Floats, garment: Mask, rng: np.random.Generator) -> tuple[Floats, Mask]:
    """A forearm from the border whose fingers touch the garment's edge; and what is left to see of the garment."""
    inside = np.argwhere(garment)[:, ::-1].astype(float)
    middle = inside.mean(axis=0)
    side = rng.uniform(0, 2 * np.pi)
    out = np.array([np.cos(side), np.sin(side)])
    tip = middle + out * ((inside - middle) @ out).max() - 12 * out
    wrist, aside = tip + 75 * out, np.array([-out[1], out[0]])
    steps = np.linspace(0, 1, 400)[:, None]
    hand = _thick(wrist + steps * 700 * out, 22.0) | _thick(wrist - steps * 22 * out, 29.0)
    for spread in (-24, -8, 8, 24):
        hand |= _thick(
            wrist - 22 * out + spread * aside + steps * (rng.uniform(40, 55) * -out + 0.2 * spread * aside), 7
        )
    skin = (
        np.array(SKINS[rng.integers(len(SKINS))], float) * (1.0 + 0.05 * smooth_noise(hand.shape, 10, rng))[..., None]
    )
    depth = np.asarray(ndimage.distance_transform_edt(hand))
    skin = skin * (1.0 - 0.3 * np.exp(-depth / 5.0))[..., None]
    picture = (
        picture
        * (1.0 - 0.35 * ndimage.gaussian_filter(ndimage.shift(hand.astype(float), (5, 4), order=0), 5))[..., None]
    )
    return _over(picture, skin, hand), garment & ~hand


def _photographed(picture: Floats, rng: np.random.Generator) -> NDArray[np.uint8]:
    """With the camera's blur, noise and JPEG."""
    noisy = ndimage.gaussian_filter(picture, (0.5, 0.5, 0)) + rng.normal(0, rng.uniform(2, 5), picture.shape)
    file = io.BytesIO()
    Image.fromarray(noisy.clip(0, 255).astype(np.uint8)).save(file, "JPEG", quality=88)
    return np.asarray(Image.open(file))
