"""What language models behind an API cost us in time, on this machine and without a network.

    python -m experiments.benchmarks.language.transport calls     # many calls at once: limits, our overhead a call
    python -m experiments.benchmarks.language.transport replay    # the 70 tasks recorded through HTTP, then replayed

Both go through litellm's real HTTP path to a server on this machine. Run them from the root of the repository.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import os
import statistics
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from polyfold_offline import OfflineLLM
from polyfold_offline.loopback import Received, Server, answering, serve

from polyfold import plugins
from polyfold.api import run
from polyfold.prompts import load_prompt
from polyfold.studies import Study
from polyfold.types import EpisodeStart, Role, Step

ROUTES = ("openai/gpt-4o", "openrouter/openai/gpt-4o")


def overhead(route: str, calls: int, latency_s: float, limit: int) -> dict[str, Any]:
    """Make calls at once and compare with what the server's latency alone would take.

    Args:
        route: model with its route.
        calls: number of calls, each from a thread of its own.
        latency_s: the server's, a call [s].
        limit: calls allowed at once.

    Returns:
        Wall time [s], overhead a call [ms] amortised over the calls, processor time a call, and the most calls that the
        server saw at once.
    """
    template = plugins.create("garments", "tshirt").template().to_text()
    messages = load_prompt("subgoals").render(template=template, instruction="fold it into a rectangular block")
    script = answering(OfflineLLM())
    with serve(lambda _: canned, latency_s) as server, ThreadPoolExecutor(calls) as pool:
        llm = plugins.create("llms", f"litellm:{route}", {"api_base": server.address, "concurrency": limit})
        canned = script(Received("", {}, {"messages": messages}))
        llm.complete(messages, {})
        list(pool.map(time.sleep, [0.01] * calls))
        server.most_at_once = 0
        clock, spent = time.perf_counter(), time.process_time()
        replies = list(pool.map(lambda _: llm.complete(messages, {}), range(calls)))
        wall, spent = time.perf_counter() - clock, time.process_time() - spent
    ideal = math.ceil(calls / limit) * latency_s
    return {
        "route": route,
        "limit": limit,
        "calls": calls,
        "at once, most": server.most_at_once,
        "wall [s]": round(wall, 2),
        "latency alone [s]": round(ideal, 2),
        "overhead a call [ms]": round(1000 * (wall - ideal) / calls, 1),
        "CPU a call, server included [ms]": round(1000 * spent / calls, 1),
        "median latency seen [ms]": round(1000 * statistics.median(reply.latency_s for reply in replies)),
    }


class Decisions:
    """Writes down every decision of every episode of the method, exactly."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def on_episode_start(self, start: EpisodeStart, role: Role) -> None:
        """The subgoals."""
        if role != "method":
            return
        self.lines.append(json.dumps([start.garment.name, start.instruction, [goal.text for goal in start.subgoals]]))

    def on_step(self, step: Step, role: Role) -> None:
        """Line, picks and places to the last bit."""
        if role != "method":
            return
        line = step.fold_line
        numbers = [step.action.picks.tolist(), step.action.places.tolist(), line and [line.start, line.end]]
        self.lines.append(json.dumps([step.index, numbers]))

    def digest(self) -> str:
        """SHA-256 of everything written down."""
        return hashlib.sha256("\n".join(self.lines).encode()).hexdigest()


def replayed(tasks: Sequence[str], first_seed: int, folder: Path) -> list[dict[str, Any]]:
    """Run the tasks with the offline reader, recorded through HTTP, and replayed with the server gone; one worker.

    The first run is only there to compile and to make the references that all of them are scored against.
    """
    cassette = folder / "cassette.jsonl"
    with serve() as server:
        inner = {"api_base": server.address}
        recording = {"name": f"record:{cassette}", "inner": f"litellm:{ROUTES[1]}", "inner_params": inner}
        rows = [
            _timed(name, llm, tasks, first_seed, folder, server)
            for name, llm in (("warm-up", "offline"), ("offline", "offline"), ("record", recording))
        ]
    rows.append(_timed("replay", {"name": f"replay:{cassette}"}, tasks, first_seed, folder, server))
    for row in rows:
        row["cassette [MB]"] = round(cassette.stat().st_size / 1e6, 2)
    return rows[1:]


def _timed(name: str, llm: Any, tasks: Sequence[str], first_seed: int, folder: Path, server: Server) -> dict[str, Any]:
    study = Study(name=name, tasks=tuple(tasks), first_seed=first_seed, instructions="first", base={"llm": llm})
    decisions = Decisions()
    before = len(server.received)
    plugins.observe(decisions)
    try:
        clock = time.perf_counter()
        records = run(study, folder / name, pictures="none", progress=False).records
        wall = time.perf_counter() - clock
    finally:
        plugins.unobserve(decisions)
    language = sum(r.seconds.get("language", 0.0) + r.seconds.get("subgoals", 0.0) for r in records)
    return {
        "llm": name,
        "episodes": len(records),
        "as wanted": sum(record.succeeded for record in records),
        "HTTP calls": len(server.received) - before,
        "wall [s]": round(wall, 1),
        "of that language [s]": round(language, 2),
        "the rest [s]": round(wall - language, 1),
        "decisions (SHA-256)": decisions.digest()[:16],
    }


def _table(rows: Sequence[dict[str, Any]]) -> str:
    head = list(rows[0])
    lines = [head, ["---"] * len(head), *([str(row[name]) for name in head] for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one of the benchmarks and print its table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    actions = parser.add_subparsers(dest="action", required=True)
    calls = actions.add_parser("calls")
    calls.add_argument("--calls", type=int, default=64)
    calls.add_argument("--latency", type=float, default=0.2, help="of the server [s]")
    calls.add_argument("--limits", type=int, nargs="+", default=[64, 16, 8])
    replay = actions.add_parser("replay")
    replay.add_argument("--tasks", nargs="+", default=["*"], help="patterns of task ids")
    replay.add_argument("--first-seed", type=int, default=2000)
    replay.add_argument("--keep", type=Path, help="folder for the runs and the cassette (default: none is kept)")
    options = parser.parse_args(arguments)
    os.environ["NO_PROXY"] = "127.0.0.1"
    if options.action == "calls":
        rows = [overhead(r, options.calls, options.latency, limit) for r in ROUTES for limit in options.limits]
    else:
        with tempfile.TemporaryDirectory() as scratch:
            rows = replayed(options.tasks, options.first_seed, options.keep or Path(scratch))
    print(_table(rows))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
