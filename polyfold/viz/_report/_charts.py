"""Charts as inline SVG: no script, no fonts, no inline styles; colours are classes that follow light and dark.

Rows of bars and dots use percentages, so that they stretch while their text keeps its size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from polyfold.analysis import Estimate
from polyfold.viz._report._curves import SCALES, Curve

COLOURS = 8
"""Colours of series in the style sheet; further series repeat them with another dash."""

WIDTH, HEIGHT = 352, 236
LEFT, RIGHT, TOP, BOTTOM = 30, 104, 10, 30
LONGEST_NAME = 12
LABEL_STEP = 14.0
TICKS = (0, 25, 50, 75, 100)
DASHES = ("", "6 3", "2 3", "8 3 2 3", "1 4")


@dataclass(frozen=True)
class Part:
    """A piece of a bar.

    Attributes:
        colour: index of its colour; None for the quiet remainder.
        value: its length, in the unit of the bar.
        label: what is written into it where it is long enough.
        title: what it is, shown on hover.
    """

    colour: int | None
    value: float
    label: str
    title: str


def dot(value: Estimate, colour: int) -> Markup:
    """A mean and its interval on an axis from 0 to 100 %; see :func:`percent_axis`."""
    ticks = Markup("").join(
        Markup('<line class="tick" x1="{0}" x2="{0}" y1="0" y2="24"/>').format(_across(at)) for at in TICKS
    )
    mark = Markup(
        '<line class="whisker s{colour}" x1="{low}" x2="{high}" y1="12" y2="12"/>'
        '<circle class="dot s{colour}" cx="{mean}" cy="12" r="4.5"/>'
    ).format(colour=colour % COLOURS, low=_across(value.low), high=_across(value.high), mean=_across(value.mean))
    return Markup('<svg class="track" height="24" aria-hidden="true" focusable="false">{}{}</svg>').format(ticks, mark)


def percent_axis() -> Markup:
    """The figures below rows of :func:`dot`."""
    figures = Markup("").join(
        Markup('<text class="axis mid" x="{}" y="14">{}</text>').format(_across(at), at) for at in TICKS[::2]
    )
    return Markup('<svg class="track" height="18" aria-hidden="true" focusable="false">{}</svg>').format(figures)


def _across(percent: float) -> str:
    """A place on the axis, set in a little so that dots at its ends are whole."""
    return f"{3 + 0.94 * min(max(percent, 0.0), 100.0):.2f}%"


def bar(parts: Sequence[Part], whole: float) -> Markup:
    """Parts side by side; ``whole`` is the length that fills the width."""
    pieces, at = [], 0.0
    for part in parts:
        share = 100.0 * part.value / whole if whole > 0 else 0.0
        if share > 0:
            pieces.append(_piece(part, at, share))
        at += share
    return Markup('<svg class="track" height="24" role="img" aria-label="{}">{}</svg>').format(
        ", ".join(part.title for part in parts if part.value > 0), Markup("").join(pieces)
    )


def _piece(part: Part, at: float, share: float) -> Markup:
    look = "rest" if part.colour is None else f"s{part.colour % COLOURS}"
    room = 2.2 * len(part.label) + 2.0
    label = Markup('<text class="in {}" x="{:.2f}%" y="16.5">{}</text>').format(look, at + share / 2, part.label)
    return Markup('<g><title>{}</title><rect class="{}" x="{:.2f}%" y="1" width="{:.2f}%" height="22"/>{}</g>').format(
        part.title, look, at, share, label if share > room else ""
    )


def curve_panel(heading: str, curves: Sequence[tuple[str, Curve]], bands: bool) -> Markup:
    """Success over the scale of the thresholds, one line per variant with its name at its end.

    Args:
        heading: what the panel is called by screen readers.
        curves: name and curve of each variant that has episodes, in the order of their colours; empty ones are skipped.
        bands: whether to shade the intervals.
    """
    drawn = [(index, name, curve) for index, (name, curve) in enumerate(curves) if curve.n]
    shades = Markup("").join(_band(index, curve) for index, _, curve in drawn) if bands else Markup("")
    lines = Markup("").join(_line(index, name, curve) for index, name, curve in reversed(drawn))
    labels = Markup("").join(_labels(drawn))
    said = "; ".join(f"{name} {100 * curve.shares[_at_one()]:.0f} % at 1×" for _, name, curve in drawn)
    return Markup(
        '<svg class="panel" viewBox="0 0 {} {}" role="img" aria-label="Success over thresholds, {}: {}">{}{}{}{}</svg>'
    ).format(WIDTH, HEIGHT, heading, said, _axes(), shades, lines, labels)


def _at_one() -> int:
    return min(range(len(SCALES)), key=lambda index: abs(SCALES[index] - 1.0))


def _x(scale: float) -> float:
    return LEFT + (scale - SCALES[0]) / (SCALES[-1] - SCALES[0]) * (WIDTH - LEFT - RIGHT)


def _y(share: float) -> float:
    return TOP + (1.0 - share) * (HEIGHT - TOP - BOTTOM)


def _axes() -> Markup:
    rows = [
        Markup(
            '<line class="grid" x1="{}" x2="{}" y1="{y:.1f}" y2="{y:.1f}"/>'
            '<text class="axis end" x="{}" y="{t:.1f}">{}</text>'
        ).format(LEFT, WIDTH - RIGHT, LEFT - 6, percent, y=_y(percent / 100), t=_y(percent / 100) + 4)
        for percent in TICKS
    ]
    columns = [
        Markup('<text class="axis mid" x="{:.1f}" y="{}">{}</text>').format(_x(scale), HEIGHT - BOTTOM + 17, label)
        for scale, label in ((0.25, "¼×"), (0.5, "½×"), (1.0, "1×"), (1.5, "1½×"), (2.0, "2×"))
    ]
    preset = Markup('<line class="preset" x1="{x:.1f}" x2="{x:.1f}" y1="{}" y2="{}"/>').format(
        TOP, HEIGHT - BOTTOM, x=_x(1.0)
    )
    return Markup("").join([*rows, *columns, preset])


def _points(values: Sequence[float], backwards: bool = False) -> str:
    points = [f"{_x(scale):.1f},{_y(value):.1f}" for scale, value in zip(SCALES, values, strict=True)]
    return " ".join(reversed(points) if backwards else points)


def _band(index: int, curve: Curve) -> Markup:
    return Markup('<polygon class="band s{}" points="{} {}"/>').format(
        index % COLOURS, _points(curve.high), _points(curve.low, backwards=True)
    )


def _line(index: int, name: str, curve: Curve) -> Markup:
    dashes = DASHES[min(index, len(DASHES) - 1)] if index < COLOURS else DASHES[1 + index % (len(DASHES) - 1)]
    return Markup('<g><title>{}</title><polyline class="curve s{}{}" points="{}"{}/></g>').format(
        name,
        index % COLOURS,
        " first" if index == 0 else "",
        _points(curve.shares),
        Markup(' stroke-dasharray="{}"').format(dashes) if dashes else "",
    )


def _labels(drawn: Sequence[tuple[int, str, Curve]]) -> list[Markup]:
    """Names at the lines' ends, moved apart where they would overlap and joined to their line."""
    order = sorted(drawn, key=lambda item: -item[2].shares[-1])
    places = _apart([_y(curve.shares[-1]) for _, _, curve in order])
    end = WIDTH - RIGHT
    return [
        Markup(
            '<line class="lead s{c}" x1="{x1}" y1="{y:.1f}" x2="{x2}" y2="{at:.1f}"/>'
            '<text class="name s{c}" x="{tx}" y="{ty:.1f}"><title>{full}</title>{short}</text>'
        ).format(
            c=index % COLOURS,
            x1=end + 1,
            x2=end + 9,
            y=_y(curve.shares[-1]),
            at=at,
            tx=end + 12,
            ty=at + 4,
            full=name,
            short=name if len(name) <= LONGEST_NAME else name[: LONGEST_NAME - 1] + "…",
        )
        for (index, name, curve), at in zip(order, places, strict=True)
    ]


def _apart(wanted: Sequence[float]) -> list[float]:
    """Heights near the wanted ones, ascending, at least a step from each other and inside the panel."""
    step = min(LABEL_STEP, (HEIGHT - TOP) / max(len(wanted), 1))
    placed: list[float] = []
    for height in wanted:
        placed.append(max(height, placed[-1] + step) if placed else height)
    limit = HEIGHT - BOTTOM - 2.0
    for index in reversed(range(len(placed))):
        placed[index] = min(placed[index], limit)
        limit = placed[index] - step
    return placed
