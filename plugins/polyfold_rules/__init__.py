"""The offline solver behind ``--llm rules``: a parser of fold language and a geometric reasoner.

A sentence passes through the packages in this order, each of which imports only those before it:

    words     text to tagged tokens and noun phrases
    frames    tokens to one frame a clause, in the order in which they are done
    shapes    noun phrases to parts of the garment, and folds to fold lines
    clauses   frames to folds
    wishes    sentences that leave the folds open: the end that they ask for, and the folds that lead there
    rules     messages in, answers out

Its class is loaded when first used, so that importing the package stays light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__all__ = ["RulesLLM"]

if TYPE_CHECKING:
    from polyfold_rules.rules import RulesLLM


def __getattr__(name: str) -> Any:
    if name in __all__:
        from polyfold_rules import rules

        return getattr(rules, name)
    raise AttributeError(f"module 'polyfold_rules' has no attribute {name!r}")
