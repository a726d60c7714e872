"""The garment kind ``tshirt``: front and back, open at the neck, both cuffs and the hem."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from polyfold.garments import Garment, Outline, Pattern, curved_outline, mesh_panels
from polyfold_standard.garments.colours import fabric_colours

if TYPE_CHECKING:
    from polyfold.polygon import Template


PATTERN = Pattern(
    corners=(
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
    ),
    top=("neck_left", "neck_right"),
    bottom=("hem_left", "hem_right"),
    size=0.85,
    layers=2,
    openings=(
        ("sleeve_bottom_left", "sleeve_top_left"),
        ("neck_left", "neck_right"),
        ("sleeve_top_right", "sleeve_bottom_right"),
        ("hem_right", "hem_left"),
    ),
)


class TShirt:
    """T-shirts of 0.38 to 0.65 m chest and 0.62 to 0.75 m length, with short to elbow-long sleeves."""

    kind: ClassVar[str] = "tshirt"
    pattern: ClassVar[Pattern] = PATTERN
    default_fabric: ClassVar[str] = "jersey"
    also_called: ClassVar[tuple[str, ...]] = ("t-shirt", "shirt", "tee", "top")

    def template(self) -> Template:
        """The polygon template."""
        from polyfold_standard.templates.tshirt import tshirt_template

        return tshirt_template()

    def generate(self, seed: int, edge_length: float = 0.0125) -> Garment:
        """The seeded t-shirt, meshed at about ``edge_length`` [m]."""
        rng = np.random.default_rng([seed, 3])
        mesh, keypoints = mesh_panels(_outline(rng), 2, edge_length)
        return Garment(self.kind, f"{self.kind}-{seed:04d}", seed, mesh, keypoints, fabric_colours(rng))


@dataclass(frozen=True)
class _Sleeve:
    """One sleeve; lengths [m], angles [rad] below the horizontal."""

    length: float
    angle: float
    cuff: float
    cuff_tilt: float


def _outline(rng: np.random.Generator) -> Outline:
    size = rng.uniform()
    chest = 0.38 + 0.27 * size
    length = 0.62 + 0.13 * (0.6 * size + 0.4 * rng.uniform())
    body = _body_corners(chest, length, rng)
    corners = _with_sleeves(body, rng)
    return curved_outline(
        corners,
        edges=_neckline(corners, rng),
        bulges=_bulges(chest, rng),
        rounding=_rounding(rng),
        openings=PATTERN.openings,
    )


def _body_corners(chest: float, length: float, rng: np.random.Generator) -> dict[str, NDArray[np.float64]]:
    """Corners of the body without sleeves [m], upright, hem near y = 0, each side a little different."""
    hem = chest * rng.uniform(0.94, 1.08)
    shoulder = chest * rng.uniform(0.84, 0.98)
    neck = chest * rng.uniform(0.30, 0.40)
    neck_depth = rng.uniform(0.05, 0.11)
    drop = rng.uniform(0.02, 0.05)
    armhole = float(np.clip(chest * rng.uniform(0.36, 0.44), 0.16, 0.25))
    half = {
        "hem": (hem / 2, 0.0),
        "armpit": (chest / 2, length - drop - armhole),
        "shoulder": (shoulder / 2, length - drop),
        "neck": (neck / 2, length),
    }
    corners = {"neck_center": np.array([0.0, length - neck_depth]) + rng.uniform(-0.004, 0.004, 2)}
    for side, sign in (("left", -1.0), ("right", 1.0)):
        for name, (x, y) in half.items():
            corners[f"{name}_{side}"] = np.array([sign * x, y]) + rng.uniform(-0.004, 0.004, 2)
    return corners


def _with_sleeves(body: dict[str, NDArray[np.float64]], rng: np.random.Generator) -> dict[str, NDArray[np.float64]]:
    """All thirteen corners in template order. Sleeves are drawn until both leave room between cuff and side seam."""
    armhole = float(np.hypot(*(body["shoulder_left"] - body["armpit_left"])))
    while True:
        length, angle = rng.uniform(0.12, 0.26), np.radians(rng.uniform(8.0, 52.0))
        cuff, tilt = armhole * rng.uniform(0.62, 0.88), np.radians(rng.uniform(-12.0, 12.0))
        sleeves = {
            side: _Sleeve(
                length * rng.uniform(0.96, 1.04),
                angle + np.radians(rng.uniform(-3, 3)),
                cuff * rng.uniform(0.96, 1.04),
                tilt,
            )
            for side in ("left", "right")
        }
        ends = {side: _sleeve_ends(body, side, sleeve) for side, sleeve in sleeves.items()}
        if all(_roomy(body, side, *ends[side]) for side in ends):
            break
    (top_left, bottom_left), (top_right, bottom_right) = ends["left"], ends["right"]
    return {
        "hem_left": body["hem_left"],
        "armpit_left": body["armpit_left"],
        "sleeve_bottom_left": bottom_left,
        "sleeve_top_left": top_left,
        "shoulder_left": body["shoulder_left"],
        "neck_left": body["neck_left"],
        "neck_center": body["neck_center"],
        "neck_right": body["neck_right"],
        "shoulder_right": body["shoulder_right"],
        "sleeve_top_right": top_right,
        "sleeve_bottom_right": bottom_right,
        "armpit_right": body["armpit_right"],
        "hem_right": body["hem_right"],
    }


def _sleeve_ends(
    body: dict[str, NDArray[np.float64]], side: str, sleeve: _Sleeve
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Top and bottom corner of the cuff [m]."""
    outward = -1.0 if side == "left" else 1.0
    along = np.array([outward * np.cos(sleeve.angle), -np.sin(sleeve.angle)])
    slope = sleeve.angle + sleeve.cuff_tilt
    across = np.array([-outward * np.sin(slope), -np.cos(slope)])
    top = body[f"shoulder_{side}"] + sleeve.length * along
    return top, top + sleeve.cuff * across


