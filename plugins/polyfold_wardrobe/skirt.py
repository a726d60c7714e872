"""The kind of garment ``skirt``: front and back, open at hem and waist."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from polyfold.garments import Garment, Pattern, curved_outline
from polyfold.polygon import SymmetricGenerator, Template, angle_range, ratio_range
from polyfold_wardrobe.cut import both_sides, mirrored, sewn

NAMES = ("hem_left", "waist_left", "waist_right", "hem_right")
HEM, WAIST = ("hem_left", "hem_right"), ("waist_left", "waist_right")
LEFT, RIGHT = ("hem_left", "waist_left"), ("hem_right", "waist_right")


class Skirt:
    """Skirts of 0.36 to 0.65 m length, straight to flared."""

    kind: ClassVar[str] = "skirt"
    pattern: ClassVar[Pattern] = Pattern(
        corners=NAMES, top=WAIST, bottom=HEM, size=0.55, layers=2, openings=(WAIST, ("hem_right", "hem_left"))
    )
    default_fabric: ClassVar[str] = "poplin"
    also_called: ClassVar[tuple[str, ...]] = ("miniskirt", "kilt")

    def template(self) -> Template:
        """The polygon template."""
        return Template(
            kind=self.kind,
            names=NAMES,
            descriptions={
                "hem_left": "left corner of the hem",
                "waist_left": "left end of the waistband",
                "waist_right": "right end of the waistband",
                "hem_right": "right corner of the hem",
            },
            parts={
                "hem": HEM,
                "waist": WAIST,
                "waistband": WAIST,
                "left side": LEFT,
                "right side": RIGHT,
                "left hem corner": ("hem_left",),
                "right hem corner": ("hem_right",),
            },
            canonical_shapes=[
                [(-0.35, 0.5), (-0.22, -0.5), (0.22, -0.5), (0.35, 0.5)],
                [(-0.5, 0.5), (-0.3, -0.5), (0.3, -0.5), (0.5, 0.5)],
            ],
            generator=SymmetricGenerator(NAMES, [HEM, WAIST]),
            penalties=[
                ratio_range(WAIST, HEM, 0.3, 0.85, 0.05),
                angle_range(WAIST, HEM, -12, 12),
                ratio_range(LEFT, RIGHT, 0.85, 1.18, 0.05),
                ratio_range(LEFT, HEM, 0.6, 2.2, 0.1),
            ],
        )

    def generate(self, seed: int, edge_length: float = 0.0125) -> Garment:
        """The seeded skirt, meshed at about ``edge_length`` [m]."""
        rng = np.random.default_rng([seed, 11])
        length = rng.uniform(0.36, 0.65)
        waist = rng.uniform(0.30, 0.42)
        hem = waist / rng.uniform(0.5, 0.8)
        corners = both_sides({"hem": (hem / 2, 0.0), "waist": (waist / 2, length)}, NAMES, rng)
        bulges = mirrored({LEFT: hem * rng.uniform(-0.02, 0.03), WAIST: rng.uniform(-0.015, 0.004)}, rng)
        bulges["hem_right", "hem_left"] = float(hem * rng.uniform(0.0, 0.04))
        rounding: dict[str, float] = dict.fromkeys(NAMES, float(rng.uniform(0.004, 0.014)))
        outline = curved_outline(corners, bulges=bulges, rounding=rounding, openings=self.pattern.openings)
        return sewn(self.kind, seed, outline, 2, edge_length, rng)
