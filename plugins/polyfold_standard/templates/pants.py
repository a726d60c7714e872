"""The template of pants; shorts share its vertices."""

from __future__ import annotations

from functools import cache

from polyfold.polygon import Penalty, SymmetricGenerator, Template, angle_range, position_range, ratio_range

__all__ = ["leg_penalties", "leg_shape", "pants_template", "two_legged"]

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
        penalties=leg_penalties(
            slender=(0.9, 4.5), rise=(0.2, 0.6), leg=(0.22, 0.75), outer=(-12, 40), crotch=(0.35, 0.65)
        ),
    )


def two_legged(kind: str, shapes: list[list[tuple[float, float]]], penalties: list[Penalty]) -> Template:
    """A template with the vertices of pants."""
    words = {
        "leg_inner": "inner corner of the {side} leg's end",
        "leg_outer": "outer corner of the {side} leg's end",
        "waist": "{side} end of the waistband",
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


def leg_penalties(
    slender: tuple[float, float],
    rise: tuple[float, float],
    leg: tuple[float, float],
    outer: tuple[float, float],
    crotch: tuple[float, float],
) -> list[Penalty]:
    """Ranges: length over waist, crotch along the spine from the waist, leg end over waist, outer seam's slant outward
    [deg], crotch across the waist."""
    down = SPINE[::-1]
    found = [
        angle_range(WAIST, SPINE, 72, 108, 5),
        ratio_range(SPINE, WAIST, *slender, 0.1),
        position_range("crotch", down, *rise, 0.04),
        position_range("crotch", WAIST, *crotch, 0.04),
        Penalty("position", ("leg_inner_left", "leg_inner_right"), WAIST, -0.02, 2.0, 0.03),
        ratio_range(("crotch", "leg_inner_left"), ("crotch", "leg_inner_right"), 0.75, 1.33, 0.06),
        ratio_range(("waist_left", "leg_outer_left"), ("waist_right", "leg_outer_right"), 0.8, 1.25, 0.06),
        ratio_range(("leg_inner_left", "leg_outer_left"), ("leg_inner_right", "leg_outer_right"), 0.67, 1.5, 0.08),
    ]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        seam = (f"waist_{side}", f"leg_outer_{side}")
        end = (f"leg_inner_{side}", f"leg_outer_{side}")
        found += [
            ratio_range(end, WAIST, *leg, 0.04),
            angle_range(end, seam, *sorted((sign * 55, sign * 125)), 5),
            angle_range(seam, down, *sorted((sign * outer[0], sign * outer[1])), 5),
        ]
    return found
