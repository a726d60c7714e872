"""The t-shirt's template."""

from __future__ import annotations

from functools import cache

from polyfold.polygon import (
    Penalty,
    SymmetricGenerator,
    Template,
    angle_range,
    offset_range,
    position_range,
    ratio_range,
)
from polyfold_standard.templates.sides import turned

NAMES = (
    "hem_left",
    "armpit_left",
    "sleeve_bottom_left",
    "sleeve_top_left",
    "shoulder_left",
    "neck_left",
    "neck_center",
    "neck_right",
    "shoulder_right",
    "sleeve_top_right",
    "sleeve_bottom_right",
    "armpit_right",
    "hem_right",
)

SIDES = ("left", "right")

HEM = ("hem_left", "hem_right")
SHOULDERS = ("shoulder_left", "shoulder_right")
SPINE = (HEM, SHOULDERS)
NECK = ("neck_left", "neck_right")


@cache
def tshirt_template() -> Template:
    """A t-shirt, front and back, with sleeves from short to elbow-long."""
    return Template(
        kind="tshirt",
        names=NAMES,
        descriptions=_descriptions(),
        parts=_parts(),
        canonical_shapes=[
            _shape(shoulder=0.25, length=0.72, sleeve=(0.22, 0.13), cuff=(-0.05, 0.15)),
            _shape(shoulder=0.25, length=0.72, sleeve=(0.18, 0.15), cuff=(-0.09, 0.12)),
            _shape(shoulder=0.19, length=0.72, sleeve=(0.16, 0.10), cuff=(-0.06, 0.13)),
        ],
        generator=SymmetricGenerator(NAMES, [(n, n.replace("_left", "_right")) for n in NAMES if n.endswith("_left")]),
        penalties=[*_body(), *_collar(), *_sleeve("left", 1.0), *_sleeve("right", -1.0), *_likeness()],
    )


def _shape(
    shoulder: float, length: float, sleeve: tuple[float, float], cuff: tuple[float, float]
) -> list[tuple[float, float]]:
    """An upright outline: half shoulder width, length, the sleeve's and the cuff's run (outward, down)."""
    chest, top = 1.1 * shoulder, 0.04
    end = (shoulder + sleeve[0], top + sleeve[1])
    right = {
        "neck": (0.4 * shoulder, 0.0),
        "shoulder": (shoulder, top),
        "sleeve_top": end,
        "sleeve_bottom": (end[0] + cuff[0], end[1] + cuff[1]),
        "armpit": (chest, top + 0.8 * shoulder),
        "hem": (chest, length),
    }
    corners = {"neck_center": (0.0, 0.08)}
    for name, (x, y) in right.items():
        corners |= {f"{name}_right": (x, y), f"{name}_left": (-x, y)}
    return [corners[name] for name in NAMES]


def _descriptions() -> dict[str, str]:
    words = {
        "hem": "{side} corner of the hem",
        "armpit": "{side} armpit",
        "sleeve_bottom": "bottom end of the {side} sleeve's cuff",
        "sleeve_top": "top end of the {side} sleeve's cuff",
        "shoulder": "{side} shoulder, where the sleeve begins",
        "neck": "{side} end of the neck opening",
    }
    named = {f"{name}_{side}": text.format(side=side) for name, text in words.items() for side in SIDES}
    return {**named, "neck_center": "center of the neck opening, its lowest point"}


def _parts() -> dict[str, tuple[str, ...]]:
    parts: dict[str, tuple[str, ...]] = {}
    for side in SIDES:
        ends = (f"sleeve_bottom_{side}", f"sleeve_top_{side}")
        parts |= {
            f"{side} sleeve": (f"armpit_{side}", *ends, f"shoulder_{side}"),
            f"{side} cuff": ends,
            f"{side} armpit": (f"armpit_{side}",),
            f"{side} shoulder": (f"shoulder_{side}",),
            f"{side} side": (f"hem_{side}", f"armpit_{side}", *ends, f"shoulder_{side}", f"neck_{side}"),
            f"{side} hem corner": (f"hem_{side}",),
        }
    return {
        **parts,
        "hem": HEM,
        "collar": ("neck_left", "neck_center", "neck_right"),
        "shoulders": SHOULDERS,
        "body": ("hem_left", "armpit_left", "shoulder_left", "shoulder_right", "armpit_right", "hem_right"),
    }


def _body() -> list[Penalty]:
    found = [
        angle_range(HEM, SPINE, 80, 100, 5),
        angle_range(SHOULDERS, SPINE, 80, 100, 5),
        ratio_range(SPINE, SHOULDERS, 1.0, 1.8, 0.15),
        ratio_range(SHOULDERS, HEM, 0.78, 1.1, 0.08),
    ]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        seam, armhole = (f"hem_{side}", f"armpit_{side}"), (f"armpit_{side}", f"shoulder_{side}")
        found += [
            angle_range(seam, SPINE, -6, 6, 4),
            # The contour hardly shows the shoulder; how the armhole leans and how long it is does.
            turned(armhole, SPINE, sign, (3, 11), 4),
            ratio_range(armhole, SHOULDERS, 0.4, 0.53, 0.05),
            position_range(f"armpit_{side}", SPINE, 0.6, 0.74, 0.04),
        ]
    return found


def _collar() -> list[Penalty]:
    return [
        ratio_range(NECK, SHOULDERS, 0.33, 0.46, 0.05),
        position_range("neck_left", SHOULDERS, 0.26, 0.35, 0.04),
        position_range("neck_right", SHOULDERS, 0.65, 0.74, 0.04),
        offset_range("neck_left", SHOULDERS, -0.13, -0.05, 0.04),
        offset_range("neck_right", SHOULDERS, -0.13, -0.05, 0.04),
        position_range("neck_center", NECK, 0.46, 0.54, 0.04),
        offset_range("neck_center", NECK, 0.0, 0.7, 0.06),
    ]


def _sleeve(side: str, sign: float) -> list[Penalty]:
    """``sign`` is 1 on the left, where the sleeve turns anticlockwise from up and its cuff clockwise."""
    armpit, bottom, top, shoulder = f"armpit_{side}", f"sleeve_bottom_{side}", f"sleeve_top_{side}", f"shoulder_{side}"
    axis = ((armpit, shoulder), (bottom, top))
    # Signed turns at the quad's corners: unsigned angles would let the sleeve cross itself, and without room between
    # underarm and side seam its lower corner slips down the side.
    loop = [armpit, bottom, top, shoulder]
    turns = {armpit: (35, 130), bottom: (40, 105), top: (70, 105), shoulder: (100, 145)}
    corners = [
        turned((b, c), (a, b), sign, turns[b], 6)
        for a, b, c in zip(loop[-1:] + loop[:-1], loop, loop[1:] + loop[:1], strict=True)
    ]
    return [
        *corners,
        turned((bottom, top), axis, sign, (70, 100), 6),
        turned(axis, SPINE, -sign, (80, 135), 8),
        ratio_range(axis, SHOULDERS, 0.2, 0.55, 0.06),
        ratio_range((bottom, top), (armpit, shoulder), 0.55, 0.85, 0.08),
    ]


def _likeness() -> list[Penalty]:
    """How much the two sides may differ."""
    pairs = [
        ("armpit", "shoulder"),
        ("sleeve_bottom", "sleeve_top"),
        ("shoulder", "sleeve_top"),
        ("hem", "armpit"),
        ("shoulder", "neck"),
    ]
    return [ratio_range((f"{a}_left", f"{b}_left"), (f"{a}_right", f"{b}_right"), 0.92, 1.09, 0.1) for a, b in pairs]
