"""What every component is held to."""

from __future__ import annotations

from polyfold.plugins._traits import Configurable
from polyfold.testing._checks import EVERY, checks
from polyfold.testing._materials import without_network
from polyfold.testing._subjects import Subject


@checks(EVERY, "it can be made, and each time anew")
def _can_be_made(subject: Subject) -> None:
    if subject.cls() is None or getattr(subject.cls(), "uses", ()):
        return
    with without_network() as asked:
        first, second = subject.make(), subject.make()
    subject.require(
        first is not second, "__init__", "two of it are one and the same", "make a new object each time; keep no state"
    )
    subject.require(
        not asked, "__init__", f"constructing it asks for a connection to {asked[:1]}", "connect when it is first used"
    )


@checks(EVERY, "its parameters say what they are")
def _parameters(subject: Subject) -> None:
    cls = subject.cls()
    if not isinstance(cls, Configurable):
        return
    bare = [name for name, field in cls.Config.model_fields.items() if not field.description]
    subject.require(
        not bare, "Config", f"{', '.join(bare)} has no description", "write Field(default=…, description='… [unit]')"
    )
    extra = cls.Config.model_config.get("extra")
    subject.require(
        extra == "forbid", "Config", "it takes parameters that it does not know in silence",
        "write model_config = ConfigDict(extra='forbid', frozen=True)",
    )  # fmt: skip
