"""The recorded tables, as they stand in ``experiments/results``."""

from __future__ import annotations

import re
from pathlib import Path

from docs.making import contents

FOLDER = Path(__file__).parents[2] / "experiments" / "results"


def names() -> list[str]:
    """The tables, by file."""
    return sorted(file.stem for file in FOLDER.glob("*.md") if file.stem != "README")


def pictures() -> list[Path]:
    """The pictures beside them."""
    return sorted(file for file in FOLDER.iterdir() if file.suffix in (".png", ".gif"))


def index() -> str:
    """What they were measured with, and the list of them."""
    return f"{_text('README')}\n{contents(names())}"


def page(name: str) -> str:
    """One of them, under its name."""
    text = _text(name)
    return text if text.startswith("# ") else f"# {name.replace('_', ' ')}\n\n{text}"


def _text(name: str) -> str:
    """A file, with links to files of the repository told as such."""
    return re.sub(r"\[([^\]]+)\]\((?:\.\./)+([^)]+)\)", r"\1 (`\2`)", (FOLDER / f"{name}.md").read_text("utf-8"))
