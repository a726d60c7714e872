"""Where a garment comes from: a seed, a mesh file, or a real garment's mask, outline or photo (its simulated twin)."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold import plugins
from polyfold._brief import brief
from polyfold.api._doubts import DOUBTFUL, confidence, doubts
from polyfold.api._looks import colours_in
from polyfold.api._photos import framed as framed_photo
from polyfold.api._photos import look
from polyfold.config import ComponentSpec, Experiment, checked_seed
from polyfold.errors import GarmentError
from polyfold.garments import Garment, Pattern
from polyfold.garments._obj import load_obj
from polyfold.garments._outline_files import load_mask, load_outline, load_picture
from polyfold.garments._twin import angle_of, repair_outline, twin_from_outline, upright_size
from polyfold.geometry import Camera, contour_of
from polyfold.geometry._masks import fill_polygon
from polyfold.geometry._rectified import Rectified
from polyfold.plugins._fabrics import garment_template
from polyfold.plugins.interfaces import SewnKind
from polyfold.types import Observation, Scene

SPAN = 300.0
"""Longest side of a real garment's bounding box in the image it is grounded in [px]."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Grounded:
    """A real garment with the polygon fitted to it.

    Attributes:
        scene: the scene, in a 400 x 400 image where the garment's longest side measures 300 px.
        rgb: that image, uint8, shape (400, 400, 3).
        outline: the silhouette in the source's pixels, shape (N, 2).
        keypoints: vertex name -> position in the source's pixels, shape (2,).
        confidence: how sure it is that this is such a garment, 0 to 1; by the fit and by ``doubts``.
        doubts: what speaks against it, in words.
        plane: how the photo's pixels map to metres on the table; None without a sheet or board beside the garment.
        size: longest side of the garment's bounding box when it lies upright [m]; None without ``plane``.
    """

    scene: Scene
    rgb: NDArray[np.uint8]
    outline: Floats
    keypoints: Mapping[str, Floats]
    confidence: float = 1.0
    doubts: tuple[str, ...] = ()
    plane: Rectified | None = None
    size: float | None = None

    __repr__ = brief

    def _repr_png_(self) -> bytes:
        from polyfold import viz

        assert self.scene.model is not None
        return viz.png(viz.grounding_picture(self.rgb, self.scene.model))


def garment(
    kind: str,
    seed: int = 0,
    *,
    mask: str | Path | ArrayLike | None = None,
    outline: str | Path | ArrayLike | None = None,
    image: str | Path | None = None,
    mesh: str | Path | None = None,
    keypoints: str | Path | None = None,
    size: float | None = None,
    edge_length: float | None = None,
    fabric: str | dict[str, Any] | ComponentSpec | None = None,
    segmenter: str | dict[str, Any] | ComponentSpec | None = None,
    sheet: str | None = None,
    experiment: Experiment | None = None,
) -> Garment:
    """A garment of a kind: seeded, from a mesh file, or the twin of a real one.

    Args:
        kind: garment kind, for example ``tshirt``.
        seed: picks the instance when nothing else is given.
        mask: PNG or bool array, shape (H, W), of a real garment; its twin lies as it lay.
        outline: JSON file or array of pixels, shape (N, 2), of a real garment, likewise.
        image: photo of a real garment on a table; likewise, and its twin has its colour.
        mesh: OBJ file; ``keypoints`` must be given too.
        keypoints: JSON file, keypoint name -> vertex index of the mesh.
        size: longest side of the garment's bounding box [m]; by default typical of the kind, or what the seed draws.
        edge_length: mesh size [m]; by default what suits the kind.
        fabric: what it is made of: a name, or a table with ``name`` and constants (without a name, of the usual
            fabric); by default what the experiment names.
        segmenter: what finds the cloth in the photo: a name, or a table with ``name`` and ``params``; by default
            ``photo``.
        sheet: what lies beside the garment in the photo and measures it: ``a3``, ``a4``, ``a5``, ``letter`` or
            ``charuco:COLUMNSxROWS:SQUARE:MARKER`` with sides in mm. The photo may then be taken at an angle.
        experiment: whose grounding finds the keypoints of a real garment, and whose fabric it is made of: by default
            what its kind usually is.

    Raises:
        GarmentError: if a file can't be used, or more than one source is given.
        GroundingError: if the outline can't be explained as this kind.
        PluginError: if no plugin provides the kind or the fabric.
        ConfigError: if the seed is no whole number, or a constant of the fabric is unknown or not plausible.
    """
    seed = checked_seed(seed)
    experiment = experiment or Experiment()
    if fabric is not None:
        experiment = experiment.override({"fabric": fabric})
    # Before the work of cutting one out: names are often mistyped.
    cloth = plugins.make_fabric(experiment.fabric, kind)
    sources = {"mask": mask, "outline": outline, "image": image, "mesh": mesh}
    given = [name for name, source in sources.items() if source is not None]
    if len(given) > 1:
        raise GarmentError(f"give one source of the garment, not {' and '.join(given)}")
    if keypoints is not None and mesh is None:
        raise GarmentError("keypoints belong to a mesh file; give the mesh too")
    _check_photo(image, segmenter, sheet)
    if not given:
        return plugins.generate_garment(kind, seed, edge_length, experiment.fabric, size)
    if mesh is not None:
        return replace(_from_mesh(kind, mesh, keypoints, size, edge_length), fabric=cloth)
    found = ground(
        kind, mask=mask, outline=outline, image=image, segmenter=segmenter, sheet=sheet, experiment=experiment
    )
    if found.confidence < DOUBTFUL:
        reasons = "; ".join(found.doubts) or f"the polygon is off by {found.scene.residual:.1f} px"
        warnings.warn(
            f"this is a {kind!r} with a confidence of {found.confidence:.2f} only ({reasons}); look at what "
            "`polyfold ground` draws",
            stacklevel=2,
        )
    ring, corners = _on_table(found.plane, found.outline, found.keypoints)
    pattern = pattern_of(kind)
    twin = twin_from_outline(ring, kind, corners, pattern, size or found.size, edge_length)
    twin = replace(twin, fabric=cloth, angle_deg=angle_of(corners, pattern))
    if image is None:
        return twin
    return replace(twin, colours=colours_in(found.rgb, found.scene.mask), photo=found.rgb)


