"""What a camera sees and what grounding makes of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from polyfold.polygon import FoldedModel
from polyfold._brief import brief
from polyfold.geometry._camera import Camera

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Observation:
    """What an RGB-D camera gives, and all that an unprivileged agent ever sees.

    Attributes:
        rgb: colours, uint8, shape (H, W, 3).
        depth: distance along the optical axis [m], float32, shape (H, W); NaN where a camera measured none.
        camera: the camera that took it.
    """

    rgb: NDArray[np.uint8]
    depth: NDArray[np.float32]
    camera: Camera

    __repr__ = brief


@dataclass(frozen=True, eq=False, repr=False)
class Scene:
    """What grounding made of an observation: pure data, enough to plan from and to ground the next image.

    Attributes:
        kind: garment kind, e.g. ``tshirt``.
        image_size: (width, height) [px].
        mask: where the cloth is, bool, shape (H, W).
        contour: outer boundary of the cloth [px], shape (N, 2).
        model: the fitted polygon model, or None for groundings without one.
        text: what a language model is shown: a strict JSON object with ``garment``, ``image`` (``width``, ``height``
            and, where known, ``px_per_cm``) and ``vertices``: name -> ``[x, y]`` [px] or ``{"at": [x, y], ...}``.
            Points without names stand in ``keypoints`` as a list. After a fold ``flat`` says where vertices lay before
            the first one, if elsewhere. ``offline`` refuses a text without any of them.
        residual: Chamfer distance between model and contour [px]; NaN without a model.
        notes: things the caller should know (a displaced garment, an ambiguous silhouette).
        picture: what a vision model is shown beside the text: colours, uint8, shape (H, W, 3); None for none.
        shown: what text and picture hold, of ``polygon``, ``keypoints``, ``image``; it decides which prompt explains
            them to the language model (``fold_line/keypoints-image-v2.md``).
        grounding: which grounding made it, in words for messages; the host writes it.
    """

    kind: str
    image_size: tuple[int, int]
    mask: NDArray[np.bool_]
    contour: Floats
    model: FoldedModel | None
    text: str
    residual: float = float("nan")
    notes: tuple[str, ...] = ()
    picture: NDArray[np.uint8] | None = None
    shown: tuple[str, ...] = ("polygon",)
    grounding: str = field(default="", repr=False)

    __repr__ = brief
