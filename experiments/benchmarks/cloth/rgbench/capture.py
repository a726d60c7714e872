"""Files of one RGBench capture: gripper poses, segmented point clouds, and where the camera was."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import SimulationError

Floats = NDArray[np.float64]

BASES = {"left": np.array([0.0, 0.25, 0.0]), "right": np.array([0.0, -0.25, 0.0])}
"""Where the arms stand in the world [m], as RGBench's environments have it; its DATASET.md has the signs reversed."""
POSE_FILE = "joints/{arm}_arm_joint_states_and_end_pose.csv"
CAMERA_FILE = "calibration/world_to_camera_transform.json"
CLOUDS, PREFIX, SUFFIX = "segment_pcds", "pointcloud_", "_segmented.pcd"


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Where one gripper was.

    Attributes:
        times: absolute [s], shape (K,), rising.
        positions: in the world [m], shape (K, 3).
    """

    times: Floats
    positions: Floats

    def at(self, time: float) -> Floats:
        """Position [m] at an absolute time [s], shape (3,); before and after the recording, its first and last."""
        return np.array([np.interp(time, self.times, self.positions[:, axis]) for axis in range(3)])


@dataclass(frozen=True, eq=False)
class Frame:
    """What the camera saw of the cloth.

    Attributes:
        time: absolute [s].
        points: in the world [m], shape (P, 3).
    """

    time: float
    points: Floats


def read_trajectory(path: str | Path, arm: str) -> Trajectory:
    """Poses of a gripper from its CSV file: columns ``time``, ``pos_x``, ``pos_y``, ``pos_z`` among others.

    Raises:
        SimulationError: if the file can't be read as such.
    """
    path = Path(path)
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = [[float(row[name]) for name in ("time", "pos_x", "pos_y", "pos_z")] for row in csv.DictReader(file)]
    except (OSError, KeyError, ValueError) as error:
        raise SimulationError(f"{path} holds no gripper poses ({error!r}); give a capture of RGBench v1") from error
    if len(rows) < 2:
        raise SimulationError(f"{path} holds fewer than two poses; download the capture again")
    table = np.array(rows)
    return Trajectory(table[:, 0], table[:, 1:] + BASES[arm])


def read_frames(capture: str | Path) -> Iterator[Frame]:
    """The capture's point clouds in the order of time, taken into the world's frame.

    Raises:
        SimulationError: if there are none, or one can't be read.
    """
    capture = Path(capture)
    files = list((capture / CLOUDS).glob(f"{PREFIX}*{SUFFIX}"))
    if not files:
        raise SimulationError(f"{capture / CLOUDS} holds no point clouds; give the folder of one capture")
    try:
        world_to_camera = np.array(json.loads((capture / CAMERA_FILE).read_text("utf-8")), float)
    except (OSError, ValueError) as error:
        raise SimulationError(f"{capture / CAMERA_FILE} can't be read ({error}); download it again") from error
    to_world = np.linalg.inv(world_to_camera)
    for path in sorted(files, key=_time_of):
        points = read_pcd(path)
        yield Frame(_time_of(path), points @ to_world[:3, :3].T + to_world[:3, 3])


def read_pcd(path: Path) -> Floats:
    """Points of a PCD file, plain text or uncompressed binary, shape (P, 3).

    Raises:
        SimulationError: for another format.
    """
    content = path.read_bytes()
    end = content.find(b"\nDATA ")
    if end < 0:
        raise SimulationError(f"{path} is no PCD file; download it again")
    body = content.index(b"\n", end + 1) + 1
    header = [line.split() for line in content[:body].decode("ascii", "replace").splitlines()]
    said = {line[0]: line[1:] for line in header if len(line) > 1}
    names, kind = said["FIELDS"], said["DATA"][0]
    if kind == "ascii":
        table = np.loadtxt(content[body:].decode("ascii").splitlines(), ndmin=2)
        points = table[:, [names.index(axis) for axis in "xyz"]]
    elif kind == "binary":
        letters = {"F": "f", "U": "u", "I": "i"}
        counts = [int(count) for count in said.get("COUNT", ["1"] * len(names))]
        fields = [
            (name, f"<{letters[letter]}{size}", (count,))
            for name, letter, size, count in zip(names, said["TYPE"], said["SIZE"], counts, strict=True)
        ]
        records = np.frombuffer(content, np.dtype(fields), count=int(said["POINTS"][0]), offset=body)
        points = np.column_stack([records[axis][:, 0] for axis in "xyz"])
    else:
        raise SimulationError(f"{path} is packed ({kind}); write it again uncompressed, for example with Open3D")
    points = points.astype(float)
    return points[np.isfinite(points).all(axis=1)]


def _time_of(path: Path) -> float:
    stamp = path.name.removeprefix(PREFIX).removesuffix(SUFFIX)
    try:
        return float(stamp)
    except ValueError as error:
        raise SimulationError(f"{path} has no time in its name; download it again") from error
