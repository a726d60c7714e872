"""The table as a picture: the cloth as it lies, with what would be done to it."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.garments import Garment
from polyfold.types import ActionMap, Decision, Observation, Scene, SimState
from polyfold.viz import overlay
from polyfold.viz._draw._cloth import cloth_picture

Image = NDArray[np.uint8]

ZOOM = 1.25
"""Size of the picture relative to what the camera sees."""


class Table(Protocol):
    """What can be drawn: a playground."""

    @property
    def observation(self) -> Observation:
        """What the camera sees."""
        ...

    @property
    def state(self) -> SimState:
        """Where the cloth is."""
        ...

    @property
    def scene(self) -> Scene:
        """What the grounding makes of it."""
        ...

    garment: Garment


def still(table: Table) -> Image:
    """The cloth as it lies with its polygon, uint8, shape (ZOOM H, ZOOM W, 3)."""
    return lying(table, with_polygon=True)


def lying(table: Table, with_polygon: bool) -> Image:
    """The cloth as it lies, drawn for people where that is known, uint8, shape (ZOOM H, ZOOM W, 3)."""
    drawn = cloth_picture(table.state, table.garment, ZOOM, 2) if table.state.known else None
    return overlay(table.observation, table.scene if with_polygon else None, zoom=ZOOM, shown=drawn)


def planned(seen: Observation, drawn: Image, plan: Decision, with_map: bool) -> Image:
    """The cloth with a plan over it.

    Args:
        seen: what the camera sees.
        drawn: the same as :func:`lying` draws it.
        plan: the fold that is thought of.
        with_map: draw what the policy thinks of every place to pick as well.
    """
    if plan.scene is None:
        return overlay(seen, None, plan.fold_line, plan.action, zoom=ZOOM, shown=drawn)
    bare = replace(plan.scene, model=None)  # its polygon is drawn already
    values = _values(plan) if with_map else None
    return overlay(seen, bare, plan.fold_line, plan.action, action_map=values, zoom=ZOOM, shown=drawn)


def has_values(plan: Decision | None) -> bool:
    """Whether the policy says of every place to pick how good it is."""
    return plan is not None and _values(plan) is not None


def _values(plan: Decision) -> ActionMap | None:
    try:
        return None if plan.action_map is None else plan.action_map()
    except PlanError:
        return None
