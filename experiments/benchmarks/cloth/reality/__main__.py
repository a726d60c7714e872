"""Run the tests that were asked for and print a Markdown table: ``python -m experiments.benchmarks.cloth.reality``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeVar

from experiments.benchmarks.cloth.reality.bench import FABRICS, fabric_named
from experiments.benchmarks.cloth.reality.cantilever import cantilever_rows
from experiments.benchmarks.cloth.reality.convergence import convergence_rows
from experiments.benchmarks.cloth.reality.drape import drape_rows
from experiments.benchmarks.cloth.reality.heart_loop import heart_loop_rows
from experiments.benchmarks.cloth.reality.penetration import penetration_rows
from experiments.benchmarks.cloth.reality.rows import Row, Test
from experiments.benchmarks.cloth.reality.stack import stack_rows
from experiments.benchmarks.cloth.reality.strip_fold import strip_fold_rows
from experiments.benchmarks.cloth.rgbench.published import published_rows
from polyfold.errors import PolyfoldError
from polyfold.garments import Fabric

Chosen = TypeVar("Chosen")

TESTS: dict[str, Test] = {
    "cantilever": cantilever_rows,
    "loop": heart_loop_rows,
    "drape": drape_rows,
    "stack": stack_rows,
    "strip": strip_fold_rows,
    "convergence": convergence_rows,
    "penetration": penetration_rows,
    "rgbench": published_rows,
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one row per figure, published beside ours."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cloth.reality", description=__doc__)
    parser.add_argument("--fabric", default="poplin", help=f"of {', '.join(FABRICS)}; several with commas")
    parser.add_argument("--only", default=",".join(TESTS), help="tests, with commas (default: all: %(default)s)")
    parser.add_argument("--edge-length", type=float, default=0.0125, help="of the meshes [m] (default: 0.0125)")
    options = parser.parse_args(arguments)
    known = {name: name for name in FABRICS}
    fabrics = [fabric_named(_chosen(parser, known, name)) for name in options.fabric.split(",")]
    tests = [(name, _chosen(parser, TESTS, name)) for name in options.only.split(",")]
    print("| test | fabric | quantity | published | ours | n |\n|---|---|---|---|---|---|")
    printed: set[Row] = set()
    for name, test in tests:
        for fabric in fabrics:
            for row in _timed(name, test, fabric, options.edge_length):
                if row not in printed:  # some don't depend on the fabric
                    print(f"| {row.test} | {row.fabric} | {row.quantity} | {row.published} | {row.ours} | {row.n} |")
                printed.add(row)


def _chosen(parser: argparse.ArgumentParser, offered: Mapping[str, Chosen], name: str) -> Chosen:
    if name not in offered:
        parser.error(f"there is no {name!r}; choose from {', '.join(offered)}")
    return offered[name]


def _timed(name: str, test: Test, fabric: Fabric, edge_length: float) -> Iterator[Row]:
    started = time.process_time()
    try:
        yield from test(fabric, edge_length)
    except PolyfoldError as error:
        yield Row(name, fabric.name, "all", "", f"failed: {error}", "")
    print(f"{name}, {fabric.name}: {time.process_time() - started:.1f} s", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
