"""Success criteria: ours, and a stricter one as others use it."""

from __future__ import annotations

from typing import ClassVar

from polyfold.types import Threshold


class Lenient:
    """Ours. The moved part is bounded because an untouched garment scores well on the other two where it is small."""

    thresholds: ClassVar[tuple[Threshold, ...]] = (
        Threshold("mppe", 30.0),
        Threshold("miou", 0.80, higher_is_better=True),
        Threshold("moved-part", 40.0),
    )


class Strict:
    """Particles off by at most twice their radius, as LangDef and BiFold ask."""

    thresholds: ClassVar[tuple[Threshold, ...]] = (
        Threshold("mppe", 12.5),
        Threshold("miou", 0.90, higher_is_better=True),
        Threshold("moved-part", 20.0),
    )
