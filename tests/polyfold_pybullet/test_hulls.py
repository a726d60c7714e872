"""Finely meshed links are measured by leaner hulls, which are nearly as large and never larger."""

import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from polyfold_pybullet.bodies import imported
from polyfold_pybullet.robots import panda, with_lean_hulls
from polyfold_pybullet.robots.hulls import TOLERANCE, lean_hull
from scipy.spatial import ConvexHull

URDF = """<robot name="ball"><link name="ball"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0"
ixz="0" iyz="0"/></inertial><collision><geometry><mesh filename="{name}" scale="{scale} {scale} {scale}"/></geometry>
</collision></link></robot>"""


def ball(count, radius, seed):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    return radius * points / np.linalg.norm(points, axis=1, keepdims=True)


def write_stl(path, points):
    facets = points[ConvexHull(points).simplices].astype("<f4")
    rows = (struct.pack("<3f", 0, 0, 0) + facet.tobytes() + b"\0\0" for facet in facets)
    path.write_bytes(b" " * 80 + struct.pack("<I", len(facets)) + b"".join(rows))


@settings(max_examples=30, deadline=None)
@given(count=st.integers(10, 800), stretch=st.floats(0.01, 1.0), seed=st.integers(0, 99))
def test_a_lean_hull_is_nearly_as_large_and_never_larger(count, stretch, seed):
    points = ball(count, 0.1, seed) * [1.0, 1.0, stretch]
    corners = lean_hull(points, TOLERANCE)
    facets = ConvexHull(corners).equations
    out = points @ facets[:, :3].T + facets[:, 3]
    assert out.max() <= TOLERANCE * 1.01
    assert {*map(tuple, corners)} <= {*map(tuple, points)}


@pytest.mark.parametrize("scale", [1.0, 0.001])
def test_pybullet_measures_distances_by_it(tmp_path, scale):
    write_stl(tmp_path / "ball.stl", ball(3000, 0.1 / scale, 0))
    urdf = tmp_path / "ball.urdf"
    urdf.write_text(URDF.format(name="ball.stl", scale=scale))
    (tmp_path / "lean").mkdir()
    lean = with_lean_hulls(urdf, tmp_path / "lean")
    assert lean != urdf
    hull = (tmp_path / "lean").glob("*.obj")
    assert sum(line.startswith("v ") for line in next(hull).read_text().splitlines()) < 600
    bullet = imported()
    client = bullet.connect(bullet.DIRECT)
    try:
        one, other = (
            bullet.loadURDF(str(lean), (x, 0, 0), useFixedBase=True, physicsClientId=client) for x in (0.0, 0.3)
        )
        (near, *_) = bullet.getClosestPoints(one, other, 1.0, physicsClientId=client)
        assert near[8] == pytest.approx(0.1, abs=0.004)
    finally:
        bullet.disconnect(client)


def test_what_is_not_fine_stays_as_it_is(tmp_path):
    urdf = tmp_path / "ball.urdf"
    write_stl(tmp_path / "ball.stl", ball(100, 0.1, 0))
    for name in ("ball.stl", "missing.stl"):
        urdf.write_text(URDF.format(name=name, scale=1.0))
        assert with_lean_hulls(urdf, tmp_path) == urdf

    franka = Path(panda().arms[0].urdf)
    assert with_lean_hulls(franka, tmp_path) == franka
