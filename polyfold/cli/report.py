"""``polyfold report``: an evaluation as one HTML page."""

from __future__ import annotations

import argparse
from pathlib import Path

import polyfold


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument(
        "run_directory", type=Path, metavar="DIR", help="run directory of an evaluation, finished or not"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="the page (default: DIR/report.html)")
    parser.add_argument(
        "--noise-floor",
        type=Path,
        metavar="DIR",
        help="run directory of experiments/noise_floor.toml; a footnote to the comparisons",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the page and say where it is."""
    from polyfold.viz._report import write_report

    noise = None if arguments.noise_floor is None else polyfold.open(arguments.noise_floor)
    path = write_report(arguments.run_directory, arguments.out, noise)
    print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
    return 0
