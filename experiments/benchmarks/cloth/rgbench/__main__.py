"""How far real points are from ours: ``python -m experiments.benchmarks.cloth.rgbench CAPTURE --mesh OBJ``.

The times of a capture (``--window``, ``--delay``) stand in RGBench's ``configs/experiment_library.yaml``.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.reality.bench import FABRICS, fabric_named
from experiments.benchmarks.cloth.rgbench.capture import POSE_FILE, Frame, read_frames
from experiments.benchmarks.cloth.rgbench.environment import ARMS, Environment
from experiments.benchmarks.cloth.rgbench.published import PUBLISHED


def chamfer(source: NDArray[np.float64], target: NDArray[np.float64]) -> float:
    """Mean over the source's points of the L1 distance to the nearest target point [m], shapes (P, 3) and (Q, 3)."""
    from scipy.spatial import KDTree

    return float(np.asarray(KDTree(target).query(source, p=1)[0]).mean())


def errors(
    environment: Environment, frames: Iterable[Frame], window: tuple[float, float], delay: float, prepared: float = 0.0
) -> list[tuple[float, float]]:
    """Chamfer distances [m] real to simulated and simulated to real of every frame in the window.

    Args:
        environment: at its start.
        frames: in the order of time.
        window: simulator's time of the frames that count, without the preparation [s].
        delay: of the camera [s].
        prepared: time that a fling's preparation takes [s].
    """
    found = []
    start = environment.get_master_start_time()
    for frame in frames:
        time = frame.time - start
        if time < 0 or time + delay > window[1]:
            continue
        environment.step_to_time(time + delay + prepared)
        if time + delay >= window[0] and len(frame.points):
            simulated = environment.get_sim_vertices()
            found.append((chamfer(frame.points, simulated), chamfer(simulated, frame.points)))
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the capture's errors beside the published ones."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cloth.rgbench", description=__doc__)
    parser.add_argument("capture", type=Path, help="folder of one capture: calibration, joints, segment_pcds")
    parser.add_argument("--mesh", type=Path, required=True, help="the garment's OBJ file")
    parser.add_argument("--action", choices=("fold", "grasp", "fling"), default="fold", help="default: fold")
    parser.add_argument("--window", type=float, nargs=2, default=(0.0, 1e9), help="start and end that count [s]")
    parser.add_argument("--delay", type=float, default=0.06, help="of the camera [s] (default: 0.06)")
    parser.add_argument("--shoulders", type=int, nargs=2, help="vertices that a fling holds")
    parser.add_argument("--fabric", choices=FABRICS, default="jersey", help="default: jersey")
    options = parser.parse_args(arguments)
    environment = Environment(_configuration(options), fabric_named(options.fabric))
    prepared = 10.0 if options.action == "fling" else 0.0
    found = np.array(errors(environment, read_frames(options.capture), tuple(options.window), options.delay, prepared))
    if not len(found):
        parser.error("no frame lies in the window; see RGBench's configs/experiment_library.yaml")
    published = PUBLISHED[f"{options.action}, pinned grippers"]
    real_to_sim, sim_to_real = 1000 * found.mean(axis=0)
    print("| simulator | Chamfer, real to simulated | simulated to real | n |\n|---|---|---|---|")
    print(f"| ours, {options.fabric} | {real_to_sim:.1f} mm | {sim_to_real:.1f} mm | {len(found)} frames |")
    for name, value in published.items():
        print(f"| {name} (published) | {value:.1f} mm | | 7 garments |")


def _configuration(options: argparse.Namespace) -> dict[str, Any]:
    """What RGBench's own runner would pass."""
    poses = {f"{arm}_arm_csv_path": options.capture / POSE_FILE.format(arm=arm) for arm in ARMS}
    return {
        "cloth": {"model_path": options.mesh},
        "cloth_params": {"shoulder_index": options.shoulders},
        "data": {"robot_joints": {name: path for name, path in poses.items() if path.exists()}},
        "action": {"type": options.action},
        "evaluate": {"start_calculate_time": options.window[0]},
    }


if __name__ == "__main__":
    main()
