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
    with pytest.raises(GarmentError, match=r"there is no file .*absent\.obj"):
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


def flat_towel(tmp_path, write):
    """A flat towel that a function writes; returns its garment, and the one that was read."""
    garment = KINDS["rectangle"].generate(2002, 0.02)
    positions = np.column_stack([garment.mesh.vertices, np.zeros(len(garment.mesh.vertices))])
    keypoints = write(tmp_path / "towel.obj", positions, garment)
    (tmp_path / "keypoints.json").write_text(json.dumps(keypoints or garment.keypoints))
    files = (tmp_path / "towel.obj", tmp_path / "keypoints.json")
    return garment, load_obj(*files, "rectangle", pattern("rectangle"), edge_length=0.02)


def test_files_as_other_programs_write_them_are_read(tmp_path):
    def write(path, positions, garment):
        lines = [
            "\ufeff# made elsewhere",
            "o towel",
            *(f"\tv\t{x:.6f}\t{y:.6f} {z:.6f} # here" for x, y, z in positions),
        ]
        count = len(positions)
        lines += [f"  f {a - count} {b - count}/1 \\\n {c - count}/1/1" for a, b, c in garment.mesh.triangles]
        path.write_text("\r\n".join(lines), "utf-8")

    garment, loaded = flat_towel(tmp_path, write)
    np.testing.assert_allclose(np.ptp(loaded.mesh.vertices, axis=0), np.ptp(garment.mesh.vertices, axis=0), rtol=0.02)


@pytest.mark.parametrize("kind", ["tshirt", "pants"])
@pytest.mark.parametrize("seed", [2001, 2002, 2003, 2004])
def test_panels_that_are_one_concave_polygon_each_keep_their_keypoints(tmp_path, kind, seed):
    garment = KINDS[kind].generate(seed, 0.02)
    rim = outer_rim(garment.mesh)
    sewn = {place for place, vertex in enumerate(rim) if garment.mesh.seam[vertex]}
    lines = [f"v {x:.6f} {y:.6f} 0.002" for x, y in garment.mesh.vertices[rim]]
    back = list[int]()
    for place, (x, y) in enumerate(garment.mesh.vertices[rim]):
        if place not in sewn:
            lines.append(f"v {x:.6f} {y:.6f} -0.002")
        back.append(place + 1 if place in sewn else len(lines))
    lines.append(" ".join(["f", *map(str, range(1, len(rim) + 1))]))
    lines.append(" ".join(["f", *map(str, reversed(back))]))
    (tmp_path / "garment.obj").write_text("\n".join(lines))
    places = {vertex: place for place, vertex in enumerate(rim)}
    keypoints = {name: places[vertex] for name, vertex in garment.keypoints.items()}
    (tmp_path / "keypoints.json").write_text(json.dumps(keypoints))
    loaded = load_obj(tmp_path / "garment.obj", tmp_path / "keypoints.json", kind, pattern(kind), edge_length=0.02)
    off = [
        loaded.mesh.vertices[loaded.keypoints[name]] - garment.mesh.vertices[vertex]
        for name, vertex in garment.keypoints.items()
    ]
    assert np.linalg.norm(off - np.mean(off, axis=0), axis=1).max() < 0.005


def outer_rim(mesh):
    """The vertices around the front panel, in order."""
    t = mesh.triangles[mesh.panel == 1]
    directed = np.vstack([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    pairs = {(int(a), int(b)) for a, b in directed}
    follows = {a: b for a, b in pairs if (b, a) not in pairs}
    rim = [next(iter(follows))]
    while follows[rim[-1]] != rim[0]:
        rim.append(follows[rim[-1]])
    return rim


def test_seams_that_nearly_meet_are_welded_with_a_word(files, garment):
    mesh, positions = garment.mesh, worn_pants(garment)
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in positions]
    copies = {vertex: len(lines) + k for k, vertex in enumerate(np.flatnonzero(mesh.seam))}
    lines += [f"v {x:.6f} {y:.6f} {z - 1e-4:.6f}" for x, y, z in positions[list(copies)]]
    for face, panel in zip(mesh.triangles, mesh.panel, strict=True):
        a, b, c = (copies.get(vertex, vertex) + 1 if panel == 1 else vertex + 1 for vertex in face)
        lines.append(f"f {a} {b} {c}" if panel == 1 else f"f {a} {c} {b}")
    files[0].write_text("\n".join(lines))
    with pytest.warns(UserWarning, match="vertices along seams are joined"):
        loaded = load_obj(*files, "pants", pattern("pants"), edge_length=0.02)
    assert rims(loaded.mesh) == 3


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("f 0 1 2", r"line \d+: a face names vertex 0; vertices count from 1"),
        ("f 1 2 99999", "names vertex 99999 of"),
        ("f 1 2", "needs three corners"),
        ("f 1 2 x", "names vertices, not 'x'"),
        ("v 1 2", "broken vertex line"),
    ],
)
def test_a_broken_line_is_named(files, line, says):
    files[0].write_text(files[0].read_text() + line + "\n")
    with pytest.raises(GarmentError, match=says):
        load_obj(*files, "pants", pattern("pants"))


def test_keypoints_on_one_vertex_are_refused(files, garment):
    files[1].write_text(json.dumps(dict.fromkeys(garment.keypoints, 5)))
    with pytest.raises(GarmentError, match="name one vertex"):
        load_obj(*files, "pants", pattern("pants"))


@pytest.mark.parametrize("factor", [1e-7, 0.12, 0.3, 100])
def test_a_mesh_in_other_units_asks_for_its_size_and_is_read_with_it(files, garment, factor):
    write_obj(files[0], worn_pants(garment), garment.mesh)
    lines = [
        " ".join(["v", *(f"{float(value) * factor:.9g}" for value in line.split()[1:])]) if line[:2] == "v " else line
        for line in files[0].read_text().splitlines()
    ]
    files[0].write_text("\n".join(lines))
    with pytest.raises(GarmentError, match=r"a pants is 0\.44 to 2\.5 m long.*--size"):
        load_obj(*files, "pants", pattern("pants"))
    loaded = load_obj(*files, "pants", pattern("pants"), size_m=1.0, edge_length=0.02)
    assert np.ptp(loaded.mesh.vertices, axis=0).max() == pytest.approx(1.0, abs=0.02)


def test_keypoints_that_are_endless_brackets_are_refused(files):
    files[1].write_text("[" * 100_000)
    with pytest.raises(GarmentError, match="no JSON"):
        load_obj(*files, "pants", pattern("pants"))
