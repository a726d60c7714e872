"""Fold sequences that people use for each kind of garment: the ends among which a wish chooses."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations

from polyfold_rules.shapes.folds import CORNERS, EDGES, OPPOSITE_CORNER, OPPOSITE_EDGE, Fold

Sequence = tuple[Fold, ...]

ACROSS = {"left": ("bottom", "top"), "right": ("bottom", "top"), "top": ("left", "right"), "bottom": ("left", "right")}
"""Edges on the other axis, the one that is taken by default first."""


def sequences(family: str) -> tuple[Sequence, ...]:
    """Every known sequence for a family of garments; of equals, the one that people would take stands first."""
    found = {"tshirt": _tshirt, "pants": _pants}.get(family, _quad)()
    return tuple(dict.fromkeys(found))


def _quad() -> Iterator[Sequence]:
    for edge in ("bottom", "top", "left", "right"):
        yield (_half(edge),)
        yield (Fold("middle", edge),)
    yield from _halvings()
    for first, second in (("left", "right"), ("top", "bottom")):
        gate = (Fold("middle", first), Fold("middle", second))
        yield gate
        yield (*gate, Fold("half", first, manner="gap"))
        yield (*gate, _half(ACROSS[first][0]))
    for edge in ("bottom", "left", "top", "right"):
        yield _thirds(edge)
        yield (*_thirds(edge), _half(ACROSS[edge][0]))
        yield (*_thirds(edge), *_thirds(ACROSS[edge][0]))
        yield (Fold("band", edge, share=1 / 3),)
    yield from _cornered()


def _halvings() -> Iterator[Sequence]:
    for edge in ("bottom", "top", "left", "right"):
        for across in ACROSS[edge]:
            yield (_half(edge), _half(across))
            yield (_half(edge), _half(across), _half(edge, again=True))
            yield (_half(edge), _half(across), _half(edge, again=True), _half(across, again=True))
        yield (_half(edge), _half(edge, again=True))


def _cornered() -> Iterator[Sequence]:
    for corner in CORNERS:
        triangle = Fold("corner", corner, OPPOSITE_CORNER[corner])
        yield (triangle,)
        for acute in CORNERS:
            if acute not in (corner, OPPOSITE_CORNER[corner]):
                yield triangle, Fold("corner", acute, OPPOSITE_CORNER[acute])
        yield (_dog_ear(corner),)
    for edge in EDGES:
        yield tuple(_dog_ear(corner) for corner in CORNERS if edge in corner.split("_"))
    for corner in ("bottom_left", "top_left"):
        yield _dog_ear(corner), _dog_ear(OPPOSITE_CORNER[corner])
    yield tuple(_dog_ear(corner) for corner in CORNERS)


def _tshirt() -> Iterator[Sequence]:
    for edge in ("left", "right", "bottom", "top"):
        yield (_half(edge),)
    yield from ((_half(edge), _half("bottom")) for edge in ("left", "right"))
    for manner in ("straight", "slanted"):
        for side in ("left", "right"):
            yield (Fold("sleeve", side, manner=manner),)
    for first, second in permutations(("left", "right")):
        for manners in (("straight",) * 2, ("slanted",) * 2, ("straight", "slanted"), ("slanted", "straight")):
            yield Fold("sleeve", first, manner=manners[0]), Fold("sleeve", second, manner=manners[1])
        sleeves = Fold("sleeve", first, manner="straight"), Fold("sleeve", second, manner="straight")
        yield (*sleeves, _half("bottom"))
        yield (*sleeves, _half("left"))
        yield (*sleeves, *_thirds("bottom"))
        yield (*sleeves, _half("left"), *_thirds("bottom"))
        yield (*sleeves, _half("bottom"), _half("bottom", again=True))


def _pants() -> Iterator[Sequence]:
    for edge in ("left", "right", "bottom", "top"):
        yield (_half(edge),)
    for edge in ("left", "right"):
        yield _half(edge), _half("bottom")
        yield _half(edge), _half("top")
        yield _half(edge), _half("bottom"), _half("bottom", again=True)
        yield (_half(edge), *_thirds("bottom"))
        yield (_half(edge), *(_half("bottom", again=index > 0) for index in range(3)))
    yield _half("bottom"), _half("left")
    yield (Fold("band", "bottom", share=0.25),)


def _half(edge: str, again: bool = False) -> Fold:
    return Fold("half", edge, manner="again" if again else "")


def _thirds(edge: str) -> Sequence:
    return Fold("band", edge, share=1 / 3), Fold("band", OPPOSITE_EDGE[edge], share=1 / 3)


def _dog_ear(corner: str) -> Fold:
    return Fold("corner", corner, "centre")
