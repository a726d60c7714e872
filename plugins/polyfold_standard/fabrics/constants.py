"""What the bundled fabrics share: their constants as parameters, with units and plausible bounds.

The table in each fabric's docstring says where a constant comes from: a measurement, a range that was published, or
``plausible; no measurement found``. Works that several of them cite:

* Wang et al. 2011: ten cloths measured for simulation, doi 10.1145/2010324.1964966; weights from its data.
* ClothDrapeTester: 251 fabrics, SIGGRAPH Asia 2022. Mean bending length of warp and weft, from linear coefficients:
  median 19 mm, 5 % below 11 mm, 5 % above 29 mm; medians by weight 19 mm (0.1 to 0.2 kg/m²), 20 mm (0.2 to 0.3) and
  22 mm (0.3 to 0.6).
* RGBench: a t-shirt in a simulator fitted to captures, AAAI 2026, ``configs/cloth_params``: friction 0.6 on cloth, 0.27
  static on the table.
* Das et al. 2005: friction between fabrics falls with pressure, so that one coefficient holds for one load only; AUTEX
  Research Journal 5(3).

Creases: the share that stays is what a test of crease recovery (ISO 2313, AATCC 66) leaves of a fold, 1 - angle / 180°.
Elastic curvature is not tabulated anywhere we know; the KES bending test goes to 250 /m and leaves a residue by then.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field

from polyfold.garments import Fabric


def _constant(name: str, description: str) -> Any:
    low, high = Fabric.LIMITS[name]
    return Field(ge=low, le=high, allow_inf_nan=False, description=description)


Thickness = Annotated[float, _constant("thickness", "distance of touching plies under light load [m]")]
Weight = Annotated[float, _constant("weight", "mass of an area [kg/m²]")]
BendingLengthWarp = Annotated[float, _constant("bending_length_warp", "Peirce bending length along the warp [m]")]
BendingLengthWeft = Annotated[float, _constant("bending_length_weft", "Peirce bending length along the weft [m]")]
ClothFriction = Annotated[float, _constant("cloth_friction", "Coulomb friction between plies [1]")]
TableFriction = Annotated[float, _constant("table_friction", "Coulomb friction on the table [1]")]
CreaseYield = Annotated[float, _constant("crease_yield", "curvature up to which bending is elastic [1/m]")]
CreaseSet = Annotated[float, _constant("crease_set", "share of the curvature beyond that which stays, 0 to 1 [1]")]


class Constants(BaseModel):
    """Parameters of a fabric; each fabric gives them its own defaults."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    thickness: Thickness
    weight: Weight
    bending_length_warp: BendingLengthWarp
    bending_length_weft: BendingLengthWeft
    cloth_friction: ClothFriction
    table_friction: TableFriction
    crease_yield: CreaseYield
    crease_set: CreaseSet


class ConstantFabric:
    """A fabric of constants. Implements :class:`polyfold.plugins.interfaces.FabricKind`."""

    name: ClassVar[str]

    def __init__(self, config: Constants) -> None:
        self.config = config

    def fabric(self) -> Fabric:
        """The fabric with these constants."""
        return Fabric(self.name, **self.config.model_dump())
