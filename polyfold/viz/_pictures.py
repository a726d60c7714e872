"""An episode in pictures: the filmstrip, and how it shows itself in Jupyter."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from html import escape
from pathlib import Path
from secrets import token_hex

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.geometry import contour_of
from polyfold.tasks._ideal import fold_ideally
from polyfold.types import ActionMap, Episode, SimState, Step
from polyfold.types._views import makes
from polyfold.viz._draw._cloth import cloth_picture, sides_of
from polyfold.viz._draw._filmstrips import PANEL, Frame, filmstrip
from polyfold.viz._draw._overlays import overlay
from polyfold.viz._draw._saving import png


@makes(Episode, "filmstrip")
def filmstrip_of(episode: Episode, path: str | Path | None = None) -> NDArray[np.uint8]:
    """One panel per fold, then the result beside the ideal, uint8, shape (H, W, 3).

    Args:
        episode: what to show.
        path: file to write: PNG, or PDF or SVG for papers, in which lines and words stay sharp at any size.
    """
    result = shown(episode, episode.final_state)
    before = [episode.initial_state, *(step.after for step in episode.steps)]
    return filmstrip(
        [_frame(step, shown(episode, state)) for step, state in zip(episode.steps, before, strict=False)],
        episode.final.rgb,
        heading=f"{episode.instruction} ({episode.garment.name})",
        result_caption=result_caption(episode),
        ideal_outline=_ideal_outline(episode),
        path=path,
        result_shown=result,
        sides=() if result is None else sides_of(episode.garment),
        photo=episode.garment.photo,
    )


def shown(episode: Episode, state: SimState, side: int = PANEL, oversample: int = 2) -> NDArray[np.uint8] | None:
    """A state drawn for people; None where it is not known, or an agent may have put the cloth back meanwhile.

    Args:
        episode: what the state is of.
        state: where the cloth is.
        side: of the picture, the longer one [px].
        oversample: samples per pixel and axis.
    """
    if episode.privileged or not state.known:
        return None
    return cloth_picture(state, episode.garment, side / max(state.camera.width, state.camera.height), oversample)


@makes(Episode, "result")
def result_of(episode: Episode) -> NDArray[np.uint8]:
    """The last picture with the ideal outline dashed over it, uint8, shape (H, W, 3)."""
    drawn = shown(episode, episode.final_state)
    return overlay(episode.final, outline=_ideal_outline(episode), shown=drawn)


def _ideal_outline(episode: Episode) -> NDArray[np.float64] | None:
    if not episode.ideal_lines or not episode.initial_state.known:
        return None
    return contour_of(fold_ideally(episode.initial_state, episode.garment, episode.ideal_lines).mask)


def _frame(step: Step, shown: NDArray[np.uint8] | None) -> Frame:
    title = step.subgoal.text if step.subgoal else f"fold {step.index + 1}"
    title = f"again: {title}" if step.retry else title
    seen = step.observation.rgb
    return Frame(seen, step.scene, step.fold_line, step.action, title, step.in_words(), action_map_of(step), shown)


def action_map_of(step: Step) -> ActionMap | None:
    """Places to pick and the policy's values, asked for now; None where the policy has none."""
    try:
        return None if step.action_map is None else step.action_map()
    except PlanError:
        return None


def result_caption(episode: Episode) -> str:
    """How the episode came out, in one line."""
    if episode.failure is not None:
        return f"{episode.failure.stage}: {episode.failure.reason}"
    if episode.fidelity is None:
        return "nothing was folded"
    return episode.fidelity.in_words(episode.task)


@makes(Episode, "html")
def episode_html(episode: Episode) -> str:
    """The filmstrip, or a fold at a time in large, and the figures, as self-contained HTML without scripts."""
    strip = png(filmstrip_of(episode))
    labels = ["all", *(str(step.index + 1) for step in episode.steps), "result"]
    figures = [_figure(strip, episode.instruction, result_caption(episode))]
    before = [episode.initial_state, *(step.after for step in episode.steps)]
    for step, state in zip(episode.steps, before, strict=False):
        frame = _frame(step, shown(episode, state, LARGE))
        figures.append(_figure(png(_large(frame)), frame.title, f"{step.index + 1}. {frame.title}: {frame.caption}"))
    figures.append(_figure(png(result_of(episode)), "the result", result_caption(episode)))
    return stepper(labels, figures) if episode.steps else figures[0]


LARGE = 520
"""Side of a fold's own picture [px]."""


def _large(frame: Frame) -> NDArray[np.uint8]:
    zoom = LARGE / max(frame.rgb.shape[:2])
    return overlay(frame.rgb, frame.scene, frame.fold_line, frame.action, zoom=zoom, shown=frame.shown)


def _figure(content: bytes, alternative: str, caption: str) -> str:
    source = f"data:image/png;base64,{b64encode(content).decode()}"
    return (
        f'<figure style="margin:0"><img style="max-width:100%" src="{source}" alt="{escape(alternative)}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def stepper(labels: Sequence[str], figures: Sequence[str]) -> str:
    """Figures of which one is shown, and a row of buttons that choose it; without scripts, so that it stays in exports.

    Args:
        labels: of the buttons.
        figures: HTML, as many; the first is shown first. Where no style sheet is read all are shown.
    """
    # The same episode may be shown twice on a page: each copy answers to its own buttons.
    name = f"polyfold-{token_hex(6)}"
    buttons: list[str] = []
    style = [
        f".{name}>input{{position:absolute;opacity:0;pointer-events:none}}",
        f".{name}>figure{{display:none}}",
        f".{name}>label{{display:inline-block;padding:1px 10px;margin:0 3px 6px 0;cursor:pointer;"
        "border:1px solid rgba(128,128,128,.5);border-radius:3px}",
    ]
    for number, label in enumerate(labels):
        one = f"{name}-{number}"
        style.append(f"#{one}:checked~figure:nth-of-type({number + 1}){{display:block}}")
        style.append(
            f"#{one}:checked+label{{background:#009660;color:#fff}}#{one}:focus-visible+label{{outline:2px solid}}"
        )
        checked = " checked" if number == 0 else ""
        buttons.append(
            f'<input type="radio" name="{name}" id="{one}"{checked}><label for="{one}">{escape(label)}</label>'
        )
    return f'<div class="{name}"><style>{"".join(style)}</style>{"".join(buttons)}{"".join(figures)}</div>'
