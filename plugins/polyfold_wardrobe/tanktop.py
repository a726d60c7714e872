"""The kind of garment ``tanktop``: front and back with straps, open at the neck, both arms and the hem."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from polyfold.garments import Garment, Pattern, curved_outline
from polyfold.polygon import (
    Penalty,
    SymmetricGenerator,
    Template,
    angle_range,
    offset_range,
    position_range,
    ratio_range,
)
from polyfold_wardrobe.cut import SIDES, both_sides, mirrored, paired, sewn, turned

NAMES = (
    "hem_left", "underarm_left", "strap_outer_left", "strap_inner_left", "neck_center",
    "strap_inner_right", "strap_outer_right", "underarm_right", "hem_right",
)  # fmt: skip
HEM, CHEST = ("hem_left", "hem_right"), ("underarm_left", "underarm_right")
STRAPS = ("strap_outer_left", "strap_outer_right")
SPINE = (HEM, STRAPS)


class TankTop:
    """Tank tops of 0.34 to 0.52 m chest and 0.55 to 0.70 m length."""

    kind: ClassVar[str] = "tanktop"
    pattern: ClassVar[Pattern] = Pattern(
        corners=NAMES,
        top=STRAPS,
        bottom=HEM,
        size=0.65,
        layers=2,
        openings=(
            ("underarm_left", "strap_outer_left"),
            ("strap_inner_left", "strap_inner_right"),
            ("strap_outer_right", "underarm_right"),
            ("hem_right", "hem_left"),
        ),
    )
    default_fabric: ClassVar[str] = "jersey"
    also_called: ClassVar[tuple[str, ...]] = ("tank top", "singlet", "undershirt", "vest")

    def template(self) -> Template:
        """The polygon template."""
        words = {
            "hem": "{side} corner of the hem",
            "underarm": "{side} end of the arm opening, below the arm",
            "strap_outer": "outer end of the {side} strap",
            "strap_inner": "inner end of the {side} strap",
        }
        told = {f"{name}_{side}": text.format(side=side) for name, text in words.items() for side in SIDES}
        return Template(
            kind=self.kind,
            names=NAMES,
            descriptions={**told, "neck_center": "center of the neck opening, its lowest point"},
            parts=_parts(),
            canonical_shapes=[_shape(0.30, 0.22, 0.10), _shape(0.36, 0.25, 0.12)],
            generator=SymmetricGenerator(NAMES, paired(NAMES)),
            penalties=_penalties(),
        )

    def generate(self, seed: int, edge_length: float = 0.0125) -> Garment:
        """The seeded tank top, meshed at about ``edge_length`` [m]."""
        rng = np.random.default_rng([seed, 14])
        chest, length = rng.uniform(0.34, 0.52), rng.uniform(0.55, 0.70)
        outer, strap = chest * rng.uniform(0.36, 0.42), rng.uniform(0.045, 0.07)
        half = {
            "hem": (chest * rng.uniform(0.48, 0.55), 0.0),
            "underarm": (chest / 2, length - rng.uniform(0.20, 0.26)),
            "strap_outer": (outer, length - rng.uniform(0.0, 0.01)),
            "strap_inner": (outer - strap, length),
            "neck_center": (0.0, length - rng.uniform(0.13, 0.19)),
        }
        corners = both_sides(half, NAMES, rng)
        bulges = mirrored(
            {
                ("hem_left", "underarm_left"): chest * rng.uniform(-0.03, 0.015),
                ("underarm_left", "strap_outer_left"): -rng.uniform(0.015, 0.035),
                ("strap_inner_left", "neck_center"): -rng.uniform(0.01, 0.03),
            },
            rng,
        )
        bulges["hem_right", "hem_left"] = float(rng.uniform(-0.004, 0.02))
        rounding = {name: float(rng.uniform(0.004, 0.012)) for name in NAMES if name != "neck_center"}
        outline = curved_outline(corners, bulges=bulges, rounding=rounding, openings=self.pattern.openings)
        return sewn(self.kind, seed, outline, 2, edge_length, rng)


def _shape(chest: float, outer: float, strap: float) -> list[tuple[float, float]]:
    """An upright outline, y down, 0.85 long: half the chest, where a strap ends outside, how wide it is."""
    right = [(outer - strap, 0.0), (outer, 0.01), (chest, 0.32), (chest, 0.85)]
    return [*((-x, y) for x, y in reversed(right)), (0.0, 0.22), *right]


def _parts() -> dict[str, tuple[str, ...]]:
    parts: dict[str, tuple[str, ...]] = {}
    for side in SIDES:
        strap = (f"strap_outer_{side}", f"strap_inner_{side}")
        parts |= {
            f"{side} strap": strap,
            f"{side} side": (f"hem_{side}", f"underarm_{side}"),
            f"{side} hem corner": (f"hem_{side}",),
        }
    neckline = ("strap_inner_left", "neck_center", "strap_inner_right")
    straps = ("strap_outer_left", "strap_inner_left", "strap_inner_right", "strap_outer_right")
    return {**parts, "hem": HEM, "straps": straps, "shoulders": STRAPS, "neckline": neckline}


def _penalties() -> list[Penalty]:
    left, right = (("strap_outer_" + side, "strap_inner_" + side) for side in SIDES)
    found = [
        ratio_range(left, right, 0.75, 1.33, 0.08),
        angle_range(left, HEM, -22, 22),
        angle_range(right, ("hem_right", "hem_left"), -22, 22),
        ratio_range(("hem_left", "strap_outer_left"), ("hem_right", "strap_outer_right"), 0.94, 1.06, 0.03),
        angle_range(HEM, SPINE, 80, 100, 5),
        angle_range(STRAPS, SPINE, 80, 100, 5),
        ratio_range(SPINE, HEM, 1.0, 2.1, 0.1),
        ratio_range(CHEST, HEM, 0.85, 1.1, 0.05),
        ratio_range(STRAPS, CHEST, 0.66, 0.92, 0.05),
        position_range("neck_center", STRAPS, 0.45, 0.55, 0.03),
        offset_range("neck_center", STRAPS, 0.25, 0.7, 0.06),
    ]
    for side in SIDES:
        seam, strap = (f"hem_{side}", f"underarm_{side}"), (f"strap_outer_{side}", f"strap_inner_{side}")
        found += [
            turned(seam, SPINE, side, (-8, 8), 4),
            position_range(f"underarm_{side}", SPINE, 0.52, 0.74, 0.04),
            ratio_range(strap, STRAPS, 0.1, 0.28, 0.03),
        ]
    return found
