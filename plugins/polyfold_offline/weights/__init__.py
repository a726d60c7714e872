"""The weights of the reader, checked before they are used."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from polyfold.errors import ConfigError

FOLDER = Path(__file__).parent

SHA256 = {
    "reader.safetensors": "6b6ee9982a906334c4b6f8c77a0d8d756aeb1bf12941383748100990fe61b2a0",
    "pieces.json": "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037",
    "words.json": "c42ed1317edf998dc1092af2c0ac8648bae76cfd4d3679a0b6c0fbbd6afe6b0f",
}

SURE = 0.6
"""Readings that are less likely than this are refused; chosen on the registers for development."""


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
