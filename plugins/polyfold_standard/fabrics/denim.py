"""The fabric ``denim``: cotton twill of about 10 oz, as of jeans.

Sources; works in short form stand in :mod:`polyfold_standard.fabrics.constants`.

* thickness, 0.95 mm: measured 0.80 to 1.19 mm (KES; Journal of Textiles 2016, 4614168, doi 10.1155/2016/4614168).
* weight, 0.33 kg/m²: measured 0.324 on an 11 oz denim (Wang et al. 2011).
* bending length, warp, 20 mm: 16 to 19 mm from the bending rigidities 1.4 to 2.2e-5 N·m of the same KES study (its
  Table 5) at 0.33 kg/m², which is assumed; median of cloth of 0.3 to 0.6 kg/m² 22 mm (ClothDrapeTester).
* bending length, weft, 17 mm: as the warp's.
* friction on cloth, 0.6: plausible; no measurement found; 0.6 fitted to a t-shirt (RGBench).
* friction on the table, 0.33: plausible; no measurement found on a table; 0.28 raw, 0.30 washed, 0.33 polished
  against a probe that moves like a finger (preprint, doi 10.21203/rs.3.rs-7719155/v1).
* elastic curvature, 100 /m: plausible; no measurement found.
* share of a crease that stays, 0.5: plausible; no measurement found.
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


class Denim(ConstantFabric):
    """Cotton twill of about 10 oz, stiff and firm: jeans."""

    name: ClassVar[str] = "denim"

    class Config(Constants):
        """Its constants; sources in the module's docstring."""

        thickness: Thickness = 0.00095
        weight: Weight = 0.33
        bending_length_warp: BendingLengthWarp = 0.02
        bending_length_weft: BendingLengthWeft = 0.017
        cloth_friction: ClothFriction = 0.6
        table_friction: TableFriction = 0.33
        crease_yield: CreaseYield = 100.0
        crease_set: CreaseSet = 0.5
