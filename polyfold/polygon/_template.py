"""What a kind of garment looks like before it is fitted: vertices and parts by name, and what its outline may be."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import GarmentError
from polyfold.polygon._folded import FoldedModel
from polyfold.polygon._generator import Generator
from polyfold.polygon._penalties import Penalty, PenaltySet

Floats = NDArray[np.float64]

_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


class Template:
    """The polygon template of one kind of garment.

    Left and right are meant as seen in the image with the garment upright, not the wearer's. Templates are plain
    values: a plugin makes one from public names and returns it from its garment kind's ``template()``.

    Example, a skirt that is wider at the hem::

        from polyfold.polygon import SymmetricGenerator, Template, angle_range, ratio_range

        names = ("hem_left", "waist_left", "waist_right", "hem_right")
        hem, waist = ("hem_left", "hem_right"), ("waist_left", "waist_right")
        skirt = Template(
            kind="skirt",
            names=names,
            descriptions={
                "hem_left": "left corner of the hem", "waist_left": "left end of the waistband",
                "waist_right": "right end of the waistband", "hem_right": "right corner of the hem",
            },
            parts={"hem": hem, "waist": waist, "left side": ("hem_left", "waist_left")},
            canonical_shapes=[[(-0.5, 0.5), (-0.25, -0.5), (0.25, -0.5), (0.5, 0.5)]],
            generator=SymmetricGenerator(names, [hem, waist]),
            penalties=[
                ratio_range(waist, hem, 0.3, 0.9),
                angle_range(waist, hem, -15, 15),
                ratio_range(("hem_left", "waist_left"), ("hem_right", "waist_right"), 0.8, 1.25),
            ],
        )

    Args:
        kind: the garment kind (not a kind of component).
        names: vertex names in polygon order: lower-case letters, digits and underscores, at most 40 characters.
        descriptions: what each vertex is, in words, for a language model.
        parts: named parts in words (``left sleeve``) -> the vertices that make them up.
        canonical_shapes: typical upright outlines in any unit, y DOWN, shape (S, V, 2); the first is shown to language
            models, all of them start the fit. They are centred and scaled to unit size.
        generator: the polygon generator of the first fitting stage.
        penalties: ranges that a plausible outline keeps.
        cyclic: the vertices' naming depends on how the garment lies (square, rectangle): the edge nearest the image's
            top, from the second to the third name, is the top.
        covered: vertices that other cloth may hide (the crotch under a leg): the contour need not reach them.
    """

    def __init__(
        self,
        kind: str,
        names: Sequence[str],
        descriptions: Mapping[str, str],
        parts: Mapping[str, Sequence[str]],
        canonical_shapes: ArrayLike,
        generator: Generator,
        penalties: Sequence[Penalty] = (),
        cyclic: bool = False,
        covered: Sequence[str] = (),
    ) -> None:
        self.kind = kind
        self.names = tuple(names)
        self.descriptions = {name: str(descriptions.get(name, "")) for name in self.names}
        self.parts = {part: tuple(members) for part, members in parts.items()}
        self.canonical_shapes = _unit_shapes(canonical_shapes, len(self.names))
        self.generator = generator
        self.penalties = PenaltySet(penalties, self.names)
        self.cyclic = cyclic
        self.covered = tuple(covered)
        self.thickness: float | None = None
        self.size_cm: tuple[int, int] | None = None
        self._check()

    def of_thickness(self, thickness: float) -> Template:
        """The same template for garments of which one layer of the model, all its panels, is ``thickness`` [m] high.

        No picture shows that; who says what lies on the table says it (``thickness`` is None otherwise).
        """
        template = copy.copy(self)
        template.thickness = float(thickness)
        return template

    def of_size(self, width: float, height: float) -> Template:
        """The same template for a garment of this width and height when it lies flat and upright [m].

        Language models are told it, so that they can plan for a drawer or a box.
        """
        template = copy.copy(self)
        template.size_cm = (round(100 * width), round(100 * height))
        return template

    @property
    def canonical(self) -> Floats:
        """An upright outline, longest side 1 (no unit), centred on the origin, y down, shape (V, 2)."""
        return self.canonical_shapes[0]

    def model(self, vertices: ArrayLike) -> FoldedModel:
        """The unfolded model with these vertices [px], shape (V, 2), in the order of ``names``."""
        return FoldedModel(np.asarray(vertices, float), self.names, self.descriptions, kind=self.kind)

    def to_text(self) -> str:
        """The template for a language model, strict JSON: garment, size if known, vertices around it, parts."""
        size = {} if self.size_cm is None else {"size_cm": list(self.size_cm)}
        parts = {part: list(members) for part, members in self.parts.items()}
        return json.dumps(
            {"garment": self.kind, **size, "vertices": self.descriptions, "parts": parts}, allow_nan=False
        )

    def _check(self) -> None:
        if len(self.names) < 3 or len(set(self.names)) != len(self.names):
            raise GarmentError(f"template {self.kind!r} needs at least three vertices with distinct names")
        for name in (self.kind, *self.names):
            if not _NAME.fullmatch(name):
                raise GarmentError(f"{name!r} is no usable name; take lower-case letters, digits and _, 40 at most")
        in_parts = {name for members in self.parts.values() for name in members}
        for what, mentioned in (("parts", in_parts), ("covered", set(self.covered))):
            if unknown := sorted(mentioned - set(self.names)):
                raise GarmentError(f"{what} of template {self.kind!r} name unknown vertices {unknown}; correct them")
        if missing := [name for name, words in self.descriptions.items() if not words]:
            raise GarmentError(f"template {self.kind!r} does not describe {missing}; add a few words for each")


def _unit_shapes(shapes: ArrayLike, vertices: int) -> Floats:
    shapes = np.asarray(shapes, float)
    if shapes.ndim != 3 or shapes.shape[1:] != (vertices, 2) or not np.isfinite(shapes).all():
        raise GarmentError(f"canonical_shapes must be finite with shape (S, {vertices}, 2), got {shapes.shape}")
    low, high = shapes.min(1, keepdims=True), shapes.max(1, keepdims=True)
    return (shapes - (low + high) / 2) / (high - low).max(2, keepdims=True)
