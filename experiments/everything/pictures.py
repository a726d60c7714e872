"""Pictures of a study's results: what went wrong, and how much is borne."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from polyfold import viz
from polyfold.analysis import Results
from polyfold.analysis._columns import column_of

MOST = 9
DISTURBANCES = {
    "light": "light falls off by",
    "shadow": "shadows as dark as",
    "grain": "grain [grey levels]",
    "depth noise": "depth noise, times a D435i's",
    "pushed": "camera pushed by [mm]",
    "turned": "camera turned by [deg]",
}
"""What disturbs by more or less, and how its axis reads."""
CAUSES = ("infrastructure", "grounding", "subgoal", "fold line", "policy", "execution")
"""First causes of failures, from seeing to folding."""
AT_ZERO = {"depth noise": 1.0}
"""What an undisturbed cell counts as, where it is not 0."""


def failures(results: Results, folder: Path, variant: str = "polyfold") -> bytes:
    """The first failed garment of each sentence that was folded wrongly, as a PNG; refusals have nothing to show.

    Args:
        results: of a study whose failures were pictured.
        folder: its run directory.
        variant: whose failures.
    """
    failed = [r for r in results.of(variant) if not r.succeeded and r.failure is None and r.picture]
    first = {(record.task, record.wording): record for record in reversed(failed)}
    cards = []
    for record in [*first.values()][::-1][:MOST]:
        assert record.picture is not None
        with Image.open(folder / record.picture) as picture:
            strip = np.asarray(picture.convert("RGB"))
        ended = f"{record.cause}; quality {record.metrics['quality']:.0f}, IoU {record.metrics['miou']:.2f}"
        cards.append(viz.Card(_first_and_result(strip), record.instruction, ended))
    return viz.png(viz.score_sheet(cards, "Folded, but not what was asked for: the first fold, the end", columns=3))


def _first_and_result(strip: NDArray[np.uint8]) -> list[NDArray[np.uint8]]:
    """The square panels at both ends of a filmstrip, uint8, shape (H, W, 3)."""
    side = strip.shape[0]
    return [strip[:, :side], strip[:, -side:]]


def curves(results: Results) -> bytes:
    """Success against every disturbance that has levels, as a PNG; variants are named KIND LEVEL, SEGMENTER."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 5.6), layout="constrained")
    panels = figure.subplots(2, 3, sharey=True).ravel()
    for axes, (kind, label) in zip(panels, DISTURBANCES.items(), strict=True):
        for number, segmenter in enumerate(("colour", "photo")):
            points = _levels(results, kind, segmenter)
            if len(points) > 1:
                _curve(axes, results, points, segmenter, viz.PALETTE[number])
        axes.set_xlabel(label)
    for axes in panels[::3]:
        axes.set_ylabel("episodes [%]")
    panels[0].set_ylim(-3, 103)
    panels[0].legend(fontsize=8, loc="lower left")
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=110)
    return file.getvalue()


def causes(results: Results) -> bytes:
    """Where the failures of every variant come from, as a PNG: a bar of its first causes (the paper's Fig. 16)."""
    from matplotlib.figure import Figure

    variants = list(results.study.variants)
    figure = Figure(figsize=(8.0, 0.8 + 0.26 * len(variants)), layout="constrained")
    axes = figure.subplots()
    left = np.zeros(len(variants))
    for number, cause in enumerate(CAUSES):
        shares = [100.0 * np.mean([r.cause == cause for r in results.of(variant)]) for variant in variants]
        axes.barh(variants, shares, left=left, color=viz.PALETTE[number % len(viz.PALETTE)], label=cause)
        left += shares
    axes.invert_yaxis()
    axes.set_xlabel(f"failed episodes [%], by their first cause; n = {len(results.of(variants[0]))} each")
    axes.legend(fontsize=8)
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=110)
    return file.getvalue()


def _levels(results: Results, kind: str, segmenter: str) -> list[tuple[float, str]]:
    """Levels of a disturbance and their variants, the undisturbed cell first."""
    cell = "cell" if segmenter == "colour" else "cell, photo"
    found = [(AT_ZERO.get(kind, 0.0), cell)]
    for name in results.study.variants:
        what, _, told = name.partition(", ")
        disturbs, _, level = what.rpartition(" ")
        if disturbs == kind and (told or "colour") == segmenter:
            found.append((float(level), name))
    return sorted(found)


def _curve(axes: Any, results: Results, points: list[tuple[float, str]], segmenter: str, colour: str) -> None:
    """Success with its interval, and strict success dashed."""
    levels = [level for level, _ in points]
    for heading, style in (("success %", "-"), ("strict %", "--")):
        column = column_of(results.run, heading)
        found = [column.over(results.of(variant)) for _, variant in points]
        means = [value.mean for value in found]
        axes.plot(levels, means, style, color=colour, marker="o", markersize=3, label=f"{segmenter}, {heading[:-2]}")
        if style == "-":
            axes.fill_between(
                levels, [value.low for value in found], [value.high for value in found], color=colour, alpha=0.15, lw=0
            )
