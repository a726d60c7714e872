"""The command line: ``polyfold VERB``. One module per verb; plugins may add verbs.

A verb's module imports at its top what its options need, and the rest when it runs, so that help comes at once.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any, Protocol, TextIO

import polyfold
from polyfold import plugins
from polyfold.errors import PolyfoldError, RefusedError

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
}

FAILED, REFUSED, INTERRUPTED = 1, 3, 130


class Verb(Protocol):
    """What a verb's module or class provides."""

    def configure(self, parser: argparse.ArgumentParser) -> None:
        """Add the options."""

    def run(self, arguments: argparse.Namespace) -> int:
        """Do it; returns the exit status."""
        ...


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit status: 0 done, 1 failed, 2 wrong usage, 3 refused, 130 interrupted."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    warnings.showwarning = _show_warning
    if "--no-plugins" in arguments:
        arguments.remove("--no-plugins")
        plugins.refresh(third_party=False)
    try:
        parsed = _parser(arguments).parse_args(arguments)
        return parsed.run(parsed)
    except RefusedError as error:
        print(f"polyfold: refused: {error}", file=sys.stderr)
        return REFUSED
    except PolyfoldError as error:
        print(f"polyfold: {error}", file=sys.stderr)
        return FAILED
    except BrokenPipeError:
        return FAILED
    except OSError as error:
        print(f"polyfold: {error}; check the path and what may be read and written there", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print("polyfold: interrupted", file=sys.stderr)
        return INTERRUPTED


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="polyfold", description="Fold cloth with two robot arms from a sentence.", allow_abbrev=False
    )
    parser.add_argument("--version", action="version", version=f"polyfold {polyfold.__version__}")
    parser.add_argument("--no-plugins", action="store_true", help="ignore the plugins of other distributions")
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", required=True)
    chosen = next((argument for argument in arguments if not argument.startswith("-")), None)
    # Only the verb that is asked for is imported; the plugins' verbs are looked up when it is not one of ours.
    for verb, (module, summary) in {**VERBS, **({} if chosen in VERBS else _plugin_verbs())}.items():
        subparser = verbs.add_parser(verb, help=summary, description=summary.capitalize() + ".", allow_abbrev=False)
        if verb == chosen:
            implementation = _implementation(module)
            implementation.configure(subparser)
            subparser.set_defaults(run=implementation.run)
    return parser


def _plugin_verbs() -> dict[str, tuple[str, str]]:
    found = plugins.catalog().components["commands"]
    return {name: (str(entries[0].target), entries[0].summary) for name, entries in sorted(found.items())}


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
