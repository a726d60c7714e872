"""The component that another one disturbs on purpose: what was disturbed is not measured with."""

from __future__ import annotations

from polyfold import plugins
from polyfold.config import ComponentSpec
from polyfold.plugins.interfaces import HasReferenceConfig


def undisturbed(kind: str, chosen: ComponentSpec) -> ComponentSpec:
    """A component without the faults or noise that it may inject; itself if it injects none.

    Args:
        kind: of component, in the plural: ``simulators``.
        chosen: its name and parameters.
    """
    cls, config = plugins.configured(kind, chosen.name, chosen.params)
    if not isinstance(cls, HasReferenceConfig):
        return chosen
    name, params = cls.reference_config(config)
    found = ComponentSpec(name=name, params=dict(params))
    # What is inside another one may be disturbed itself.
    return found if name == chosen.name else undisturbed(kind, found)
