"""The kind of garment ``towel``: one panel, longer than the paper's rectangles."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import ClassVar

import numpy as np

from polyfold.garments import Garment, Pattern, curved_outline
from polyfold.polygon import SymmetricGenerator, Template, angle_range, ratio_range
from polyfold_wardrobe.cut import both_sides, sewn

CORNERS = ("bottom_left", "top_left", "top_right", "bottom_right")
LEFT, TOP, RIGHT, BOTTOM = zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True)


class Towel:
    """Towels of 0.6 to 0.9 m, one and a half to three times as long as wide."""

    kind: ClassVar[str] = "towel"
    pattern: ClassVar[Pattern] = Pattern(
        corners=CORNERS, top=("top_left", "top_right"), bottom=("bottom_left", "bottom_right"), size=0.8, cyclic=CORNERS
    )
    default_fabric: ClassVar[str] = "terry"
    also_called: ClassVar[tuple[str, ...]] = ("bath towel", "beach towel")

    def template(self) -> Template:
        """The polygon template."""
        edges = (LEFT, TOP, RIGHT, BOTTOM, LEFT)
        return Template(
            kind=self.kind,
            names=CORNERS,
            descriptions={name: f"{name.replace('_', ' ')} corner" for name in CORNERS},
            parts={
                **{f"{name.replace('_', ' ')} corner": (name,) for name in CORNERS},
                "left edge": LEFT, "top edge": TOP, "right edge": RIGHT, "bottom edge": BOTTOM,
            },
            canonical_shapes=[[(-w, 1.0), (-w, -1.0), (w, -1.0), (w, 1.0)] for w in (0.33, 0.5, 0.66, 1.5, 2.0, 3.0)],
            generator=SymmetricGenerator(CORNERS, [("bottom_left", "bottom_right"), ("top_left", "top_right")]),
            penalties=[
                *(angle_range(after, before, 70, 110, 4.0) for before, after in pairwise(edges)),
                ratio_range(LEFT, RIGHT, 0.85, 1.18, 0.05),
                ratio_range(TOP, BOTTOM, 0.85, 1.18, 0.05),
                ratio_range(LEFT, BOTTOM, 0.25, 4.0),
            ],
            cyclic=True,
        )  # fmt: skip

    def generate(self, seed: int, edge_length: float = 0.0125) -> Garment:
        """The seeded towel, meshed at about ``edge_length`` [m]."""
        rng = np.random.default_rng([seed, 12])
        length = rng.uniform(0.6, 0.9)
        width = length / rng.uniform(1.5, 3.0)
        half = {"bottom": (width / 2, -length / 2), "top": (width / 2, length / 2)}
        corners = both_sides(half, CORNERS, rng)
        bulges: dict[tuple[str, str], float] = {
            pair: float(rng.uniform(-0.003, 0.004)) for pair in (LEFT, TOP, RIGHT, BOTTOM)
        }
        rounding: dict[str, float] = dict.fromkeys(CORNERS, float(rng.uniform(0.004, 0.012)))
        outline = curved_outline(corners, bulges=bulges, rounding=rounding)
        return replace(sewn(self.kind, seed, outline, 1, edge_length, rng), cyclic=CORNERS)
