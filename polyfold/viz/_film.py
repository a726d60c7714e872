"""An episode as a film: the plan of each fold, the arms doing it, the sentence above and the step below."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold.types import Episode, Observation, SimState, Step
from polyfold.viz._draw._animation import gif
from polyfold.viz._draw._canvas import Canvas, Page, line_height, wrapped
from polyfold.viz._draw._drawing import draw_fold_line
from polyfold.viz._draw._overlays import overlay
from polyfold.viz._draw._style import ARMS, FAINT, INK, PAPER
from polyfold.viz._pictures import shown

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

SIDE, MARGIN, SENTENCE, TITLE = 400, 12, 16, 14
PLAN_S, RESULT_S = 1.2, 2.0
"""How long the plan of a fold is shown before it begins, and the result before the film begins again [s]."""
HELD = 12.0
"""An arm holds what lies within this of its pick [px]."""


@dataclass(frozen=True, eq=False)
class Moment:
    """The cloth while it moves.

    Attributes:
        seen: what the camera sees.
        state: where the cloth is.
        fold: which fold of the episode moves it, from 0.
    """

    seen: Observation
    state: SimState
    fold: int


def write_film(episode: Episode, moments: Sequence[Moment], path: Path, fps: float) -> Path:
    """Write an episode as an endless GIF.

    Args:
        episode: what happened.
        moments: how it moved, in order.
        path: file to write.
        fps: moments per second.
    """
    pictures, holds = [], {}
    before = episode.initial_state
    moving = {fold: list(group) for fold, group in groupby(moments, key=lambda moment: moment.fold)}
    for step in episode.steps:
        holds[len(pictures)] = PLAN_S
        pictures.append(_page(episode, _plan(episode, step, before), step))
        pictures += [_page(episode, rgb, step) for rgb in _motion(episode, step, before, moving.get(step.index, []))]
        before = step.after
    pictures.append(_page(episode, _cloth(episode, episode.final, episode.final_state), None))
    return gif(pictures, path, fps=fps, hold_s=RESULT_S, holds=holds)


def _cloth(episode: Episode, seen: Observation, state: SimState, oversample: int = 2) -> Image:
    return overlay(seen, zoom=SIDE / max(seen.rgb.shape[:2]), shown=shown(episode, state, SIDE, oversample))


def _plan(episode: Episode, step: Step, before: SimState) -> Image:
    """What was seen before a fold, with its line and its picks and places."""
    zoom = SIDE / max(step.observation.rgb.shape[:2])
    drawn = shown(episode, before, SIDE)
    return overlay(step.observation, step.scene, step.fold_line, step.action, zoom=zoom, shown=drawn)


def _motion(episode: Episode, step: Step, before: SimState, moments: Sequence[Moment]) -> Iterator[Image]:
    """The fold itself, with its line and the arms where the cloth that they hold is."""
    held = _held(step, before) if before.known and not episode.privileged else []
    for moment in moments:
        rgb = _cloth(episode, moment.seen, moment.state, oversample=1)
        canvas = Canvas(moment.seen.rgb, SIDE / max(moment.seen.rgb.shape[:2]), rgb)
        if step.fold_line is not None:
            draw_fold_line(canvas, step.fold_line, step.scene)
        for particle, colour in zip(held, ARMS, strict=False):
            if particle is not None:
                point = moment.state.camera.to_pixels(moment.state.positions[particle])
                canvas.disc(point, 6.6, PAPER)
                canvas.disc(point, 5.2, colour)
        yield canvas.image()


def _held(step: Step, before: SimState) -> list[int | None]:
    """The particle that each arm holds: the highest near its pick, if any is."""
    pixels = before.camera.to_pixels(before.positions)
    found: list[int | None] = []
    for pick, plies in zip(step.action.picks, step.after.grasped or (1,) * step.action.arms, strict=True):
        away = np.hypot(*(pixels - pick).T)
        near = np.flatnonzero(away <= max(HELD, float(away.min())))
        found.append(int(near[np.argmax(before.positions[near, 2])]) if plies else None)
    return found


def _page(episode: Episode, picture: Image, step: Step | None) -> Image:
    """A picture between the sentence and what is being done; all pages of a film have one size."""
    height, width = picture.shape[:2]
    text = width - 2 * MARGIN
    above, below = 2 * line_height(SENTENCE) + 2 * MARGIN, 2 * line_height(TITLE) + 2 * MARGIN
    page = Page(width, above + height + below)
    page.lines(
        wrapped(episode.instruction, SENTENCE, text, bold=True, most=2), MARGIN, MARGIN, SENTENCE, INK, bold=True
    )
    page.picture(picture, 0, above)
    told = wrapped(_told(step, len(episode.steps)), TITLE, text, most=2)
    page.lines(told, MARGIN, above + height + MARGIN, TITLE, FAINT)
    return page.image()


def _told(step: Step | None, count: int) -> str:
    if step is None:
        return "the result"
    what = step.subgoal.text if step.subgoal is not None else "fold"
    return f"{step.index + 1} of {count}: {'again, ' if step.retry else ''}{what}"
