"""What is planned and done."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from polyfold._brief import brief
from polyfold.errors import ActionError
from polyfold.geometry._camera import Camera
from polyfold.geometry._fold_line import FoldLine
from polyfold.types._perception import Scene

Floats = NDArray[np.float64]

ActionMap = tuple[Floats, Floats]
"""Places to pick [px], shape (N, 2), and how good a policy takes each for, shape (N,); higher is better."""


@dataclass(frozen=True)
class Subgoal:
    """One bimanual fold in words: *fold <part> <direction> to <part> <axis>* (paper, Sec. IV-B)."""

    text: str


@dataclass(frozen=True, eq=False)
class Action:
    """One pick-and-place with one or two arms; arms move together.

    Attributes:
        picks, places: pixels, float, shape (arms, 2), arms 1 or 2.
        heights: how high above the table the tips of each arm's fingers are when they close [m], shape (arms,); plies
            below stay where they are. None takes all plies.
    """

    picks: Floats
    places: Floats
    heights: Floats | None = None

    def __post_init__(self) -> None:
        picks, places = np.asarray(self.picks, float), np.asarray(self.places, float)
        if picks.shape != places.shape or picks.shape not in ((1, 2), (2, 2)):
            raise ActionError(
                f"picks and places must both have shape (1, 2) or (2, 2), got {picks.shape} and {places.shape}; "
                "give one (x, y) pixel per arm"
            )
        if not (np.isfinite(picks).all() and np.isfinite(places).all()):
            raise ActionError("picks and places must be finite pixels; one is NaN or infinite")
        object.__setattr__(self, "picks", picks)
        object.__setattr__(self, "places", places)
        if self.heights is not None:
            heights = np.asarray(self.heights, float)
            if heights.shape != (len(picks),) or not (np.isfinite(heights) & (heights >= 0)).all():
                raise ActionError(
                    f"heights must be {len(picks)} number(s) from 0 up, one per arm; got {heights.tolist()}"
                )
            object.__setattr__(self, "heights", heights)

    @property
    def arms(self) -> int:
        """Number of arms, 1 or 2."""
        return len(self.picks)

    def check_inside(self, camera: Camera) -> None:
        """Raise :class:`ActionError` if a pick or place lies outside the camera's image."""
        points = np.vstack([self.picks, self.places])
        outside = (points < -0.5).any(1) | (points[:, 0] > camera.width - 0.5) | (points[:, 1] > camera.height - 0.5)
        if outside.any():
            x, y = points[outside][0]
            raise ActionError(
                f"the pixel ({x:.0f}, {y:.0f}) lies outside the {camera.width} x {camera.height} image; "
                "keep picks and places inside it"
            )


@dataclass(frozen=True, eq=False, repr=False)
class Decision:
    """What an agent wants done next, and what led to it.

    Attributes:
        action: the picks and places to execute.
        subgoal: the step in words, if the agent has one.
        fold_line: the fold line behind the action, if there is one.
        scene: the scene it decided on, if it made one.
        seconds: time spent per stage (``grounding``, ``language``, ``policy``) [s].
        retry: whether this repeats a fold that was seen to have failed.
        action_map: computes what the policy thinks of every place to pick, for pictures; None where it can't say, or
            did not choose the picks (:func:`polyfold.plugins.interfaces.action_map_later`).
    """

    action: Action
    subgoal: Subgoal | None = None
    fold_line: FoldLine | None = None
    scene: Scene | None = None
    seconds: Mapping[str, float] = field(default_factory=dict)
    retry: bool = False
    action_map: Callable[[], ActionMap] | None = None

    __repr__ = brief
