"""The theory and the geometry that the textile tests of the cloth rest on."""

import sys

import numpy as np
import pytest

from experiments.benchmarks.cloth.measures import crossing_edges
from experiments.benchmarks.cloth.reality.__main__ import main
from experiments.benchmarks.cloth.reality.bench import Cloth, elastic, fabric_named
from experiments.benchmarks.cloth.reality.cantilever import hang
from experiments.benchmarks.cloth.reality.drape import DISC, PEDESTAL, drape_coefficient, shadow
from experiments.benchmarks.cloth.reality.elastica import (
    bending_length_of,
    cantilever,
    chord_angle,
    heart_loop,
    peirce_cantilever,
    peirce_heart_loop,
)
from experiments.benchmarks.cloth.reality.penetration import ipctk_crossings
from experiments.benchmarks.cloth.reality.sheets import disc, lifted, pile, square, strip, turned


def test_a_stiff_cantilever_bends_like_a_beam():
    length, bending_length = 0.02, 0.05
    tip = cantilever(length, bending_length)
    assert -tip.up[-1] == pytest.approx(length**4 / (8 * bending_length**3), rel=0.01)


def test_the_elastica_agrees_with_peirces_formula_where_the_standard_uses_it():
    assert np.degrees(chord_angle(0.04, 0.02)) == pytest.approx(41.5, abs=0.3)
    for overhang in (0.03, 0.04, 0.05):
        assert peirce_cantilever(chord_angle(overhang, 0.02), overhang) == pytest.approx(0.02, rel=0.04)


@pytest.mark.parametrize("overhang", [0.02, 0.04, 0.08])
def test_a_bending_length_is_found_again_from_the_angle(overhang):
    assert bending_length_of(chord_angle(overhang, 0.013), overhang) == pytest.approx(0.013, rel=0.002)


def test_a_cantilever_keeps_its_length():
    shape = cantilever(0.1, 0.012)
    assert np.hypot(np.diff(shape.across), np.diff(shape.up)).sum() == pytest.approx(0.1, rel=1e-3)


def test_a_weightless_heart_loop_is_as_high_as_peirce_says():
    assert -heart_loop(1.0, 10.0).up[-1] == pytest.approx(0.1337, abs=0.0005)


@pytest.mark.parametrize("bending_length", [0.012, 0.017, 0.025])
def test_peirces_formula_for_the_heart_loop_holds_within_five_percent(bending_length):
    height = -heart_loop(0.15, bending_length).up[-1]
    assert peirce_heart_loop(height, 0.15) == pytest.approx(bending_length, rel=0.05)


def test_a_softer_loop_hangs_lower():
    heights = [-heart_loop(0.2, length).up[-1] for length in (0.03, 0.02, 0.01)]
    assert heights == sorted(heights)


def test_drape_coefficients_of_known_shadows():
    assert drape_coefficient(np.pi * PEDESTAL**2) == pytest.approx(0.0)
    assert drape_coefficient(np.pi * DISC**2) == pytest.approx(1.0)
    half = (PEDESTAL**2 + DISC**2) / 2
    assert drape_coefficient(np.pi * half) == pytest.approx(0.5)


@pytest.mark.parametrize("edge_length", [0.02, 0.01])
def test_the_shadow_of_a_flat_disc_is_its_area(edge_length):
    mesh = disc(DISC, edge_length)
    assert drape_coefficient(shadow(lifted(mesh.vertices, 0.1), mesh.triangles)) == pytest.approx(1.0, abs=0.015)


def test_folded_over_cloth_shades_once():
    mesh = square(0.2, 0.02)
    folded = np.column_stack([np.abs(mesh.vertices[:, 0]), mesh.vertices[:, 1], 0 * mesh.vertices[:, 0]])
    assert shadow(folded, mesh.triangles) == pytest.approx(0.02, rel=0.08)


