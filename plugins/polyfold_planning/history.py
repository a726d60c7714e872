"""Which subgoals have been carried out, as planners tell language models."""

from __future__ import annotations

from collections.abc import Sequence

from polyfold.geometry import FoldLine
from polyfold.types import Action, Subgoal


def after(done: Sequence[str], subgoal: Subgoal, plan: FoldLine | Action | Subgoal) -> list[str]:
    """What has been done once the plan of a subgoal is carried out: what has come open is done no longer."""
    if isinstance(plan, Subgoal):
        return [text for text in done if text != plan.text]
    return [*done, subgoal.text]
