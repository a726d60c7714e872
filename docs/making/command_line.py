"""The command line: every verb with what its help says."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from polyfold.cli import _parser


def page() -> str:
    """All verbs, bundled plugins' among them."""
    told = ["# Command line", "", "`polyfold VERB --help` says the same.", ""]
    for name, parser in verbs():
        told += [f"## polyfold {name}", "", parser.description or "", "", "| argument | what |", "|---|---|"]
        told += [f"| `{flags}` | {says.replace('|', chr(92) + '|')} |" for flags, says in options(parser)]
        told.append("")
    return "\n".join(told)


def verbs() -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """Each verb, and each verb of a verb, with its parser."""
    for name in _choices(_parser([])):
        # Only the verb that is asked for is given its options.
        yield from _with_inner(name, _choices(_parser([name]))[name])


def _with_inner(name: str, parser: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    inner = _choices(parser)
    if not inner:
        yield name, parser
    for below, one in inner.items():
        yield from _with_inner(f"{name} {below}", one)


def _choices(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            return dict(action.choices)
    return {}


def options(parser: argparse.ArgumentParser) -> Iterator[tuple[str, str]]:
    """Each argument as it is written, with what it is."""
    for action in parser._actions:
        if isinstance(action, argparse._HelpAction | argparse._SubParsersAction) or action.help == argparse.SUPPRESS:
            continue
        value = "" if action.nargs == 0 else f" {_value(action)}"
        flags = ", ".join(f"{flag}{value}" for flag in action.option_strings) or _value(action)
        yield flags, (action.help or "") % {**vars(action), "prog": parser.prog}


def _value(action: argparse.Action) -> str:
    if action.metavar is not None:
        return " ".join(action.metavar) if isinstance(action.metavar, tuple) else action.metavar
    if action.choices is not None:
        return "{" + ",".join(map(str, action.choices)) + "}"
    return action.dest if not action.option_strings else action.dest.upper()
