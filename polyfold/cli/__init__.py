"""The command line: ``polyfold VERB``. One module per verb; plugins may add verbs.

A verb's module imports at its top what its options need, and the rest when it runs, so that help comes at once.
"""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, NoReturn, Protocol, TextIO

import polyfold
from polyfold.cli._boundary import answer, flush, speak_any_text
from polyfold.cli._options.numbers import TYPES
from polyfold.errors import did_you_mean
from polyfold.plugins import catalog, refresh

__all__ = ["main"]

VERBS = {
    "fold": ("polyfold.cli.fold", "fold a garment from a sentence, in simulation"),
    "ground": ("polyfold.cli.ground", "fit the polygon model to a photo, mask or outline"),
    "garments": ("polyfold.cli.garments", "draw a picture sheet of seeded garments"),
    "tasks": ("polyfold.cli.tasks", "list the task suites and their tasks"),
    "evaluate": ("polyfold.cli.evaluate", "run a study: variants over tasks and garments"),
    "table": ("polyfold.cli.table", "tabulate an evaluation"),
    "report": ("polyfold.cli.report", "write an evaluation as one HTML page"),
    "prompt": ("polyfold.cli.prompt", "show what a language model is told"),
    "plugins": ("polyfold.cli.plugins", "list the installed plugins and their components"),
    "new-plugin": ("polyfold.cli.new_plugin", "write a package with a component of any kind, whose tests pass"),
    "check": ("polyfold.cli.check", "hold a plugin's components to what their kinds promise"),
}


class Verb(Protocol):
    """What a verb's module or class provides."""

    def configure(self, parser: argparse.ArgumentParser) -> None:
        """Add the options."""

    def run(self, arguments: argparse.Namespace) -> int:
        """Do it; returns the exit status."""
        ...


def _keep_to_one_thread() -> None:
    """Have OpenBLAS (numpy 2.4) use one thread, unless the user says otherwise.

    Matrices are small here. Two threads gain nothing on them, and where the cores are busy they wait for each other:
    fitting a polygon beside two other processes took 7 s instead of 0.3.
    """
    if "numpy" not in sys.modules:
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status: 0 done, 1 failed, 2 wrong usage, 3 refused, 130 interrupted."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    warnings.showwarning = _show_warning
    speak_any_text()
    _keep_to_one_thread()
    if "--no-plugins" in arguments:
        arguments.remove("--no-plugins")
        refresh(third_party=False)
    try:
        status = _run(arguments)
        flush()
    except (Exception, KeyboardInterrupt) as error:
        answered = answer(error)
        if answered is None:
            raise
        message, status = answered
        if message:
            print(f"polyfold: {message}", file=sys.stderr)
    return status


def _run(arguments: Sequence[str]) -> int:
    parser = _parser(arguments)
    parsed = parser.parse_args(arguments)
    if parsed.verb is None:
        parser.print_help()
        return 0
    return parsed.run(parsed)


class _Verbs(argparse._SubParsersAction):
    """Verbs whose own help begins with what the list of them says."""

    def add_parser(self, name: str, **settings: Any) -> argparse.ArgumentParser:
        said = settings.get("help") or ""
        return super().add_parser(name, **{"description": f"{said[:1].upper()}{said[1:]}.", **settings})


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, the options are a ``--help`` away; and knows some types of options by name."""

    def __init__(self, *arguments: Any, **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        self.register("action", "parsers", _Verbs)
        for name, parse in TYPES.items():
            self.register("type", name, parse)

    def error(self, message: str) -> NoReturn:
        """End with exit status 2."""
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    parser = Parser(prog="polyfold", description="Fold cloth with two robot arms from a sentence.", allow_abbrev=False)
    parser.add_argument("--version", action="version", version=f"polyfold {polyfold.__version__}")
    parser.add_argument("--no-plugins", action="store_true", help="ignore the plugins of other distributions")
    verbs = parser.add_subparsers(dest="verb", metavar="VERB")
    chosen = next((argument for argument in arguments if not argument.startswith("-")), None)
    # Only the verb that is asked for is imported; the plugins' verbs are looked up when it is not one of ours.
    ours = chosen in VERBS or (chosen is None and "--version" in arguments)
    known = {**VERBS, **({} if ours else _plugin_verbs())}
    if chosen is not None and chosen not in known:
        parser.error(f"there is no verb {chosen!r}; {did_you_mean(chosen, known)}")
    for verb, (module, summary) in known.items():
        told = summary.replace("%", "%%")  # argparse fills in what a % announces
        subparser = verbs.add_parser(verb, help=told, allow_abbrev=False)
        if verb == chosen:
            implementation = _implementation(module)
            implementation.configure(subparser)
            subparser.set_defaults(run=_complete(verb, implementation.run))
    return parser


def _plugin_verbs() -> dict[str, tuple[str, str]]:
    found = catalog().components["commands"]
    return {name: (str(entries[0].target), entries[0].summary) for name, entries in sorted(found.items())}


def _complete(verb: str, run: Callable[[argparse.Namespace], int]) -> Callable[[argparse.Namespace], int]:
    """What a verb does, once it is said what a plugin's verb can't do without; its help is there all the same."""
    if verb in VERBS:
        return run

    def checked(arguments: argparse.Namespace) -> int:
        catalog().components["commands"][verb][0].refuse_if_incomplete(f"polyfold {verb}")
        return run(arguments)

    return checked


def _implementation(target: str) -> Verb:
    module, _, attribute = target.partition(":")
    found: Any = import_module(module)
    return getattr(found, attribute) if attribute else found


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    print(f"polyfold: warning: {message}", file=sys.stderr)