def test_a_strip_has_vertices_where_it_is_clamped_and_can_be_cut_across():
    mesh = strip(0.1, 0.025, 0.0125, (0.0,))
    at_clamp = mesh.vertices[np.abs(mesh.vertices[:, 0]) < 1e-9]
    assert {-0.0125, 0.0125} <= set(at_clamp[:, 1].round(6))
    assert np.ptp(turned(mesh).vertices, axis=0) == pytest.approx([0.025, 0.1])


def test_plies_of_a_pile_are_separate_and_keep_apart():
    fabric = fabric_named("terry")
    sheet = square(0.1, 0.02)
    mesh = pile(sheet, 3)
    count = len(sheet.vertices)
    assert len(mesh.triangles) == 3 * len(sheet.triangles)
    assert (mesh.triangles // count == mesh.triangles[:, :1] // count).all()
    levels = [fabric.thickness * (0.5 + 1.5 * ply) for ply in range(3)]
    cloth = Cloth(mesh, fabric, np.vstack([lifted(sheet.vertices, level) for level in levels]))
    cloth.wait(0.5)
    heights = cloth.positions()[:, 2].reshape(3, count).mean(axis=1)
    assert np.diff(heights) == pytest.approx([fabric.thickness] * 2, rel=0.1)


def test_pinned_particles_stay_and_go_where_they_are_carried():
    mesh = square(0.1, 0.02)
    cloth = Cloth(mesh, fabric_named("terry"), lifted(mesh.vertices, 0.05))
    corner = np.array([int(mesh.vertices.sum(axis=1).argmin())])
    start = cloth.positions()[corner]
    cloth.pin(corner)
    cloth.wait(0.3)
    assert cloth.positions()[corner] == pytest.approx(start)
    assert cloth.positions()[:, 2].min() < 0.02
    rise = np.linspace(0.0, 0.05, round(0.2 / cloth.substep))
    cloth.carry(start + np.column_stack([0 * rise, 0 * rise, rise])[:, None])
    assert cloth.positions()[corner, 2] == pytest.approx(start[:, 2] + 0.05, abs=1e-6)


def test_a_softer_strip_hangs_lower():
    fabric = fabric_named("terry")
    stiff, soft = (hang(elastic(fabric, length), 0.0375, 0.0125) for length in (0.015, 0.008))
    assert soft.drop > stiff.drop > 0
    assert soft.bending_length < stiff.bending_length


def test_without_ipctk_the_message_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "ipctk", None)
    mesh = square(0.1, 0.02)
    with pytest.raises(ImportError, match="pip install ipctk"):
        ipctk_crossings(mesh, lifted(mesh.vertices, 0.0))


def test_both_counts_of_crossing_edges_agree():
    pytest.importorskip("ipctk")
    sheet = square(0.1, 0.02)
    mesh = pile(sheet, 2)
    rng = np.random.default_rng(3)
    # Shifted, so that no vertex is exactly above another: at corners and edges the two may count otherwise.
    waves = np.vstack([lifted(sheet.vertices, 0.0), lifted(sheet.vertices + np.array([0.0031, 0.0047]), 0.001)])
    waves[:, 2] += rng.normal(0.0, 0.001, len(waves))
    assert ipctk_crossings(mesh, waves) == pytest.approx(crossing_edges(mesh, waves))
    apart = np.vstack([lifted(sheet.vertices, 0.0), lifted(sheet.vertices, 0.01)])
    assert ipctk_crossings(mesh, apart) == 0.0


def test_the_command_prints_published_beside_ours(capsys):
    main(["--only", "stack,rgbench", "--edge-length", "0.03"])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "| test | fabric | quantity | published | ours | n |"
    assert any("16 plies" in line for line in lines)
    assert any("19.6" in line and "needs the data" in line for line in lines)


def test_an_unknown_test_is_answered_with_the_known_ones(capsys):
    with pytest.raises(SystemExit):
        main(["--only", "shear"])
    assert "cantilever" in capsys.readouterr().err
