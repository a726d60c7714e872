"""Open tasks: goals without given folds, judged on where the cloth ends; after the goals of the paper's Fig. 14.

In a suite (:mod:`polyfold.tasks`) an open task reads::

    accept_from = "polyfold70"            # optional: the suite whose tasks are accepted; this is the default

    [[goal]]
    id = "napkin-smaller-square"
    garment = "square"
    text = "I want this napkin to be a smaller square."
    accept = ["square-corners-all"]
    done = { area_max = 0.62, rectangular_min = 0.85, length_max = 0.82 }

It is reached when the cloth ends as one of the accepted tasks does, or when the final silhouette keeps every bound of
``done``; see :class:`Bounds`. At least one of the two is given.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

Mask = NDArray[np.bool_]

Share = Annotated[float, Field(gt=0.0, le=1.0)]
Count = Annotated[int, Field(ge=0, le=99)]


class Bounds(BaseModel):
    """What the end must keep, all of it; a bound that is not given is none.

    Attributes:
        area_min, area_max: the final silhouette's area / the flat garment's.
        rectangular_min: its area / the area of its minimum-area bounding rectangle.
        triangular_min: its area / the area of its minimum enclosing triangle.
        length_max: the long side of its minimum-area rectangle / that of the flat garment.
        steps_min, steps_max: number of folds carried out, each counted once however often it was tried.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    area_min: Share | None = None
    area_max: Share | None = None
    rectangular_min: Share | None = None
    triangular_min: Share | None = None
    length_max: Share | None = None
    steps_min: Count | None = None
    steps_max: Count | None = None

    @model_validator(mode="after")
    def _can_be_kept(self) -> Bounds:
        if not self.given():
            raise ValueError(f"it has no bound; give one of {', '.join(type(self).model_fields)}")
        for name in ("area", "steps"):
            low, high = getattr(self, f"{name}_min"), getattr(self, f"{name}_max")
            if low is not None and high is not None and low > high:
                raise ValueError(f"{name}_min {low} is above {name}_max {high}; swap or widen them")
        return self

    def given(self) -> Mapping[str, float]:
        """The bounds that are given, by name."""
        return self.model_dump(exclude_none=True)

    def failing(self, measured: Measured) -> tuple[str, ...]:
        """Names of the bounds that a result does not keep; ``in_view`` before them if it could not be measured."""
        missed = [] if measured.in_view else ["in_view"]
        for name, bound in self.given().items():
            quantity, _, side = name.rpartition("_")
            value = getattr(measured, quantity)
            if value < bound if side == "min" else value > bound:
                missed.append(name)
        return tuple(missed)


class OpenTask(BaseModel):
    """A goal that leaves the folds to the planner.

    Attributes:
        id: unique name within its suite, among the tasks too.
        garment: garment kind.
        text: the sentence that asks for it.
        type: the family it belongs to in tables.
        accept: ids of the tasks whose end states count as this goal's.
        done: bounds that count as reaching it, whatever the folds were.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: str = Field(pattern=r"^[a-z0-9_-]+$", max_length=80)
    garment: str
    text: str = Field(min_length=1)
    type: str = "goal"
    accept: tuple[str, ...] = ()
    done: Bounds | None = None

    @field_validator("accept")
    @classmethod
    def _once_each(cls, accept: tuple[str, ...]) -> tuple[str, ...]:
        for task_id in accept:
            if accept.count(task_id) > 1:
                raise ValueError(f"the task {task_id!r} is named twice; remove one")
        return accept

    @model_validator(mode="after")
    def _can_be_judged(self) -> OpenTask:
        if not self.accept and self.done is None:
            raise ValueError("nothing counts as reaching it; give 'accept', 'done' or both")
        return self

    @property
    def instructions(self) -> tuple[str, ...]:
        """The sentence, as :class:`polyfold.tasks.Task` has its wordings."""
        return (self.text,)

    def in_words(self) -> str:
        """What counts as reaching it."""
        ways = [f"ends as {' or '.join(self.accept)}"] if self.accept else []
        if self.done is not None:
            ways.append("keeps " + ", ".join(f"{name} {bound:g}" for name, bound in self.done.given().items()))
        return ", or ".join(ways)


@dataclass(frozen=True)
class Measured:
    """An end as :class:`Bounds` sees it.

    Attributes:
        area, rectangular, triangular, length: ratios, explained there; 0 where a silhouette is empty.
        steps: number of folds carried out.
        in_view: whether the cloth lies inside the picture: what was carried out of it can't be measured, and is no
            smaller for it.
    """

    area: float
    rectangular: float
    triangular: float
    length: float
    steps: int
    in_view: bool


def measure(final: Mask, flat: Mask, steps: int) -> Measured:
    """Measure the end of an episode.

    Args:
        final: the cloth in the last picture, bool, shape (H, W).
        flat: the cloth in the first picture, flat, bool, shape (H, W).
        steps: number of folds carried out.
    """
    if not (final.any() and flat.any()):
        return Measured(0.0, 0.0, 0.0, 0.0, steps, in_view=False)
    hull, area = _hull(final), float(final.sum())
    sides, flat_sides = _rectangle(hull), _rectangle(_hull(flat))
    return Measured(
        area=area / float(flat.sum()),
        rectangular=area / (sides[0] * sides[1]),
        triangular=area / _triangle_area(hull),
        length=max(sides) / max(flat_sides),
        steps=steps,
        in_view=not (final[[0, -1]].any() or final[:, [0, -1]].any()),
    )


def _hull(mask: Mask) -> NDArray[np.int32]:
    """Convex hull of the silhouette [half pixels], shape (N, 1, 2): of the middles of all pixels' edges.

    Their centres would make upright shapes a pixel too small, and their corners make turned ones a pixel too large.
    """
    import cv2

    found = 2 * np.argwhere(mask)[:, ::-1].astype(np.int32)
    middles = np.concatenate([found + middle for middle in ((1, 0), (0, 1), (-1, 0), (0, -1))])
    return np.asarray(cv2.convexHull(middles), np.int32)


def _rectangle(hull: NDArray[np.int32]) -> tuple[float, float]:
    """Sides [px] of the bounding rectangle of least area."""
    import cv2

    width, height = cv2.minAreaRect(hull)[1]
    return width / 2, height / 2


def _triangle_area(hull: NDArray[np.int32]) -> float:
    """Area [px²] of the least enclosing triangle."""
    import cv2

    # OpenCV loses its way on hulls with nearly parallel neighbours, which the staircase of slanted edges has. Without
    # them the hull is up to half a pixel smaller; its own area still bounds the triangle from below.
    area = cv2.minEnclosingTriangle(cv2.approxPolyDP(hull, 1.0, True))[0]
    return max(float(area), cv2.contourArea(hull)) / 4
