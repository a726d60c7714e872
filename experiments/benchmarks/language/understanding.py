"""How often instructions are planned as meant: ``python -m experiments.benchmarks.language.understanding``.

Every instruction is planned by a planner and a language model on a seeded garment, lying within 20 degrees of upright,
and folded ideally, without physics or camera: the model text of each step comes from the fold before. The cloth that
each fold line moves is compared with what the lines of the accepted tasks move.

A set is a TOML file of ``[[instruction]]`` (``text``, ``garment``, ``accept``: task ids, optionally
``unordered = true``) and ``[[refuse]]`` (``text``, ``garment``), which must be refused. ``--held-out`` judges only the
entries with ``held_out = true``, which no grammar or prompt was developed on, ``--developed`` only the others.
"""

from __future__ import annotations

import argparse
import hashlib
import itertools
import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError, RefusedError
from polyfold.geometry import Camera, FoldLine, rotate
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins import create, find
from polyfold.plugins.interfaces import Planner
from polyfold.polygon import FoldedModel
from polyfold.rollout._transcript import Transcript
from polyfold.tasks import Suite, Task, fold_lines, load_suite
from polyfold.types import Scene

TOLERANCE = 0.05
"""Moved cloth may lie this share of the garment's span from where it should, on average, after every step."""

ROTATION = 20.0
"""Garments lie within this many degrees of upright."""

FIRST_SEED = 2000


@dataclass(frozen=True, eq=False)
class Laid:
    """A garment on the table.

    Attributes:
        model: its unfolded model.
        particles: its particles [px], shape (N, 2).
        size: (width, height) of the image [px].
        extent: width and height of the garment when it lies upright [m]; None to leave planners untold.
        pixels_per_metre: scale of the image; None likewise.
    """

    model: FoldedModel
    particles: NDArray[np.float64]
    size: tuple[int, int]
    extent: tuple[float, float] | None = None
    pixels_per_metre: float | None = None


@dataclass(frozen=True)
class Outcome:
    """What became of one instruction: ``as intended``, ``refused``, ``other folds`` or ``no usable answer``."""

    garment: str
    text: str
    expected: tuple[str, ...]
    result: str
    detail: str = ""


@cache
def laid_garment(kind: str, seed: int) -> Laid:
    """The seeded garment of a kind, turned by up to :data:`ROTATION`, as the camera would see it."""
    garment_kind = create("garments", kind)
    garment = garment_kind.generate(seed, 0.025)
    template = garment_kind.template()
    angle = np.radians(np.random.default_rng([seed, 70]).uniform(-ROTATION, ROTATION))
    flat = rotate(garment.mesh.vertices, angle)
    camera = Camera.framing(2 * float(np.hypot(*flat.T).max()) / 0.8)
    particles = camera.to_pixels(flat)
    vertices = [particles[garment.keypoints[name]] for name in template.names]
    width, height = np.ptp(garment.mesh.vertices[:, :2], axis=0).tolist()
    size = (camera.width, camera.height)
    return Laid(template.model(vertices), particles, size, (width, height), camera.pixels_per_metre)


def plan_ideally(text: str, laid: Laid, planner: Planner, llm: Any) -> list[FoldLine]:
    """The fold lines of an instruction, each planned on the ideal result of those before."""
    conversation = Transcript(llm)
    template = create("garments", laid.model.kind).template()
    template = template.of_size(*laid.extent) if laid.extent else template
    model = laid.model
    lines = []
    for subgoal in planner.subgoals(text, template, conversation):
        width, height = laid.size
        outline = model.outline()
        mask = fill_polygon(outline, height, width)
        scene = Scene(model.kind, laid.size, mask, outline, model, model.to_text(laid.size, laid.pixels_per_metre))
        line = planner.plan(subgoal, scene, conversation)
        assert isinstance(line, FoldLine)
        model = model.fold(line)
        lines.append(line)
    return lines


def folded_states(particles: NDArray[np.float64], lines: Sequence[FoldLine]) -> list[NDArray[np.float64]]:
    """Particles [px], shape (N, 2), before the first and after each fold."""
    states = [particles]
    for line in lines:
        now = states[-1]
        states.append(line.fold(now))
    return states


def agrees(laid: Laid, planned: Sequence[FoldLine], wanted: Sequence[FoldLine]) -> bool:
    """Whether both sequences move the same cloth to the same places, step by step."""
    if len(planned) != len(wanted):
        return False
    span = float(np.ptp(laid.particles, axis=0).max())
    ours, theirs = folded_states(laid.particles, planned), folded_states(laid.particles, wanted)
    for step in range(1, len(ours)):
        moved = (ours[step] != ours[step - 1]).any(1) | (theirs[step] != theirs[step - 1]).any(1)
        if not moved.any() or np.hypot(*(ours[step] - theirs[step])[moved].T).mean() > TOLERANCE * span:
            return False
    return True


def accepted(laid: Laid, planned: Sequence[FoldLine], task_ids: Sequence[str], suite: Suite, unordered: bool) -> bool:
    """Whether a plan carries out one of the tasks."""
    points = dict(zip(laid.model.names, laid.model.rest, strict=True))
    for task_id in task_ids:
        wanted = fold_lines(suite.task(task_id), points)
        free = unordered or _order_is_free(suite.task(task_id), wanted, laid, suite)
        orders = itertools.permutations(wanted) if free else [wanted]
        if any(agrees(laid, planned, order) for order in orders):
            return True
    return False


