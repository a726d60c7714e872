"""Pages made from the code: what every kind of component must do, what comes with PolyFold, and the command line."""

from __future__ import annotations

import shutil
from pathlib import Path


def write_pages(folder: Path) -> None:
    """Write every page that is made into a folder, in place of what it holds.

    Pages that say the same as before are left as they are, so that Sphinx does not read them again.
    """
    from docs.making import command_line, components, kinds, modules, results, studies

    pages = {
        "fragments/kinds.txt": kinds.table(),
        **{f"howto/{kind}.md": kinds.page(kind) for kind in kinds.KINDS},
        "components.md": components.page(),
        "command-line.md": command_line.page(),
        "study-file.md": studies.page(),
        "reference/index.md": modules.index(),
        **{f"reference/{name}.md": modules.page(name) for name in modules.names()},
        "results/index.md": results.index(),
        **{f"results/{name}.md": results.page(name) for name in results.names()},
    }
    for file in folder.rglob("*.md"):
        if str(file.relative_to(folder).as_posix()) not in pages:
            file.unlink()
    for place, text in pages.items():
        file = folder / place
        file.parent.mkdir(parents=True, exist_ok=True)
        if not file.exists() or file.read_text("utf-8") != text:
            file.write_text(text, "utf-8")
    for picture in results.pictures():
        shutil.copyfile(picture, folder / "results" / picture.name)


def contents(pages: list[str]) -> str:
    """A list of pages, as Sphinx wants it, that is not shown on its own page."""
    return "\n".join(["```{toctree}", ":hidden:", "", *pages, "```", ""])
