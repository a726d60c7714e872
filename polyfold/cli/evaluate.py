"""``polyfold evaluate``: run a study, resumable and in parallel."""

from __future__ import annotations

import argparse
from pathlib import Path

import polyfold
from polyfold.studies import Study
from polyfold.studies._cell import PICTURES
from polyfold.studies._study import made_of, with_variants

EPILOG = (
    "A study is a TOML file: name, suite, tasks, garments, first_seed, instructions, edge_length, sizes, split, steps, "
    "reference, criteria, metrics, published, seed, [base] for what all variants share, [variants.NAME] for what tells "
    "each from the others, factors. All but the name may be left out; what each means: "
    "python -c 'import polyfold; help(polyfold.Study)', or docs/studies.md."
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.epilog = EPILOG
    parser.add_argument("config", type=Path, help="study, for example experiments/smoke.toml")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="run directory; resumed if it exists")
    parser.add_argument(
        "--workers", type="count", default=1, metavar="N", help="processes on this machine (default: 1)"
    )
    parser.add_argument("--engine", choices=["local", "dask"], default="local", help="dask: a cluster")
    parser.add_argument("--address", metavar="URL", help="of the Dask scheduler (default: start one here)")
    parser.add_argument(
        "--pictures",
        choices=PICTURES,
        default="failed",
        help="small pictures for the report; failed (default) has the first episode of each task too",
    )
    parser.add_argument(
        "--accept-change",
        action="store_true",
        help="go on with a run although code, prompts or weights have changed since; the run records it",
    )
    parser.add_argument("--garments", type="count", metavar="N", help="garments per kind instead of the study's")
    parser.add_argument("--fabric", metavar="NAME", help="what garments are made of where the variant names none")
    parser.add_argument("--variants", nargs="+", metavar="NAME", help="only these of the study's variants")


def run(arguments: argparse.Namespace) -> int:
    """Run what is missing and print the table."""
    study = polyfold.load(arguments.config)
    if arguments.garments is not None:
        study = Study(**{**study.model_dump(), "garments": arguments.garments})
    if arguments.fabric is not None:
        study = made_of(study, arguments.fabric)
    if arguments.variants is not None:
        study = with_variants(study, arguments.variants)
    try:
        results = polyfold.run(
            study,
            arguments.out,
            arguments.workers,
            arguments.engine,
            arguments.address,
            pictures=arguments.pictures,
            accept_change=arguments.accept_change,
        )
    except KeyboardInterrupt:
        print(f"interrupted; what is finished is in {arguments.out}, run the same command to go on")
        raise
    print(polyfold.table(results))
    return 0