def pattern_of(kind: str) -> Pattern:
    """How a kind of garment is sewn. Raises GarmentError if its class does not say."""
    cls = plugins.component_class("garments", kind)
    if not isinstance(cls, SewnKind):
        raise GarmentError(f"the garment kind {kind!r} does not say how it is sewn; give its class a `pattern`")
    return cls.pattern


def _from_mesh(
    kind: str, mesh: str | Path, keypoints: str | Path | None, size: float | None, edge_length: float | None
) -> Garment:
    if keypoints is None:
        raise GarmentError("a mesh needs named keypoints; give a JSON file of keypoint name -> vertex index")
    return load_obj(mesh, keypoints, kind, pattern_of(kind), size, edge_length)


def ground(
    kind: str,
    *,
    mask: str | Path | ArrayLike | None = None,
    outline: str | Path | ArrayLike | None = None,
    image: str | Path | None = None,
    segmenter: str | dict[str, Any] | ComponentSpec | None = None,
    sheet: str | None = None,
    experiment: Experiment | None = None,
) -> Grounded:
    """Fit a kind's polygon model to a real garment.

    Args: as in :func:`garment`; give exactly one of ``mask``, ``outline`` and ``image``.

    Raises:
        GarmentError: if the source can't be used, or no cloth or no sheet is found in the photo.
        GroundingError: if it can't be explained as this kind.
        PluginError: if there is no such segmenter.
    """
    _check_photo(image, segmenter, sheet)
    photo = None if image is None else look(image, segmenter, sheet)
    source = outline_of(mask=mask, outline=outline) if photo is None else photo.outline
    plane = None if photo is None else photo.plane
    silhouette = source if plane is None else plane.on_table(source)
    centre = (silhouette.min(axis=0) + silhouette.max(axis=0)) / 2
    scale = SPAN / float(np.ptp(silhouette, axis=0).max())
    camera = Camera()
    shift = np.asarray(camera.centre) - scale * centre
    framed_mask = fill_polygon(scale * silhouette + shift, camera.height, camera.width)

    def to_frame(pixels: Floats) -> Floats:
        return scale * (pixels if plane is None else plane.on_table(pixels)) + shift

    rgb = _drawn(framed_mask) if photo is None else framed_photo(photo.rgb, to_frame, camera)
    depth = np.full(framed_mask.shape, camera.elevation, np.float32)
    grounding = plugins.create_chosen(experiment or Experiment(), "grounding")
    template = garment_template(kind)
    seen = Observation(rgb, depth, camera)
    scene: Scene = grounding.ground(seen, framed_mask, template)
    if scene.model is None:
        raise GarmentError("a real garment needs a grounding with a polygon model; use the grounding 'polygon'")

    def ground_as(other: str) -> Scene:
        return grounding.ground(seen, framed_mask, garment_template(other))

    vertices = scene.model.vertices()
    placed = np.array([(vertices[name].point - shift) / scale for name in template.names])
    size = _size(kind, silhouette, dict(zip(template.names, placed, strict=True))) if plane is not None else None
    points = placed if plane is None else plane.in_photo(placed)
    keypoints = dict(zip(template.names, points, strict=True))
    found = [*doubts(kind, scene, None if photo is None else rgb, ground_as), *(photo.doubts if photo else ())]
    sure = confidence(scene.residual, found)
    return Grounded(scene, rgb, source, keypoints, sure, tuple(words for _, words in found), plane, size)


