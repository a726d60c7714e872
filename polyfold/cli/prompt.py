"""``polyfold prompt``: what a language model is told, rendered for a garment and a step of an episode."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from polyfold import plugins
from polyfold.cli._options.components import add_component_options, experiment_from
from polyfold.cli._options.garment_source import add_source_options, garment_from
from polyfold.errors import ConfigError

if TYPE_CHECKING:
    from polyfold.types import Call, Episode, Message

CHARACTERS_PER_TOKEN = 3.4
"""The prompts in ``prompts/`` have 3.1 (fold_line) to 3.9 (subgoals) by the tokenizer of gpt-4o, on t-shirts."""

PICTURE_TOKENS = 255
"""What a picture counts: OpenAI's 85 and 170 a tile of 512 px at high detail; at low detail it counts 85."""

_CHOOSE = "choose among them, or give another --instruction, --planner or --step"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the actions and their options."""
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    actions.add_parser("list", help="the prompts that are installed")
    show = actions.add_parser("show", help="one prompt as the model gets it, with its number of tokens")
    show.add_argument("role", nargs="?", help="for example subgoals or fold_line; without one, the roles are listed")
    show.add_argument("--instruction", default="fold it in half", help="default: fold it in half")
    show.add_argument("--step", type="seed", default=0, metavar="N", help="after N folds, for what is asked per fold")
    show.add_argument("--model", metavar="ROUTE/MODEL", help="count tokens by this model's tokenizer (needs litellm)")
    show.add_argument("--json", action="store_true", help="print one JSON object")
    add_source_options(show)
    add_component_options(show)


def run(arguments: argparse.Namespace) -> int:
    """List the prompts, or fold as far as needed and show what was asked."""
    if arguments.action == "list":
        from polyfold.prompts import prompt_names

        print("\n".join(prompt_names()))
        return 0
    calls = _calls(arguments)
    if arguments.role is None:
        print("\n".join(dict.fromkeys(call.role for call in calls)))
        return 0
    call = _asked(arguments, calls)
    tokens, how = _tokens(call.messages, arguments.model)
    if arguments.json:
        shown = {name: getattr(call, name) for name in ("role", "step", "params", "messages")}
        print(json.dumps({**shown, "tokens": tokens, "counted": how}, ensure_ascii=False))
        return 0
    for message in call.messages:
        print(f"--- {message['role']}\n{_text(message)}\n")
    print(f"--- {tokens} tokens ({how}), parameters {json.dumps(dict(call.params))}")
    return 0


def _calls(arguments: argparse.Namespace) -> Sequence[Call]:
    """What a language model is asked in an episode. Raises ConfigError if it is asked nothing."""
    from polyfold.api import attempt

    experiment = experiment_from(arguments)
    garment = garment_from(arguments, experiment)
    episode = attempt(arguments.instruction, garment, arguments.seed, experiment)
    if not episode.calls:
        raise ConfigError(_with_failure("no language model is asked anything", episode))
    return episode.calls


def _asked(arguments: argparse.Namespace, calls: Sequence[Call]) -> Call:
    """The request in a role and at a step. Raises ConfigError if nothing of the kind was asked."""
    wanted = [call for call in calls if call.role == arguments.role]
    if not wanted:
        roles = ", ".join(dict.fromkeys(call.role for call in calls))
        raise ConfigError(f"nothing was asked in the role {arguments.role!r}, but in {roles}; {_CHOOSE}")
    found = [call for call in wanted if call.step in (None, arguments.step)]
    if not found:
        steps = ", ".join(str(step) for step in dict.fromkeys(call.step for call in wanted))
        raise ConfigError(f"{arguments.role!r} was not asked at step {arguments.step}, but at {steps}; {_CHOOSE}")
    return found[0]


def _with_failure(problem: str, episode: Episode) -> str:
    ended = f"; the episode ended early ({episode.failure.reason})" if episode.failure else ""
    return f"{problem}{ended}; give another --instruction, --agent or --planner"


def _tokens(messages: Sequence[Message], model: str | None) -> tuple[int, str]:
    """The number of tokens, and how it was counted."""
    pictures = sum(_pictures(message) for message in messages)
    each = f", each picture taken as {PICTURE_TOKENS}, OpenAI's high detail" if pictures else ""
    if model is None:
        characters = sum(len(_words(message)) for message in messages)
        count, how = (
            math.ceil(characters / CHARACTERS_PER_TOKEN),
            f"estimated at {CHARACTERS_PER_TOKEN:g} characters each",
        )
    else:
        counter = plugins.component_class("llms", "litellm")
        texts = [{"role": message["role"], "content": _words(message)} for message in messages]
        count, how = counter.count_tokens(model, texts), f"by the tokenizer of {model}"
    return count + pictures * PICTURE_TOKENS, how + each


def _pictures(message: Message) -> int:
    content = message["content"]
    return 0 if isinstance(content, str) else sum(part["type"] != "text" for part in content)


def _words(message: Message) -> str:
    """The text alone."""
    content = message["content"]
    return content if isinstance(content, str) else "\n".join(p["text"] for p in content if p["type"] == "text")


def _text(message: Message) -> str:
    content = message["content"]
    if isinstance(content, str):
        return content
    return "\n".join(part["text"] if part["type"] == "text" else _picture(part) for part in content)


def _picture(part: Mapping[str, Any]) -> str:
    return f"[picture of {part['bytes']} bytes, SHA-256 {part['sha256'][:12]}]"
