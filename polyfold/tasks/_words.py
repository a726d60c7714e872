"""A task's folds in words, by the names of their points."""

from __future__ import annotations

from collections.abc import Mapping

from polyfold.tasks._suite import Fold


def describe(fold: Fold) -> str:
    """A task's step in words, by the names of its points."""
    if fold.pairs is not None:
        moves = [f"{_named(source)} onto {_named(target)}" for source, target in fold.pairs]
        return f"fold {' and '.join(moves)}"
    assert fold.crease is not None
    assert fold.lift is not None
    start, end = fold.crease
    return f"fold {_named(fold.lift)} over along the line from {_named(start)} to {_named(end)}"


def _named(point: Mapping[str, float]) -> str:
    """``top left``, or ``the point between top left and top right`` with the weights where they differ."""
    names = [name.replace("_", " ") for name in point]
    if len(names) == 1:
        return names[0]
    shares = list(point.values())
    if max(shares) - min(shares) < 0.01:
        return f"the middle of {' and '.join(names)}"
    parts = [f"{share:.0%} {name}" for name, share in zip(names, shares, strict=True)]
    return f"the point {' and '.join(parts)}"
