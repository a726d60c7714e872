"""``polyfold fit``: train a baseline from demonstrations."""

from __future__ import annotations

import argparse
from pathlib import Path

from polyfold.errors import ConfigError, did_you_mean

ROWS = {
    "foldsformer": "polyfold_baselines.agents.foldsformer:Foldsformer",
    "bifold": "polyfold_baselines.agents.bifold:BiFold",
    "ltf": "polyfold_baselines.agents.ltf:LearningToFold",
    "langdef": "polyfold_baselines.agents.langdef:LangDef",
}
"""Baselines that are trained so."""


class Fit:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        parser.add_argument("row", metavar="BASELINE", help=f"one of {', '.join(ROWS)}")
        parser.add_argument("--demos", type=Path, required=True, metavar="DIR", help="folder of polyfold demos")
        parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; resumed if it exists")
        parser.add_argument("--passes", type="count", metavar="N", help="folds looked at (default: 100000)")
        parser.add_argument("--width", type="count", metavar="N", help="of the network (default: 128)")
        parser.add_argument("--depth", type="count", metavar="N", help="of the network (default: 4)")
        parser.add_argument("--seed", type="seed", metavar="N", help="of weights and order (default: 0)")
        parser.add_argument("--device", choices=["auto", "cpu", "cuda"], default="auto", help="default: auto")

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Train what is missing and say how well it picks."""
        from importlib import import_module

        from pydantic import ValidationError

        from polyfold.errors import validation_problem
        from polyfold_baselines.learning.fitting import FitConfig, fit

        if arguments.row not in ROWS:
            raise ConfigError(f"no baseline is called {arguments.row!r}; {did_you_mean(arguments.row, ROWS)}")
        module, _, name = ROWS[arguments.row].partition(":")
        cls = getattr(import_module(module), name)
        given = {name: getattr(arguments, name) for name in ("passes", "width", "depth", "seed")}
        chosen = {name: value for name, value in given.items() if value is not None}
        try:
            config = FitConfig(row=arguments.row, demos=str(arguments.demos), **chosen)
        except ValidationError as error:
            raise ConfigError(validation_problem(error, FitConfig.model_fields)) from error
        weights = fit(config, cls, arguments.out, arguments.device)
        print(f"weights: {weights}")
        return 0
