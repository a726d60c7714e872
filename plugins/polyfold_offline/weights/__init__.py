"""The weights of the reader, checked before they are used."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from polyfold.errors import ConfigError

FOLDER = Path(__file__).parent

SHA256 = {
    "reader.safetensors": "21c569f5eb3cf8bb7d2322e96cb8d8f2fefcefede27bb5b887c111d437e6a7ab",
    "pieces.json": "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037",
    "words.json": "03ab09a4ccad4437e52cc27b3bd4d6a1d41585dc8e57de58ae3534d22319bd5f",
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
