"""How many wishes are reached on the ideal cloth: ``python -m experiments.benchmarks.language.wishes FILE.toml``.

A wish names a result and no way; its entry says what counts as done, as the suite ``ambiguous`` does, which is measured
without a file. Every sentence is planned by a planner and a language model on one seeded garment, lying within 20
degrees of upright, and folded ideally, without physics or camera.
"""

from __future__ import annotations

import argparse
import tomllib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.language.understanding import accepted, laid_garment, plan_ideally
from polyfold.errors import RefusedError
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins import create, find
from polyfold.plugins.interfaces import Planner
from polyfold.polygon import FoldedModel
from polyfold.tasks import OpenTask, Suite, load_suite
from polyfold.tasks._goals import measure

GARMENT = 2001
"""The seed of the garments."""


def outcome(goal: OpenTask, suite: Suite, planner: Planner, llm: Any) -> tuple[str, str]:
    """What became of a wish, ``reached``, ``missed`` or ``refused``, and why in words."""
    laid = laid_garment(goal.garment, GARMENT)
    try:
        lines = plan_ideally(goal.text, laid, planner, llm)
    except RefusedError as error:
        return "refused", str(error)
    if goal.accept and accepted(laid, lines, goal.accept, suite, unordered=False):
        return "reached", ""
    end = laid.model
    for line in lines:
        end = end.fold(line)
    measured = measure(_silhouette(end, laid.size), _silhouette(laid.model, laid.size), len(lines))
    failing = () if goal.done is None else goal.done.failing(measured)
    if goal.done is not None and not failing:
        return "reached", ""
    return "missed", f"{len(lines)} folds, area {measured.area:.2f}: {', '.join(map(str, failing)) or 'another task'}"


def _silhouette(model: FoldedModel, size: tuple[int, int]) -> NDArray[np.bool_]:
    return np.any([fill_polygon(facet.polygon, size[1], size[0]) for facet in model.facets()], axis=0)


def main(arguments: Sequence[str] | None = None) -> None:
    """Judge the wishes of a file and print a Markdown table and what was not reached."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.language.wishes", description=__doc__)
    parser.add_argument("file", nargs="?", type=Path, help="TOML with [[goal]]; default: the suite ambiguous")
    parser.add_argument("--planner", default="hierarchical")
    parser.add_argument("--llm", default="offline")
    parser.add_argument("--brief", action="store_true", help="do not list what was not reached")
    options = parser.parse_args(arguments)
    goals = _goals(options.file)
    suite = load_suite(str(find("tasks", "polyfold70").target))
    planner, llm = create("planners", options.planner), create("llms", options.llm)
    found = [(goal, *outcome(goal, suite, planner, llm)) for goal in goals]
    print("| garment | n | reached | missed | refused |\n|---|---|---|---|---|")
    for kind in [*dict.fromkeys(goal.garment for goal in goals), "all"]:
        counts = Counter(verdict for goal, verdict, _ in found if kind in (goal.garment, "all"))
        shares = (
            f"{counts[verdict]} ({counts[verdict] / counts.total():.1%})"
            for verdict in ("reached", "missed", "refused")
        )
        print(f"| {kind} | {counts.total()} | {' | '.join(shares)} |")
    for goal, verdict, why in found:
        if verdict != "reached" and not options.brief:
            print(f"\n- {goal.garment}: “{goal.text}”\n  {verdict}: {why}")


def _goals(file: Path | None) -> list[OpenTask]:
    if file is None:
        return list(load_suite(str(find("tasks", "ambiguous").target)).goals)
    return [OpenTask(**goal) for goal in tomllib.loads(file.read_text("utf-8"))["goal"]]


if __name__ == "__main__":
    main()
