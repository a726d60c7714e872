"""What policies are held to."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from polyfold.errors import PlanError
from polyfold.geometry import Camera, FoldLine
from polyfold.testing._checks import checks
from polyfold.testing._materials import changed, kept, lines, scene
from polyfold.testing._subjects import Subject
from polyfold.types import Action, Scene

NEAR, MIRRORED = 8.0, 20.0
"""How far picks may be from the contour, and places from where the picks are mirrored [px of 400]."""


def _tried() -> Iterator[tuple[FoldLine, Scene]]:
    for seen in (scene("square"), scene("rectangle"), scene("square", folded=True)):
        for line in lines(seen):
            yield line, seen


def _act(policy: object, line: FoldLine, seen: Scene, seed: int = 0) -> Action:
    return policy.act(line, seen, np.random.default_rng(seed))  # pyright: ignore[reportAttributeAccessIssue]


@checks("policies", "picks lie on the contour, left of the line")
def _picks(subject: Subject) -> None:
    policy = subject.make()
    for line, seen in _tried():
        picks = _act(policy, line, seen).picks
        away = np.sqrt(((picks[:, None] - seen.contour) ** 2).sum(-1)).min(1)
        subject.require(
            (away <= NEAR).all(), "act", f"a pick is {away.max():.0f} px from the contour, where no cloth's edge is",
            "choose among scene.contour[line.lifts(scene.contour)]; pixels are (x, y), y down",
        )  # fmt: skip
        subject.require(
            line.lifts(picks).all(), "act", "a pick lies right of the fold line, on cloth that stays",
            "what is LEFT of the directed line is lifted: fold_line.lifts(points) says which points are",
        )  # fmt: skip


@checks("policies", "places are the picks, mirrored")
def _places(subject: Subject) -> None:
    policy = subject.make()
    for line, seen in _tried():
        action = _act(policy, line, seen)
        off = np.sqrt(((action.places - line.mirror(action.picks)) ** 2).sum(-1)).max()
        subject.require(
            off <= MIRRORED, "act", f"a place is {off:.0f} px from where its pick is mirrored on the fold line",
            "places = fold_line.mirror(picks)",
        )  # fmt: skip


@checks("policies", "picks and places lie inside the picture")
def _inside(subject: Subject) -> None:
    policy = subject.make()
    for line, seen in _tried():
        _act(policy, line, seen).check_inside(Camera())


@checks("policies", "the same seed gives the same picks")
def _seeded(subject: Subject) -> None:
    line, seen = next(_tried())
    first, second = (_act(subject.make(), line, seen, seed=7) for _ in range(2))
    subject.require(
        (first.picks == second.picks).all() and (first.places == second.places).all(), "act",
        "the same line, scene and seed give other picks", "draw from the rng that act is handed, and from nothing else",
    )  # fmt: skip


@checks("policies", "it remembers nothing of other lines")
def _forgets(subject: Subject) -> None:
    policy = subject.make()
    (line, seen), *others = _tried()
    first = _act(policy, line, seen)
    for other, there in others:
        _act(policy, other, there)
    again = _act(policy, line, seen)
    subject.require(
        (first.picks == again.picks).all(), "act", "after other lines the same one gives other picks",
        "keep nothing between calls: episodes are resumed, and studies run them in any order",
    )  # fmt: skip


@checks("policies", "it changes nothing that it is handed")
def _untouched(subject: Subject) -> None:
    policy = subject.make()
    for line, seen in _tried():
        before = kept(seen)
        _act(policy, line, seen)
        part = changed(before, seen)
        subject.require(not part, "act", f"it writes into scene.{part}", f"copy it first: scene.{part}.copy()")


@checks("policies", "a line that lifts nothing is refused")
def _refuses(subject: Subject) -> None:
    policy, seen = subject.make(), scene("square")
    beyond = FoldLine((5.0, 395.0), (5.0, 5.0))
    try:
        action = _act(policy, beyond, seen)
    except PlanError:
        return
    subject.require(
        False, "act", f"no cloth lies left of the line, and it picks at {action.picks.round().tolist()}",
        "raise PlanError('no cloth lies left of the fold line') then",
    )  # fmt: skip
