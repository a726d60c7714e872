"""How often many manners of speaking are understood: ``python -m experiments.benchmarks.language.registers``.

Every sentence is asked of a language model through the prompt for subgoals and, for each subgoal, the prompt for fold
lines, on a garment of ordinary size that is folded ideally. The cloth that each line moves is compared with what the
written meaning moves (``experiments/language/MEANINGS.md``); what a meaning leaves open may be settled in any way, and
a goal may be reached by any known sequence that ends as it asks.

``--use dev`` takes the registers for development, ``final`` those that are looked at once, ``train`` the others.
``--curve`` adds, for the backend ``offline``, what other thresholds of sureness would have answered.
"""

from __future__ import annotations

import argparse
import itertools
import json
import statistics
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from polyfold_offline.cloth.creases import crease_of
from polyfold_offline.cloth.folds import Fold
from polyfold_offline.cloth.garment import Garment, NotUnderstoodError
from polyfold_offline.cloth.shape import Shape
from polyfold_offline.meaning.folding import folds_of
from polyfold_offline.meaning.goals import demands
from polyfold_offline.meaning.outcomes import outcomes
from polyfold_offline.meaning.program import Piece, Program, parse_program
from tqdm import tqdm

from experiments.benchmarks.language.understanding import Laid, agrees, plan_ideally
from polyfold.analysis import share
from polyfold.errors import PlanError, PolyfoldError, RefusedError
from polyfold.geometry import Camera, FoldLine
from polyfold.geometry._masks import fill_polygon
from polyfold.plugins import create
from polyfold.plugins.interfaces import Planner

SENTENCES = Path(__file__).parents[2] / "language" / "sentences"

SIZES = {"square": (50.0, 50.0), "rectangle": (50.0, 70.0), "tshirt": (60.0, 66.0), "pants": (40.0, 90.0)}
"""Width and height of the garments that sentences are about [cm]."""

RIGHT, SILENT, REFUSED = "right", "another fold", "refused"
"""What becomes of a sentence; one that is to be refused is ``right`` when it is."""


@dataclass(frozen=True)
class Sentence:
    """A written sentence."""

    register: str
    garment: str
    meaning: str
    text: str

    @property
    def impossible(self) -> bool:
        """Whether it must be refused."""
        return self.meaning.startswith("no ")


@dataclass(frozen=True)
class Verdict:
    """What a language model made of a sentence, and how long it took [ms]."""

    sentence: Sentence
    result: str
    detail: str
    milliseconds: float


def read_sentences(use: str) -> list[Sentence]:
    """The sentences of the registers with one use: ``train``, ``dev`` or ``final``."""
    found = []
    for path in sorted((SENTENCES / use).glob("*.jsonl")):
        lines = path.read_text(encoding="utf-8").splitlines()
        found += [Sentence(path.stem, e["garment"], e["meaning"], e["text"]) for e in map(json.loads, lines)]
    return found


# What a meaning allows ------------------------------------------------------------------------------------------------

_OPEN = {
    "half": {
        "any": ("L", "R", "T", "B"),
        "side": ("L", "R"),
        "end": ("T", "B"),
        "long": ("L", "R"),
        "short": ("T", "B"),
    },
    "mid": {"any": ("L", "R", "T", "B"), "side": ("L", "R"), "end": ("T", "B")},
    "centre": {"any": ("BL", "TL", "TR", "BR")},
    "across": {"any": ("BL", "TL", "TR", "BR")},
    "sleeve": {"any": ("L", "R")},
}


def ways(kind: str, meaning: str) -> list[list[Fold]]:
    """Every sequence of folds that carries out a meaning, the default one first; none if it is to be refused."""
    program, lengths = parse_program(meaning)
    garment = Garment(kind, kind, {}, SIZES[kind])
    if program[0].operation == "no":
        return []
    if program[0].operation == "goal":
        size = (lengths[0], lengths[1]) if len(lengths) == 2 else None
        tests = [test for _, test in demands(program[0], size, garment)]
        return [list(o.folds) for o in outcomes(kind) if all(test(o) for test in tests)]
    settled = itertools.chain([program], itertools.product(*map(_settled, program)))
    return list(_done(settled, lengths, garment))


def _done(programs: Iterator[Program], lengths: Sequence[float], garment: Garment) -> Iterator[list[Fold]]:
    for program in programs:
        try:
            yield folds_of(program, lengths, garment).folds
        except NotUnderstoodError:
            continue


