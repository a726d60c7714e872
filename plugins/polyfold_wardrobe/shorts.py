"""The kind of garment ``shorts``: front and back, open at the waist and both leg ends."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from polyfold.garments import Garment, Pattern, curved_outline
from polyfold.polygon import Penalty, SymmetricGenerator, Template, angle_range, position_range, ratio_range
from polyfold_wardrobe.cut import SIDES, both_sides, mirrored, paired, sewn, turned

NAMES = (
    "leg_inner_left", "leg_outer_left", "waist_left", "waist_right", "leg_outer_right", "leg_inner_right", "crotch",
)  # fmt: skip
WAIST = ("waist_left", "waist_right")
LEG_ENDS = ("leg_outer_left", "leg_inner_left", "leg_inner_right", "leg_outer_right")
SPINE, DOWN = (LEG_ENDS, WAIST), (WAIST, LEG_ENDS)


class Shorts:
    """Shorts of 0.30 to 0.55 m length."""

    kind: ClassVar[str] = "shorts"
    pattern: ClassVar[Pattern] = Pattern(
        corners=NAMES,
        top=WAIST,
        bottom=("leg_outer_left", "leg_outer_right"),
        size=0.5,
        layers=2,
        openings=(("leg_inner_left", "leg_outer_left"), WAIST, ("leg_outer_right", "leg_inner_right")),
        slits=("crotch",),
    )
    default_fabric: ClassVar[str] = "denim"
    also_called: ClassVar[tuple[str, ...]] = ("short trousers", "bermudas", "swim trunks")

    def template(self) -> Template:
        """The polygon template."""
        words = {
            "leg_inner": "inner corner of the {side} leg's end",
            "leg_outer": "outer corner of the {side} leg's end",
            "waist": "{side} end of the waist",
        }
        told = {f"{name}_{side}": text.format(side=side) for name, text in words.items() for side in SIDES}
        return Template(
            kind=self.kind,
            names=NAMES,
            descriptions={**told, "crotch": "crotch, where the legs meet"},
            parts=_parts(),
            canonical_shapes=[
                _shape(waist=0.4, length=0.9, rise=0.6, gap=0.06, leg=0.36),
                _shape(waist=0.36, length=1.1, rise=0.6, gap=0.04, leg=0.32),
            ],
            generator=SymmetricGenerator(NAMES, paired(NAMES)),
            penalties=_penalties(),
            covered=("crotch",),
        )

    def generate(self, seed: int, edge_length: float = 0.0125) -> Garment:
        """The seeded shorts, meshed at about ``edge_length`` [m]."""
        rng = np.random.default_rng([seed, 13])
        waist = rng.uniform(0.30, 0.44)
        length = waist * rng.uniform(0.95, 1.35)
        leg, gap = waist * rng.uniform(0.40, 0.52), rng.uniform(0.03, 0.10)
        rise = length * rng.uniform(0.5, 0.66)
        half = {
            "leg_inner": (gap / 2, 0.0),
            "leg_outer": (gap / 2 + leg, 0.01),
            "waist": (waist / 2, length),
            "crotch": (0.0, length - rise),
        }
        corners = both_sides(half, NAMES, rng)
        bulges = mirrored(
            {
                ("leg_inner_left", "leg_outer_left"): rng.uniform(-0.002, 0.006),
                ("leg_outer_left", "waist_left"): waist * rng.uniform(-0.01, 0.03),
                WAIST: rng.uniform(-0.015, 0.005),
                ("crotch", "leg_inner_left"): rng.uniform(-0.006, 0.003),
            },
            rng,
        )
        rounding: dict[str, float] = dict.fromkeys(NAMES, float(rng.uniform(0.004, 0.012)))
        outline = curved_outline(corners, bulges=bulges, rounding=rounding, openings=self.pattern.openings)
        return sewn(self.kind, seed, outline, 2, edge_length, rng)


def _shape(waist: float, length: float, rise: float, gap: float, leg: float) -> list[tuple[float, float]]:
    """An upright outline, y down: half waist, length, rise, half the gap between the legs, width of a leg's end."""
    right = [(waist, 0.0), (gap + leg, length), (gap, length)]
    return [*((-x, y) for x, y in reversed(right)), *right, (0.0, rise)]


def _parts() -> dict[str, tuple[str, ...]]:
    parts: dict[str, tuple[str, ...]] = {}
    for side in SIDES:
        end = (f"leg_inner_{side}", f"leg_outer_{side}")
        parts |= {
            f"{side} leg": (*end, f"waist_{side}", "crotch"),
            f"{side} leg end": end,
            f"{side} side": (f"leg_outer_{side}", f"waist_{side}"),
            f"{side} waist corner": (f"waist_{side}",),
        }
    return {**parts, "waist": WAIST, "leg ends": LEG_ENDS, "crotch": ("crotch",)}


def _penalties() -> list[Penalty]:
    found = [
        angle_range(WAIST, SPINE, 80, 100, 5),
        ratio_range(SPINE, WAIST, 0.8, 1.5, 0.1),
        position_range("crotch", DOWN, 0.46, 0.7, 0.04),
        position_range("crotch", WAIST, 0.4, 0.6, 0.05),
        Penalty("position", ("leg_inner_left", "leg_inner_right"), WAIST, -0.02, 0.5, 0.05),
        ratio_range(("waist_left", "leg_outer_left"), ("waist_right", "leg_outer_right"), 0.85, 1.18, 0.08),
        ratio_range(("leg_inner_left", "leg_outer_left"), ("leg_inner_right", "leg_outer_right"), 0.85, 1.18, 0.1),
    ]
    for side in SIDES:
        seam, end = (f"waist_{side}", f"leg_outer_{side}"), (f"leg_inner_{side}", f"leg_outer_{side}")
        found += [
            ratio_range(end, WAIST, 0.36, 0.58, 0.06),
            turned(end, seam, side, (60, 120)),
            turned(seam, DOWN, side, (-8, 22), 5),
        ]
    return found
