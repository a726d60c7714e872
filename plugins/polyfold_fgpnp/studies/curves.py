"""How learning goes on and what more data gives (the paper's Figs. 10 and 8).

    python -m polyfold_fgpnp.studies.curves --help

First train, with ``snapshots`` in the TOML file, once per seed or data size; then let a study fold with every file of
weights; then draw. Paths in the study are those given here, relative to where one runs:

    polyfold train experiments/training/pair.toml --seed 1 --out runs/pair-s1
    python -m polyfold_fgpnp.studies.curves study runs/pair-s* > curve.toml
    polyfold evaluate curve.toml --out runs/curve
    python -m polyfold_fgpnp.studies.curves training runs/pair-s* --evaluation runs/curve --out training.png

    polyfold train experiments/training/pair.toml --folds 2500 --out runs/pair-2500
    python -m polyfold_fgpnp.studies.curves study --last --steps multi runs/pair-2500 runs/pair-s0 > sizes.toml
    polyfold evaluate sizes.toml --out runs/sizes
    python -m polyfold_fgpnp.studies.curves sizes runs/sizes --out sizes.png

Each drawing is a PNG, and a Markdown table on the standard output. ± is the standard deviation over trainings, with
n - 1; it says how much the seed matters and nothing about which garments were drawn. For that the tables have a 95 %
bootstrap interval over garments, whose episodes are kept together, of the score averaged over trainings. Of a study
that is not finished only the episodes count that all its variants have. Choosing an epoch by these curves and reporting
its success on the same garments would be tuning on them. With fewer folds as many epochs are fewer steps, and the last
tenth of the garments, which is held out, is another one: compare data sizes by what is evaluated, not by their logs.
Where nearly every fold succeeds, ``--score moved-part`` tells more apart.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import polyfold
from polyfold.errors import ConfigError, PolyfoldError
from polyfold_fgpnp.studies.curve_figures import sizes_figure, training_figure
from polyfold_fgpnp.studies.curve_tables import sizes_table, training_table
from polyfold_fgpnp.studies.scores import SUCCESS, Scores
from polyfold_fgpnp.studies.variants import few_tasks, study_of
from polyfold_fgpnp.training.runs import read_run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PROGRAM = "python -m polyfold_fgpnp.studies.curves"
SCORE_HELP = f"{SUCCESS}, or the name of a metric (default: {SUCCESS})"


def main(arguments: Sequence[str] | None = None) -> int:
    """Write a study, or draw; returns 1, with a message, if that can't be done."""
    options = _parser().parse_args(arguments)
    try:
        options.run(options)
    except PolyfoldError as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=PROGRAM, description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    verbs = parser.add_subparsers(required=True, metavar="VERB")
    study = verbs.add_parser("study", help="print a study, TOML, that folds with the weights of trainings")
    study.add_argument("runs", nargs="+", type=Path, metavar="RUN", help="folders of `polyfold train`")
    study.add_argument("--last", action="store_true", help="only the last weights of each, not its snapshots")
    study.add_argument("--name", default="curve", help="of the study (default: curve)")
    study.add_argument("--tasks-per-kind", type=int, default=5, metavar="N", help="default: 5")
    study.add_argument("--steps", choices=["single", "multi"], help="only tasks of one fold, or of several")
    study.add_argument("--garments", type=int, default=3, metavar="N", help="per kind (default: 3)")
    study.add_argument("--first-seed", type=int, default=0, metavar="SEED", help="of the garments (default: 0)")
    study.set_defaults(run=_print_study)
    training = verbs.add_parser("training", help="loss, rank correlation and success over epochs (Fig. 10)")
    training.add_argument("runs", nargs="+", type=Path, metavar="RUN", help="folders of `polyfold train`, one per seed")
    training.add_argument("--evaluation", type=Path, metavar="DIR", help="run directory of the study")
    training.add_argument("--out", type=Path, default=Path("training.png"), metavar="PNG", help="default: training.png")
    training.set_defaults(run=_draw_training)
    training.add_argument("--score", default=SUCCESS, metavar="NAME", help=SCORE_HELP)
    sizes = verbs.add_parser("sizes", help="success by data size (Fig. 8)")
    sizes.add_argument("evaluation", type=Path, metavar="DIR", help="run directory of the study")
    sizes.add_argument("--out", type=Path, default=Path("sizes.png"), metavar="PNG", help="default: sizes.png")
    sizes.set_defaults(run=_draw_sizes)
    sizes.add_argument("--score", default=SUCCESS, metavar="NAME", help=SCORE_HELP)
    return parser


def _print_study(options: argparse.Namespace) -> None:
    import tomli_w

    if options.tasks_per_kind < 1:
        raise ConfigError(f"--tasks-per-kind {options.tasks_per_kind} leaves no task; give 1 or more")
    tasks = few_tasks(options.tasks_per_kind, options.steps)
    runs = [read_run(path) for path in options.runs]
    study = study_of(runs, options.name, tasks, options.garments, options.first_seed, options.last)
    print(
        f"# By `{PROGRAM} study`: of each kind's tasks, sorted by id, those in the middle of {options.tasks_per_kind}"
    )
    print("# equal parts. Paths are relative to where one runs.")
    print(tomli_w.dumps(study), end="")


def _draw_training(options: argparse.Namespace) -> None:
    runs = [read_run(path) for path in options.runs]
    found = None if options.evaluation is None else Scores(polyfold.open(options.evaluation), options.score)
    _save(training_figure(runs, found), options.out)
    print(training_table(runs, found).markdown())


def _draw_sizes(options: argparse.Namespace) -> None:
    found = Scores(polyfold.open(options.evaluation), options.score)
    _save(sizes_figure(found), options.out)
    print(sizes_table(found).markdown())


def _save(figure: Figure, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    raise SystemExit(main())
