"""What later packages make of a value, pictures and records: they register here how, so that values stay bare."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from polyfold.errors import PolyfoldError

_MAKERS: dict[tuple[type, str], Callable[..., Any]] = {}

Maker = TypeVar("Maker", bound=Callable[..., Any])


def makes(cls: type, view: str) -> Callable[[Maker], Maker]:
    """Decorate the function that makes a view of values of a class: ``@makes(Episode, "filmstrip")``."""

    def register(maker: Maker) -> Maker:
        _MAKERS[cls, view] = maker
        return maker

    return register


def view_of(value: Any, view: str, *arguments: Any) -> Any:
    """The view of a value. Raises PolyfoldError if the package that makes it was not imported yet."""
    maker = _MAKERS.get((type(value), view))
    if maker is None:
        raise PolyfoldError(f"nothing makes the {view} of a {type(value).__name__} yet; import polyfold.viz first")
    return maker(value, *arguments)
