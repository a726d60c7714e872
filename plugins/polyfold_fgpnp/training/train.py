"""``polyfold train``: learn a value network from random folds."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from polyfold.config import read_toml
from polyfold.errors import ConfigError

if TYPE_CHECKING:
    from polyfold_fgpnp.training.training import TrainingConfig


class Train:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        parser.add_argument("config", type=Path, help="TOML, for example experiments/training/pair.toml")
        parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; resumed if it exists")
        parser.add_argument("--device", choices=["auto", "cpu", "cuda"], default="auto", help="default: auto")
        parser.add_argument("--data", metavar="DIR", action="append", help="data set instead of the file's; repeatable")
        parser.add_argument("--seed", type=int, metavar="N", help="instead of the file's")
        parser.add_argument(
            "--folds", type=int, metavar="N", help="first folds of each data set, instead of the file's"
        )

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Train what is missing and say where the weights are."""
        changes = {name: getattr(arguments, name) for name in ("data", "seed", "folds")}
        config = read_config(arguments.config, **changes)
        from polyfold_fgpnp.training.training import train

        try:
            weights = train(config, arguments.out, arguments.device)
        except KeyboardInterrupt:
            print(f"interrupted; run the same command to go on from the last epoch in {arguments.out}")
            raise
        print(f"weights: {weights}")
        return 0


def read_config(path: str | Path, **changes: object) -> TrainingConfig:
    """A training configuration from TOML, with some values replaced where they are not None.

    Raises:
        ConfigError: naming the field that is wrong.
    """
    from pydantic import ValidationError

    from polyfold_fgpnp.training.training import TrainingConfig

    content = {**read_toml(path), **{name: value for name, value in changes.items() if value is not None}}
    try:
        return TrainingConfig(**content)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        what = f"a bad value for {where!r}" if where else "values that don't go together"
        raise ConfigError(f"{path} has {what}: {first['msg']}; correct it") from error
