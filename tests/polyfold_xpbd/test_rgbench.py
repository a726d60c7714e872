"""The adapter for RGBench, on a made-up capture in its format."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from experiments.benchmarks.cloth.rgbench.__main__ import chamfer, errors, main
from experiments.benchmarks.cloth.rgbench.capture import BASES, CAMERA_FILE, POSE_FILE, read_frames, read_trajectory
from experiments.benchmarks.cloth.rgbench.environment import Environment, fabric_of
from experiments.benchmarks.cloth.rgbench.garments import read_garment
from polyfold.errors import ConfigError, GarmentError, SimulationError
from polyfold.garments import Outline, mesh_panels

START = 1753700000.0
GRAB, END = 0.3, 0.8
RISE = 0.1
ARMS = ("left", "right")
FLAT_POSE = np.array([0.0, 0, 0, 1, 0, 0, 0])


@pytest.fixture(scope="module")
def capture(tmp_path_factory):
    """A bag of two layers whose upper corners two grippers lift by 10 cm; the camera stands 1 m above, looking down."""
    folder = tmp_path_factory.mktemp("capture")
    corners = np.array([[-0.15, -0.15], [0.15, -0.15], [0.15, 0.15], [-0.15, 0.15]])
    outline = Outline(corners, {str(k): k for k in range(4)}, (("0", "1"),))
    mesh, named = mesh_panels(outline, 2, 0.03)
    triangles = mesh.triangles.copy()
    below = mesh.panel == 0
    triangles[below, 1], triangles[below, 2] = mesh.triangles[below, 2], mesh.triangles[below, 1]
    lines = [f"v {x:.6f} {y:.6f} {0.002 * z:.6f}" for (x, y), z in zip(mesh.vertices, mesh.layer, strict=True)]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    (folder / "bag.obj").write_text("\n".join(lines))
    for name in ("joints", "calibration", "segment_pcds"):
        (folder / name).mkdir()
    for arm, corner in zip(ARMS, ("3", "2"), strict=True):
        _write_poses(folder / POSE_FILE.format(arm=arm), np.append(mesh.vertices[named[corner]], 0.0) - BASES[arm])
    world_to_camera = np.diag([1.0, -1.0, -1.0, 1.0])
    world_to_camera[2, 3] = 1.0
    (folder / CAMERA_FILE).write_text(json.dumps(world_to_camera.tolist()))
    seen = np.column_stack([mesh.vertices, np.full(len(mesh.vertices), 0.003)])
    in_camera = seen * [1, -1, -1] + [0, 0, 1]
    for k, time in enumerate((0.1, 0.2)):
        _write_pcd(folder / "segment_pcds" / f"pointcloud_{START + time:.6f}_segmented.pcd", in_camera, binary=k > 0)
    return folder


def _write_poses(path, start):
    times = np.linspace(0.0, 1.0, 51)
    rise = RISE * np.clip((times - GRAB) / (END - GRAB), 0.0, 1.0)
    rows = ["time,pos_1,pos_gripper,pos_x,pos_y,pos_z,orn_w,orn_x,orn_y,orn_z"]
    rows += [
        f"{START + t:.6f},0,0,{start[0]},{start[1]},{start[2] + z},1,0,0,0" for t, z in zip(times, rise, strict=True)
    ]
    path.write_text("\n".join(rows))


def _write_pcd(path, points, binary):
    count = len(points)
    kind = "binary" if binary else "ascii"
    header = (
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
        f"WIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA {kind}\n"
    )
    if binary:
        records = np.zeros(count, [("xyz", "<f4", 3), ("rgb", "<u4")])
        records["xyz"] = points
        body = records.tobytes()
    else:
        body = "\n".join(f"{x:.6f} {y:.6f} {z:.6f} 0" for x, y, z in points).encode()
    path.write_bytes(header.encode() + body)


def configuration(capture, **changes):
    poses = {f"{arm}_arm_csv_path": str(capture / POSE_FILE.format(arm=arm)) for arm in ARMS}
    return {
        "cloth": {"model_path": str(capture / "bag.obj"), "init_pose": FLAT_POSE.tolist()},
        "cloth_params": {"name": "bag", "density": 220, "friction": 0.6, "ground_friction": 0.266},
        "data": {"robot_joints": poses, "sim_start_time": 0.0},
        "action": {"type": "fold"},
        "evaluate": {"start_calculate_time": GRAB, "end_calculate_time": END},
        **changes,
    }


def test_the_environment_has_rgbenchs_methods_and_follows_the_grippers(capture):
    environment = Environment(cfg=configuration(capture), simulation_app=None)
    assert environment.get_master_start_time() == pytest.approx(START)
    assert environment.get_current_sim_time() == 0.0
    flat = environment.get_sim_vertices()
    assert flat.shape[1] == 3
    environment.step_to_time(GRAB)
    assert environment.get_sim_vertices()[:, 2].max() < 0.02
    environment.step_to_time(1.0)
    assert environment.get_current_sim_time() == pytest.approx(1.0, abs=0.002)
    risen = environment.get_sim_vertices()
    for sign in (-1, 1):
        corner = np.linalg.norm(flat[:, :2] - [sign * 0.15, 0.15], axis=1).argmin()
        assert risen[corner] == pytest.approx([sign * 0.15, 0.15, RISE], abs=1e-3)
    assert np.median(risen[:, 2]) < RISE
    environment.step()
    environment.close()


def test_a_fling_holds_the_shoulders_and_is_prepared(capture):
    flat = read_garment(capture / "bag.obj", FLAT_POSE).vertices
    shoulders = [int(np.linalg.norm(flat - [x, 0.15], axis=1).argmin()) for x in (-0.15, 0.15)]
    action = {"type": "fling", "fling_prepare_time": 0.2, "fling_wait_time": 0.1}
    constants = {"shoulder_index": shoulders}
    environment = Environment(configuration(capture, action=action, cloth_params=constants))
    environment.step_to_time(0.3 + END)
    assert environment.get_sim_vertices()[shoulders, 2] == pytest.approx([RISE, RISE], abs=1e-3)


def test_namespaces_do_as_configuration(capture):
    def as_namespace(value):
        if isinstance(value, dict):
            return SimpleNamespace(**{key: as_namespace(item) for key, item in value.items()})
        return value

    environment = Environment(as_namespace(configuration(capture)))
    assert environment.get_master_start_time() == pytest.approx(START)


def test_frames_come_into_the_world_from_both_kinds_of_file(capture):
    frames = list(read_frames(capture))
    assert [frame.time - START for frame in frames] == pytest.approx([0.1, 0.2], abs=1e-5)
    for frame in frames:
        assert frame.points[:, 2] == pytest.approx(0.003, abs=1e-5)
        assert np.ptp(frame.points[:, :2], axis=0) == pytest.approx([0.3, 0.3], abs=1e-4)
    assert frames[0].points == pytest.approx(frames[1].points, abs=1e-5)


def test_cloth_that_lies_as_it_was_seen_has_a_small_error(capture):
    found = errors(Environment(configuration(capture)), read_frames(capture), (0.0, 1.0), 0.0)
    assert len(found) == 2
    assert max(max(pair) for pair in found) < 0.008


def test_the_chamfer_distance_is_one_way_and_in_the_l1_norm():
    source, target = np.array([[0.0, 0, 0]]), np.array([[1.0, 1, 1], [5.0, 5, 5]])
    assert chamfer(source, target) == pytest.approx(3.0)
    assert chamfer(target, source) == pytest.approx(9.0)


def test_the_command_prints_ours_beside_the_published(capture, capsys):
    main([str(capture), "--mesh", str(capture / "bag.obj"), "--window", "0", "0.5", "--delay", "0"])
    printed = capsys.readouterr().out
    assert "ours, jersey" in printed
    assert "19.6 mm" in printed


def test_constants_of_a_garment_become_a_fabric():
    fabric = fabric_of({"name": "green_tshirt", "density": 220, "friction": 0.6, "ground_friction": 0.266})
    assert fabric.weight == pytest.approx(0.22)
    assert fabric.table_friction == pytest.approx(0.266)


def test_front_and_back_are_told_apart(capture):
    mesh = read_garment(capture / "bag.obj", np.array([0.1, 0, 0, 1, 0, 0, 0]))
    assert mesh.layers == 2
    assert mesh.seam.any()
    assert mesh.layer[mesh.seam].max() == 0
    assert mesh.vertices[:, 0].mean() == pytest.approx(0.1, abs=0.01)


def test_what_is_missing_is_named(capture, tmp_path):
    with pytest.raises(ConfigError, match=r"cloth\.model_path"):
        Environment(configuration(capture, cloth={}))
    with pytest.raises(ConfigError, match="left_arm_csv_path"):
        Environment(configuration(capture, data={}))
    with pytest.raises(SimulationError, match="no point clouds"):
        list(read_frames(tmp_path))
    (tmp_path / "poses.csv").write_text("time,x\n0,1\n")
    with pytest.raises(SimulationError, match="no gripper poses"):
        read_trajectory(tmp_path / "poses.csv", "left")
    with pytest.raises(GarmentError, match="flat garment"):
        read_garment(capture / "bag.obj", np.array([0, 0, 0, 0.7071, 0.7071, 0, 0]))
