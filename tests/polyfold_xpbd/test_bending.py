"""Hinges store what theory says: half the rigidity times the curvature squared, per area."""

from dataclasses import replace

import numpy as np
import pytest
from polyfold_xpbd.model import GRAVITY, build_model

from experiments.benchmarks.cloth.reality.bench import fabric_named
from experiments.benchmarks.cloth.reality.sheets import disc, square, strip, turned
from polyfold.garments import Fabric, Mesh


def cube_of_bending_length(mesh: Mesh, fabric: Fabric, angle: float) -> float:
    """Of a sheet that is rolled up a little along ``angle`` [rad] from x, by the energy of its hinges [m³]."""
    model = build_model(mesh, fabric)
    along = mesh.vertices @ [np.cos(angle), np.sin(angle)]
    stencils = (model.hinge_weights * (along**2 / 2)[model.hinges]).sum(axis=1)
    # Of curvature 1; per mass, of which a particle has 1 / N.
    return float((stencils**2).sum() / len(mesh.vertices) / GRAVITY)


def poplin(warp: float, weft: float) -> Fabric:
    return replace(fabric_named("poplin"), bending_length_warp=warp, bending_length_weft=weft)


SHEETS = {
    "square": square(0.3, 0.0125),
    "coarse square": square(0.3, 0.03),
    "disc": disc(0.15, 0.0125),
    "strip": strip(0.075, 0.025, 0.0125, (0.0,)),
}


@pytest.mark.parametrize("mesh", SHEETS.values(), ids=SHEETS)
@pytest.mark.parametrize(("warp", "weft"), [(0.018, 0.018), (0.018, 0.013), (0.009, 0.012)])
def test_warp_and_weft_have_their_own_bending_length(mesh, warp, weft):
    fabric = poplin(warp, weft)
    assert cube_of_bending_length(mesh, fabric, 0.0) == pytest.approx(weft**3, rel=0.02)
    assert cube_of_bending_length(mesh, fabric, np.pi / 2) == pytest.approx(warp**3, rel=0.02)


@pytest.mark.parametrize("degrees", [0, 15, 30, 45, 60, 90, 135])
@pytest.mark.parametrize("edge_length", [0.008, 0.0125])
def test_a_fabric_alike_both_ways_bends_alike_in_all_directions(degrees, edge_length):
    found = cube_of_bending_length(square(0.3, edge_length), poplin(0.018, 0.018), np.radians(degrees))
    assert found == pytest.approx(0.018**3, rel=0.1)


def test_on_the_skew_a_fabric_is_no_stiffer_than_along_its_stiffer_direction():
    found = cube_of_bending_length(SHEETS["square"], poplin(0.018, 0.013), np.pi / 4)
    assert 0.9 * 0.013**3 < found < 0.018**3


def test_a_turned_sample_has_warp_for_weft():
    mesh, fabric, other = SHEETS["square"], poplin(0.018, 0.013), poplin(0.013, 0.018)
    one, two = cube_of_bending_length(turned(mesh), fabric, 0.0), cube_of_bending_length(mesh, other, np.pi / 2)
    assert one == pytest.approx(two, rel=0.02)
