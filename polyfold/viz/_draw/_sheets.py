"""Sheets: many pictures on one page, each with its name or score."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil, sqrt
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import ConfigError
from polyfold.viz._draw._canvas import Page, fitted, line_height, wrapped
from polyfold.viz._draw._saving import save
from polyfold.viz._draw._style import FAINT, INK, RULE

Image = NDArray[np.uint8]

GAP, MARGIN = 16, 28
HEADING, TITLE, CAPTION = 22, 15, 13


@dataclass(frozen=True, eq=False)
class Card:
    """One case of a sheet: pictures that belong together side by side, with a title above and a caption below.

    Attributes:
        pictures: one or more, uint8, shape (H, W, 3); any sizes.
        title: what it is.
        caption: how it came out.
    """

    pictures: Sequence[Image]
    title: str = ""
    caption: str = ""


def garment_sheet(
    pictures: Mapping[str, Image],
    heading: str = "",
    path: str | Path | None = None,
    *,
    columns: int | None = None,
    side: int = 200,
) -> Image:
    """A picture of each garment with its name below.

    Args:
        pictures: name -> picture, uint8, shape (H, W, 3); laid out in this order.
        heading: what stands above all.
        path: PNG to write.
        columns: pictures in a row; by default the page comes out a little wider than high.
        side: size of each picture [px].
    """
    cards = [Card((rgb,), caption=name) for name, rgb in pictures.items()]
    return score_sheet(cards, heading, path, columns=columns, side=side)


def score_sheet(
    cards: Sequence[Card],
    heading: str = "",
    path: str | Path | None = None,
    *,
    columns: int | None = None,
    side: int = 200,
) -> Image:
    """Cases in a grid, such as real garments beside their twins with the overlap.

    Args:
        cards: the cases; all with the same number of pictures line up best.
        heading: what stands above all.
        path: PNG to write.
        columns: cases in a row; by default the page comes out a little wider than high.
        side: size of each picture [px].

    Returns:
        uint8, shape (H, W, 3).

    Raises:
        ConfigError: if there are no cases.
    """
    if not cards:
        raise ConfigError("a sheet needs at least one picture; give some")
    most = max(len(card.pictures) for card in cards)
    card_width = most * side + (most - 1) * 4
    columns = columns or max(1, min(len(cards), ceil(sqrt(1.6 * len(cards) / most))))
    texts = [(_text(card.title, TITLE, card_width, True), _text(card.caption, CAPTION, card_width)) for card in cards]
    above = _height([title for title, _ in texts], TITLE, 6)
    below = _height([caption for _, caption in texts], CAPTION, 6)
    width = 2 * MARGIN + columns * (card_width + GAP) - GAP
    heading_lines = wrapped(heading, HEADING, width - 2 * MARGIN, bold=True)
    top = MARGIN + (len(heading_lines) * line_height(HEADING) + 14 if heading_lines else 0)
    row_height = above + side + below + GAP
    page = Page(width, top + ceil(len(cards) / columns) * row_height - GAP + MARGIN)
    page.lines(heading_lines, MARGIN, MARGIN - 4, HEADING, INK, bold=True)
    for number, (card, (title, caption)) in enumerate(zip(cards, texts, strict=True)):
        x = MARGIN + number % columns * (card_width + GAP)
        y = top + number // columns * row_height
        page.lines(title, x, y + above - 6 - len(title) * line_height(TITLE), TITLE, INK, bold=True)
        for place, rgb in enumerate(card.pictures):
            page.picture(fitted(rgb, side), x + place * (side + 4), y + above, frame=RULE)
        page.lines(caption, x, y + above + side + 6, CAPTION, FAINT)
    image = page.image()
    if path is not None:
        save(image, path)
    return image


def _text(text: str, size: int, width: int, bold: bool = False) -> list[str]:
    return wrapped(text, size, width, bold, most=2)


def _height(texts: Sequence[Sequence[str]], size: int, space: int) -> int:
    lines = max(len(text) for text in texts)
    return lines * line_height(size) + space if lines else 0
