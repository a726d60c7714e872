"""Inverse kinematics: ``python -m experiments.benchmarks.cell.reach``. Reachable and unreachable poses, and the time.

Reachable poses are those of random joint angles within limits, and hands that point down over the table, of which the
reachable ones are found by trying from ten times as many starts. Prints a Markdown table.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from polyfold_pybullet.kinematics import Kinematics, OutOfReach, Reached
from polyfold_pybullet.planning.grasping import top_down
from polyfold_pybullet.robots import RobotModel, robot_model

Floats = NDArray[np.float64]

POSITION, ROTATION = 1e-3, 0.02
"""What counts as reached [m], [rad]."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cell.reach", description=__doc__)
    parser.add_argument("--robots", nargs="+", default=["panda", "yumi"])
    parser.add_argument("--poses", type=int, default=300)
    parser.add_argument("--seed", type=int, default=2000)
    options = parser.parse_args(arguments)
    print("| robot, arm | poses | reached | time: median, p99, largest |\n|---|---|---|---|")
    for name in options.robots:
        model = robot_model(name)
        for arm in model.arms:
            kinematics = Kinematics(arm)
            rng = np.random.default_rng(options.seed)
            drawn = rng.uniform(kinematics.chain.lower, kinematics.chain.upper, (options.poses, len(kinematics.chain)))
            _print_row(f"{name}, {arm.name}", "random joints", kinematics, kinematics.along(drawn))
            over = _over_the_table(model, kinematics, options.poses, rng)
            _print_row(f"{name}, {arm.name}", "top-down over the table", kinematics, over)
            away = over.copy()
            away[:, 2, 3] += 2.0
            _print_row(f"{name}, {arm.name}", "2 m above, unreachable", kinematics, away)


def _over_the_table(model: RobotModel, kinematics: Kinematics, count: int, rng: np.random.Generator) -> Floats:
    """Reachable poses of a hand that points down, up to 30 cm above the table, shape (count, 4, 4)."""
    searching = Kinematics(kinematics.arm, restarts=2000)
    poses: list[Floats] = []
    while len(poses) < count:
        position = [rng.uniform(*model.table.x), rng.uniform(*model.table.y), rng.uniform(0.0, 0.3)]
        pose = top_down(position, rng.uniform(-np.pi, np.pi))
        if isinstance(searching.inverse(pose), Reached):
            poses.append(pose)
    return np.array(poses)


def _print_row(who: str, what: str, kinematics: Kinematics, poses: Floats) -> None:
    kinematics.inverse(poses[0])
    seconds, reached = [], 0
    for pose in poses:
        clock = time.process_time()
        answer = kinematics.inverse(pose)
        seconds.append(time.process_time() - clock)
        reached += not isinstance(answer, OutOfReach) and _is_right(kinematics, answer, pose)
    middle, high, most = 1000 * np.median(seconds), 1000 * np.percentile(seconds, 99), 1000 * max(seconds)
    print(f"| {who} | {len(poses)} {what} | {reached} | {middle:.2f}, {high:.2f}, {most:.2f} ms |", flush=True)


def _is_right(kinematics: Kinematics, answer: Reached, pose: Floats) -> bool:
    """Whether an answer is within limits and tolerances, by the forward kinematics."""
    found, chain = kinematics.forward(answer.joints), kinematics.chain
    turned = np.arccos(np.clip((np.trace(found[:3, :3].T @ pose[:3, :3]) - 1) / 2, -1, 1))
    within = (answer.joints >= chain.lower - 1e-9).all() and (answer.joints <= chain.upper + 1e-9).all()
    return bool(np.linalg.norm(found[:3, 3] - pose[:3, 3]) <= POSITION and turned <= ROTATION and within)


if __name__ == "__main__":
    main()
