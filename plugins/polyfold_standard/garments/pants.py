"""The garment kind ``pants``: front and back, open at the waist and both leg ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment, Outline, Pattern, curved_outline, mesh_panels
from polyfold_standard.garments.colours import fabric_colours

if TYPE_CHECKING:
    from polyfold.polygon import Template


PATTERN = Pattern(
    corners=(
        "leg_inner_left",
        "leg_outer_left",
        "waist_left",
        "waist_right",
        "leg_outer_right",
        "leg_inner_right",
        "crotch",
    ),
    top=("waist_left", "waist_right"),
    bottom=("leg_outer_left", "leg_outer_right"),
    size=0.8,
    layers=2,
    openings=(
        ("leg_inner_left", "leg_outer_left"),
        ("waist_left", "waist_right"),
        ("leg_outer_right", "leg_inner_right"),
    ),
    slits=("crotch",),
)


class Pants:
    """Trousers of 0.62 to 0.95 m length, straight to flared."""

    kind: ClassVar[str] = "pants"
    pattern: ClassVar[Pattern] = PATTERN
    default_fabric: ClassVar[str] = "denim"
    also_called: ClassVar[tuple[str, ...]] = ("trousers", "jeans", "slacks")

    def template(self) -> Template:
        """The polygon template."""
        from polyfold_standard.templates.pants import pants_template

        return pants_template()

    def generate(self, seed: int, edge_length: float = 0.0125) -> Garment:
        """The seeded trousers, meshed at about ``edge_length`` [m]."""
        rng = np.random.default_rng([seed, 4])
        mesh, keypoints = mesh_panels(_outline(rng), 2, edge_length)
        return Garment(self.kind, f"{self.kind}-{seed:04d}", seed, mesh, keypoints, fabric_colours(rng))


def _outline(rng: np.random.Generator) -> Outline:
    length = rng.uniform(0.62, 0.95)
    waist = float(np.clip(length * rng.uniform(0.40, 0.54), 0.28, 0.46))
    corners = _corners(length, waist, rng)
    return curved_outline(corners, bulges=_bulges(waist, rng), rounding=_rounding(rng), openings=PATTERN.openings)


def _corners(length: float, waist: float, rng: np.random.Generator) -> dict[str, NDArray[np.float64]]:
    """All seven corners in template order [m], upright, leg ends near y = 0, each side a little different."""
    rise = length * rng.uniform(0.27, 0.38)
    gap = rng.uniform(0.04, 0.16)
    leg = waist * rng.uniform(0.34, 0.52)
    half = {
        "leg_inner": (gap / 2, 0.0),
        "leg_outer": (gap / 2 + leg, 0.008),
        "waist": (waist / 2, length),
    }

    def corner(name: str, sign: float) -> NDArray[np.float64]:
        x, y = half[name]
        return np.array([sign * x, y]) + rng.uniform(-0.004, 0.004, 2)

    return {
        "leg_inner_left": corner("leg_inner", -1.0),
        "leg_outer_left": corner("leg_outer", -1.0),
        "waist_left": corner("waist", -1.0),
        "waist_right": corner("waist", 1.0),
        "leg_outer_right": corner("leg_outer", 1.0),
        "leg_inner_right": corner("leg_inner", 1.0),
        "crotch": np.array([0.0, length - rise]) + rng.uniform(-0.005, 0.005, 2),
    }


def _bulges(waist: float, rng: np.random.Generator) -> dict[tuple[str, str], float]:
    """How far each seam's middle lies outside its straight edge [m]; alike on both sides."""
    outer = waist * rng.uniform(-0.01, 0.06)
    inner = rng.uniform(-0.008, 0.004)
    band, end = rng.uniform(-0.018, 0.006), rng.uniform(-0.003, 0.006)
    pairs = {
        ("leg_inner_left", "leg_outer_left"): end,
        ("leg_outer_left", "waist_left"): outer,
        ("waist_left", "waist_right"): band,
        ("waist_right", "leg_outer_right"): outer,
        ("leg_outer_right", "leg_inner_right"): end,
        ("leg_inner_right", "crotch"): inner,
        ("crotch", "leg_inner_left"): inner,
    }
    return {pair: float(bulge * rng.uniform(0.8, 1.2)) for pair, bulge in pairs.items()}


def _rounding(rng: np.random.Generator) -> dict[str, float]:
    """Where the roundings begin, seen from the corner [m]."""
    waist, leg, crotch = rng.uniform(0.004, 0.014), rng.uniform(0.003, 0.012), rng.uniform(0.012, 0.03)
    return {
        "waist_left": waist,
        "waist_right": waist,
        "crotch": crotch,
        **{f"leg_{edge}_{side}": leg for edge in ("inner", "outer") for side in ("left", "right")},
    }
