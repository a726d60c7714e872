"""The garment kind ``rectangle``."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from polyfold.garments import Garment, Pattern
from polyfold_standard.garments.cloth import CLOTH, cloth_garment, cloth_outline

if TYPE_CHECKING:
    from polyfold.polygon import Template


class Rectangle:
    """Rectangular cloths, such as towels, of 0.25 to 0.45 m; half of them lie upright, half across."""

    kind: ClassVar[str] = "rectangle"
    pattern: ClassVar[Pattern] = CLOTH
    # Of this size they are napkins and tea towels, not bath towels, which would be terry.
    default_fabric: ClassVar[str] = "poplin"
    also_called: ClassVar[tuple[str, ...]] = ("towel", "scarf", "cloth")

    def template(self) -> Template:
        """The polygon template."""
        from polyfold_standard.templates.quads import rectangle_template

        return rectangle_template()

    def generate(self, seed: int, edge_length: float = 0.01) -> Garment:
        """The seeded rectangle, meshed at about ``edge_length`` [m]."""
        rng = np.random.default_rng([seed, 2])
        long = rng.uniform(0.25, 0.45)
        short = long * rng.uniform(0.5, 0.9)
        width, height = (short, long) if rng.uniform() < 0.5 else (long, short)
        return cloth_garment(self.kind, seed, cloth_outline(width, height, rng), edge_length, rng)