def _check_photo(image: str | Path | None, segmenter: object, sheet: str | None) -> None:
    if image is None and (segmenter is not None or sheet is not None):
        what = "a sheet measures" if sheet is not None else "a segmenter searches"
        raise GarmentError(f"{what} a photo; give one as image")


def _on_table(
    plane: Rectified | None, outline: Floats, keypoints: Mapping[str, Floats]
) -> tuple[Floats, dict[str, Floats]]:
    """Outline and keypoints as seen straight from above."""
    if plane is None:
        return outline, dict(keypoints)
    points = plane.on_table(np.array(list(keypoints.values())))
    return plane.on_table(outline), dict(zip(keypoints, points, strict=True))


def _size(kind: str, outline: Floats, keypoints: Mapping[str, Floats]) -> float:
    """Longest side of the upright garment [m]; as it lies, if its kind does not say which way up that is."""
    cls = plugins.component_class("garments", kind)
    if isinstance(cls, SewnKind):
        return upright_size(outline, keypoints, cls.pattern)
    return float(np.ptp(outline, axis=0).max())


def outline_of(*, mask: str | Path | ArrayLike | None = None, outline: str | Path | ArrayLike | None = None) -> Floats:
    """The silhouette [px], shape (N, 2), of a mask or outline."""
    if outline is not None:
        return load_outline(outline) if isinstance(outline, str | Path) else _checked_outline(outline)
    if mask is None:
        raise GarmentError("give a mask, an outline or an image of the garment")
    return contour_of(load_mask(mask) if isinstance(mask, str | Path) else _checked_mask(mask))


def _checked_outline(outline: ArrayLike) -> Floats:
    try:
        points = np.asarray(outline, float)
    except (TypeError, ValueError) as error:
        raise GarmentError(f"an outline is an array of pixels (x, y), shape (N, 2), and not so ({error})") from error
    repair_outline(points)
    return points


def _checked_mask(mask: ArrayLike) -> NDArray[np.bool_]:
    pixels = np.asarray(mask)
    if pixels.ndim != 2 or pixels.dtype.kind not in "buif":
        raise GarmentError(
            f"a mask is an array of shape (H, W), True where the cloth is, and not of {pixels.dtype}, shape "
            f"{pixels.shape}; of a picture give one channel, compared with a threshold"
        )
    found = np.nan_to_num(pixels, nan=0).astype(bool)
    if not found.any() or found.all():
        raise GarmentError(
            f"the mask is {'full' if found.any() else 'empty'}; give one that is True where the cloth is"
        )
    return found


def is_mask(path: str | Path) -> bool:
    """Whether a picture file is a black-and-white mask, dark around its border, rather than a photo."""
    pixels = load_picture(path)
    stride = max(1, round((pixels.size / 3e6) ** 0.5))
    pixels = pixels[::stride, ::stride]
    grey = ((pixels < 16) | (pixels > 239)).mean() > 0.99 and np.ptp(pixels.astype(int), axis=2).max() < 16
    border = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
    return bool(grey and (border > 127).mean() <= 0.5)


def _drawn(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """A plain picture of a mask, for sources that have no photo."""
    rgb = np.full((*mask.shape, 3), 236, np.uint8)
    rgb[mask] = (120, 150, 180)
    return rgb
