"""The look that all pictures share: colours that colour-blind readers can tell apart, and fonts."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

Colour = tuple[int, int, int]

PAPER: Colour = (255, 255, 255)
INK: Colour = (28, 32, 40)
FAINT: Colour = (110, 116, 126)
RULE: Colour = (206, 210, 216)
POLYGON: Colour = (22, 28, 48)
GOAL: Colour = (204, 51, 17)
FOLD_LINE: Colour = (0, 150, 94)
LIFTED: Colour = (120, 196, 168)
"""The fold line's green, thin as it lies on cloth that is lifted."""
ARMS: tuple[Colour, Colour] = ((245, 133, 24), (214, 39, 130))
"""Orange and magenta: apart in hue for normal sight and in blueness for red-green blindness."""

MAP: tuple[Colour, ...] = (
    (0, 34, 78), (18, 53, 112), (59, 73, 108), (87, 93, 109), (112, 113, 115),
    (138, 134, 120), (167, 156, 118), (197, 180, 107), (229, 205, 82), (254, 232, 56),
)  # fmt: skip
"""Ten stops of cividis, from low to high."""


def css(colour: Colour) -> str:
    """A colour as style sheets have it."""
    return "#{:02x}{:02x}{:02x}".format(*colour)


@cache
def font(size: int, bold: bool = False) -> Any:
    """DejaVu Sans in pixels where matplotlib is installed (it has the signs we use), else Pillow's own font."""
    from PIL import ImageFont

    spec = find_spec("matplotlib")
    for folder in spec.submodule_search_locations if spec and spec.submodule_search_locations else ():
        name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
        file = Path(folder) / "mpl-data" / "fonts" / "ttf" / name
        if file.is_file():
            return ImageFont.truetype(str(file), size)
    return ImageFont.load_default(size)
