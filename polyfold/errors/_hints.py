"""Phrases for the messages of errors: what an unknown name may have meant, and what a model of pydantic refused."""

from __future__ import annotations

import errno
import math
import re
import reprlib
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from operator import index
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_origin

if TYPE_CHECKING:
    from pydantic import ValidationError
    from pydantic.fields import FieldInfo
    from pydantic_core import ErrorDetails


def did_you_mean(name: object, known: Iterable[str], otherwise: str | None = None) -> str:
    """Say which known names are near an unknown one, or which there are.

    Args:
        name: the name that is not known; something that is no text is near none.
        known: the names that are.
        otherwise: what to say where none is near; by default all names that are known.

    Returns:
        A phrase for the end of a message, such as ``did you mean 'caso'?``, the nearest name first.
    """
    known = list(known)
    near = get_close_matches(name, known, n=3, cutoff=0.6) if isinstance(name, str) else []
    if near:
        return f"did you mean {' or '.join(map(repr, near))}?"
    if otherwise is not None:
        return otherwise
    if not known:
        return "there are none"
    more = f" and {len(known) - _MANY} more" if len(known) > _MANY else ""
    return f"the known ones are {', '.join(known[:_MANY])}{more}"


_MANY = 20
"""Names that fit into a message."""


def file_problem(error: OSError, path: object = None) -> str:
    """Say why a file could not be read or written, and what to do.

    Args:
        error: what the operating system said.
        path: of the file; by default the one that the error names.

    Returns:
        A whole message, such as ``there is no shirt.png; check the path``.
    """
    place = error.filename if path is None else path
    if place is None:
        said = error.strerror or str(error) or type(error).__name__
        return f"reading or writing failed ({said}); check the disk and what may be written there"
    for kind, told in _FILE_PROBLEMS:
        if isinstance(error, kind):
            return told.format(place)
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return f"{place} can't be written, the disk is full; make room, or choose another disk"
    said = error.strerror or str(error) or type(error).__name__
    return f"{place} can't be read or written ({said}); check the path"


_FILE_PROBLEMS: tuple[tuple[type[OSError], str], ...] = (
    (FileNotFoundError, "there is no file {}; check the path"),
    (IsADirectoryError, "{} is a folder; give a file"),
    (NotADirectoryError, "there can be no {}, since a part of this path is a file; check the path"),
    (FileExistsError, "{} exists and is no folder; choose another path"),
    (PermissionError, "{} may not be read or written by you; change its permissions, or choose another path"),
)


def toml_problem(error: ValueError, text: str) -> str:
    """Say why a text is no TOML, and what to do, such as ``is not valid TOML: ...; correct it``."""
    of_escapes = str(error).startswith(("Unescaped", "Invalid hex", "Escaped character"))
    windows = re.search(r'"((?:[\w-]+:)?[A-Za-z]:\\(?!\\)[^"\n]*)"', text) if of_escapes else None
    remedy = f"write paths with a backslash in single quotes, '{windows[1]}'" if windows else "correct it"
    return f"is not valid TOML: {error}; {remedy}"


MOST = 2**63 - 1
"""The largest whole number that every file format and random generator here takes."""


def whole_number_problem(value: object, least: int = 0, written: str | None = None) -> str:
    """Say that a value is no whole number from ``least`` to :data:`MOST`; empty if it is one, numpy's included.

    Args:
        value: what is given.
        least: the smallest that will do.
        written: as what it was given, if it was read from a text.
    """
    try:
        number = least - 1 if isinstance(value, bool) else index(value)  # pyright: ignore[reportArgumentType]
    except TypeError:
        number = least - 1
    if least <= number <= MOST:
        return ""
    most = f" to {MOST}" if number > MOST else ""
    return f"{(value if written is None else written)!r} is not a whole number from {least}{most}; give one"


def misplaced_truth(values: Mapping[str, Any], fields: Mapping[str, FieldInfo]) -> str:
    """Say which number is given as true or false, which pydantic takes for 1 and 0; empty if none is.

    Args:
        values: what is given, by field.
        fields: a model's fields.
    """
    for name, value in values.items():
        if name not in fields:
            continue
        annotation, among = fields[name].annotation, name
        if isinstance(value, Mapping) and get_origin(annotation) is dict:  # a table of numbers
            annotation = _plain(get_args(annotation)[1])
            among, value = next(((f"{name}.{key}", v) for key, v in value.items() if isinstance(v, bool)), (name, None))
        if isinstance(value, bool) and _is_a_number(annotation):
            return f"has a bad value for {among!r}: {str(value).lower()} is no number; give one"
    return ""


def _plain(annotation: Any) -> Any:
    """A type without what ``Annotated`` says of it."""
    return get_args(annotation)[0] if get_origin(annotation) is Annotated else annotation


def _in_plain_words(problem: ErrorDetails) -> str:
    """What pydantic says, without the names of its own and Python's types."""
    wanted = _WANTED.get(problem["type"])
    if wanted is None:
        return problem["msg"].removeprefix("Value error, ")
    if problem["input"] is None:
        return f"{wanted} is wanted"
    return f"{wanted} is wanted, not {reprlib.repr(problem['input'])}"


_WANTED = {
    "string_type": "a text",
    "tuple_type": "a list",
    "list_type": "a list",
    "dict_type": "a table",
    "model_type": "a table",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "float_parsing": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_pattern_mismatch": "a name of letters, digits, '.', '_' and '-'",
}


def _is_a_number(annotation: Any) -> bool:
    """Whether a field takes a number and no truth value."""
    kinds = {annotation, *get_args(annotation)}
    return bool(kinds & {int, float}) and bool not in kinds


def validation_problem(error: ValidationError, known: Iterable[str] = (), below: int = 0) -> str:
    """Say what a model of pydantic refused first, and what to do.

    Args:
        error: what pydantic raised.
        known: the model's settings, to suggest one for an unknown name.
        below: leave out so many parts of the place in the model, which the message names already.

    Returns:
        A phrase for a message that begins with where the values came from, such as
        ``has a bad value for 'policy.gamma': Input should be less than 1; change it``.
    """
    problems = error.errors()
    problem = problems[0]
    if problem["type"] == "missing":  # what is missing was often given by a name that there is not
        problem = next((one for one in problems if one["type"] == "extra_forbidden"), problem)
    place = ".".join(str(part) for part in problem["loc"][below:])
    if problem["type"] == "extra_forbidden":
        known = list(known)
        return f"has no setting {place!r}; {did_you_mean(place, known) if known else 'remove it'}"
    if problem["type"] == "missing":
        return f"has no {place!r}; add it"
    said = _in_plain_words(problem)
    if isinstance(problem["input"], float) and math.isnan(problem["input"]):
        return f"has a bad value{f' for {place!r}' if place else ''}: nan is no number; give one"
    # A model's own check may already say what to do.
    advises = problem["type"] == "value_error" and ";" in said
    if advises:
        return f"has a bad value for {place!r}: {said}" if place else f"can't be used: {said}"
    if not problem["loc"]:
        return f"has values that don't go together: {said}; change them"
    return f"has a bad value{f' for {place!r}' if place else ''}: {said}; change it"
