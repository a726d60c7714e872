"""What an episode costs in tokens: ``python -m experiments.benchmarks.language.tokens``.

Every task of a suite is planned in its first wording and folded ideally, without physics or camera, by a backend that
answers here; what it is asked is counted by the tokenizer of a provider's model: calls, tokens a call, and how much of
a call is the same in every such call, which providers' prompt caches take off.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from experiments.benchmarks.language.understanding import FIRST_SEED, laid_garment, plan_ideally
from polyfold.errors import PlanError
from polyfold.plugins import component_class, create, find
from polyfold.plugins.interfaces import LLM
from polyfold.tasks import load_suite
from polyfold.types import Message, Reply

Asked = Sequence[Message]


class Listening:
    """A backend that keeps what it is asked."""

    def __init__(self, llm: LLM) -> None:
        self._llm = llm
        self.asked: list[Asked] = []

    def complete(self, messages: Sequence[Message], params: Mapping[str, Any]) -> Reply:
        """Answer as the backend does."""
        self.asked.append(list(messages))
        return self._llm.complete(messages, params)


def main(arguments: Sequence[str] | None = None) -> None:
    """Plan, count, and print a Markdown table."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.language.tokens", description=__doc__)
    parser.add_argument("--suite", default="polyfold70", help="default: polyfold70")
    parser.add_argument("--planners", nargs="+", default=["hierarchical", "plan"], metavar="PLANNER")
    parser.add_argument("--llm", default="offline", help="what answers (default: offline)")
    parser.add_argument("--model", default="gpt-4o", help="whose tokens are counted (default: gpt-4o)")
    options = parser.parse_args(arguments)
    print(
        "| planner | call | calls an episode | tokens a call | largest | the same in every call | tokens an episode |"
    )
    print("|---|---|---|---|---|---|---|")
    for planner in options.planners:
        for row in _rows(planner, options):
            print("| " + " | ".join((planner, *row)) + " |")


def _rows(planner: str, options: argparse.Namespace) -> list[tuple[str, ...]]:
    asked = _episodes(planner, options)
    count = component_class("llms", "litellm").count_tokens
    episodes = len(asked)
    calls = {
        "first": [episode[0] for episode in asked],
        "each later": [messages for episode in asked for messages in episode[1:]],
    }
    rows, whole = [], 0
    for name, messages in calls.items():
        if not messages:
            continue
        tokens = [count(options.model, each) for each in messages]
        alike = count(options.model, _common(messages)) / statistics.mean(tokens)
        whole += sum(tokens)
        rows.append(
            (
                name,
                f"{len(messages) / episodes:.2f}",
                f"{statistics.mean(tokens):.0f}",
                str(max(tokens)),
                f"{alike:.0%}",
                "",
            )
        )
    rows.append(
        (f"all (n = {episodes})", f"{sum(map(len, asked)) / episodes:.2f}", "", "", "", f"{whole / episodes:.0f}")
    )
    return rows


def _episodes(planner: str, options: argparse.Namespace) -> list[list[Asked]]:
    suite = load_suite(str(find("tasks", options.suite).target))
    found = []
    for number, task in enumerate(suite.tasks):
        llm = Listening(create("llms", options.llm))
        laid = laid_garment(task.garment, FIRST_SEED + number % 50)
        try:
            plan_ideally(task.instructions[0], laid, create("planners", planner), llm)
        except PlanError as error:
            print(f"{task.id}: {error}", file=sys.stderr)
        found.append(llm.asked)
    return found


def _common(asked: Sequence[Asked]) -> list[Message]:
    """The messages that all begin with; of the first that differs, the text that is common."""
    common: list[Message] = []
    for together in zip(*asked, strict=False):
        if all(message == together[0] for message in together):
            common.append(together[0])
            continue
        texts = [str(message["content"]) for message in together]
        return [*common, {**together[0], "content": os.path.commonprefix(texts)}]  # noqa: RUF071  (characters are meant)
    return common


if __name__ == "__main__":
    main()
