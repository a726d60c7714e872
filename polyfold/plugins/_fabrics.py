"""Where garments get their fabric: the one that is chosen, or the one that their kind is usually made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from polyfold.errors import GarmentError, PluginError, did_you_mean
from polyfold.plugins._host import HOST
from polyfold.plugins._traits import MadeOf

if TYPE_CHECKING:
    from polyfold.config import ComponentSpec
    from polyfold.garments import Fabric, Garment
    from polyfold.plugins.interfaces import GarmentKind
    from polyfold.polygon import Template

FALLBACK = "poplin"
"""What kinds of garment are made of that do not say: a plain cotton weave of medium weight and stiffness."""


SMALLEST, LARGEST = 0.1, 2.0
"""Longest side of a garment that is asked for by its size [m]."""


def is_usual(kind: str, spec: ComponentSpec) -> bool:
    """Whether a choice stands for the usual fabric of whichever kind of garment it is."""
    from polyfold.config import USUAL

    return kind == "fabrics" and spec.name == USUAL


def usual_parameters() -> list[str]:
    """What can be overridden of the usual fabric: the constants that every fabric has."""
    from polyfold.garments import Fabric

    return list(Fabric.LIMITS)


def default_fabric(garment_kind: str) -> str:
    """Name of the fabric that a kind of garment is usually made of; ``poplin`` where its class does not say.

    Raises:
        PluginError: if no plugin provides the kind.
    """
    cls = HOST.component_class("garments", garment_kind)
    return cls.default_fabric if isinstance(cls, MadeOf) else FALLBACK


def chosen_fabric(choice: ComponentSpec, garment_kind: str) -> ComponentSpec:
    """The component behind a choice: itself, or the usual fabric of the kind with the choice's parameters."""
    if not is_usual("fabrics", choice):
        return choice
    return choice.model_copy(update={"name": default_fabric(garment_kind)})


def _make_usual(garment_kind: str, params: Mapping[str, Any]) -> Fabric:
    name = default_fabric(garment_kind)
    if name not in HOST.names("fabrics"):
        owner = HOST.find("garments", garment_kind).plugin
        whose = "that was registered by hand" if owner.is_session else f"of the plugin {owner.label}"
        raise PluginError(
            f"the garment {garment_kind!r} {whose} is usually made of {name!r} (default_fabric), and no fabric is "
            f"called so; {did_you_mean(name, HOST.names('fabrics'))}"
        )
    return HOST.create("fabrics", name, params).fabric()


def make_fabric(choice: ComponentSpec, garment_kind: str) -> Fabric:
    """The fabric that an experiment's ``fabric`` means for a kind of garment.

    Raises:
        PluginError: if there is no such fabric or kind; the message suggests the nearest.
        ConfigError: if a constant is unknown or not plausible.
    """
    if is_usual("fabrics", choice):
        return _make_usual(garment_kind, choice.params)
    return HOST.create("fabrics", choice.name, choice.params).fabric()


def garment_template(garment_kind: str, fabric: Fabric | None = None) -> Template:
    """The polygon template of a kind of garment, told how thick a layer of it is: all panels of the fabric.

    Args:
        garment_kind: registered kind, for example ``tshirt``.
        fabric: what the person who folds it says it is made of; by default what the kind usually is.

    Raises:
        PluginError: if there is no such kind or fabric.
    """
    from polyfold.plugins.interfaces import SewnKind

    made = fabric or _make_usual(garment_kind, {})
    cls = HOST.component_class("garments", garment_kind)
    panels = cls.pattern.layers if isinstance(cls, SewnKind) else 1
    return HOST.create("garments", garment_kind).template().of_thickness(panels * made.thickness)


def _cut(generator: GarmentKind, kind: str, seed: int, edge_length: float, size: float, scale: float) -> Garment:
    """The garment as it is before it is scaled to a size."""
    try:
        return generator.generate(seed, edge_length / scale)
    except GarmentError as error:
        raise GarmentError(
            f"an edge length of {edge_length:g} m does not suit a {kind} of {size:g} m; give a smaller one"
        ) from error


def generate_garment(
    garment_kind: str,
    seed: int,
    edge_length: float | None = None,
    fabric: ComponentSpec | None = None,
    size: float | None = None,
) -> Garment:
    """The seeded garment of a kind, made of a fabric.

    Args:
        garment_kind: registered kind, for example ``tshirt``.
        seed: which one.
        edge_length: mesh size [m]; by default the kind's own.
        fabric: what it is made of; by default what the kind usually is.
        size: longest side of its bounding box [m], all else in proportion; by default what the seed draws.

    Raises:
        PluginError: if there is no such kind or fabric.
        ConfigError: if the seed is no whole number, or a constant of the fabric is unknown or not plausible.
        GarmentError: if the size is not one that two arms fold.
    """
    from polyfold.config import Experiment, checked_seed

    seed = checked_seed(seed)
    generator = HOST.create("garments", garment_kind)
    garment = generator.generate(seed) if edge_length is None else generator.generate(seed, edge_length)
    if size is not None:
        if not SMALLEST <= size <= LARGEST:
            raise GarmentError(
                f"a {garment_kind} of {size:g} m can't be folded here; give its longest side in metres, from "
                f"{SMALLEST:g} to {LARGEST:g}"
            )
        corners = garment.mesh.vertices
        scale = size / float((corners.max(axis=0) - corners.min(axis=0)).max())
        if edge_length is not None:
            garment = _cut(generator, garment_kind, seed, edge_length, size, scale)
        mesh = replace(garment.mesh, vertices=garment.mesh.vertices * scale)
        garment = replace(garment, name=f"{garment.name}-{100 * size:.0f}cm", mesh=mesh)
    return replace(garment, fabric=make_fabric(fabric or Experiment().fabric, garment_kind))
