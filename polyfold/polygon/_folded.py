"""A garment that has been folded: what lies where, in which layer, and what its outline is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold._brief import brief
from polyfold.errors import GarmentError
from polyfold.geometry import FoldLine, polygon_area, rotate
from polyfold.polygon._coincidence import Pair, meetings, together
from polyfold.polygon._covering import inside_depth, nearest_point, silhouette
from polyfold.polygon._layers import Facet, fold_facets, plies_at
from polyfold.polygon._text import model_text
from polyfold.polygon._vertices import VertexState

Floats = NDArray[np.float64]

_TOUCH = 1.0
"""A vertex this close to a piece above it [px] counts as hidden: its position is not known better than that."""


@dataclass(frozen=True, eq=False)
class _Place:
    """The topmost piece that has a vertex, its place there [px], shape (2,), and all layers that have it."""

    facet: Facet
    point: Floats
    layers: tuple[int, ...]


@dataclass(frozen=True, eq=False, repr=False)
class FoldedModel:
    """The parameterized polygon model of a garment after some folds; a value, like everything in a scene.

    Attributes:
        rest: vertices of the flat garment where it lay before the folds [px], shape (V, 2), in polygon order.
        names: vertex names, in the same order.
        descriptions: vertex name -> what it is, in words.
        folds: the fold lines so far, oldest first, each in the frame of ``rest``.
        kind: the garment kind.
        allowances: how much cloth across its line [px] the bend of each fold uses up; all 0 if not given. What lies
            within half of it of the line is in the bend, so the crease's edge is that half short of the line, while
            the rest of the lifted part comes to lie exactly on its mirror image. Negative where the outer plies of a
            thick packet stand out beyond the line.
        meetings: which vertices each fold was meant to bring onto which, as pairs of names; none if not given.
        numbers: of each fold, from 1 in the order in which they were made; its crease's ends are named by it, and keep
            their names when an earlier flap comes open.
    """

    rest: Floats
    names: tuple[str, ...]
    descriptions: Mapping[str, str]
    folds: tuple[FoldLine, ...] = ()
    kind: str = "cloth"
    allowances: tuple[float, ...] = ()
    meetings: tuple[tuple[Pair, ...], ...] = ()
    numbers: tuple[int, ...] = ()
    _facets: tuple[Facet, ...] | None = field(default=None, repr=False)

    __repr__ = brief

    def __post_init__(self) -> None:
        rest = np.array(self.rest, float)
        if rest.shape != (len(self.names), 2) or len(rest) < 3 or not np.isfinite(rest).all():
            raise GarmentError(
                f"rest must be finite pixels of shape ({len(self.names)}, 2), one row per name, got {rest.shape}"
            )
        rest.setflags(write=False)
        object.__setattr__(self, "rest", rest)
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "folds", tuple(self.folds))
        object.__setattr__(self, "allowances", tuple(self.allowances) or (0.0,) * len(self.folds))
        object.__setattr__(self, "meetings", tuple(self.meetings) or ((),) * len(self.folds))
        object.__setattr__(self, "numbers", tuple(self.numbers) or tuple(range(1, len(self.folds) + 1)))
        for what, given in (("allowances", self.allowances), ("meetings", self.meetings), ("numbers", self.numbers)):
            if len(given) != len(self.folds):
                raise GarmentError(f"there are {len(self.folds)} folds and {len(given)} {what}; give one per fold")

    def fold(self, line: FoldLine, allowance: float = 0.0, planned: FoldLine | None = None) -> FoldedModel:
        """The model after one more fold: the cloth left of ``line`` is lifted, mirrored and laid on top.

        Args:
            line: the fold line [px].
            allowance: how much cloth across the line [px] the bend uses up.
            planned: the line that was meant [px], where ``line`` is what became of it: the vertices that it brings onto
                each other are then at one place, although ``line`` would lay them a little apart.

        Raises:
            PlanError: if the line is too short, or leaves all cloth on one side; the message says which.
        """
        number = max(self.numbers, default=0) + 1
        facets = fold_facets(self.facets(), line, number, allowance)
        met = meetings(self.points(), planned, self._size) if planned else ()
        return FoldedModel(
            self.rest,
            self.names,
            self.descriptions,
            (*self.folds, line),
            self.kind,
            (*self.allowances, allowance),
            (*self.meetings, met),
            (*self.numbers, number),
            facets,
        )

    def plies(self, line: FoldLine) -> float:
        """How many layers a fold along ``line`` would bend, on average along the crease."""
        return plies_at(self.facets(), line)

    def before(self, fold: int) -> FoldedModel:
        """The model with only the first ``fold`` folds."""
        return self._of(range(fold))

    def without(self, fold: int) -> FoldedModel:
        """The model without its ``fold``-th fold, from 1; the later ones stay, and their creases keep their names."""
        kept = [number for number in range(len(self.folds)) if number != fold - 1]
        gone = {f"fold{self.numbers[fold - 1]}_{end}" for end in ("start", "end")}
        model = self._of(kept)
        met = tuple(tuple(pair for pair in pairs if not gone & set(pair)) for pairs in model.meetings)
        return replace(model, meetings=met)

    def facets(self) -> tuple[Facet, ...]:
        """The flat pieces the garment consists of now."""
        return self._pieces

    def outline(self) -> Floats:
        """The silhouette [px], shape (N, 2): the largest outer ring of the union of all pieces."""
        return self._outline

    def vertices(self) -> dict[str, VertexState]:
        """Every named vertex as it lies now: the template's in polygon order, then the creases' ends.

        Vertices that a fold was meant to bring onto each other are at one place, the mean of where their pieces have
        them.
        """
        return dict(self._vertices)

    def points(self) -> dict[str, Floats]:
        """Name -> position [px], shape (2,)."""
        return {name: state.point for name, state in self.vertices().items()}

    def to_text(self, image_size: tuple[int, int], pixels_per_metre: float | None = None) -> str:
        """The model for a language model: strict JSON in stable order, coordinates in whole pixels.

        Args:
            image_size: (width, height) [px].
            pixels_per_metre: of the table, if known, so that centimetres can be told.
        """
        image: dict[str, float] = {"width": int(image_size[0]), "height": int(image_size[1])}
        if pixels_per_metre is not None:
            image["px_per_cm"] = round(pixels_per_metre / 100, 2)
        flat = dict(zip(self.names, self.rest, strict=True)) if self.folds else {}
        return model_text(self.kind, self.vertices(), self.facets(), flat, image)

    def transformed(
        self, angle: float, translation: ArrayLike = (0.0, 0.0), centre: ArrayLike = (0.0, 0.0)
    ) -> FoldedModel:
        """The whole model moved rigidly.

        Args:
            angle: how far it is turned [rad], positive from x towards y: clockwise as seen in the image.
            translation: how far it is shifted afterwards [px], shape (2,).
            centre: what it is turned about [px], shape (2,).
        """
        shift = np.asarray(translation, float)

        def move(points: ArrayLike) -> Floats:
            return rotate(points, angle, centre) + shift

        folds = tuple(FoldLine.between(*move([line.start, line.end])) for line in self.folds)
        return FoldedModel(
            move(self.rest),
            self.names,
            self.descriptions,
            folds,
            self.kind,
            self.allowances,
            self.meetings,
            self.numbers,
        )

    def with_last_fold(self, line: FoldLine, allowance: float = 0.0) -> FoldedModel:
        """The model with its last fold replaced."""
        if not self.folds:
            raise GarmentError("the model has no fold to replace; use fold() to add one")
        return self.before(len(self.folds) - 1).fold(line, allowance)

    def _of(self, kept: Sequence[int]) -> FoldedModel:
        """The model with only some of its folds, counted from 0."""
        return FoldedModel(
            self.rest,
            self.names,
            self.descriptions,
            tuple(self.folds[k] for k in kept),
            self.kind,
            tuple(self.allowances[k] for k in kept),
            tuple(self.meetings[k] for k in kept),
            tuple(self.numbers[k] for k in kept),
        )

    @cached_property
    def _pieces(self) -> tuple[Facet, ...]:
        if self._facets is not None:
            return self._facets
        facets: tuple[Facet, ...] = (Facet.flat(self.rest, self.names),)
        for number, line, allowance in zip(self.numbers, self.folds, self.allowances, strict=True):
            facets = fold_facets(facets, line, number, allowance)
        return facets

    @cached_property
    def _outline(self) -> Floats:
        return silhouette(facet.polygon for facet in self.facets())

    @cached_property
    def _vertices(self) -> dict[str, VertexState]:
        found = {name: self._found(name) for name in self._all_names()}
        met = [pair for pairs in self.meetings for pair in pairs]
        points = together({name: place.point for name, place in found.items()}, met, self._size)
        return {name: self._state(name, place, points[name]) for name, place in found.items()}

    @property
    def _size(self) -> float:
        """Square root of the flat garment's area [px]."""
        return float(np.sqrt(abs(polygon_area(self.rest))))

    def _all_names(self) -> list[str]:
        creases = [f"fold{number}_{end}" for number in self.numbers for end in ("start", "end")]
        return [*self.names, *creases]

    def _found(self, name: str) -> _Place:
        owners = [(facet, i) for facet in self.facets() for i, names in enumerate(facet.names) if name in names]
        if not owners:
            facet, point = self._position_of_lost(name)
            return _Place(facet, point, (facet.layer,))
        facet, corner = max(owners, key=lambda owner: owner[0].layer)
        return _Place(facet, facet.polygon[corner], tuple(sorted({owner.layer for owner, _ in owners})))

    def _state(self, name: str, place: _Place, point: Floats) -> VertexState:
        facet = place.facet
        covered = any(
            other.layer > facet.layer and inside_depth(place.point, other.polygon) > -_TOUCH for other in self.facets()
        )
        return VertexState(point, self._describe(name, facet.flipped), place.layers, not covered, facet.flipped)

    def _position_of_lost(self, name: str) -> tuple[Facet, Floats]:
        """Piece and position of a vertex in a bend, or on a dropped sliver: it moves with the nearest piece."""
        origin = self._rest_point(name)

        def depth(facet: Facet) -> float:
            return inside_depth(origin, facet.at_rest(facet.polygon))

        nearest = max(self.facets(), key=depth)
        point = nearest.motion[:, :2] @ origin + nearest.motion[:, 2]
        if any(allowance > 0.0 for allowance in self.allowances):
            point = nearest_point(point, nearest.polygon)  # in a bend: it lies at the crease's edge, not beyond
        return nearest, point

    def _rest_point(self, name: str) -> Floats:
        """Where on the flat garment a vertex lies; for a crease's end, as it was when it was made."""
        if name in self.names:
            return self.rest[self.names.index(name)]
        number = int(name.removeprefix("fold").split("_")[0])
        for facet in self.before(self.numbers.index(number) + 1).facets():
            for i, names in enumerate(facet.names):
                if name in names:
                    return facet.at_rest(facet.polygon[i])
        raise GarmentError(f"the crease of fold {number} left no trace; fold along a line that crosses more cloth")

    def _describe(self, name: str, flipped: bool) -> str:
        if name in self.names:
            words = self.descriptions.get(name, name.replace("_", " "))
            return f"{words} (folded over, reverse side up)" if flipped else words
        number, end = name.removeprefix("fold").split("_")
        return f"{end} of the crease made by fold {number}"
