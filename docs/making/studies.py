"""What a study file may hold, from the model that reads it."""

from __future__ import annotations

import inspect
import json
import re

from polyfold.studies import Study


def page() -> str:
    """A row a setting."""
    told = descriptions()
    rows = [
        f"| `{name}` | {_default(field)} | {told[name].replace('|', chr(92) + '|')} |"
        for name, field in Study.model_fields.items()
    ]
    told = (
        "Everything but the name may be left out. Dotted paths reach into components: [what each takes](components.md)."
    )
    head = ["# What a study file may hold", "", told, "", "| setting | default | what |", "|---|---|---|"]
    return "\n".join([*head, *rows, ""])


def descriptions() -> dict[str, str]:
    """What the model's documentation says of each setting."""
    listed = inspect.cleandoc(Study.__doc__ or "").partition("Attributes:\n")[2]
    entries = re.split(r"\n(?=    [\w, ]+: )", "\n" + listed)
    split = (entry.strip().partition(": ") for entry in entries if entry.strip())
    return {
        name: re.sub(r":\w+:`(\w+)`", r"`\1`", " ".join(words.split())).replace("``", "`")
        for names, _, words in split
        for name in names.split(", ")
    }


def _default(field) -> str:
    if field.is_required():
        return ""
    value = field.get_default(call_default_factory=True)
    return "" if value is None else f"`{json.dumps(value, default=list)}`"
