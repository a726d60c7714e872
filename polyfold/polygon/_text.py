"""The polygon model as a language model is shown it: strict JSON in a stable order."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from polyfold.polygon._layers import Facet
from polyfold.polygon._vertices import VertexState


def model_text(
    kind: str, vertices: Mapping[str, VertexState], facets: Iterable[Facet], image_size: tuple[int, int]
) -> str:
    """Vertices with whole pixels, description, layers and visibility; edges per layer, creases marked.

    Args:
        kind: garment kind.
        vertices: named vertices, in the order to show them.
        facets: the pieces of cloth.
        image_size: (width, height) [px].
    """
    shown = {
        name: {
            "x": round(float(state.point[0])),
            "y": round(float(state.point[1])),
            "description": state.description,
            "layers": list(state.layers),
            "visible": state.visible,
        }
        for name, state in vertices.items()
    }
    width, height = image_size
    content: dict[str, Any] = {
        "garment": kind,
        "image": {"width": int(width), "height": int(height)},
        "vertices": shown,
        "edges": _edges(facets, list(vertices)),
    }
    return json.dumps(content, allow_nan=False)


def _edges(facets: Iterable[Facet], order: list[str]) -> dict[str, list[list[str]]]:
    layers: dict[int, list[list[str]]] = {}
    for facet in sorted(facets, key=lambda facet: facet.layer):
        known = layers.setdefault(facet.layer, [])
        for edge in _named_edges(facet, order):
            if edge not in known and [edge[1], edge[0], *edge[2:]] not in known:
                known.append(edge)
    return {str(layer): edges for layer, edges in layers.items()}


def _named_edges(facet: Facet, order: list[str]) -> list[list[str]]:
    """Edges between named corners; unnamed corners (a line that cuts the cloth twice) are passed over."""
    corners = [i for i, names in enumerate(facet.names) if names]
    found = []
    for i, j in zip(corners, corners[1:] + corners[:1], strict=True):
        labels = {facet.edges[k % len(facet.edges)] for k in range(i, j if j > i else j + len(facet.edges))}
        a, b = (min(facet.names[k], key=order.index) for k in (i, j))
        if a != b and len(labels) == 1:
            found.append([a, b, *(labels - {""})])
    return found
