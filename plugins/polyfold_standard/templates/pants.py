"""The template of pants; shorts share its vertices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from polyfold.polygon import Penalty, SymmetricGenerator, Template, angle_range, position_range, ratio_range
from polyfold_standard.templates.sides import turned

NAMES = (
    "leg_inner_left",
    "leg_outer_left",
    "waist_left",
    "waist_right",
    "leg_outer_right",
    "leg_inner_right",
    "crotch",
)

SIDES = ("left", "right")

WAIST = ("waist_left", "waist_right")
LEG_ENDS = ("leg_outer_left", "leg_inner_left", "leg_inner_right", "leg_outer_right")
SPINE = (LEG_ENDS, WAIST)


@cache
def pants_template() -> Template:
    """Long trousers, straight to flared."""
    return two_legged(
        "pants",
        shapes=[
            leg_shape(waist=0.2, length=0.8, rise=0.26, gap=0.05, leg=0.17),
            leg_shape(waist=0.2, length=0.9, rise=0.26, gap=0.025, leg=0.16),
        ],
        penalties=leg_penalties(LegRanges()),
        # Where the legs nearly touch, the contour ends below the crotch.
        covered=("crotch",),
    )


def two_legged(
    kind: str, shapes: list[list[tuple[float, float]]], penalties: list[Penalty], covered: tuple[str, ...] = ()
) -> Template:
    """A template with the vertices of pants."""
    words = {
        "leg_inner": "inner corner of the {side} leg's end",
        "leg_outer": "outer corner of the {side} leg's end",
        "waist": "{side} end of the waist",
    }
    descriptions = {f"{name}_{side}": text.format(side=side) for name, text in words.items() for side in SIDES}
    return Template(
        kind=kind,
        names=NAMES,
        descriptions={**descriptions, "crotch": "crotch, where the legs meet"},
        parts=_parts(),
        canonical_shapes=shapes,
        generator=SymmetricGenerator(NAMES, [(n, n.replace("_left", "_right")) for n in NAMES if n.endswith("_left")]),
        penalties=penalties,
        covered=covered,
    )


def leg_shape(waist: float, length: float, rise: float, gap: float, leg: float) -> list[tuple[float, float]]:
    """An upright outline: half waist, length, rise, half the gap between the legs, width of a leg's end."""
    return [
        (-gap, length),
        (-gap - leg, length),
        (-waist, 0.0),
        (waist, 0.0),
        (gap + leg, length),
        (gap, length),
        (0.0, rise),
    ]


def _parts() -> dict[str, tuple[str, ...]]:
    parts: dict[str, tuple[str, ...]] = {}
    for side in SIDES:
        end = (f"leg_inner_{side}", f"leg_outer_{side}")
        parts |= {
            f"{side} leg": (*end, f"waist_{side}", "crotch"),
            f"{side} leg end": end,
            f"{side} side": (f"leg_outer_{side}", f"waist_{side}"),
            f"{side} waist corner": (f"waist_{side}",),
        }
    return {**parts, "waist": WAIST, "leg ends": LEG_ENDS, "crotch": ("crotch",)}


@dataclass(frozen=True)
class LegRanges:
    """What two-legged garments differ in: (low, high) ranges.

    Attributes:
        slender: length over waist.
        rise: where the crotch lies between waist and leg ends.
        crotch: where the crotch lies across the waist.
        gap: distance of the legs' inner corners over the waist.
        leg: width of a leg's end over the waist.
        cuff: angle between a leg's end and its outer seam [deg].
        flare: slant of the outer seam, outward [deg].
        likeness: left over right.
    """

    slender: tuple[float, float] = (0.9, 4.5)
    rise: tuple[float, float] = (0.29, 0.37)
    crotch: tuple[float, float] = (0.35, 0.65)
    gap: tuple[float, float] = (-0.02, 2.0)
    leg: tuple[float, float] = (0.22, 0.75)
    cuff: tuple[float, float] = (55.0, 125.0)
    flare: tuple[float, float] = (-12.0, 40.0)
    likeness: tuple[float, float] = (0.8, 1.25)


def leg_penalties(ranges: LegRanges) -> list[Penalty]:
    """The penalties of a two-legged garment."""
    down = (WAIST, LEG_ENDS)
    found = [
        angle_range(WAIST, SPINE, 80, 100, 5),
        ratio_range(SPINE, WAIST, *ranges.slender, 0.1),
        position_range("crotch", down, *ranges.rise, 0.04),
        position_range("crotch", WAIST, *ranges.crotch, 0.05),
        Penalty("position", ("leg_inner_left", "leg_inner_right"), WAIST, *ranges.gap, 0.05),
        ratio_range(("crotch", "leg_inner_left"), ("crotch", "leg_inner_right"), *ranges.likeness, 0.08),
        ratio_range(("waist_left", "leg_outer_left"), ("waist_right", "leg_outer_right"), *ranges.likeness, 0.08),
        ratio_range(
            ("leg_inner_left", "leg_outer_left"), ("leg_inner_right", "leg_outer_right"), *ranges.likeness, 0.1
        ),
    ]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        seam = (f"waist_{side}", f"leg_outer_{side}")
        end = (f"leg_inner_{side}", f"leg_outer_{side}")
        found += [
            ratio_range(end, WAIST, *ranges.leg, 0.06),
            turned(end, seam, sign, ranges.cuff, 6),
            turned(seam, down, sign, ranges.flare, 5),
        ]
    return found
