"""``polyfold fit``: train a baseline from demonstrations."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from polyfold.errors import ConfigError, did_you_mean

if TYPE_CHECKING:
    from pydantic import BaseModel

ROWS = {
    "foldsformer": "polyfold_baselines.agents.imitating.foldsformer:Foldsformer",
    "foldsformer-2arm": "polyfold_baselines.agents.imitating.foldsformer:Foldsformer2Arm",
    "bifold": "polyfold_baselines.agents.imitating.bifold:BiFold",
    "ltf": "polyfold_baselines.agents.imitating.ltf:LearningToFold",
    "langdef": "polyfold_baselines.agents.imitating.langdef:LangDef",
    "langdef-2arm": "polyfold_baselines.agents.imitating.langdef:LangDef2Arm",
    "metafold-like": "polyfold_baselines.agents.imitating.metafold:MetaFoldLike",
}
"""Baselines that learn heatmaps, flows or values from demonstrations or drags."""
BY_DRAGGING = {"vcd": "polyfold_baselines.agents.searching.vcd:Vcd"}
"""Baselines that learn from random drags what cloth does."""
BY_TRYING = {"ppo": "polyfold_baselines.agents.ppo:Ppo"}
"""Baselines that learn by trying folds."""
EVERY = (*ROWS, *BY_DRAGGING, *BY_TRYING)


class Fit:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        parser.add_argument("row", metavar="BASELINE", help=f"one of {', '.join(EVERY)}")
        parser.add_argument("--demos", type=Path, metavar="DIR", help="folder of polyfold demos; ppo needs none")
        parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; resumed if it exists")
        parser.add_argument(
            "--passes", type="count", metavar="N", help="folds looked at (default: 100000; vcd: 200000; ppo: 20000)"
        )
        parser.add_argument("--width", type="count", metavar="N", help="of the network (default: 128; vcd: 64)")
        parser.add_argument("--depth", type="count", metavar="N", help="of the network (default: 4; vcd: 6)")
        parser.add_argument("--seed", type="seed", metavar="N", help="of weights and order (default: 0)")
        parser.add_argument("--device", choices=["auto", "cpu", "cuda"], default="auto", help="default: auto")

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Train what is missing and say how well it picks."""
        if arguments.row not in EVERY:
            hint = did_you_mean(arguments.row, EVERY)
            raise ConfigError(f"no baseline is called {arguments.row!r}; {hint}")
        if arguments.row in BY_TRYING:
            weights = _tried(arguments)
        elif arguments.demos is None:
            raise ConfigError(f"{arguments.row} learns from demonstrations; give their folder with --demos")
        else:
            weights = _fitted(arguments)
        print(f"weights: {weights}")
        return 0


def _fitted(arguments: argparse.Namespace) -> Path:
    settings = {"row": arguments.row, "demos": str(arguments.demos)}
    settings |= _chosen(arguments, "passes", "width", "depth", "seed")
    row = row_class(arguments.row)
    if arguments.row in BY_DRAGGING:
        from polyfold_baselines.learning.dynamics.training import DynamicsConfig, fit_dynamics

        return fit_dynamics(_valid(DynamicsConfig, **settings), row, arguments.out, arguments.device)
    from polyfold_baselines.learning.fitting import FitConfig, fit

    return fit(_valid(FitConfig, **settings), row, arguments.out, arguments.device)


def row_class(row: str) -> Any:
    """The agent's class of a baseline that is trained."""
    from importlib import import_module

    module, _, name = {**ROWS, **BY_DRAGGING, **BY_TRYING}[row].partition(":")
    return getattr(import_module(module), name)


def _tried(arguments: argparse.Namespace) -> Path:
    from polyfold_baselines.learning.trying.reinforcing import TryConfig, reinforce

    for name in ("demos", "width", "depth"):
        if getattr(arguments, name) is not None:
            raise ConfigError(f"{arguments.row} learns by trying and takes no --{name}; leave it out")
    config = _valid(TryConfig, row=arguments.row, **_chosen(arguments, "passes", "seed"))
    return reinforce(config, arguments.out, arguments.device)


def _chosen(arguments: argparse.Namespace, *names: str) -> dict[str, Any]:
    return {name: getattr(arguments, name) for name in names if getattr(arguments, name) is not None}


Model = TypeVar("Model", bound="BaseModel")


def _valid(model: type[Model], **settings: Any) -> Model:
    from pydantic import ValidationError

    from polyfold.errors import validation_problem

    try:
        return model(**settings)
    except ValidationError as error:
        raise ConfigError(validation_problem(error, model.model_fields)) from error
