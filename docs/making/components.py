"""Everything that comes with PolyFold: each component with what can be set of it."""

from __future__ import annotations

from html import escape

from polyfold import plugins
from polyfold.api._describe import About, about
from polyfold.plugins.hookspecs import KINDS, singular


def page() -> str:
    """All kinds, all components, all parameters."""
    told = [
        "# What is inside",
        "",
        "Every part is a component of a plugin, named on the command line, in TOML and in notebooks. "
        '`polyfold plugins show NAME` and `polyfold.describe("NAME")` tell the same of what is installed with you.',
        "",
    ]
    for kind in KINDS:
        told += [f"## {kind.capitalize()}", "", f"[How to write one](howto/{singular(kind)}.md)", ""]
        for name in bundled(kind):
            told += _component(about(kind, name))
    return "\n".join(told)


def bundled(kind: str) -> list[str]:
    """The names of a kind's components that come with PolyFold."""
    found = plugins.catalog().components[kind]
    return sorted(name for name, entries in found.items() if entries[0].plugin.distribution == "polyfold")


def _component(told: About) -> list[str]:
    lines = [f"### `{told.name}` ({told.kind})", "", f"{escape(told.summary)}.", ""]
    if told.parameters:
        lines += ["| set | values | default | what |", "|---|---|---|---|"]
        for one in told.parameters:
            default = f"`{one.default}`" if 0 < len(one.default) < 60 else ""
            cells = (f"`{one.place}{one.name}`", one.values, default, one.description)
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
        lines.append("")
    return lines
