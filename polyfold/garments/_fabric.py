"""What a garment is made of: the constants of a fabric that simulators and the ideal fold go by."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import ClassVar

from polyfold.errors import GarmentError


@dataclass(frozen=True)
class Fabric:
    """A fabric by its measurable constants, in SI units.

    Attributes:
        name: what it is called, for example ``denim``.
        thickness: distance of touching plies under light load [m].
        weight: mass of an area [kg/m²].
        bending_length_warp, bending_length_weft: Peirce's bending length [m] along and across: a strip's flexural
            rigidity per width is weight · 9.81 m/s² · bending length³ (Peirce 1930, doi 10.1080/19447023008661529).
            Warp is upright in the garment's mesh; in knits it is the wales' direction.
        cloth_friction: Coulomb friction between plies.
        table_friction: Coulomb friction on the table.
        crease_yield: curvature up to which bending is elastic [1/m].
        crease_set: share of the curvature beyond ``crease_yield`` that stays, from 0 (elastic) to 1.

    Raises:
        GarmentError: if a constant is not finite or not plausible, see :attr:`LIMITS`.
    """

    name: str
    thickness: float
    weight: float
    bending_length_warp: float
    bending_length_weft: float
    cloth_friction: float
    table_friction: float
    crease_yield: float
    crease_set: float

    LIMITS: ClassVar[Mapping[str, tuple[float, float]]] = MappingProxyType(
        {
            "thickness": (0.0001, 0.01),
            "weight": (0.01, 3.0),
            "bending_length_warp": (0.001, 0.1),
            "bending_length_weft": (0.001, 0.1),
            "cloth_friction": (0.0, 2.0),
            "table_friction": (0.0, 2.0),
            "crease_yield": (0.0, 100_000.0),
            "crease_set": (0.0, 1.0),
        }
    )
    """Lowest and highest plausible value of each constant, in its unit."""

    def __post_init__(self) -> None:
        for constant, value in self.constants().items():
            low, high = self.LIMITS[constant]
            if not (math.isfinite(value) and low <= value <= high):
                raise GarmentError(
                    f"the fabric {self.name!r} has {constant}={value:g}, which is not plausible; "
                    f"give it in SI units, from {low:g} to {high:g}"
                )

    @property
    def bending_length(self) -> float:
        """Geometric mean of both bending lengths [m], for models that bend alike in every direction."""
        return math.sqrt(self.bending_length_warp * self.bending_length_weft)

    def constants(self) -> dict[str, float]:
        """Every constant by name, without the fabric's own name: what results depend on."""
        return {constant: float(getattr(self, constant)) for constant in self.LIMITS}


UNCHOSEN = Fabric(
    name="poplin",
    thickness=0.00045,
    weight=0.12,
    bending_length_warp=0.018,
    bending_length_weft=0.013,
    cloth_friction=0.5,
    table_friction=0.35,
    crease_yield=100.0,
    crease_set=0.5,
)
"""What a garment is made of before one is chosen for it: the same as the bundled ``poplin``, which has the sources.

Generators of garments know no fabrics; this keeps what they make usable without the host of plugins.
"""