def _roomy(
    body: dict[str, NDArray[np.float64]], side: str, top: NDArray[np.float64], bottom: NDArray[np.float64]
) -> bool:
    """Whether the underarm seam is at least 5 cm long and at least 28 degrees away from the side seam."""
    under = bottom - body[f"armpit_{side}"]
    outward = -1.0 if side == "left" else 1.0
    length = float(np.hypot(*under))
    away = np.degrees(np.arctan2(outward * under[0], -under[1]))
    return length >= 0.05 and 28.0 <= away <= 110.0


def _neckline(
    corners: dict[str, NDArray[np.float64]], rng: np.random.Generator
) -> dict[tuple[str, str], NDArray[np.float64]]:
    """Both halves of the neckline as pieces of one superellipse, from V-like to boat-shaped."""
    power = rng.uniform(1.5, 2.6)
    s = np.linspace(0.0, 1.0, 24)
    left, centre, right = corners["neck_left"], corners["neck_center"], corners["neck_right"]

    def half(end: NDArray[np.float64]) -> NDArray[np.float64]:
        across = np.sin(s * np.pi / 2)
        return np.column_stack(
            [centre[0] + (end[0] - centre[0]) * across, centre[1] + (end[1] - centre[1]) * across**power]
        )

    return {("neck_left", "neck_center"): half(left)[::-1], ("neck_center", "neck_right"): half(right)}


def _bulges(chest: float, rng: np.random.Generator) -> dict[tuple[str, str], float]:
    """How far each seam's middle lies outside its straight edge [m]; alike on both sides."""
    side = chest * rng.uniform(-0.035, 0.02)
    underarm, sleeve_top, shoulder = rng.uniform(-0.012, 0.004), rng.uniform(0.0, 0.012), rng.uniform(-0.003, 0.006)
    cuff, hem = rng.uniform(0.0, 0.006), rng.uniform(-0.004, 0.022)
    pairs = {
        ("hem_left", "armpit_left"): side,
        ("armpit_left", "sleeve_bottom_left"): underarm,
        ("sleeve_bottom_left", "sleeve_top_left"): cuff,
        ("sleeve_top_left", "shoulder_left"): sleeve_top,
        ("shoulder_left", "neck_left"): shoulder,
        ("neck_right", "shoulder_right"): shoulder,
        ("shoulder_right", "sleeve_top_right"): sleeve_top,
        ("sleeve_top_right", "sleeve_bottom_right"): cuff,
        ("sleeve_bottom_right", "armpit_right"): underarm,
        ("armpit_right", "hem_right"): side,
        ("hem_right", "hem_left"): hem,
    }
    return {pair: float(bulge * rng.uniform(0.8, 1.2)) for pair, bulge in pairs.items()}


def _rounding(rng: np.random.Generator) -> dict[str, float]:
    """Where the roundings begin, seen from the corner [m]: soft armpits and shoulders, a more or less round hem."""
    hem, armpit, shoulder, cuff = (
        rng.uniform(0.004, 0.035),
        rng.uniform(0.008, 0.022),
        rng.uniform(0.015, 0.045),
        rng.uniform(0.003, 0.008),
    )
    sides = ("left", "right")
    return {
        **{f"hem_{side}": hem for side in sides},
        **{f"armpit_{side}": armpit for side in sides},
        **{f"shoulder_{side}": shoulder for side in sides},
        **{f"sleeve_{end}_{side}": cuff for end in ("top", "bottom") for side in sides},
    }
