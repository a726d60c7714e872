"""The kind of garment ``longsleeve``: a long-sleeved shirt, its sleeves laid beside the body."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from polyfold.garments import Garment, Pattern, curved_outline
from polyfold.polygon import (
    Penalty,
    SymmetricGenerator,
    Template,
    angle_range,
    offset_range,
    position_range,
    ratio_range,
)
from polyfold_wardrobe.cut import SIDES, Floats, both_sides, mirrored, paired, sewn, turned

NAMES = (
    "hem_left", "armpit_left", "sleeve_bottom_left", "sleeve_top_left", "shoulder_left", "neck_left", "neck_center",
    "neck_right", "shoulder_right", "sleeve_top_right", "sleeve_bottom_right", "armpit_right", "hem_right",
)  # fmt: skip
HEM, SHOULDERS = ("hem_left", "hem_right"), ("shoulder_left", "shoulder_right")
NECK = ("neck_left", "neck_right")
SPINE = (HEM, SHOULDERS)


class LongSleeve:
    """Shirts of 0.32 to 0.44 m chest with sleeves of 0.36 to 0.48 m, 28 to 45 degrees below the horizontal."""

    kind: ClassVar[str] = "longsleeve"
    pattern: ClassVar[Pattern] = Pattern(
        corners=NAMES,
        top=NECK,
        bottom=HEM,
        size=0.95,
        layers=2,
        openings=(
            ("sleeve_bottom_left", "sleeve_top_left"), NECK, ("sleeve_top_right", "sleeve_bottom_right"),
            ("hem_right", "hem_left"),
        ),
    )  # fmt: skip
    default_fabric: ClassVar[str] = "jersey"
    also_called: ClassVar[tuple[str, ...]] = ("long-sleeved shirt", "sweatshirt", "jumper", "sweater", "pullover")

    def template(self) -> Template:
        """The polygon template."""
        words = {
            "hem": "{side} corner of the hem",
            "armpit": "{side} armpit",
            "sleeve_bottom": "bottom end of the {side} sleeve's cuff",
            "sleeve_top": "top end of the {side} sleeve's cuff",
            "shoulder": "{side} shoulder, where the sleeve begins",
            "neck": "{side} end of the neck opening",
        }
        told = {f"{name}_{side}": text.format(side=side) for name, text in words.items() for side in SIDES}
        return Template(
            kind=self.kind,
            names=NAMES,
            descriptions={**told, "neck_center": "center of the neck opening, its lowest point"},
            parts=_parts(),
            canonical_shapes=[_shape(degrees) for degrees in (30.0, 38.0, 46.0)],
            generator=SymmetricGenerator(NAMES, paired(NAMES)),
            penalties=[*_body(), *(penalty for side in SIDES for penalty in _sleeve(side)), *_likeness()],
        )

    def generate(self, seed: int, edge_length: float = 0.0125) -> Garment:
        """The seeded shirt, meshed at about ``edge_length`` [m]."""
        rng = np.random.default_rng([seed, 15])
        chest, angle = rng.uniform(0.32, 0.44), np.radians(rng.uniform(28.0, 45.0))
        length, armhole = chest * rng.uniform(1.35, 1.6), chest * rng.uniform(0.42, 0.5)
        sleeve, cuff = chest * rng.uniform(1.05, 1.2), armhole * rng.uniform(0.5, 0.65)
        shoulder = chest * rng.uniform(0.44, 0.49)
        top = length - rng.uniform(0.02, 0.04)
        end = np.array([shoulder + sleeve * np.cos(angle), top - sleeve * np.sin(angle)])
        half = {
            "hem": (chest * rng.uniform(0.47, 0.54), 0.0),
            "armpit": (chest / 2, top - armhole),
            "sleeve_bottom": tuple(end - cuff * np.array([np.sin(angle), np.cos(angle)])),
            "sleeve_top": tuple(end),
            "shoulder": (shoulder, top),
            "neck": (chest * rng.uniform(0.17, 0.2), length),
            "neck_center": (0.0, length - rng.uniform(0.04, 0.08)),
        }
        corners = both_sides(half, NAMES, rng)
        bulges = mirrored(
            {
                ("hem_left", "armpit_left"): chest * rng.uniform(-0.03, 0.02),
                ("sleeve_bottom_left", "sleeve_top_left"): rng.uniform(0.0, 0.004),
                ("sleeve_top_left", "shoulder_left"): rng.uniform(0.0, 0.012),
                ("neck_left", "neck_center"): -rng.uniform(0.002, 0.01),
            },
            rng,
        )
        bulges["hem_right", "hem_left"] = float(rng.uniform(-0.004, 0.02))
        rounding = {name: float(rng.uniform(0.003, 0.010)) for name in NAMES if name != "neck_center"}
        outline = curved_outline(corners, bulges=bulges, rounding=rounding, openings=self.pattern.openings)
        return sewn(self.kind, seed, outline, 2, edge_length, rng)


def _shape(degrees: float) -> list[tuple[float, float]]:
    """An upright outline, y down, with sleeves so far below the horizontal."""
    angle = np.radians(degrees)
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    shoulder: Floats = np.array([0.23, 0.03])
    top = shoulder + 0.56 * along
    right = {
        "neck": (0.09, 0.0), "shoulder": tuple(shoulder), "sleeve_top": tuple(top),
        "sleeve_bottom": tuple(top + 0.13 * across), "armpit": (0.25, 0.26), "hem": (0.25, 0.74),
    }  # fmt: skip
    corners = {"neck_center": (0.0, 0.06)}
    for name, (x, y) in right.items():
        corners |= {f"{name}_right": (float(x), float(y)), f"{name}_left": (-float(x), float(y))}
    return [corners[name] for name in NAMES]


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
    body = ("hem_left", "armpit_left", "shoulder_left", "shoulder_right", "armpit_right", "hem_right")
    collar = ("neck_left", "neck_center", "neck_right")
    return {**parts, "hem": HEM, "collar": collar, "shoulders": SHOULDERS, "body": body}


def _body() -> list[Penalty]:
    found = [
        angle_range(HEM, SPINE, 80, 100, 5),
        angle_range(SHOULDERS, SPINE, 80, 100, 5),
        ratio_range(SPINE, SHOULDERS, 1.2, 1.9, 0.1),
        ratio_range(SHOULDERS, HEM, 0.78, 1.08, 0.06),
        ratio_range(NECK, SHOULDERS, 0.32, 0.5, 0.05),
        position_range("neck_left", SHOULDERS, 0.25, 0.36, 0.04),
        position_range("neck_right", SHOULDERS, 0.64, 0.75, 0.04),
        offset_range("neck_left", SHOULDERS, -0.14, -0.03, 0.04),
        offset_range("neck_right", SHOULDERS, -0.14, -0.03, 0.04),
        position_range("neck_center", NECK, 0.44, 0.56, 0.04),
        offset_range("neck_center", NECK, 0.1, 0.7, 0.08),
    ]
    for side in SIDES:
        found += [
            turned((f"hem_{side}", f"armpit_{side}"), SPINE, side, (-7, 7), 4),
            ratio_range((f"armpit_{side}", f"shoulder_{side}"), SHOULDERS, 0.4, 0.6, 0.05),
            position_range(f"armpit_{side}", SPINE, 0.6, 0.76, 0.04),
        ]
    return found


def _sleeve(side: str) -> list[Penalty]:
    """A sleeve is a long quad that leaves the body at the armhole."""
    armpit, bottom, top, shoulder = f"armpit_{side}", f"sleeve_bottom_{side}", f"sleeve_top_{side}", f"shoulder_{side}"
    axis = ((armpit, shoulder), (bottom, top))
    return [
        ratio_range((shoulder, top), SHOULDERS, 0.95, 1.45, 0.06),
        ratio_range((bottom, top), (armpit, shoulder), 0.42, 0.75, 0.06),
        turned((bottom, top), axis, side, (72, 108)),
        turned(axis, SPINE, "right" if side == "left" else "left", (100, 150), 6),
    ]


def _likeness() -> list[Penalty]:
    """How much the two sides may differ."""
    pairs = [("armpit", "shoulder"), ("sleeve_bottom", "sleeve_top"), ("shoulder", "sleeve_top"), ("hem", "armpit")]
    return [ratio_range((f"{a}_left", f"{b}_left"), (f"{a}_right", f"{b}_right"), 0.9, 1.11, 0.1) for a, b in pairs]
