"""What planners are held to."""

from __future__ import annotations

from typing import Any

from polyfold.errors import LLMError, PlanError, RefusedError
from polyfold.plugins._fabrics import garment_template
from polyfold.testing._checks import checks
from polyfold.testing._materials import Scripted, scene, unanswered
from polyfold.testing._subjects import Subject
from polyfold.types import Reply, Subgoal

GARBAGE = (
    "",
    "I would love to help you fold this!",
    '{"subgoals": "fold it"}',
    "{" * 200,
    '{"line": [[NaN, 1], [2, 3]]}',
    "```json\n[1, 2, 3]\n```",
)


def _both(subject: Subject, conversation: Scripted) -> Any:
    """What comes of asking for subgoals, and of planning the first one."""
    planner, seen = subject.make(), scene("square")
    subgoals = planner.subgoals("fold it in half", garment_template("square"), conversation)
    return planner.plan(subgoals[0] if subgoals else Subgoal("fold it in half"), seen, conversation)


@checks("planners", "garbage from the model ends in a PlanError, after bounded repairs")
def _garbage(subject: Subject) -> None:
    for text in GARBAGE:
        conversation = Scripted(Reply(text))
        try:
            made = _both(subject, conversation)
        except PlanError:
            continue
        subject.require(
            conversation.asked == 0, "plan", f"the model says {text[:30]!r}, and the plan is {made!r}",
            "check the answer; raise PlanError with the reason after a few repairs",
        )  # fmt: skip


@checks("planners", "a refusal of the model is passed on")
def _refusal(subject: Subject) -> None:
    conversation = Scripted(Reply("", finish="refusal", refusal="this can't be folded"))
    try:
        _both(subject, conversation)
    except RefusedError as error:
        subject.require(
            "can't be folded" in str(error), "subgoals", f"the model's reason is lost: {error}",
            "raise RefusedError(reply.refusal)",
        )  # fmt: skip
        return
    except PlanError:
        return
    subject.require(
        conversation.asked == 0, "subgoals", "the model refuses, and it plans on", "look at reply.refusal first"
    )


@checks("planners", "a model that can't be reached ends in an LLMError")
def _unreachable(subject: Subject) -> None:
    conversation = unanswered()
    try:
        _both(subject, conversation)
    except (LLMError, PlanError):
        return
    subject.require(
        conversation.asked == 0, "subgoals", "the model can't be reached, and it plans on", "let the LLMError pass"
    )
