"""The fabric ``poplin``: plain-woven cotton, as of shirts, napkins and tea towels.

Sources; works in short form stand in :mod:`polyfold_standard.fabrics.constants`.

* thickness, 0.45 mm: plausible; no measurement found under this load; a plain cotton of 0.150 kg/m² has 0.318 mm
  under a thickness gauge's (Penava et al. 2014, Fibres & Textiles in Eastern Europe 22(2), Table 1, as quoted
  elsewhere: the paper was not seen).
* weight, 0.12 kg/m²: plausible; no measurement found; that plain cotton weighs 0.150.
* bending length, warp, 18 mm: plausible; no measurement found; the median of 251 fabrics is 19 mm, also from 0.1 to
  0.2 kg/m² (ClothDrapeTester).
* bending length, weft, 13 mm: plausible; no measurement found; poplin has about half as many threads across.
* friction on cloth, 0.5: plausible; no measurement found.
* friction on the table, 0.35: plausible; no measurement found; 0.27 static for a t-shirt (RGBench).
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


class Poplin(ConstantFabric):
    """Plain-woven cotton of medium stiffness: shirts, napkins, tea towels."""

    name: ClassVar[str] = "poplin"

    class Config(Constants):
        """Its constants; sources in the module's docstring."""

        thickness: Thickness = 0.00045
        weight: Weight = 0.12
        bending_length_warp: BendingLengthWarp = 0.018
        bending_length_weft: BendingLengthWeft = 0.013
        cloth_friction: ClothFriction = 0.5
        table_friction: TableFriction = 0.35
        crease_yield: CreaseYield = 100.0
        crease_set: CreaseSet = 0.5
