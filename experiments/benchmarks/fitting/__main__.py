"""Measure how well polygons are fitted.

    python -m experiments.benchmarks.fitting [--kind tshirt] [--n 200] [--folds | --creases] [--data DIR --real]

Without a switch, camera images of simulated flat garments at any rotation. ``--folds`` follows them through the folds
of the standard tasks, each drawn on the true garment and executed by a policy. ``--creases`` compares the lines of the
sleeves' folds on the fit with those on the true garment. ``--data DIR --real`` fits outlines of
real garments and compares with hand-annotated keypoints. Seconds are CPU time of one grounding.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from experiments.benchmarks.fitting.creases import CreaseResult, measure_creases
from experiments.benchmarks.fitting.real import DATASETS, measure_real
from experiments.benchmarks.fitting.simulated import FlatResult, FoldResult, measure_flat, measure_folds
from polyfold import plugins
from polyfold.plugins.interfaces import Grounding

KINDS = ("square", "rectangle", "tshirt", "pants")

FAR = 25.0
"""A vertex this far off [px] is wrong."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print markdown tables."""
    description = "Measure how well polygons are fitted."
    parser = argparse.ArgumentParser(prog="experiments.benchmarks.fitting", description=description)
    parser.add_argument("--kind", nargs="*", default=None, help="garment kinds (default: all)")
    parser.add_argument("--n", type=int, default=200, help="garments of each kind (default: 200)")
    parser.add_argument("--first-seed", type=int, default=5000, help="seed of the first garment (default: 5000)")
    parser.add_argument("--folds", action="store_true", help="follow garments through folds")
    parser.add_argument(
        "--creases", action="store_true", help="compare fold lines through vertices (t-shirts' sleeves)"
    )
    parser.add_argument(
        "--policy", default="affordance-pair", help="policy that executes the folds (default: affordance-pair)"
    )
    parser.add_argument("--real", action="store_true", help="fit real outlines; needs --data")
    parser.add_argument("--data", type=Path, help="folder with the outlines, one JSON object a line")
    parser.add_argument("--rows", choices=["even", "odd", "all"], default="odd", help="rows of the real data")
    parser.add_argument("--optimizer", choices=["lm", "pattern"], default="lm", help="optimizer of the grounding")
    options = parser.parse_args(arguments)
    if options.real and options.data is None:
        parser.error("--real needs --data DIR, the folder with *-train.jsonl")
    grounding = plugins.create("groundings", "polygon", {"optimizer": options.optimizer})
    seeds = range(options.first_seed, options.first_seed + options.n)
    if options.real:
        _print_real(options.data, options.kind or list(DATASETS), options.rows, grounding)
    elif options.creases:
        print("\n| fold line | n | median [deg] | p90 [deg] | median with one fitted end [deg] |")
        print("|---|---|---|---|---|")
        for kind in options.kind or ["tshirt"]:
            _print_creases(measure_creases(kind, seeds, grounding))
    elif options.folds:
        print("\n| garment | folds | n | median [px] | p90 [px] | mean > 25 px | CPU median [s] | CPU max [s] |")
        print("|---|---|---|---|---|---|---|---|")
        for kind in options.kind or KINDS:
            _print_folds(kind, measure_folds(kind, seeds, grounding, options.policy))
    else:
        print("\n| garment | n | wrong orientation | median [px] | p90 [px] | vertex > 25 px off | CPU [s] | max |")
        print("|---|---|---|---|---|---|---|---|")
        for kind in options.kind or KINDS:
            _print_flat(kind, measure_flat(kind, seeds, grounding))


def _print_flat(kind: str, results: list[FlatResult]) -> None:
    means = np.array([result.errors.mean() for result in results])
    wrong = np.mean([result.turned for result in results])
    far = np.mean([result.errors.max() > FAR for result in results])
    seconds = [result.seconds for result in results]
    print(
        f"| {kind} | {len(results)} | {wrong:.1%} | {np.median(means):.1f} | {np.percentile(means, 90):.1f} | "
        f"{far:.1%} | {np.median(seconds):.3f} | {max(seconds):.3f} |",
        flush=True,
    )


def _print_folds(kind: str, results: list[FoldResult]) -> None:
    for folds in sorted({result.folds for result in results}):
        chosen = [result for result in results if result.folds == folds]
        errors, seconds = [r.error for r in chosen], [r.seconds for r in chosen]
        print(
            f"| {kind} | {folds} | {len(chosen)} | {np.median(errors):.1f} | {np.percentile(errors, 90):.1f} | "
            f"{np.mean(np.array(errors) > FAR):.1%} | {np.median(seconds):.3f} | {max(seconds):.3f} |",
            flush=True,
        )


def _print_creases(results: list[CreaseResult]) -> None:
    for task in dict.fromkeys(result.task for result in results):
        chosen = [result for result in results if result.task == task]
        turns = [result.turn for result in chosen]
        blame = [f"{name} {np.median([r.blame[name] for r in chosen]):.1f}" for name in chosen[0].blame]
        print(
            f"| {task} | {len(chosen)} | {np.median(turns):.1f} | {np.percentile(turns, 90):.1f} | "
            f"{', '.join(blame)} |",
            flush=True,
        )


def _print_real(data: Path, kinds: Sequence[str], rows: str, grounding: Grounding) -> None:
    print(f"\n| garment | rows | n | median [px] | p90 [px] | mean > {FAR:.0f} px | CPU median [s] | CPU max [s] |")
    print("|---|---|---|---|---|---|---|---|")
    for kind in kinds:
        results = measure_real(kind, data, rows, grounding)
        means, seconds = [r.errors.mean() for r in results], [r.seconds for r in results]
        print(
            f"| {kind} | {rows} | {len(results)} | {np.median(means):.1f} | {np.percentile(means, 90):.1f} | "
            f"{np.mean(np.array(means) > FAR):.1%} | {np.median(seconds):.3f} | {max(seconds):.3f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
