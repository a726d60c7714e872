"""Pictures of episodes and of results."""

from polyfold.viz import _pictures as _pictures
from polyfold.viz._draw._animation import gif
from polyfold.viz._draw._filmstrips import Frame, filmstrip
from polyfold.viz._draw._overlays import overlay, value_map
from polyfold.viz._draw._polygons import grounding_picture
from polyfold.viz._draw._saving import png, save
from polyfold.viz._draw._sheets import Card, score_sheet
from polyfold.viz._draw._shown import animate, show
from polyfold.viz._plots import PALETTE
from polyfold.viz._provider_figure import provider_figure

__all__ = [
    "PALETTE",
    "Card",
    "Frame",
    "animate",
    "filmstrip",
    "gif",
    "grounding_picture",
    "overlay",
    "png",
    "provider_figure",
    "save",
    "score_sheet",
    "show",
    "value_map",
]
