"""A garment to fold by hand: with fold lines, with picks, with sentences, and back again; a widget in JupyterLab."""

from polyfold.playground import _showing as _showing
from polyfold.playground._playground import Playground, play

__all__ = [
    "Playground",
    "play",
]
