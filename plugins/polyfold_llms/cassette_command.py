"""``polyfold cassette``: look into a cassette, export what a run lacked, fill it in; round by round.

polyfold evaluate study.toml --out runs/a             # llm: replay:gpt.jsonl, missing = "requests.jsonl"
polyfold cassette missing requests.jsonl --form openai --out batch.jsonl
polyfold cassette fill gpt.jsonl requests.jsonl --answers batch-output.jsonl
polyfold cassette fill gpt.jsonl requests.jsonl --llm litellm:openrouter/openai/gpt-4o
polyfold evaluate study.toml --out runs/a             # goes on from there; again until nothing is missing
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from polyfold.errors import ConfigError, LLMAccessError, LLMError
from polyfold.types import Reply
from polyfold_llms.batch import FORMS, PendingRequest, export_line, read_answers, read_pending, with_cost
from polyfold_llms.cassette import Cassette, open_cassette
from polyfold_llms.request_keys import model_of


class CassetteCommand:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the actions and their options."""
        _configure(parser)

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Do one action."""
        return {"show": _show, "missing": _export, "fill": _fill}[arguments.action](arguments)


def _configure(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    show = actions.add_parser("show", help="what a cassette holds")
    show.add_argument("cassette", type=Path, help="file of answers that record kept")
    show.add_argument("--json", action="store_true", help="print one JSON object")
    missing = actions.add_parser("missing", help="write the requests that a run lacked, for another program")
    missing.add_argument("requests", type=Path, help="file that replay collected them in (llm.missing)")
    missing.add_argument("--form", choices=FORMS, default="plain", help="see polyfold_llms.batch (default: plain)")
    missing.add_argument("--model", help="what the service calls the model")
    missing.add_argument("--out", type=Path, help="file (default: print)")
    fill = actions.add_parser("fill", help="add answers to a cassette, from a file or from a backend")
    fill.add_argument("cassette", type=Path, help="cassette that answers are added to")
    fill.add_argument("requests", type=Path, help="file that replay collected requests in (llm.missing)")
    source = fill.add_mutually_exclusive_group(required=True)
    source.add_argument("--answers", type=Path, help="answers, in any of the forms")
    source.add_argument("--llm", metavar="NAME[:ARG]", help="backend to ask")
    fill.add_argument(
        "--set", metavar="PARAM=VALUE", action="append", default=[], help="a parameter of that backend; may be repeated"
    )
    fill.add_argument("--workers", type="count", default=8, metavar="N", help="calls at once, with --llm (default: 8)")


def _setting(text: str) -> tuple[str, Any]:
    name, equals, value = text.partition("=")
    if not equals:
        raise ConfigError(f"--set {text!r} does not read PARAM=VALUE; for example --set timeout_s=60")
    try:
        return name, json.loads(value)
    except ValueError:
        return name, value


def _show(arguments: argparse.Namespace) -> int:
    if not arguments.cassette.exists():
        raise ConfigError(f"there is no cassette {arguments.cassette}; check the path")
    groups: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for entry in open_cassette(arguments.cassette.resolve()).entries():
        groups.setdefault((entry["request"]["model"], str(entry["place"].get("role", ""))), []).append(entry)
    summary = [{"model": model, "role": role, **_summary(entries)} for (model, role), entries in groups.items()]
    if arguments.json:
        print(json.dumps(summary, indent=2))
        return 0
    for row in summary:
        cost = "unknown" if row["cost"] is None else f"{row['cost']:.4f}"
        print(
            f"{row['model']}  {row['role'] or '(no role)'}: {row['requests']} requests in {row['episodes']} episodes, "
            f"{row['completion_tokens']} tokens answered, US$ {cost}, recorded {row['recorded']}"
        )
    return 0


def _summary(entries: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    replies = [entry["reply"] for entry in entries]
    days = sorted(entry["recorded"] for entry in entries)
    costs = [reply.get("cost") for reply in replies]
    episodes = {json.dumps([e["place"].get(n) for n in ("task", "garment", "seed", "instruction")]) for e in entries}
    return {
        "requests": len(entries),
        "episodes": len(episodes),
        "completion_tokens": sum((reply.get("usage") or {}).get("completion_tokens", 0) for reply in replies),
        "cost": None if None in costs else sum(costs),
        "recorded": days[0] if days[0] == days[-1] else f"{days[0]} to {days[-1]}",
    }


def _export(arguments: argparse.Namespace) -> int:
    lines = [
        json.dumps(export_line(m, arguments.form, arguments.model), ensure_ascii=False)
        for m in read_pending(arguments.requests)
    ]
    text = "".join(line + "\n" for line in lines)
    if arguments.out is None:
        sys.stdout.write(text)
        return 0
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(text, "utf-8")
    print(f"{len(lines)} requests: {arguments.out}")
    return 0


def _fill(arguments: argparse.Namespace) -> int:
    cassette = open_cassette(arguments.cassette.resolve())
    open_requests = {m.key: m for m in read_pending(arguments.requests) if cassette.find(m.request) is None}
    answers = read_answers(arguments.answers) if arguments.answers else _asked(open_requests, arguments)
    counts, problems = _add(cassette, open_requests, answers)
    print(
        f"{counts['filled']} filled in, {counts['failed']} failed, {counts['unknown']} answers to nothing that is "
        f"missing; {len(open_requests) - counts['filled']} requests are still missing"
    )
    for problem in problems[:5]:
        print(f"  {problem}")
    return 0 if counts["filled"] == len(open_requests) else 1


def _add(
    cassette: Cassette, requests: Mapping[str, PendingRequest], answers: Iterator[tuple[str, Reply | str]]
) -> tuple[Counter[str], list[str]]:
    counts: Counter[str] = Counter()
    problems = []
    for key, answer in answers:
        if key not in requests:
            counts["unknown"] += 1
        elif isinstance(answer, str):
            counts["failed"] += 1
            problems.append(f"{key[:12]}: {answer}")
        else:
            missing = requests[key]
            cassette.add(missing.request, missing.place, with_cost(answer, missing.request["model"]))
            counts["filled"] += 1
    return counts, problems


def _asked(requests: Mapping[str, PendingRequest], arguments: argparse.Namespace) -> Iterator[tuple[str, Reply | str]]:
    """Ask a backend for each request, several at once; what it answers is passed on as it comes."""
    from concurrent.futures import ThreadPoolExecutor, as_completed

    from polyfold.plugins import create

    llm = create("llms", arguments.llm, dict(_setting(text) for text in arguments.set))
    asked = model_of(llm, arguments.llm)
    others = {m.request["model"] for m in requests.values()} - {asked}
    if others:
        raise ConfigError(f"the requests are for {', '.join(sorted(others))}, not for {asked}; fill them with that")

    def ask(missing: PendingRequest) -> Reply | str:
        try:
            return llm.complete(missing.messages, missing.request["params"])
        except LLMAccessError:
            raise
        except LLMError as error:
            return str(error)

    with ThreadPoolExecutor(arguments.workers) as pool:
        running = {pool.submit(ask, missing): key for key, missing in requests.items()}
        try:
            for future in as_completed(running):
                yield running[future], future.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
