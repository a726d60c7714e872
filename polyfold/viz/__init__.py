"""Pictures of episodes and of results."""

from polyfold.viz._pictures import filmstrip_of, result_of
from polyfold.viz._plots import PALETTE, bars
from polyfold.viz._provider_figure import provider_figure
from polyfold.viz._thumbnails import thumbnail
from polyfold.viz.draw._animation import gif
from polyfold.viz.draw._filmstrips import Frame, filmstrip
from polyfold.viz.draw._overlays import overlay, value_map
from polyfold.viz.draw._polygons import grounding_picture, polygon_picture
from polyfold.viz.draw._saving import png, save
from polyfold.viz.draw._sheets import Card, garment_sheet, score_sheet
from polyfold.viz.draw._shown import animate, show

__all__ = [
    "PALETTE",
    "Card",
    "Frame",
    "animate",
    "bars",
    "filmstrip",
    "filmstrip_of",
    "garment_sheet",
    "gif",
    "grounding_picture",
    "overlay",
    "png",
    "polygon_picture",
    "provider_figure",
    "result_of",
    "save",
    "score_sheet",
    "show",
    "thumbnail",
    "value_map",
]
