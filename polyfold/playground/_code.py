"""What was folded by hand as Python that folds it again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from polyfold import plugins
from polyfold.config import Experiment
from polyfold.garments import Garment
from polyfold.geometry import FoldLine
from polyfold.playground._moves import Move


def as_code(garment: Garment, seed: int, experiment: Experiment, moves: Iterable[Move]) -> str:
    """A script that makes the same moves.

    Args:
        garment: what was folded.
        seed: of how it lay.
        experiment: with which components.
        moves: what was asked for, in order.
    """
    lines = ["import polyfold", ""]
    arguments = [repr(garment.kind)]
    if not _is_drawn(garment, seed, experiment):
        # Nothing that runs: without what made it, it would be another garment, and the folds would be others.
        made = f"polyfold.garment({garment.kind!r}, seed={garment.seed or 0}, ...)"
        lines += [f"garment = ...  # {garment.name}, made as you made it: {made}"]
        arguments = ["garment"]
    arguments += [f"seed={seed}"] if seed else []
    arguments += [f"{name}={_plain(value)!r}" for name, value in _chosen(experiment).items()]
    lines += [f"playground = polyfold.play({', '.join(arguments)})"]
    lines += [f"playground.fold({_move(move)})" for move in moves]
    return "\n".join([*lines, "playground.episode", ""])


def _is_drawn(garment: Garment, seed: int, experiment: Experiment) -> bool:
    """Whether kind, seed and fabric are all that it takes to make the garment again."""
    if garment.seed != seed or garment.angle_deg is not None:
        return False
    drawn = plugins.generate_garment(garment.kind, seed, None, experiment.fabric, None)
    return drawn.fabric == garment.fabric and np.array_equal(drawn.mesh.vertices, garment.mesh.vertices)


def _chosen(experiment: Experiment) -> dict[str, Any]:
    """What differs from the usual components."""
    usual, told = Experiment().model_dump(), experiment.model_dump()
    return {name: value for name, value in told.items() if value != usual[name]}


def _plain(value: Any) -> Any:
    """A component by its name alone where it has no parameters."""
    if not isinstance(value, Mapping):
        return value
    return {"name": value["name"], **value["params"]} if value["params"] else value["name"]


def _move(move: Move) -> str:
    if isinstance(move, str):
        return repr(move)
    if isinstance(move, FoldLine):
        return f"polyfold.FoldLine({_point(move.start)}, {_point(move.end)})"
    heights = "" if move.heights is None else f", heights={move.heights.tolist()}"
    return f"polyfold.Action({_points(move.picks)}, {_points(move.places)}{heights})"


def _points(points: ArrayLike) -> str:
    return f"[{', '.join(_point(point) for point in np.asarray(points))}]"


def _point(point: ArrayLike) -> str:
    """Written so that it is read back as the very same number."""
    x, y = (float(value) for value in np.asarray(point, float))
    return f"({x!r}, {y!r})"
