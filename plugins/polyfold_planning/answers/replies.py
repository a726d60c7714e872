"""Reading a language model's reply: reasoning, then one last fenced JSON object. Nothing in it is ever executed."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from polyfold.errors import PlanError, RefusedError
from polyfold.geometry import FoldLine
from polyfold.types import Action, Reply
from polyfold_planning.answers.lines import too_short

_FENCE = re.compile(r"```[ \t]*(?:json\b)?\s*(.*?)\s*(?:```|\Z)", re.DOTALL | re.IGNORECASE)
"""A fenced block, on one line or many; the last one may lack its end."""

MAX_REPLY = 100_000
_BRACES = 200
"""So many braces are tried as the beginning of an answer that stands in no fence."""


def answer_object(reply: Reply) -> Mapping[str, Any]:
    """The reply's last JSON object.

    Raises:
        RefusedError: if the model refuses, with its reason.
        PlanError: if there is none or it is not plain JSON; the message tells the model what to do.
    """
    if reply.refusal or reply.finish == "refusal":
        raise RefusedError(
            f"the language model refused: {reply.refusal or 'no reason given'}; rephrase the instruction"
        )
    if reply.finish == "length":
        raise PlanError("the answer was cut off before its end; answer more briefly")
    text = reply.text
    if len(text) > MAX_REPLY:
        raise PlanError("the answer is far too long; answer in a few sentences and one JSON object")
    content = _decoded(text)
    if not isinstance(content, dict):
        raise PlanError("the JSON at the end must be an object; end with one fenced ```json object")
    reason = content.get("refused")
    if isinstance(reason, str) and reason.strip():
        raise RefusedError(reason.strip()[:500])
    return {key: value for key, value in content.items() if key != "refused"}


def _decoded(text: str) -> Any:
    """The JSON of the last fenced block; without any, of the object that the text ends with."""
    blocks = [block for block in _FENCE.findall(text) if block]
    if not blocks:
        return _ending(text.rstrip())
    try:
        return json.loads(blocks[-1], parse_constant=_no_constants)
    except (ValueError, RecursionError) as error:
        raise PlanError(f"the last ```json block is not valid JSON ({error}); correct it") from error


def _ending(text: str) -> Any:
    """The object that a text ends with, from the first brace whose object reaches the end."""
    starts = [at for at, sign in enumerate(text) if sign == "{"] if text.endswith("}") else []
    for start in starts[:_BRACES]:
        try:
            return json.loads(text[start:], parse_constant=_no_constants)
        except (ValueError, RecursionError):
            continue
    raise PlanError("the answer has no fenced ```json block; end with exactly one")


def _no_constants(name: str) -> float:
    raise ValueError(f"{name} is no number")


def subgoals_in(content: Mapping[str, Any], at_most: int) -> list[str]:
    """The list of subgoal texts. Raises PlanError if it has another form."""
    found = content.get("subgoals")
    if not isinstance(found, list) or not all(isinstance(text, str) and text.strip() for text in found):
        raise PlanError('the JSON must have the form {"subgoals": ["fold the ...", ...]}; give a list of sentences')
    if not 1 <= len(found) <= at_most:
        raise PlanError(f"{len(found)} subgoals were given; give between 1 and {at_most}, or refuse with a reason")
    return [" ".join(text.split())[:300] for text in found]


def undone_in(content: Mapping[str, Any], done: Sequence[str]) -> str | None:
    """The subgoal that the answer says has come open; None if it says nothing of the kind.

    Raises:
        PlanError: if that was not done.
    """
    if "undone" not in content:
        return None
    text = content["undone"]
    if text not in done:
        known = "; ".join(done) or "nothing yet"
        raise PlanError(f"{str(text)[:100]!r} has not been done; name one of the folds done so far: {known}")
    return str(text)


def fold_line_in(content: Mapping[str, Any]) -> FoldLine:
    """The fold line [px]. Raises PlanError if it has another form or a coordinate is not finite."""
    line = content.get("fold_line")
    form = '{"fold_line": {"start": {"x": 0, "y": 0}, "end": {"x": 0, "y": 0}}}'
    if not isinstance(line, Mapping):
        raise PlanError(f"the JSON must have the form {form}")
    points = []
    for end in ("start", "end"):
        point = line.get(end)
        if not isinstance(point, Mapping):
            raise PlanError(f"the JSON must have the form {form}; {end!r} is missing")
        points.append(tuple(_coordinate(point.get(axis), end, axis) for axis in ("x", "y")))
    if points[0] == points[1]:
        raise PlanError(too_short(0.0))
    return FoldLine(points[0], points[1])


def plan_in(content: Mapping[str, Any], at_most: int, may_be_empty: bool) -> list[tuple[str, FoldLine]]:
    """Subgoals with their fold lines [px], in order.

    Args:
        content: the answer's object.
        at_most: how many are accepted.
        may_be_empty: whether nothing may be left to do.

    Raises:
        PlanError: if they have another form or number, or a coordinate is not finite.
    """
    folds = content.get("plan")
    if not isinstance(folds, list) or not all(isinstance(fold, Mapping) for fold in folds):
        raise PlanError('the JSON must have the form {"plan": [{"subgoal": "fold the ...", "fold_line": {...}}, ...]}')
    texts = [fold.get("subgoal") for fold in folds]
    if folds or not may_be_empty:
        texts = subgoals_in({"subgoals": texts}, at_most)
    return [(text, fold_line_in(fold)) for text, fold in zip(texts, folds, strict=True)]


def action_in(content: Mapping[str, Any], arms: Sequence[int]) -> Action:
    """Picks and places [px], each of shape (arms, 2).

    Args:
        content: the answer's object.
        arms: how many picks are allowed.

    Raises:
        PlanError: if they have another form or number, or a coordinate is not finite.
    """
    counts = " or ".join(str(count) for count in arms)
    form = '{"picks": [{"x": 0, "y": 0}], "places": [{"x": 0, "y": 0}]}'
    lists = {}
    for what in ("picks", "places"):
        points = content.get(what)
        if not isinstance(points, list) or not all(isinstance(point, Mapping) for point in points):
            raise PlanError(f"the JSON must have the form {form}, with {counts} of each; {what!r} is missing or wrong")
        if len(points) not in arms:
            raise PlanError(f"{len(points)} {what} were given; give {counts}")
        lists[what] = [[_coordinate(point.get(axis), what, axis) for axis in ("x", "y")] for point in points]
    if len(lists["picks"]) != len(lists["places"]):
        raise PlanError("every pick needs one place; give as many places as picks, in the same order")
    return Action(lists["picks"], lists["places"])


def says_done(content: Mapping[str, Any]) -> bool:
    """Whether the answer is that nothing is left to do: ``{"done": true}``."""
    return content.get("done") is True


def _coordinate(value: Any, end: str, axis: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or abs(value) > 1e6 or not math.isfinite(value):
        raise PlanError(f"{end}.{axis} must be a finite number of pixels, got {str(value)[:40]}; give plain numbers")
    return float(value)
