"""``polyfold train``: learn a value network from random folds."""

from __future__ import annotations

import argparse
from pathlib import Path


class Train:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        parser.add_argument("config", type=Path, help="TOML, for example experiments/training/pair.toml")
        parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; resumed if it exists")
        parser.add_argument("--device", choices=["auto", "cpu", "cuda"], default="auto", help="default: auto")
        parser.add_argument("--data", metavar="DIR", action="append", help="data set instead of the file's; repeatable")
        parser.add_argument("--epochs", type="count", metavar="N", help="passes over the data, instead of the file's")
        parser.add_argument("--seed", type="seed", metavar="N", help="instead of the file's")
        parser.add_argument(
            "--folds", type="count", metavar="N", help="first folds of each data set, instead of the file's"
        )

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Train what is missing and say where the weights are."""
        from polyfold_fgpnp.training.config import read_config
        from polyfold_fgpnp.training.training import train

        changes = {name: getattr(arguments, name) for name in ("data", "epochs", "seed", "folds")}
        config = read_config(arguments.config, **changes)
        try:
            weights = train(config, arguments.out, arguments.device)
        except KeyboardInterrupt:
            print(f"interrupted; run the same command to go on from the last epoch in {arguments.out}")
            raise
        print(f"weights: {weights}")
        return 0
