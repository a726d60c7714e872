"""``polyfold report``: an evaluation as one HTML page."""

from __future__ import annotations

import argparse
from pathlib import Path

__all__ = ["configure", "run"]


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument(
        "run_directory", type=Path, metavar="DIR", help="run directory of an evaluation, finished or not"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="the page (default: DIR/report.html)")
    parser.add_argument(
        "--noise-floor",
        type=float,
        metavar="POINTS",
        help="how far repeated runs of one variant differ in success, in percentage points; a footnote",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the page and say where it is."""
    from polyfold.report import write_report

    path = write_report(arguments.run_directory, arguments.out, arguments.noise_floor)
    print(f"{path} ({path.stat().st_size / 1e6:.1f} MB)")
    return 0
