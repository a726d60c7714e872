"""Fold lines of tasks on a garment, and which task a plan carries out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from polyfold.errors import ConfigError
from polyfold.geometry import FoldLine
from polyfold.tasks._suite import Fold, Task


def fold_lines(task: Task, keypoints: Mapping[str, ArrayLike]) -> list[FoldLine]:
    """The task's fold lines on a flat garment, one per step.

    Tasks are written on the flat garment: what a step moves counts for later ones as where it lay. But a point that a
    fold takes along unnamed, such as the corner of a crooked square beside its diagonal, is where the fold takes it.

    Args:
        task: the task.
        keypoints: keypoint name -> pixel of the flat garment, shape (2,).

    Returns:
        Directed lines [px] as long as the garment along them, the lifted part on their left.

    Raises:
        ConfigError: if the task needs a keypoint that is missing, or its points coincide on this garment.
    """
    everything = np.array([np.asarray(point, float) for point in keypoints.values()])
    return [_stretched(line, everything) for line, _ in _folded(task, keypoints)]


def points_after(task: Task | None, keypoints: Mapping[str, ArrayLike]) -> dict[str, NDArray[np.float64]]:
    """Where the points that a further step would go by are once a task was done [px]; None for no task yet."""
    at = {name: np.asarray(point, float) for name, point in keypoints.items()}
    for _, at in _folded(task, keypoints) if task else ():  # noqa: B007
        pass
    return at


def _folded(
    task: Task, keypoints: Mapping[str, ArrayLike]
) -> Iterator[tuple[FoldLine, dict[str, NDArray[np.float64]]]]:
    """Each step's line, and where the points that later ones go by are after it."""
    at, moved = {name: np.asarray(point, float) for name, point in keypoints.items()}, set[str]()
    for number, fold in enumerate(task.steps, 1):
        try:
            line = _line_of(fold, at)
        except KeyError as error:
            raise ConfigError(
                f"task {task.id}, step {number} needs the keypoint {error}, which the garment does not have; "
                f"it has {', '.join(keypoints)}"
            ) from error
        except ValueError as error:
            raise ConfigError(f"task {task.id}, step {number}: {error}; choose other points") from error
        moved.update(*(source for source, _ in fold.pairs or ()), fold.lift or {})
        at |= {name: line.mirror(at[name]) for name in at.keys() - moved if line.distance(at[name]) > 0.0}
        yield line, dict(at)


def mirror_line(sources: ArrayLike, targets: ArrayLike) -> FoldLine:
    """The line whose reflection brings ``sources`` nearest to ``targets`` (least squares), sources on its left.

    Args:
        sources: positions [px], shape (N, 2).
        targets: where each should come to lie [px], shape (N, 2).

    Raises:
        ValueError: if sources and targets coincide.
    """
    sources, targets = np.atleast_2d(np.asarray(sources, float)), np.atleast_2d(np.asarray(targets, float))
    moved, total = sources - targets, sources + targets
    spread = total - total.mean(0)
    if np.hypot(*moved.T).max() < 1e-9:
        raise ValueError("the points to move already lie on their targets")
    _, vectors = np.linalg.eigh(spread.T @ spread - moved.T @ moved)
    normal = vectors[:, 0]
    normal = normal if (moved @ normal).sum() > 0 else -normal
    return _line_from_normal(normal, total.mean(0) / 2)


def recognise(
    tasks: Iterable[Task],
    keypoints: Mapping[str, ArrayLike],
    planned: Iterable[FoldLine],
    degrees: float = 10.0,
    offset: float = 0.06,
) -> str | None:
    """The task that a plan carries out, or None when it is no task's.

    Args:
        tasks: candidates, of the garment's kind.
        keypoints: keypoint name -> pixel of the flat garment, shape (2,).
        planned: the plan's fold lines [px], in order.
        degrees: how far the directions may differ; the same side must be lifted.
        offset: how far a planned line may pass from the middle of the task's line, as a share of the garment's span.
    """
    planned = list(planned)
    span = float(np.ptp(np.array([np.asarray(point, float) for point in keypoints.values()]), axis=0).max())
    best: tuple[float, str] | None = None
    for task in tasks:
        if len(task.steps) != len(planned):
            continue
        differences = [
            _difference(ideal, line, degrees, offset * span)
            for ideal, line in zip(fold_lines(task, keypoints), planned, strict=True)
        ]
        worst = max(differences)
        if worst <= 1.0 and (best is None or worst < best[0]):
            best = worst, task.id
    return best[1] if best else None


def _difference(ideal: FoldLine, line: FoldLine, degrees: float, offset: float) -> float:
    """How far a line is from the ideal one, in tolerances; at most 1 is a match."""
    along_ideal, along = np.subtract(ideal.end, ideal.start), np.subtract(line.end, line.start)
    cross = along_ideal[0] * along[1] - along_ideal[1] * along[0]
    angle = abs(np.degrees(np.arctan2(cross, along_ideal @ along)))
    middle = np.add(ideal.start, ideal.end) / 2
    return max(float(angle) / degrees, abs(float(line.distance(middle))) / offset)


def _line_of(fold: Fold, keypoints: Mapping[str, ArrayLike]) -> FoldLine:
    if fold.pairs is not None:
        sources = [_position(source, keypoints) for source, _ in fold.pairs]
        targets = [_position(target, keypoints) for _, target in fold.pairs]
        return mirror_line(sources, targets)
    start, end = (_position(point, keypoints) for point in fold.crease or ())
    if (start == end).all():
        raise ValueError("the crease's two points lie on one another")
    line = FoldLine.between(start, end)
    distance = float(line.distance(_position(fold.lift or {}, keypoints)))
    if distance == 0.0:
        raise ValueError("the point to lift lies on the crease")
    return line if distance > 0 else line.reversed()


def _position(point: Mapping[str, float], keypoints: Mapping[str, ArrayLike]) -> NDArray[np.float64]:
    return sum((weight * np.asarray(keypoints[name], float) for name, weight in point.items()), np.zeros(2))


def _line_from_normal(normal: NDArray[np.float64], through: NDArray[np.float64]) -> FoldLine:
    """The unit-length line through a point whose left side the normal points to (y down)."""
    along = np.array([-normal[1], normal[0]])
    return FoldLine.between(through - along / 2, through + along / 2)


def _stretched(line: FoldLine, points: NDArray[np.float64]) -> FoldLine:
    """The same line, reaching as far as the points do along it."""
    start = np.asarray(line.start)
    along = np.subtract(line.end, line.start) / line.length
    reach = (points - start) @ along
    return FoldLine.between(start + reach.min() * along, start + reach.max() * along)
