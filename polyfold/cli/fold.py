"""``polyfold fold``: the main job, from a sentence to a folded garment and its pictures."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import polyfold
from polyfold.cli._options.components import add_component_options, experiment_from
from polyfold.cli._options.garment_source import add_source_options, garment_from

if TYPE_CHECKING:
    from polyfold.types import EpisodeStart, Fidelity, Step


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("instruction", help='what to do, for example "fold the t-shirt into a rectangular block"')
    add_source_options(parser)
    parser.add_argument("--task", help="judge against this standard task (polyfold70), for example tshirt-half-hem")
    parser.add_argument("--out", type=Path, metavar="DIR", help="where to leave episode.json and the pictures")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of the progress")
    add_component_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Fold, show what happens as it happens, and save the result."""
    experiment = experiment_from(arguments)
    garment = garment_from(arguments, experiment)
    episode = polyfold.fold(
        arguments.instruction,
        garment,
        seed=arguments.seed,
        task=arguments.task,
        out=arguments.out,
        experiment=experiment,
        observer=None if arguments.json else Printer(),
    )
    if arguments.json:
        print(json.dumps({**episode.summary(), "out": str(arguments.out) if arguments.out else None}))
    else:
        _print_result(episode, arguments.out)
    return 0


class Printer:
    """Prints an episode as it happens."""

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Print the sentence and what it was split into."""
        print(f"{start.garment.name}: {start.instruction}")
        for number, subgoal in enumerate(start.subgoals, 1):
            print(f"  {number}. {subgoal.text}")
        self._flush(f"  planned in {start.seconds:.2f} s")

    def on_step(self, step: Step) -> None:
        """Print where was folded, and how long each stage took."""
        line = step.fold_line
        where = (
            f"line ({line.start[0]:.0f}, {line.start[1]:.0f}) -> ({line.end[0]:.0f}, {line.end[1]:.0f})" if line else ""
        )
        times = ", ".join(f"{stage} {seconds:.2f} s" for stage, seconds in step.seconds.items())
        number = f"{step.index + 1} (again)" if step.retry else f"{step.index + 1}"
        self._flush(f"  fold {number}: {where}, {step.in_words()}; {times}")

    def _flush(self, line: str) -> None:
        print(line)
        sys.stdout.flush()


def _how_to_name(fidelity: Fidelity) -> str:
    return "" if fidelity.vouched else " (--task)"


def _print_result(episode: polyfold.Episode, out: Path | None) -> None:
    if episode.fidelity is not None:
        print(f"  result: {episode.fidelity.in_words(episode.task)}{_how_to_name(episode.fidelity)}")
    if out is not None:
        moving = f", {out / 'fold.gif'}" if (out / "fold.gif").exists() else ""
        print(f"  pictures: {out / 'filmstrip.png'}{moving}")
    else:
        print("  pictures: none; --out DIR leaves some")
