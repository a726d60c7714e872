"""The clause at hand, and what the words so far lead to expect of the next ones."""

from __future__ import annotations

from collections.abc import Sequence

from polyfold_rules.frames.frame import Frame
from polyfold_rules.words.tokens import Token


class OpenClause:
    """What an assembler knows between two tokens; the handlers of words, its subclasses, read and change it.

    Args:
        tokens: the tagged instruction.

    Attributes:
        frame: what the clause says so far.
        done: the clauses that have ended, each with when it is done: ``sentence``, ``then``, ``earlier``, ``later``.
        order: when the clause at hand is done.
        role: what the next noun phrase will be: ``moving``, ``target``, ``axis``, ``excluded``, ``leads`` or ``held``.
        purpose: whether what follows says what the fold is for or how it ends, not what moves.
        spanning: whether the phrases name the ends of a line: *between ... and ...*.
        spanning_from: whether they do so after *from*.
        shaping: whether a shape follows: *into a ...*, *make a ...*.
        joined: whether *and* or a comma stands before the token.
        comma: whether a comma stands directly before it.
        laying: whether the last verb lays something down, so that *along* tells where it goes.
        grasped: whether a part was taken hold of and is still meant by *it*.
        target_last: whether the last noun phrase was a target.
        contrasted: whether a *but* began the clause.
        axis_open: whether a noun phrase may still describe the line named before.
        sentence_start: how many clauses ended before this sentence.
        skip_to: index of the token to go on with, if a handler has read ahead.
        garments: garments named so far.
        several: whether more than one garment was named.
        passed: unknown words passed over.
        steps: a stated number of folds.
    """

    def __init__(self, tokens: Sequence[Token]) -> None:
        self.tokens = tokens
        self.done: list[tuple[str, Frame]] = []
        self.frame = Frame()
        self.order = "then"
        self.role = "moving"
        self.purpose = False
        self.spanning = False
        self.spanning_from = False
        self.shaping = False
        self.joined = False
        self.comma = False
        self.laying = False
        self.grasped = False
        self.target_last = False
        self.contrasted = False
        self.axis_open = True
        self.sentence_start = 0
        self.skip_to = 0
        self.garments: list[str] = []
        self.several = False
        self.passed: list[str] = []
        self.steps: int | None = None
        self._named_last = False
        self._line_last = False
        self._lead_last = False
        self._moving_last = False

    def _close(self, order: str = "then") -> None:
        """End the clause and begin the next, which is done in the given order."""
        if self.frame.empty and self.frame.leads is not None:
            self.frame.moving.append(self.frame.leads)
        if not self.frame.empty:
            self.done.append((self.order, self.frame))
            self.order = order
        elif order != "then":
            self.order = order
        self.frame = Frame()
        self.role, self.purpose, self.spanning, self.shaping = "moving", False, False, False
        self.spanning_from = self.contrasted = False
