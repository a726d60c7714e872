"""What cloth in a fabric's own thickness does on meshes as fine as those of every run: plies, packets, creases."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pytest
from polyfold_xpbd.solver import NOTHING_HELD, SETTLING

from experiments.benchmarks.cloth.measures import crossing_edges, layer_order, strain
from experiments.benchmarks.cloth.reality.bench import Cloth
from experiments.benchmarks.cloth.reality.cantilever import hang
from experiments.benchmarks.cloth.reality.sheets import lifted, pile, square
from polyfold import plugins
from polyfold.config import ComponentSpec
from polyfold.garments import Garment, curved_outline, mesh_panels
from polyfold.geometry import FoldLine
from polyfold.types import Action, SimState

SIDE = 0.25
CORNERS = ("bottom_left", "top_left", "top_right", "bottom_right")
SAMPLES = [(fabric, edge) for fabric in ("poplin", "denim") for edge in (0.0125, 0.0155)]


def made(name, **constants):
    return plugins.make_fabric(ComponentSpec(name=name, params=constants), "square")


def napkin(fabric, edge_length):
    corners = dict(zip(CORNERS, SIDE / 2 * np.array([[-1, -1], [-1, 1], [1, 1], [1, -1]]), strict=True))
    mesh, keypoints = mesh_panels(curved_outline(corners), 1, edge_length)
    return Garment("square", "napkin", None, mesh, keypoints, cyclic=CORNERS, fabric=fabric)


def laid(garment):
    simulator = plugins.create("simulators", "xpbd")
    simulator.reset(garment, 1)
    return simulator


def onto(simulator, picks, places):
    pixels = simulator.state().keypoint_pixels()
    return Action(np.array([pixels[name] for name in picks]), np.array([pixels[name] for name in places]))


def far_from_crease(action, state):
    """Signed distance [m] of every particle from the fold line in this state: positive where it is lifted."""
    line = FoldLine.moving(action.picks.mean(axis=0), action.places.mean(axis=0))
    return line.distance(state.camera.to_pixels(state.positions)) / state.camera.pixels_per_metre


@dataclass
class Folded:
    """A napkin folded in half upwards, then in quarters to the right, and what it looked like in between.

    ``resting`` is one second after ``half``, ``waited`` two, and ``rested`` one second after ``quarter``.
    """

    garment: Garment
    left: np.ndarray
    half: SimState
    resting: SimState
    waited: SimState
    quarter: SimState
    rested: SimState

    @property
    def flap(self):
        return self.left > 0.04


@lru_cache
def folded(fabric, edge_length):
    garment = napkin(fabric, edge_length)
    simulator = laid(garment)
    flat = simulator.state()
    action = onto(simulator, ["bottom_left", "bottom_right"], ["top_left", "top_right"])
    simulator.execute(action)
    half = simulator.state()
    simulator.wait(1.0)
    resting = simulator.state()
    simulator.wait(1.0)
    waited = simulator.state()
    simulator.execute(onto(simulator, ["bottom_left", "top_left"], ["bottom_right", "top_right"]))
    quarter = simulator.state()
    simulator.wait(1.0)
    return Folded(garment, far_from_crease(action, flat), half, resting, waited, quarter, simulator.state())


def creep(before, after):
    return np.linalg.norm(after.positions - before.positions, axis=1)


@pytest.mark.parametrize(("fabric", "edge_length"), SAMPLES)
def test_folded_cloth_stays_finite_above_the_table_and_as_large_as_it_is(fabric, edge_length):
    cloth = folded(made(fabric), edge_length)
    for state in (cloth.half, cloth.waited, cloth.quarter, cloth.rested):
        assert np.isfinite(state.positions).all()
        assert state.positions[:, 2].min() > 0.4 * cloth.garment.fabric.thickness
        assert np.percentile(np.abs(strain(cloth.garment.mesh, state.positions)), 99) <= 0.08


@pytest.mark.parametrize(("fabric", "edge_length"), SAMPLES)
def test_plies_of_cloth_folded_in_half_do_not_pierce_each_other(fabric, edge_length):
    cloth = folded(made(fabric), edge_length)
    for state in (cloth.half, cloth.waited):
        assert crossing_edges(cloth.garment.mesh, state.positions) <= 0.002


@pytest.mark.parametrize(("fabric", "edge_length"), SAMPLES)
def test_plies_of_cloth_folded_in_quarters_do_not_pierce_each_other(fabric, edge_length):
    cloth = folded(made(fabric), edge_length)
    for state in (cloth.quarter, cloth.rested):
        assert crossing_edges(cloth.garment.mesh, state.positions) <= 0.01


@pytest.mark.parametrize(("fabric", "edge_length"), SAMPLES)
def test_what_was_folded_over_lies_on_top(fabric, edge_length):
    cloth = folded(made(fabric), edge_length)
    for state in (cloth.half, cloth.waited):
        order = layer_order(state.positions, cloth.left > 0, cloth.left > 2 * edge_length, edge_length / 2)
        assert order >= 0.995


@pytest.mark.parametrize(("fabric", "edge_length"), SAMPLES)
def test_cloth_folded_in_half_stays_where_it_is(fabric, edge_length):
    cloth = folded(made(fabric), edge_length)
    assert creep(cloth.half, cloth.resting).mean() <= 0.002


@pytest.mark.parametrize(("fabric", "edge_length"), SAMPLES)
def test_cloth_folded_in_quarters_stays_where_it_is(fabric, edge_length):
    cloth = folded(made(fabric), edge_length)
    assert creep(cloth.quarter, cloth.rested).mean() <= 0.002


def stacked(fabric):
    """Heights [m], shape (8, N), of eight separate plies that rest, and how far each particle crept in a second [m]."""
    sheet = square(0.12, 0.0125)
    levels = [fabric.thickness * (0.5 + 1.1 * ply) for ply in range(8)]
    cloth = Cloth(pile(sheet, 8), fabric, np.vstack([lifted(sheet.vertices, level) for level in levels]))
    cloth.wait(1.0)
    before = cloth.positions()
    cloth.wait(1.0)
    return cloth.positions()[:, 2].reshape(8, -1), np.linalg.norm(cloth.positions() - before, axis=1)


@pytest.mark.parametrize("fabric", ["poplin", "denim"])
def test_a_stack_of_eight_plies_keeps_its_order_and_its_place(fabric):
    heights, crept = stacked(made(fabric))
    assert crept.max() <= 0.002
    assert (np.diff(heights, axis=0) > 0).all()
    assert heights[-1].mean() > 0.6 * 7.5 * made(fabric).thickness


@pytest.mark.parametrize("fabric", ["poplin", "denim", "felt"])
def test_every_ply_of_a_stack_keeps_its_thickness(fabric):
    heights, _ = stacked(made(fabric))
    assert np.diff(heights.mean(axis=1)).min() > 0.6 * made(fabric).thickness


@pytest.mark.parametrize("edge_length", [0.0125, 0.0155])
def test_a_state_is_all_that_a_fold_depends_on(edge_length):
    garment = napkin(made("denim"), edge_length)
    simulator = laid(garment)
    simulator.execute(onto(simulator, ["bottom_left", "bottom_right"], ["top_left", "top_right"]))
    start = simulator.state()
    again = onto(simulator, ["bottom_left"], ["top_right"])
    picture = simulator.execute(again)
    ended = simulator.state().positions
    other = laid(garment)
    for restored in (simulator, other):
        restored.restore(start)
        seen = restored.execute(again)
        assert restored.state().positions.tobytes() == ended.tobytes()
        assert (seen.rgb.tobytes(), seen.depth.tobytes()) == (picture.rgb.tobytes(), picture.depth.tobytes())


@pytest.mark.parametrize("edge_length", [0.0125, 0.0155])
def test_denim_that_was_folded_in_half_stays_closed(edge_length):
    cloth = folded(made("denim"), edge_length)
    plies = cloth.waited.positions[cloth.flap, 2] / cloth.garment.fabric.thickness
    assert np.median(plies) == pytest.approx(1.5, abs=0.15)
    assert np.percentile(plies, 95) < 2.5


def test_a_crease_is_remembered_when_the_cloth_is_opened_again():
    garment = napkin(made("denim", crease_set=0.9), 0.0155)
    simulator = laid(garment)
    flat = simulator.state()
    action = onto(simulator, ["bottom_left", "bottom_right"], ["top_left", "top_right"])
    simulator.execute(action)
    folded = simulator.state()
    crease = np.abs(far_from_crease(action, flat)) < 0.02
    way = action.picks - action.places
    slack = action.picks - 10.0 * way / np.hypot(*way.T)[:, None]

    def ridge(extra):
        """Height of the crease [m] in cloth that is opened, but not drawn so taut that it is ironed."""
        simulator.restore(replace(folded, extra=extra))
        simulator.execute(Action(simulator.state().camera.to_pixels(corners(simulator)), slack))
        return simulator.state().positions[crease, 2].mean()

    ironed = {name: value for name, value in folded.extra.items() if not name.startswith("crease")}
    assert len(ironed) < len(folded.extra)
    assert ridge(folded.extra) > 1.3 * ridge(ironed)


def corners(simulator):
    keypoints = simulator.state().keypoint_positions()
    return np.array([keypoints["bottom_left"], keypoints["bottom_right"]])


def _near(positions, triangles, within):
    """Pairs of a vertex over or under the inside of a triangle of other cloth and less than ``within`` [m] away."""
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    u, w = b - a, c - a
    n = np.cross(u, w)
    square = (n**2).sum(axis=1)
    found = set()
    for i, point in enumerate(positions):
        r = point - a
        beta, gamma = (np.cross(r, w) * n).sum(axis=1) / square, (np.cross(u, r) * n).sum(axis=1) / square
        over = (beta > 0) & (gamma > 0) & (beta + gamma < 1) & ~(triangles == i).any(axis=1)
        over &= np.abs((r * n).sum(axis=1)) < within * np.sqrt(square)
        found |= {(i, int(t)) for t in np.flatnonzero(over)}
    return found


@pytest.mark.parametrize("edge_length", [0.0125, 0.0155])
def test_what_comes_near_what_strayed_is_listed_though_it_did_not_stray_itself(edge_length):
    """In between, only pairs of what left its foreseen path are listed anew."""
    cloth = folded(made("poplin"), edge_length)
    simulator = laid(cloth.garment)
    simulator.restore(cloth.half)
    solver = simulator._solver
    solver.wait(2 * solver.dt)
    rng = np.random.default_rng(0)
    strayed = rng.choice(len(solver.x), 12, replace=False)
    # Sideways by half an edge: onto triangles and under vertices that it was not near before.
    turn = rng.uniform(0, 2 * np.pi, 12)
    solver.x[strayed, :2] += 0.5 * edge_length * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    positions = solver.positions()
    solver._advance(NOTHING_HELD, 2, 3, SETTLING, 0.0)
    memory = solver.memory()
    vertex_pairs = memory["pair_kinds"][0]
    listed = set(zip(memory["pair_first"][:vertex_pairs], memory["pair_second"][:vertex_pairs], strict=True))
    triangles = solver.triangles.astype(int)
    touching = {
        (i, t)
        for i, t in _near(positions, triangles, 2 * cloth.garment.fabric.thickness)
        if i in strayed or np.isin(triangles[t], strayed).any()
    }
    assert sum(i not in strayed for i, _ in touching) > 12
    assert touching <= listed


def test_a_thicker_fabric_makes_a_higher_packet():
    heights = []
    for thickness in (0.0005, 0.001, 0.002):
        cloth = folded(made("denim", thickness=thickness), 0.0155)
        heights.append(np.median(cloth.waited.positions[cloth.flap, 2]))
        assert heights[-1] == pytest.approx(1.5 * thickness, rel=0.15)
    assert heights == sorted(heights)


def test_a_fabric_bends_more_along_its_limp_direction():
    fabric = made("denim", bending_length_warp=0.022, bending_length_weft=0.011, crease_set=0.0)
    warp, weft = (hang(fabric, 0.0375, 0.0125, along) for along in ("warp", "weft"))
    assert weft.drop > 1.3 * warp.drop
    assert warp.bending_length > 1.5 * weft.bending_length
