import json

import numpy as np
import pytest
from shapes import KINDS, assert_sound, edges, pattern, rims

from polyfold.errors import GarmentError
from polyfold.garments._obj import load_obj


def worn_pants(garment):
    """Trousers of a flat two-layer garment, with legs and hips as round tubes; nearly an isometry."""
    mesh = garment.mesh
    at = {name: mesh.vertices[vertex] for name, vertex in garment.keypoints.items()}
    x, y = mesh.vertices.T
    outer = np.interp(
        y, [at["leg_outer_right"][1], at["waist_right"][1]], [at["leg_outer_right"][0], at["waist_right"][0]]
    )
    front = np.where(mesh.layer == 1, 1.0, -1.0)
    share = np.clip(np.abs(x) / outer, 0, 1)
    depth = 0.05 * np.sqrt(np.clip(1 - (2 * share - 1) ** 2, 0, None))
    blend = 1 / (1 + np.exp(-(y - at["crotch"][1] - 0.05) / 0.03))
    hips = 0.07 * np.sqrt(np.clip(1 - share**2, 0, None))
    z = front * ((1 - blend) * depth + blend * hips)
    z[mesh.seam] = 0.0
    return np.column_stack([x, y, z])


def write_obj(path, positions, mesh, offset=0):
    faces = mesh.triangles.copy()
    faces[mesh.panel == 0] = faces[mesh.panel == 0][:, ::-1]
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in positions]
    lines += [f"f {a}//{a} {b}//{b} {c}//{c}" for a, b, c in faces + 1]
    lines[len(positions) : len(positions)] = ["vn 0 0 1"] * len(positions)
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture
def garment():
    return KINDS["pants"].generate(2001, 0.025)


@pytest.fixture
def files(tmp_path, garment):
    write_obj(tmp_path / "jeans.obj", worn_pants(garment), garment.mesh)
    (tmp_path / "keypoints.json").write_text(json.dumps(garment.keypoints))
    return tmp_path / "jeans.obj", tmp_path / "keypoints.json"


@pytest.mark.parametrize("axes", [(0, 1, 2), (0, 2, 1), (2, 1, 0)], ids=["y up", "z up", "facing x"])
def test_worn_trousers_are_laid_flat(files, garment, axes):
    positions = worn_pants(garment)[:, axes]
    if axes != (0, 1, 2):
        positions = positions * [1, -1, 1] if axes == (0, 2, 1) else positions * [1, 1, -1]
    path = write_obj(files[0], positions, garment.mesh)
    flat = load_obj(path, files[1], "pants", pattern("pants"), edge_length=0.02)
    assert flat.name == "jeans"
    assert_sound(flat.mesh, 0.02, least_angle=12.0)
    assert rims(flat.mesh) == 3
    width, height = np.ptp(flat.mesh.vertices, axis=0)
    original = np.ptp(garment.mesh.vertices, axis=0)
    assert height == pytest.approx(original[1], rel=0.06)
    assert original[0] < width < 1.4 * original[0], "tubes are wider once pressed flat"
    at = {name: flat.mesh.vertices[vertex] for name, vertex in flat.keypoints.items()}
    assert at["leg_outer_left"][0] < at["leg_inner_left"][0] < at["leg_inner_right"][0] < at["leg_outer_right"][0]
    assert at["leg_outer_left"][1] < at["crotch"][1] < at["waist_left"][1]


def test_size_in_metres_wins_over_the_file_s_units(files, garment):
    path = write_obj(files[0], 100 * worn_pants(garment), garment.mesh)
    with pytest.raises(GarmentError, match="give its longest side in metres"):
        load_obj(path, files[1], "pants", pattern("pants"))
    flat = load_obj(path, files[1], "pants", pattern("pants"), size_m=0.6, edge_length=0.02)
    assert np.ptp(flat.mesh.vertices, axis=0).max() == pytest.approx(0.6, rel=0.03)


def test_inconsistent_winding_and_scraps_are_put_right(files, garment):
    text = files[0].read_text().splitlines()
    faces = [k for k, line in enumerate(text) if line.startswith("f ")]
    for k in faces[::5]:
        _, a, b, c = text[k].split()
        text[k] = f"f {b} {a} {c}"
    count = len(garment.mesh.vertices)
    button = ["v 0 0 1", "v 0.001 0 1", "v 0 0.001 1", f"f {count + 1} {count + 2} {count + 3}"]
    files[0].write_text("\n".join(text + button))
    assert rims(load_obj(*files, "pants", pattern("pants"), edge_length=0.02).mesh) == 3