def _order_is_free(task: Task, lines: Sequence[FoldLine], laid: Laid, suite: Suite) -> bool:
    """Whether the order can't matter: the flaps do not overlap, and no task differs from this one in order alone."""
    others = [other for other in suite.for_garment(task.garment) if other.id != task.id]
    if any(len(o.steps) == len(task.steps) and all(s in task.steps for s in o.steps) for o in others):
        return False
    times_lifted = sum(line.lifts(laid.particles).astype(int) for line in lines)
    return len(lines) > 1 and float(np.mean(times_lifted > 1)) <= 0.01


def judge_set(content: dict[str, Any], suite: Suite, planner: Planner, llm: Any, garments: int = 1) -> list[Outcome]:
    """Judge every instruction of a set on ``garments`` seeded garments; the worst result counts."""
    outcomes = []
    for entry in [*content.get("instruction", []), *content.get("refuse", [])]:
        found = [_judge(entry, suite, planner, llm, number) for number in range(garments)]
        bad = [outcome for outcome in found if not _good(outcome)]
        outcomes.append((bad or found)[0])
    return outcomes


def _judge(entry: dict[str, Any], suite: Suite, planner: Planner, llm: Any, number: int) -> Outcome:
    digest = int(hashlib.sha256(entry["text"].encode()).hexdigest()[:8], 16)
    laid = laid_garment(entry["garment"], FIRST_SEED + 50 * number + digest % 50)
    expected = tuple(entry.get("accept", ()))
    try:
        lines = plan_ideally(entry["text"], laid, planner, llm)
    except RefusedError as reason:
        return Outcome(entry["garment"], entry["text"], expected, "refused", str(reason))
    except PlanError as reason:
        return Outcome(entry["garment"], entry["text"], expected, "no usable answer", str(reason))
    if accepted(laid, lines, expected, suite, entry.get("unordered", False)):
        return Outcome(entry["garment"], entry["text"], expected, "as intended")
    return Outcome(entry["garment"], entry["text"], expected, "other folds", f"{len(lines)} folds")


def _good(outcome: Outcome) -> bool:
    return outcome.result == ("as intended" if outcome.expected else "refused")


def table(outcomes: Sequence[Outcome]) -> str:
    """Counts and shares per garment as a markdown table."""
    rows = ["| garment | to fold | as intended | other folds | refused | no usable answer | to refuse | refused |"]
    rows.append("|" + "---|" * 8)
    kinds = sorted({outcome.garment for outcome in outcomes})
    for kind in [*kinds, "all"]:
        here = [outcome for outcome in outcomes if kind in (outcome.garment, "all")]
        wanted = Counter(outcome.result for outcome in here if outcome.expected)
        unwanted = Counter(outcome.result for outcome in here if not outcome.expected)
        n, m = wanted.total(), unwanted.total()
        cells = [_share(wanted[r], n) for r in ("as intended", "other folds", "refused", "no usable answer")]
        rows.append(f"| {kind} | {n} | {' | '.join(cells)} | {m} | {_share(unwanted['refused'], m)} |")
    return "\n".join(rows)


def _share(count: int, total: int) -> str:
    return f"{count}/{total} ({100 * count / total:.1f} %)" if total else "–"


def part_of_set(content: dict[str, Any], held_out: bool) -> dict[str, Any]:
    """The held-out part of a set, or the developed one, to which every entry without ``held_out`` belongs."""
    return {
        heading: [entry for entry in content.get(heading, []) if entry.get("held_out", False) == held_out]
        for heading in ("instruction", "refuse")
    }


def suite_set(suite: Suite) -> dict[str, Any]:
    """The suite's own instructions as a set."""
    entries = [
        {"text": text, "garment": task.garment, "accept": [task.id]}
        for task in suite.tasks
        for text in task.instructions
    ]
    return {"instruction": entries}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmark and print its table and failures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--set", help="TOML file of instructions; without it, those of the task suite")
    part = parser.add_mutually_exclusive_group()
    part.add_argument("--held-out", action="store_true", help="only entries with held_out = true")
    part.add_argument("--developed", action="store_true", help="only entries without held_out = true")
    parser.add_argument("--suite", default="polyfold70", help="task suite")
    parser.add_argument("--planner", default="hierarchical")
    parser.add_argument("--llm", default="offline")
    parser.add_argument("--garments", type=int, default=1, help="garments per instruction; all must come out right")
    parser.add_argument("--brief", action="store_true", help="do not list the failures")
    options = parser.parse_args(arguments)
    suite = load_suite(str(find("tasks", options.suite).target))
    content = tomllib.loads(Path(options.set).read_text("utf-8")) if options.set else suite_set(suite)
    if options.held_out or options.developed:
        content = part_of_set(content, options.held_out)
    planner, llm = create("planners", options.planner), create("llms", options.llm)
    outcomes = judge_set(content, suite, planner, llm, options.garments)
    print(table(outcomes))
    failures = [outcome for outcome in outcomes if not _good(outcome)]
    if failures and not options.brief:
        print("\nNot as intended:\n")
        for outcome in failures:
            wanted = ", ".join(outcome.expected) or "a refusal"
            print(f"- {outcome.garment}: “{outcome.text}”\n  wanted {wanted}; {outcome.result}: {outcome.detail}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
