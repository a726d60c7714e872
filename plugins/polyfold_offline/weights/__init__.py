"""The weights of the reader, checked before they are used."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from polyfold.errors import ConfigError

FOLDER = Path(__file__).parent

SHA256 = {
    "reader.safetensors": "481836f91e592991c5395908d4c93e7f1bd112504d3ba30f871e4eca0b008288",
    "pieces.json": "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037",
    "words.json": "7162cd6e85689bba96c79c61bc613ad6a33bbf64d9f0c25fe19e6cb394007400",
}

SURE = 0.8
"""Readings that are less likely than this are refused. Chosen on the sentences for development that nobody looked at
before the weights were trained: the least of .5, .6, .7, .8, .9 at which at most 2 % of them were folded otherwise."""


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