def test_vertices_repeated_along_texture_seams_are_joined(files, garment):
    mesh, positions = garment.mesh, worn_pants(garment)
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in positions]
    copies = {vertex: len(lines) + k for k, vertex in enumerate(np.flatnonzero(mesh.seam))}
    lines += [lines[vertex] for vertex in copies]
    for face, panel in zip(mesh.triangles, mesh.panel, strict=True):
        a, b, c = (copies.get(vertex, vertex) + 1 if panel == 1 else vertex + 1 for vertex in face)
        lines.append(f"f {a} {b} {c}" if panel == 1 else f"f {a} {c} {b}")
    files[0].write_text("\n".join(lines))
    assert rims(load_obj(*files, "pants", pattern("pants"), edge_length=0.02).mesh) == 3


def test_a_garment_that_is_flat_already_may_have_front_and_back_in_one_place(files, garment):
    flat = np.column_stack([garment.mesh.vertices, np.zeros(len(garment.mesh.vertices))])
    loaded = load_obj(write_obj(files[0], flat, garment.mesh), files[1], "pants", pattern("pants"), edge_length=0.02)
    np.testing.assert_allclose(np.ptp(loaded.mesh.vertices, axis=0), np.ptp(garment.mesh.vertices, axis=0), rtol=0.03)


def test_a_flat_cloth_stays_what_it_is(tmp_path):
    garment = KINDS["rectangle"].generate(2002, 0.02)
    flat = np.column_stack([garment.mesh.vertices, np.zeros(len(garment.mesh.vertices))])
    write_obj(tmp_path / "towel.obj", flat, garment.mesh)
    (tmp_path / "keypoints.json").write_text(json.dumps(garment.keypoints))
    loaded = load_obj(
        tmp_path / "towel.obj", tmp_path / "keypoints.json", "rectangle", pattern("rectangle"), edge_length=0.02
    )
    np.testing.assert_allclose(np.ptp(loaded.mesh.vertices, axis=0), np.ptp(garment.mesh.vertices, axis=0), rtol=0.02)
    assert loaded.mesh.layers == 1


def test_a_bowl_does_not_lie_flat(tmp_path):
    garment = KINDS["square"].generate(2002, 0.02)
    x, y = garment.mesh.vertices.T / np.abs(garment.mesh.vertices).max()
    length = np.hypot(x, y)
    bowl = np.column_stack([np.sin(1.9 * length) * x / length, np.sin(1.9 * length) * y / length, np.cos(1.9 * length)])
    write_obj(tmp_path / "bowl.obj", np.nan_to_num(bowl) * 0.2, garment.mesh)
    (tmp_path / "keypoints.json").write_text(json.dumps(garment.keypoints))
    with pytest.raises(GarmentError, match="does not lie flat"):
        load_obj(tmp_path / "bowl.obj", tmp_path / "keypoints.json", "square", pattern("square"))


def test_a_fin_is_not_a_manifold(files, garment):
    pairs, owners = edges(garment.mesh)
    a, b = pairs[owners == 2][0] + 1
    count = len(garment.mesh.vertices)
    files[0].write_text(files[0].read_text() + f"v 0 0 3\nf {a} {b} {count + 1}\n")
    with pytest.raises(GarmentError, match="not a manifold"):
        load_obj(*files, "pants", pattern("pants"))


def test_meshes_that_cannot_be_used_are_refused(files, tmp_path):
    vertices = "\n".join(line for line in files[0].read_text().splitlines() if line.startswith("v "))
    for text, words in (("", "no finite vertices"), (vertices, "no faces"), ("v a b c", "broken vertex")):
        files[0].write_text(text)
        with pytest.raises(GarmentError, match=words):
            load_obj(*files, "pants", pattern("pants"))
    with pytest.raises(GarmentError, match="give an OBJ file"):
        load_obj(tmp_path / "absent.obj", files[1], "pants", pattern("pants"))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"crotch": None}, "missing: crotch"),
        ({"collar": 3}, "unknown: collar"),
        ({"crotch": 10**6}, "no vertex of the mesh"),
        ({"crotch": True}, "no vertex of the mesh"),
    ],
)
def test_wrong_keypoints_are_named(files, change, words):
    keypoints = {**json.loads(files[1].read_text()), **change}
    files[1].write_text(json.dumps({name: vertex for name, vertex in keypoints.items() if vertex is not None}))
    with pytest.raises(GarmentError, match=words):
        load_obj(*files, "pants", pattern("pants"))


def test_keypoints_must_be_an_object(files):
    for text in ("[]", "{", "{}"):
        files[1].write_text(text)
        with pytest.raises(GarmentError, match="JSON object"):
            load_obj(*files, "pants", pattern("pants"))
