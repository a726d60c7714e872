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

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

__all__ = ["Bounds", "OpenTask"]

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

    def given(self) -> dict[str, float]:
        """The bounds that are given, by name."""
        return self.model_dump(exclude_none=True)


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
