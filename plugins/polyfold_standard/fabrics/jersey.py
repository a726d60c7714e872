"""The fabric ``jersey``: plain weft-knitted cotton, as of t-shirts.

Sources; works in short form stand in :mod:`polyfold_standard.fabrics.constants`.

* thickness, 0.7 mm: plausible; no measurement found under this load.
* weight, 0.16 kg/m²: plausible; no measurement found of single jersey; an interlock t-shirt weighs 0.187 (Wang et
  al. 2011).
* bending length, warp, 12 mm (wales): plausible; no measurement found; limp for a fabric: of 251, 5 % lie below 11
  mm (ClothDrapeTester).
* bending length, weft, 9 mm (courses): plausible; no measurement found; knits bend more easily across.
* friction on cloth, 0.6: fitted to a t-shirt (RGBench).
* friction on the table, 0.3: fitted to the same t-shirt: 0.27, static (RGBench), rounded up.
* elastic curvature, 100 /m: plausible; no measurement found.
* share of a crease that stays, 0.45: plausible; no measurement found; knits recover better than weaves.
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


class Jersey(ConstantFabric):
    """Plain weft-knitted cotton, limp: t-shirts."""

    name: ClassVar[str] = "jersey"

    class Config(Constants):
        """Its constants; sources in the module's docstring."""

        thickness: Thickness = 0.0007
        weight: Weight = 0.16
        bending_length_warp: BendingLengthWarp = 0.012
        bending_length_weft: BendingLengthWeft = 0.009
        cloth_friction: ClothFriction = 0.6
        table_friction: TableFriction = 0.3
        crease_yield: CreaseYield = 100.0
        crease_set: CreaseSet = 0.45
