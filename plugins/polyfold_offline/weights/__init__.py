"""The weights of the reader, checked before they are used."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from polyfold.errors import ConfigError

FOLDER = Path(__file__).parent

SHA256 = {
    "reader.safetensors": "8d32971a79643771431780a186132183f14b80f4dcf5b66b23114d1cd0e0194b",
    "pieces.json": "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037",
    "words.json": "586d5ec805764a0597cfde150f963a841d91ad6c2bedaa2733e9a8b3b951c9af",
}

SURE = 0.85
"""Readings that are less likely than this are refused.

Of .5, .6, .7, .75, .8, .85, .9 the least at which today's weights fold no more of the sentences for development
otherwise than those before them did at .8; see ``experiments/results/language.md``.
"""


@cache
def checked_folder() -> Path:
    """The folder of the weights.

    Raises:
        ConfigError: if a file is missing or isn't the one that was published.
    """
    for name, wanted in SHA256.items():
        path = FOLDER / name
        found = hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else "missing"
        if found != wanted:
            raise ConfigError(
                f"{path} is {'missing' if found == 'missing' else 'not as published'}; install polyfold again"
            )
    return FOLDER
