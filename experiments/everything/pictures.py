"""Pictures of what went wrong in a study."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from polyfold import viz
from polyfold.analysis import Results

MOST = 9


def failures(results: Results, folder: Path, variant: str = "polyfold") -> bytes:
    """The first failed garment of each sentence that was folded wrongly, as a PNG; refusals have nothing to show.

    Args:
        results: of a study whose failures were pictured.
        folder: its run directory.
        variant: whose failures.
    """
    failed = [r for r in results.of(variant) if not r.succeeded and r.failure is None and r.picture]
    first = {(record.task, record.wording): record for record in reversed(failed)}
    cards = []
    for record in [*first.values()][::-1][:MOST]:
        assert record.picture is not None
        with Image.open(folder / record.picture) as picture:
            strip = np.asarray(picture.convert("RGB"))
        ended = f"{record.cause}; quality {record.metrics['quality']:.0f}, IoU {record.metrics['miou']:.2f}"
        cards.append(viz.Card(_first_and_result(strip), record.instruction, ended))
    return viz.png(viz.score_sheet(cards, "Folded, but not what was asked for: the first fold, the end", columns=3))


def _first_and_result(strip: NDArray[np.uint8]) -> list[NDArray[np.uint8]]:
    """The square panels at both ends of a filmstrip, uint8, shape (H, W, 3)."""
    side = strip.shape[0]
    return [strip[:, :side], strip[:, -side:]]
