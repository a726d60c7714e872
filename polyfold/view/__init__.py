"""Pictures: overlays, filmstrips, animations and sheets, as uint8 arrays of shape (H, W, 3) and as files.

Images in, images out; nothing here needs an episode, a simulator or a display. Colours can be told apart by
colour-blind readers and every stroke has a light edge, so that it shows on any cloth.
"""

from polyfold.view.animation import gif
from polyfold.view.filmstrips import Frame, filmstrip
from polyfold.view.overlays import overlay, value_map
from polyfold.view.polygons import grounding_picture, polygon_picture
from polyfold.view.saving import png, save
from polyfold.view.sheets import Card, garment_sheet, score_sheet
from polyfold.view.shown import animate, show

__all__ = [
    "Card",
    "Frame",
    "animate",
    "filmstrip",
    "garment_sheet",
    "gif",
    "grounding_picture",
    "overlay",
    "png",
    "polygon_picture",
    "save",
    "score_sheet",
    "show",
    "value_map",
]