def _settled(piece: Piece) -> list[Piece]:
    places = _OPEN.get(piece.operation, {}).get(piece.place, (piece.place,))
    manners = ("straight", "slanted") if piece.operation == "sleeve" and piece.detail == "any" else (piece.detail,)
    return [Piece(piece.operation, place, manner) for place in places for manner in manners]


# Judging --------------------------------------------------------------------------------------------------------------


@cache
def laid(kind: str) -> Laid:
    """A garment of ordinary size on the table, upright."""
    width, height = (side / 100 for side in SIZES[kind])
    template = create("garments", kind).template()
    camera = Camera.framing(max(width, height) / 0.6)
    shape = template.canonical - (template.canonical.max(0) + template.canonical.min(0)) / 2
    vertices = shape / np.ptp(shape, axis=0) * [width, height] * camera.pixels_per_metre + camera.centre
    inside = fill_polygon(vertices, camera.height, camera.width)[::_EVERY, ::_EVERY]
    particles = _EVERY * np.argwhere(inside)[:, ::-1].astype(float)
    size = (camera.width, camera.height)
    return Laid(template.model(vertices), particles, size, (width, height), camera.pixels_per_metre)


_EVERY = 4
"""Every so many pixels there is a particle of cloth."""


def lines_of(folds: Sequence[Fold], cloth: Laid) -> list[FoldLine] | None:
    """The lines of folds, each on the ideal result of those before; None where one can't be made."""
    model, found = cloth.model, []
    for fold in folds:
        try:
            line = crease_of(fold, Shape.of_model(model, cloth.size, cloth.pixels_per_metre)).line
            model = model.fold(line)
        except (NotUnderstoodError, PolyfoldError):
            return None
        found.append(line)
    return found


@cache
def accepted_lines(kind: str, meaning: str) -> list[list[FoldLine]]:
    """The fold lines of every way to carry out a meaning."""
    found = (lines_of(folds, laid(kind)) for folds in ways(kind, meaning))
    return [lines for lines in found if lines is not None]


def judge(sentence: Sentence, planner: Planner, llm: Any) -> Verdict:
    """What a language model makes of a sentence."""
    cloth, began = laid(sentence.garment), time.perf_counter()
    lines, detail = None, ""
    try:
        lines = plan_ideally(sentence.text, cloth, planner, llm)
    except (RefusedError, PlanError) as reason:
        detail = str(reason)
    spent = 1000 * (time.perf_counter() - began)
    return Verdict(sentence, result_of(sentence, lines), detail or f"{len(lines or ())} folds", spent)


def result_of(sentence: Sentence, lines: Sequence[FoldLine] | None) -> str:
    """What became of a sentence that these lines were planned for; None if it was refused."""
    if lines is None:
        return RIGHT if sentence.impossible else REFUSED
    accepted = accepted_lines(sentence.garment, sentence.meaning)
    return RIGHT if any(agrees(laid(sentence.garment), lines, wanted) for wanted in accepted) else SILENT


def table(verdicts: Sequence[Verdict]) -> str:
    """Shares a register and of all, with intervals that hold for other registers, as a markdown table."""
    rows = ["| register | to fold | right | another fold | refused | to refuse | refused |", "|" + "---|" * 7]
    registers = sorted({verdict.sentence.register for verdict in verdicts})
    rows += [_row(name, [v for v in verdicts if v.sentence.register == name]) for name in registers]
    return "\n".join([*rows, _row(f"all {len(registers)}", verdicts, clustered=True)])


def _row(name: str, verdicts: Sequence[Verdict], clustered: bool = False) -> str:
    meant = [verdict for verdict in verdicts if not verdict.sentence.impossible]
    never = [verdict for verdict in verdicts if verdict.sentence.impossible]

    def said(among: Sequence[Verdict], result: str) -> str:
        found = share([v.result == result for v in among], [v.sentence.register for v in among])
        return f"{found.mean:.1f} [{found.low:.1f}, {found.high:.1f}]" if clustered else f"{found.mean:.1f}"

    cells = [said(meant, result) for result in (RIGHT, SILENT, REFUSED)]
    return f"| {name} | {len(meant)} | {' | '.join(cells)} | {len(never)} | {said(never, RIGHT)} |"


