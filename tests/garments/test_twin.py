import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import KINDS, assert_sound, pattern, rims

from polyfold.errors import GarmentError
from polyfold.garments._twin import twin_from_outline
from polyfold.geometry import iou, polygon_area, rotate
from polyfold.geometry._masks import fill_polygon

SAMPLE = [json.loads(line) for line in (Path(__file__).parents[1] / "data" / "artf_sample.jsonl").open()]
SIDES = ("left", "right")
SHIRT = {
    **{
        f"{ours}_{side}": f"{theirs}_{side}"
        for ours, theirs in (("hem", "waist"), ("armpit", "armpit"))
        for side in SIDES
    },
    **{f"{name}_{side}": f"{name}_{side}" for name in ("shoulder", "neck") for side in SIDES},
    **{f"sleeve_{end}_{side}": f"sleeve_{side}_{end}" for end in ("top", "bottom") for side in SIDES},
}
SHORTS = {
    "crotch": "crotch",
    **{f"waist_{side}": f"waist_{side}" for side in SIDES},
    **{f"leg_{end}_{side}": f"pipe_{side}_{end}" for end in ("outer", "inner") for side in SIDES},
}


def annotation(line):
    """Kind, outline [px] and keypoints of an annotated real garment, left and right as seen."""
    outline = np.array(max(line["mask"], key=lambda polygon: abs(polygon_area(polygon))))
    points = {name: np.array(point) for name, point in line["keypoints"].items()}
    if line["garment"] == "towel":
        corners = np.array(list(points.values()))
        turn = np.arctan2(*(corners - corners.mean(0)).T[::-1])
        return (
            "rectangle",
            outline,
            dict(zip(KINDS["rectangle"].pattern.corners, corners[np.argsort(turn)], strict=True)),
        )
    kind, names = ("tshirt", SHIRT) if line["garment"] == "tshirt" else ("pants", SHORTS)
    found = {ours: points[theirs] for ours, theirs in names.items()}
    if kind == "tshirt":
        middle, hem = ((found[f"{name}_left"] + found[f"{name}_right"]) / 2 for name in ("neck", "hem"))
        found["neck_center"] = middle + 0.08 * (hem - middle)
    if polygon_area([found[name] for name in KINDS[kind].pattern.corners]) < 0:
        swap = {"left": "right", "right": "left"}
        found = {"_".join(swap.get(part, part) for part in name.split("_")): point for name, point in found.items()}
    return kind, outline, found


def seen(garment, scale=500.0, angle=0.0):
    """A generated garment as an outline and keypoints in pixels."""
    mesh = garment.mesh

    def pixels(points):
        return rotate(points, angle) * scale * [1, -1] + 300

    return pixels(mesh.vertices[mesh.boundary]), {n: pixels(mesh.vertices[v]) for n, v in garment.keypoints.items()}


@pytest.mark.parametrize("line", SAMPLE, ids=lambda line: Path(line["image"]).parent.name + line["image"][-27:-12])
def test_real_outlines_become_sound_twins(line):
    kind, outline, keypoints = annotation(line)
    twin = twin_from_outline(outline, kind, keypoints, KINDS[kind].pattern, edge_length=0.02)
    pattern = KINDS[kind].pattern
    assert_sound(twin.mesh, 0.02, least_angle=12.0, shortest=0.25)
    assert twin.mesh.layers == pattern.layers
    assert rims(twin.mesh) == max(1, len(pattern.openings))
    assert set(twin.keypoints) == set(pattern.corners)
    assert np.ptp(twin.mesh.vertices, axis=0).max() == pytest.approx(pattern.size, rel=0.06)
    assert twin.cyclic == pattern.cyclic
    top, bottom = (
        np.mean([twin.mesh.vertices[twin.keypoints[name]] for name in names], axis=0)
        for names in (pattern.top, pattern.bottom)
    )
    assert top[1] - bottom[1] > 3 * abs(top[0] - bottom[0]), "upright"


