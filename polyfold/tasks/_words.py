"""A suite's tasks in words, for a terminal and for a notebook."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape

Place = Mapping[str, float]


def moves_in_words(
    pairs: Iterable[tuple[Place, Place]] | None, crease: tuple[Place, Place] | None, lift: Place | None
) -> str:
    """One fold, by the names of its points; the arguments are those of a task's step."""
    if pairs is not None:
        moves = [f"{_named(source)} onto {_named(target)}" for source, target in pairs]
        return f"fold {' and '.join(moves)}"
    assert crease is not None
    assert lift is not None
    start, end = crease
    return f"fold {_named(lift)} over along the line from {_named(start)} to {_named(end)}"


def _named(point: Place) -> str:
    """``top left``, ``the middle of ...``, or how far it is from one point to the other."""
    names = [name.replace("_", " ") for name in point]
    if len(names) == 1:
        return names[0]
    shares = list(point.values())
    if max(shares) - min(shares) < 0.01 and len(names) > 3:
        return "the centre"
    if max(shares) - min(shares) < 0.01:
        return f"the middle of {', '.join(names[:-1])} and {names[-1]}"
    if len(names) == 2:
        return f"the point {_share(shares[1])} of the way from {names[0]} to {names[1]}"
    parts = [f"{_share(share)} {name}" for name, share in zip(names, shares, strict=True)]
    return f"the point {', '.join(parts[:-1])} and {parts[-1]}"


SHARES = {1 / 4: "a quarter", 1 / 3: "a third", 2 / 3: "two thirds", 3 / 4: "three quarters"}


def _share(share: float) -> str:
    return next((words for value, words in SHARES.items() if abs(share - value) < 0.005), f"{share:.0%}")


def sentences_in_words(sentences: Sequence[str]) -> str:
    """The first sentence that asks for a task, and how many others there are."""
    if not sentences:
        return "(no sentence)"
    more = len(sentences) - 1
    return f"“{sentences[0]}”" + (f" and {more} more" if more else "")


def listed(rows: Iterable[tuple[str, str, str, Sequence[str]]]) -> str:
    """Name, family, sentence and folds of each, as text."""
    blocks = []
    for name, family, sentence, folds in rows:
        lines = [f"{name}  [{family}]", f"    {sentence}"]
        lines += [f"    {f'{number}. ' if len(folds) > 1 else ''}{fold}" for number, fold in enumerate(folds, 1)]
        blocks.append("\n".join(lines))
    return "\n".join(blocks)


def as_table(rows: Iterable[tuple[str, str, str, Sequence[str]]]) -> str:
    """The same as an HTML table."""
    head = "".join(f'<th style="text-align:left">{name}</th>' for name in ("task", "family", "sentence", "folds"))
    body = "".join(
        "<tr>"
        + "".join(
            f'<td style="text-align:left;vertical-align:top">{cell}</td>'
            for cell in (escape(name), escape(family), escape(sentence), "<br>".join(map(escape, folds)))
        )
        + "</tr>"
        for name, family, sentence, folds in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
