"""The polygon model as a language model is shown it: strict JSON in a stable order, nothing said twice."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.polygon._layers import Facet
from polyfold.polygon._vertices import VertexState

_WORD = re.compile(r"[a-z]+|[0-9]+")

MOVED = 1.5
"""A vertex this far from where it lay on the flat garment [px] has been moved."""


def model_text(
    kind: str,
    vertices: Mapping[str, VertexState],
    facets: Iterable[Facet],
    flat: Mapping[str, NDArray[np.float64]],
    image: Mapping[str, float],
) -> str:
    """Vertices with whole pixels; once the garment is folded, layers, pieces, and where vertices lay when flat.

    What goes without saying is left out: that a vertex is visible, on the lowest layer, and what its name says already.

    Args:
        kind: garment kind.
        vertices: named vertices, in the order to show them.
        facets: the pieces of cloth.
        flat: where vertices lay on the flat garment [px], shape (2,) each; empty if it is flat.
        image: what is said of the picture, such as its ``width`` and ``height`` [px].
    """
    content: dict[str, Any] = {
        "garment": kind,
        "image": dict(image),
        "vertices": {name: _shown(name, state) for name, state in vertices.items()},
    }
    if flat:
        moved = {name: at for name, at in flat.items() if np.hypot(*(vertices[name].point - at)) > MOVED}
        content["flat"] = {name: _whole(at) for name, at in moved.items()}
        content["outlines"] = _outlines(facets, list(vertices))
    return json.dumps(content, allow_nan=False)


def _shown(name: str, state: VertexState) -> Any:
    """Where a vertex lies, and what else there is to say of it."""
    more: dict[str, Any] = {}
    if state.layers != (0,):
        more["layers"] = list(state.layers)
    if not state.visible:
        more["hidden"] = True
    if not set(_WORD.findall(name)) <= set(_WORD.findall(state.description.lower())):
        more["is"] = state.description
    return {"at": _whole(state.point), **more} if more else _whole(state.point)


def _whole(point: NDArray[np.float64]) -> list[int]:
    return [round(float(value)) for value in point]


def _outlines(facets: Iterable[Facet], order: list[str]) -> dict[str, list[list[str]]]:
    """The pieces of every layer by the named corners around them; corners without a name are passed over."""
    layers: dict[int, list[list[str]]] = {}
    for facet in sorted(facets, key=lambda facet: facet.layer):
        named = [min(names, key=order.index) for names in facet.names if names]
        layers.setdefault(facet.layer, []).append(list(dict.fromkeys(named)))
    return {str(layer): pieces for layer, pieces in layers.items()}