@pytest.mark.parametrize("kind", KINDS)
@given(angle=st.floats(-3, 3), scale=st.floats(200, 2000))
@settings(max_examples=6)
def test_a_twin_is_the_garment_again_whatever_its_pose_in_the_picture(kind, angle, scale):
    garment = KINDS[kind].generate(2005, 0.02)
    size = float(np.ptp(garment.mesh.vertices, axis=0).max())
    twin = twin_from_outline(
        *seen(garment, scale, angle)[:1], kind, seen(garment, scale, angle)[1], pattern(kind), size, 0.02
    )
    masks = [fill_polygon(mesh.vertices[mesh.boundary] * 400 + 250, 500, 500) for mesh in (garment.mesh, twin.mesh)]
    assert iou(*masks) > 0.93
    for name, vertex in garment.keypoints.items():
        apart = garment.mesh.vertices[vertex] - twin.mesh.vertices[twin.keypoints[name]]
        assert np.hypot(*apart) < 0.05, name


def test_size_is_the_longest_side():
    outline, keypoints = seen(KINDS["pants"].generate(2001, 0.03))
    for size in (0.5, 1.1):
        twin = twin_from_outline(outline, "pants", keypoints, pattern("pants"), size, 0.02)
        assert np.ptp(twin.mesh.vertices, axis=0).max() == pytest.approx(size, rel=0.03)


def test_a_wiggly_outline_with_a_loop_is_repaired():
    garment = KINDS["tshirt"].generate(2002, 0.01)
    outline, keypoints = seen(garment)
    wiggly = outline + np.random.default_rng(0).normal(0, 1.2, outline.shape)
    k = len(wiggly) // 3
    wiggly = np.vstack([wiggly[: k + 3], wiggly[k - 2 : k], wiggly[k + 3 :]])
    twin = twin_from_outline(wiggly, "tshirt", keypoints, pattern("tshirt"), 0.8, 0.02)
    assert_sound(twin.mesh, 0.02, least_angle=12.0)


def test_keypoints_off_the_outline_are_moved_onto_it():
    garment = KINDS["tshirt"].generate(2003, 0.02)
    outline, keypoints = seen(garment)
    rng = np.random.default_rng(1)
    noisy = {name: point + rng.normal(0, 5, 2) for name, point in keypoints.items()}
    twin = twin_from_outline(outline, "tshirt", noisy, pattern("tshirt"), edge_length=0.02)
    assert set(twin.keypoints.values()) <= set(twin.mesh.boundary.tolist())


def test_legs_that_lie_side_by_side_are_cut_apart():
    corners = {
        "leg_inner_left": (200, 380), "leg_outer_left": (110, 380), "waist_left": (120, 40), "waist_right": (280, 40),
        "leg_outer_right": (290, 380), "leg_inner_right": (200, 380), "crotch": (200, 170),
    }  # fmt: skip
    outline = [corners[name] for name in ("leg_outer_left", "waist_left", "waist_right", "leg_outer_right")]
    twin = twin_from_outline(outline, "pants", corners, pattern("pants"), edge_length=0.02)
    assert rims(twin.mesh) == 3
    mesh, keypoints = twin.mesh, twin.keypoints
    crotch = mesh.vertices[keypoints["crotch"]]
    waist = mesh.vertices[keypoints["waist_left"]]
    assert waist[1] - crotch[1] == pytest.approx(130 / 340 * 0.8, abs=0.02)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"outline": [[0, 0], [1, 1]]}, "three finite points"),
        ({"outline": [[0, 0], [100, 100], [100, 0], [0, 100]]}, "falls apart"),
        ({"keypoints": {"top_left": (0, 0)}}, "bottom_left, top_right, bottom_right are missing"),
        ({"size_m": 40.0}, "plausible"),
        ({"edge_length": 0.5}, "edge length"),
        ({"mirrored": True}, "mirrored"),
        ({"keypoints_nan": True}, "finite pixels"),
    ],
)
def test_unusable_input_is_refused_with_what_to_do(change, words):
    outline, keypoints = seen(KINDS["rectangle"].generate(2001, 0.03))
    if change.pop("mirrored", False):
        swap = {"left": "right", "right": "left"}
        keypoints = {"_".join(swap.get(p, p) for p in name.split("_")): xy for name, xy in keypoints.items()}
    if change.pop("keypoints_nan", False):
        keypoints = {**keypoints, "top_left": (np.nan, 0)}
    arguments = {
        "outline": outline,
        "kind": "rectangle",
        "keypoints": keypoints,
        "pattern": pattern("rectangle"),
        **change,
    }
    with pytest.raises(GarmentError, match=words):
        twin_from_outline(**arguments)
