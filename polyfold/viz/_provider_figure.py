"""Language models side by side, as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from polyfold.analysis import Estimate, Results
from polyfold.viz._plots import PALETTE, error_bar

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
from polyfold.analysis._providers import MEASURES, is_free, measured
from polyfold.logs import StudyEpisodeRecord

PANELS: Sequence[tuple[str, Sequence[str]]] = (
    ("success %", ("success %",)),
    ("valid answers %", ("valid at once %", "valid after repair %")),
    ("failures %", ("subgoal failures %", "fold-line failures %")),
    ("latency [s/call]", ("latency [s/call]",)),
    ("tokens per episode", ("tokens in", "tokens out")),
    ("cost per episode [US$]", ("cost [US$]",)),
)
"""Panels of the figure, each with the measures that it shows."""


def provider_figure(results: Results) -> Figure:
    """The table as a picture: a panel a measure, a row a model, bars with 95 % intervals.

    Returns:
        A matplotlib figure. Unknown values are a dash.
    """
    from matplotlib.figure import Figure

    models = [variant for variant in results.study.variants if results.of(variant)]
    figure = Figure(figsize=(2.0 + 1.9 * len(PANELS), 1.2 + 0.42 * len(models)), layout="constrained")
    panels = figure.subplots(1, len(PANELS), sharey=True)
    for axes, (title, measures) in zip(panels, PANELS, strict=True):
        for place, measure in enumerate(measures):
            _draw(axes, results, models, measure, place, len(measures))
        _dress(axes, title, measures)
    panels[0].set_yticks(range(len(models)), models)
    panels[0].invert_yaxis()
    return figure


def _draw(axes: Axes, results: Results, models: Sequence[str], measure: str, place: int, of: int) -> None:
    """The bars of one measure; ``place`` of ``of`` that share each model's row."""
    height = 0.8 / of
    for row, model in enumerate(models):
        records = results.of(model)
        found = measured(records, measure)
        at = row + (place - (of - 1) / 2) * height
        known = found.n > 0
        if known:
            span = [[error_bar(found.mean - found.low)], [error_bar(found.high - found.mean)]]
            axes.barh(at, found.mean, 0.9 * height, xerr=span, color=PALETTE[place], capsize=2, error_kw={"lw": 1})
        text = _value(records, measure, found) if known else "–"
        axes.annotate(
            text,
            (found.high if known else 0.0, at),
            (4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8 if of == 1 else 6,
            annotation_clip=False,  # 0 lies on the edge
        )


def _value(records: Sequence[StudyEpisodeRecord], measure: str, found: Estimate) -> str:
    if measure.startswith("cost") and is_free(records):
        return "free"
    return f"{found.mean:.{MEASURES[measure].digits}f}"


def _dress(axes: Axes, title: str, measures: Sequence[str]) -> None:
    from matplotlib.patches import Patch

    axes.set_title(title, fontsize=9)
    axes.tick_params(labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    # Room for the figures beside the bars. Failures are few: their panel ends where they do.
    whole = "%" in title and title != "failures %"
    axes.set_xlim(0, 130 if whole else 1.4 * axes.get_xlim()[1])
    axes.set_xticks([0, 50, 100]) if whole else axes.locator_params(axis="x", nbins=3)
    if len(measures) > 1:
        # The bars below one another, named in their order.
        keys = [Patch(color=PALETTE[place], label=name.removesuffix(" %")) for place, name in enumerate(measures)]
        axes.legend(
            handles=keys, frameon=False, fontsize=7, loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=3
        )
