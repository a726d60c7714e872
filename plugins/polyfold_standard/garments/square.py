"""The garment kind ``square``."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from polyfold.garments import Garment, Pattern
from polyfold_standard.garments.cloth import CLOTH, cloth_garment, cloth_outline

if TYPE_CHECKING:
    from polyfold.polygon import Template


class Square:
    """Square cloths, such as napkins, of 0.25 to 0.45 m."""

    kind: ClassVar[str] = "square"
    pattern: ClassVar[Pattern] = CLOTH
    default_fabric: ClassVar[str] = "poplin"
    also_called: ClassVar[tuple[str, ...]] = ("napkin", "handkerchief", "bandana")

    def template(self) -> Template:
        """The polygon template."""
        from polyfold_standard.templates.quads import square_template

        return square_template()

    def generate(self, seed: int, edge_length: float = 0.01) -> Garment:
        """The seeded square, meshed at about ``edge_length`` [m]."""
        rng = np.random.default_rng([seed, 1])
        side = rng.uniform(0.25, 0.45)
        outline = cloth_outline(side, side * rng.uniform(0.97, 1.03), rng)
        return cloth_garment(self.kind, seed, outline, edge_length, rng)
