"""What one can ask for at once, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from polyfold._brief import brief
from polyfold.errors import ConfigError
from polyfold.geometry import FoldLine
from polyfold.rollout._rollout import Mark
from polyfold.types import Action, Step

Move = str | FoldLine | Action
"""What one can ask for: a sentence, a fold line, or picks and places."""


@dataclass(frozen=True, eq=False, repr=False)
class Turn:
    """What was asked for at once, and the folds that came of it."""

    move: Move
    steps: tuple[Step, ...]
    before: Mark

    __repr__ = brief

    def in_words(self) -> str:
        """What was asked for, and what came of it."""
        asked = f"“{self.move}”" if isinstance(self.move, str) else "a fold line"
        asked = "picks and places" if isinstance(self.move, Action) else asked
        return f"{asked}: {'; '.join(step.in_words() for step in self.steps)}"


def refuse_what_is_no_move(move: object, kinds: Any) -> None:
    """Raise ConfigError for what is neither."""
    if not isinstance(move, kinds):
        raise ConfigError(f"{move!r} is no move; give a polyfold.FoldLine, a polyfold.Action, or to fold a sentence")