@dataclass(frozen=True)
class Answer:
    """What the backend ``offline`` would answer if it refused nothing, and the highest limit at which it does."""

    sentence: Sentence
    sure: float
    result: str


def answers(sentences: Sequence[Sentence], weights: Path | None) -> list[Answer]:
    """The likeliest reading of each sentence."""
    from polyfold_offline.reading.reader import Reader
    from polyfold_offline.weights import checked_folder

    reader = Reader(weights or checked_folder(), sure=0.0)
    found = []
    for sentence in tqdm(sentences, desc="curve"):
        garment = Garment(sentence.garment, sentence.garment, {}, SIZES[sentence.garment])
        best = reader.readings(sentence.text, garment)[0]
        lines = lines_of(best.folding.folds, laid(sentence.garment)) if best.folding else None
        found.append(Answer(sentence, best.limit, result_of(sentence, lines)))
    return found


def shares_at(least: float, found: Sequence[Answer]) -> tuple[float, float, float]:
    """Per cent right and folded otherwise among what is to be folded, and refused of what is to be refused."""
    meant = [answer for answer in found if not answer.sentence.impossible]
    never = [answer for answer in found if answer.sentence.impossible]

    def share(among: Sequence[Answer], result: str) -> float:
        return 100 * sum(a.result == result and a.sure >= least for a in among) / max(1, len(among))

    return share(meant, RIGHT), share(meant, SILENT), 100 - share(never, SILENT)


def curve(found: Sequence[Answer]) -> str:
    """What other thresholds would have answered, as a markdown table."""
    rows = ["| sure | right | another fold | refused | impossible refused |", "|" + "---|" * 5]
    for least in THRESHOLDS:
        right, silent, refused = shares_at(least, found)
        rows.append(f"| {least:g} | {right:.1f} | {silent:.1f} | {100 - right - silent:.1f} | {refused:.1f} |")
    return "\n".join(rows)


def draw_curve(found: Sequence[Answer], path: Path) -> None:
    """Draw right answers over silently wrong ones, for every threshold."""
    from matplotlib.figure import Figure

    levels = sorted({answer.sure for answer in found}, reverse=True)
    points = np.array([shares_at(least, found) for least in levels])
    figure = Figure(figsize=(5.2, 3.6), layout="constrained")
    axes = figure.subplots()
    axes.plot(points[:, 1], points[:, 0], color="#1f5f8b")
    for number, least in enumerate(THRESHOLDS):
        right, silent, _ = shares_at(least, found)
        axes.plot(silent, right, "o", color="#1f5f8b", markersize=4)
        below = 6 + 9 * (number % 3)  # neighbours lie close together
        axes.annotate(
            f"{least:g}", (silent, right), (0, -below), textcoords="offset points", fontsize=7, ha="center", va="top"
        )
    axes.set(xlabel="another fold than was meant [%]", ylabel="right [%]", xlim=(0, None), ylim=(0, 100))
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=120)


THRESHOLDS = (0.0, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table, and what went wrong unless ``--brief``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--use", choices=["train", "dev", "final"], default="dev")
    parser.add_argument("--llm", default="offline")
    parser.add_argument("--brief", action="store_true", help="no list of what went wrong")
    parser.add_argument("--curve", action="store_true", help="what other thresholds would have answered")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="with --curve: where to draw it")
    parser.add_argument("--weights", type=Path, metavar="DIR", help="with --curve: other weights than the shipped ones")
    options = parser.parse_args(arguments)
    sentences = read_sentences(options.use)
    if options.curve:
        found = answers(sentences, options.weights)
        print(curve(found))
        if options.picture is not None:
            draw_curve(found, options.picture)
        return 0
    planner, llm = create("planners", "hierarchical"), create("llms", options.llm)
    verdicts = [judge(sentence, planner, llm) for sentence in tqdm(sentences, desc=options.llm)]
    if not options.brief:
        for verdict in (verdict for verdict in verdicts if verdict.result != RIGHT):
            told = verdict.sentence
            print(f"{told.register} | {told.garment} | {told.meaning} | {told.text!r}:")
            print(f"    {verdict.result} {verdict.detail}")
    print(table(verdicts))
    print(f"\nMedian {statistics.median(v.milliseconds for v in verdicts):.0f} ms a sentence, fold lines included.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
