"""How values show themselves where IPython runs: registered by name, so that nothing is imported before it is shown."""

from __future__ import annotations

import sys
from typing import Any

SHOWN = (
    ("polyfold.garments._garment", "Garment"),
    ("polyfold.geometry._fold_line", "FoldLine"),
    ("polyfold.polygon._folded", "FoldedModel"),
    ("polyfold.polygon._template", "Template"),
    ("polyfold.tasks._suite", "Task"),
    ("polyfold.types._decisions", "Action"),
    ("polyfold.types._perception", "Observation"),
    ("polyfold.types._perception", "Scene"),
)
"""Home and name of each class that is a picture: what is drawn stands in :mod:`polyfold.viz._values`."""


def register() -> None:
    """Have IPython show these values as pictures, and figures too; nothing where it does not run."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    if shell is not None:
        pictures = shell.display_formatter.formatters["image/png"]
        for module, name in SHOWN:
            pictures.for_type_by_name(module, name, _png)
        # IPython itself shows a figure as text until %matplotlib was called.
        pictures.for_type_by_name("matplotlib.figure", "Figure", _figure_png)


def _png(value: Any) -> bytes:
    from polyfold.viz._draw._saving import png
    from polyfold.viz._values import picture_of

    return png(picture_of(value))


def _figure_png(figure: Any) -> bytes:
    from io import BytesIO

    content = BytesIO()
    figure.savefig(content, format="png", dpi=120, bbox_inches="tight")
    return content.getvalue()
