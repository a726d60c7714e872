"""The fabric ``felt``: pressed wool felt of low density, as of craft felt.

Sources; works in short form stand in :mod:`polyfold_standard.fabrics.constants`.

* thickness, 2.0 mm: chosen: roll felts are made from about 1.2 to 25 mm (SAE J314; ASTM D2475, doi
  10.1520/D2475-01R08).
* weight, 0.36 kg/m²: 0.18 g/cm³, as of the grades F-10 to F-15 of SAE J314, at that thickness.
* bending length, warp, 25 mm: plausible; no measurement found; of 251 fabrics 5 % lie above 29 mm
  (ClothDrapeTester).
* bending length, weft, 25 mm: as the warp's: a felt has no grain.
* friction on cloth, 0.6: plausible; no measurement found.
* friction on the table, 0.4: plausible; no measurement found on a table; suppliers list 0.37 for felt without
  saying on what.
* elastic curvature, 100 /m: plausible; no measurement found.
* share of a crease that stays, 0.35: plausible; no measurement found; felt hardly creases.
"""

from __future__ import annotations

from typing import ClassVar

from polyfold_standard.fabrics.constants import (
    BendingLengthWarp,
    BendingLengthWeft,
    ClothFriction,
    ConstantFabric,
    Constants,
    CreaseSet,
    CreaseYield,
    TableFriction,
    Thickness,
    Weight,
)


class Felt(ConstantFabric):
    """Pressed wool felt of low density, thick and alike in all directions: craft felt."""

    name: ClassVar[str] = "felt"

    class Config(Constants):
        """Its constants; sources in the module's docstring."""

        thickness: Thickness = 0.002
        weight: Weight = 0.36
        bending_length_warp: BendingLengthWarp = 0.025
        bending_length_weft: BendingLengthWeft = 0.025
        cloth_friction: ClothFriction = 0.6
        table_friction: TableFriction = 0.4
        crease_yield: CreaseYield = 100.0
        crease_set: CreaseSet = 0.35
