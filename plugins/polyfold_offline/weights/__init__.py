"""The weights of the reader, checked before they are used."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from polyfold.errors import ConfigError

FOLDER = Path(__file__).parent

SHA256 = {
    "reader.safetensors": "74b92005c9f8f3d3527fc28049368aaeab31381e01e7f21540a15bbce9d2fc71",
    "pieces.json": "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037",
    "words.json": "18a037892a50fa19c370a119874ff26cbb68bfed571754bfdd27d7733079b4a7",
}

SURE = 0.8
"""Readings that are less likely than this are refused. Chosen on the sentences for development: the least of .5, .6,
.7, .8, .9 at which at most 2 % were folded otherwise and at least 98 % of the impossible ones refused, of all of them
and of those that nobody had looked at before."""


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
