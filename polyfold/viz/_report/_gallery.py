"""The gallery: which episodes are shown, and their pictures as part of the page."""

from __future__ import annotations

import math
import statistics
from base64 import b64encode
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from polyfold.logs import StudyEpisodeRecord
from polyfold.viz._report._curves import smallest_scale
from polyfold.viz._report._source import Source

LIMIT = 15_000_000
"""Most characters of all embedded pictures together."""

TYPES = {b"RIFF": "image/webp", b"\x89PNG": "image/png"}


@dataclass(frozen=True)
class Card:
    """One episode to show.

    Attributes:
        record: the episode.
        pick: why it stands out among its variant and kind: ``best``, ``median``, ``failure`` or nothing.
        picture: data URI.
        panels: pictures in the strip.
    """

    record: StudyEpisodeRecord
    pick: str
    picture: str
    panels: int


@dataclass(frozen=True)
class Gallery:
    """The cards and what is missing.

    Attributes:
        cards: in the order of the variants; what stands out comes first.
        pictured: episodes that have a picture on disk.
        left_out: how many of these did not fit.
        unpictured: episodes without a picture.
        mapped: whether a card shows a policy's values of picks.
    """

    cards: Sequence[Card]
    pictured: int
    left_out: int
    unpictured: int
    mapped: bool


def gallery(source: Source, limit: int = LIMIT) -> Gallery:
    """Choose and read pictures until the limit is reached.

    What stands out comes first, then failures, then successes, each in turn from every variant, kind and cause, so that
    what is rare is not crowded out.
    """
    files = _files(source)
    pictured = [record for record in source.records if record.key in files]
    picks = _picks(source, pictured)
    turns = _turns(pictured)
    wanted = sorted(
        pictured,
        key=lambda record: (record.key not in picks, record.succeeded, turns[record.key]),
    )
    chosen: list[Card] = []
    spent = 0
    for record in wanted:
        card = _card(files[record.key], record, picks.get(record.key, ""))
        if card is not None:
            spent += len(card.picture)
            if spent > limit:
                break
            chosen.append(card)
    rank = {variant: index for index, variant in enumerate(source.variants)}
    order = ("best", "median", "failure", "")
    chosen.sort(key=lambda card: (rank.get(card.record.variant, len(rank)), order.index(card.pick)))
    unpictured = len(source.records) - len(pictured)
    mapped = any(card.record.values_picks for card in chosen)
    return Gallery(chosen, len(pictured), len(pictured) - len(chosen), unpictured, mapped)


def _files(source: Source) -> dict[str, Path]:
    """Pictures by the key of their episode, without those that are missing or lie outside of the run directory."""
    root = source.folder.resolve()
    found = {}
    for record in source.records:
        if record.picture:
            path = (root / record.picture).resolve()
            if path.is_relative_to(root) and path.is_file():
                found[record.key] = path
    return found


def _turns(records: Sequence[StudyEpisodeRecord]) -> dict[str, int]:
    """How many episodes of the same variant, kind and cause come before each, by key."""
    seen: Counter[tuple[str, str, str | None]] = Counter()
    turns = {}
    for record in records:
        group = (record.variant, record.garment.kind, record.cause)
        turns[record.key] = seen[group]
        seen[group] += 1
    return turns


def _picks(source: Source, pictured: Sequence[StudyEpisodeRecord]) -> dict[str, str]:
    """Why which episodes stand out, by key; each once."""
    found: dict[str, str] = {}
    needed = {record.key: smallest_scale(record, source.own_criterion) for record in source.records}
    for variant in source.variants:
        for kind in source.results.kinds():
            mine = [record for record in pictured if (record.variant, record.garment.kind) == (variant, kind)]
            everything = [needed[record.key] for record in source.of(variant, kind)]
            found |= _picks_of(mine, needed, [scale for scale in everything if math.isfinite(scale)])
    return found


def _picks_of(
    pictured: Sequence[StudyEpisodeRecord], needed: Mapping[str, float], everything: Sequence[float]
) -> dict[str, str]:
    """The best, the median and the first further failure of each cause.

    Args:
        pictured: episodes to choose from.
        needed: by key, the factor on the criterion's thresholds at which an episode just meets them.
        everything: these factors of all episodes, pictured or not, that the median is of.
    """
    found: dict[str, str] = {}
    scored = sorted((r for r in pictured if math.isfinite(needed[r.key])), key=lambda record: needed[record.key])
    successes = [record for record in scored if record.succeeded]
    if successes:
        found[successes[0].key] = "best"
    if scored:
        middle = statistics.median(everything)
        found.setdefault(min(scored, key=lambda record: abs(needed[record.key] - middle)).key, "median")
    failures = [record for record in pictured if not record.succeeded and record.key not in found]
    first_of_cause = {record.cause: record.key for record in reversed(failures)}
    return found | dict.fromkeys(first_of_cause.values(), "failure")


def _card(path: Path, record: StudyEpisodeRecord, pick: str) -> Card | None:
    data = path.read_bytes()
    media = next((media for start, media in TYPES.items() if data.startswith(start)), None)
    if media is None:
        return None
    uri = f"data:{media};base64,{b64encode(data).decode()}"
    return Card(record, pick, uri, _panels(data))


def _panels(data: bytes) -> int:
    """How many square panels stand side by side."""
    from io import BytesIO

    from PIL import Image

    with Image.open(BytesIO(data)) as picture:
        return max(1, round(picture.width / picture.height))
