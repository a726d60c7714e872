"""Outlines of real garments, from a JSON file, a mask or a photograph; all in pixels, y down."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import GarmentError, GroundingError
from polyfold.errors._hints import file_problem
from polyfold.garments._silhouette import find_cloth
from polyfold.garments._twin import repair_outline
from polyfold.geometry import contour_of, polygon_area

WORKING_SIZE = 1000
"""Photographs are searched at no more than this many pixels along their longer side."""


def load_outline(path: str | Path) -> NDArray[np.float64]:
    """Read an outline [px, y down], shape (M, 2).

    The file holds ``[[x, y], …]``, or an object with that list under ``outline``, or annotations: of labelme
    (``shapes``), of one picture in COCO's format (``annotations``, as polygons), or a line of aRTF Clothes (``mask``).
    Of several polygons the largest counts.

    Raises:
        GarmentError: if the file can't be read or holds no outline.
    """
    content = _json(Path(path))
    polygons = _polygons(content, path)
    outlines = [_points(polygon, path) for polygon in polygons if polygon or len(polygons) == 1]
    found = max(outlines, key=lambda outline: abs(polygon_area(outline)))
    try:
        repair_outline(found)
    except GarmentError as error:
        raise GarmentError(f"{path}: {error}") from error
    return found


def load_mask(path: str | Path) -> NDArray[np.bool_]:
    """Read a mask, bright where the garment is, or a cut-out that is transparent elsewhere, bool, shape (H, W).

    Raises:
        GarmentError: if the file is no picture, or is empty, full, or bright around the border.
    """
    picture = _opened(Path(path))
    cut_out = "A" in picture.getbands() and picture.getchannel("A").getextrema()[0] < 255
    pixels = np.asarray(picture.getchannel("A") if cut_out else picture.convert("L"))
    mask = pixels > (127 if pixels.max() > 1 else 0)  # labels 0 and 1 make a mask too
    if not mask.any() or mask.all():
        raise GarmentError(f"the mask {path} is {'full' if mask.any() else 'empty'}; paint the garment white on black")
    if np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]]).mean() > 0.5:
        raise GarmentError(
            f"the mask {path} is bright around its border; paint the garment white on black, not inverted, or give a "
            "photo of dark cloth as a photo (--image)"
        )
    return mask


def load_picture(path: str | Path) -> NDArray[np.uint8]:
    """Read a photograph as it is meant to be seen, uint8 RGB, shape (H, W, 3), not to be written to."""
    path = Path(path)
    try:
        found = path.stat()
        stamp = found.st_ino, found.st_mtime_ns, found.st_size
    except OSError:
        stamp = ()  # what is wrong is said when it is opened
    return _decoded(path, Path.cwd(), stamp)


@lru_cache(maxsize=1)
def _decoded(path: Path, folder: Path, stamp: tuple[int, ...]) -> NDArray[np.uint8]:
    """The picture last read: one photo is looked at for what it is, for its outline and to draw on it.

    It stays in memory until the next one is read, 3 bytes a pixel.
    """
    picture = _opened(path)
    pixels = np.asarray(picture if picture.mode == "RGB" else picture.convert("RGB"))
    pixels.flags.writeable = False
    return pixels


def outline_from_photo(
    path: str | Path, find: Callable[[NDArray[np.uint8]], NDArray[np.bool_]] = find_cloth
) -> NDArray[np.float64]:
    """Outline of the garment in a photograph [px of the photograph], shape (M, 2).

    Args:
        path: PNG or JPEG file.
        find: finds the cloth in a picture of at most 1000 px, uint8, shape (H, W, 3): its mask, bool, shape (H, W). By
            default on a plain background.

    Raises:
        GarmentError: if the file is no picture or no garment stands out from the background.
    """
    import cv2

    picture = load_picture(path)
    height, width = picture.shape[:2]
    scale = min(1.0, WORKING_SIZE / max(height, width))
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    smaller = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8) if scale < 1.0 else picture
    try:
        outline = contour_of(find(smaller))
    except (GarmentError, GroundingError) as error:
        raise GarmentError(f"{path}: {error}") from error
    factor = np.array([width / size[0], height / size[1]])
    return (outline + 0.5) * factor - 0.5


def _json(path: Path) -> Any:
    try:
        text = path.read_text("utf-8-sig")
    except OSError as error:
        raise GarmentError(file_problem(error, path)) from error
    except UnicodeDecodeError as error:
        raise GarmentError(f"the outline {path} is no text ({error}); give a JSON file in UTF-8") from error
    try:
        return json.loads(text)
    except (json.JSONDecodeError, RecursionError) as error:
        raise GarmentError(f"the outline {path} is not valid JSON ({error}); write [[x, y], ...] in pixels") from error


def _polygons(content: Any, path: str | Path) -> list[Any]:
    """The polygons of any of the formats, as they stand there."""
    if not isinstance(content, dict):
        return content if _is_nested(content) else [content]
    if isinstance(shapes := content.get("shapes"), list):
        return [shape.get("points") for shape in shapes if _is_polygon_of_labelme(shape)] or [None]
    if isinstance(annotations := content.get("annotations"), list):
        return _polygons_of_coco(annotations, path)
    found = content.get("outline", content.get("mask"))
    return list(found) if found and _is_nested(found) else [found]


def _is_polygon_of_labelme(shape: Any) -> bool:
    return isinstance(shape, dict) and shape.get("shape_type", "polygon") == "polygon"


def _polygons_of_coco(annotations: list[Any], path: str | Path) -> list[Any]:
    described = [annotation for annotation in annotations if isinstance(annotation, dict)]
    pictures = {annotation.get("image_id") for annotation in described}
    if len(pictures) > 1:
        raise GarmentError(f"{path} annotates {len(pictures)} pictures; keep the annotations of one of them")
    found = list[Any]()
    for annotation in described:
        segmentation = annotation.get("segmentation")
        if not isinstance(segmentation, list):
            raise GarmentError(f"{path} holds a segmentation that is no polygon (run lengths?); export polygons")
        found += [[values[at : at + 2] for at in range(0, len(values), 2)] for values in segmentation]
    return found or [None]


def _is_nested(content: Any) -> bool:
    """Whether this is a list of polygons rather than of points."""
    return bool(
        isinstance(content, list) and content and isinstance(content[0], list)
        and content[0] and isinstance(content[0][0], list)
    )  # fmt: skip


def _points(polygon: Any, path: str | Path) -> NDArray[np.float64]:
    try:
        points = np.asarray(polygon, float)
    except (TypeError, ValueError):
        points = np.empty(0)
    if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 3 or not np.isfinite(points).all():
        raise GarmentError(
            f"{path} holds no outline: at least three finite points [[x, y], ...] are needed; correct it"
        )
    return points


def _opened(path: Path) -> Any:
    """A picture as it is meant to be seen, with 8 bits a channel."""
    from PIL import Image, ImageOps, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # a large photo is no attack
            picture = Image.open(path)
        picture.load()
    except UnidentifiedImageError as error:
        raise GarmentError(f"{path} is no picture that can be read; give a PNG or JPEG file") from error
    except Image.DecompressionBombError as error:
        raise GarmentError(f"the picture {path} is too large ({error}); make it smaller first") from error
    except (SyntaxError, ValueError, EOFError) as error:  # what PIL's readers raise of damaged data
        raise GarmentError(f"the picture {path} is damaged ({error}); save it again as PNG or JPEG") from error
    except OSError as error:
        broken = error.errno is None  # of the picture's own data
        raise GarmentError(
            f"the picture {path} is damaged ({error}); save it again as PNG or JPEG"
            if broken
            else file_problem(error, path)
        ) from error
    ImageOps.exif_transpose(picture, in_place=True)
    return _in_bytes(picture)


def _in_bytes(picture: Any) -> Any:
    """The picture with 8 bits a channel; a grey one of 16 or 32 bits, or of floating point, is scaled, not cut off."""
    from PIL import Image

    if picture.mode not in ("I", "F") and not picture.mode.startswith("I;16"):
        return picture
    values = np.nan_to_num(np.asarray(picture).astype(float))
    most = float(values.max(initial=0.0))
    white = next((white for white in (1.0, 255.0, 65_535.0) if most <= white), most)
    return Image.fromarray(np.round(values.clip(0) * (255.0 / white)).astype(np.uint8))


_SAMPLES = Path(__file__).parents[1] / "samples"


def samples() -> dict[str, Path]:
    """Outlines of real garments that come with the package, to try things on.

        >>> from polyfold.garments import samples
        >>> polyfold.garment("tshirt", outline=samples()["tshirt"])

    Returns:
        Name -> file, as ``outline`` of :func:`polyfold.garment` and :func:`polyfold.ground`, and ``polyfold fold
        --outline``, read it: ``shorts``, ``towel`` and ``tshirt``, from the aRTF Clothes dataset (doi
        10.5281/zenodo.10875542, CC-BY 4.0).
    """
    return {path.stem: path for path in sorted(_SAMPLES.glob("*.json"))}
