"""The fabric ``terry``: cotton terry of medium weight, as of bath towels.

Sources; works in short form stand in :mod:`polyfold_standard.fabrics.constants`.

* thickness, 2.0 mm: plausible; no measurement found under this load; the trade gives 2.5 to 9 mm for the height of
  free loops.
* weight, 0.40 kg/m²: plausible; no measurement found; the trade calls towels of 0.3 to 0.5 medium.
* bending length, warp, 16 mm: plausible; no measurement found; 22 mm is the median of cloth of 0.3 to 0.6 kg/m²
  (ClothDrapeTester), and loops add weight rather than stiffness.
* bending length, weft, 14 mm: as the warp's.
* friction on cloth, 0.7: plausible; no measurement found; loops interlock.
* friction on the table, 0.5: plausible; no measurement found.
* elastic curvature, 100 /m: plausible; no measurement found.
* share of a crease that stays, 0.45: plausible; no measurement found; loops keep folds from being sharp.
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


class Terry(ConstantFabric):
    """Cotton terry of medium weight, thick and soft: bath towels."""

    name: ClassVar[str] = "terry"

    class Config(Constants):
        """Its constants; sources in the module's docstring."""

        thickness: Thickness = 0.002
        weight: Weight = 0.4
        bending_length_warp: BendingLengthWarp = 0.016
        bending_length_weft: BendingLengthWeft = 0.014
        cloth_friction: ClothFriction = 0.7
        table_friction: TableFriction = 0.5
        crease_yield: CreaseYield = 100.0
        crease_set: CreaseSet = 0.45
