"""RGBench's published figures: ``results/paper_baselines.csv``, column ``cd_l1_r2s``, mean of seven garments."""

from __future__ import annotations

from collections.abc import Iterator

from experiments.benchmarks.cloth.reality.rows import Row
from polyfold.garments import Fabric

SOURCE = "RGBench, AAAI 2026, results/paper_baselines.csv"
PUBLISHED = {
    "fold, pinned grippers": {"GarmentDynamics": 19.6, "PyBullet": 27.3, "Isaac Sim": 32.7},
    "fold, whole robot": {"GarmentDynamics": 19.6, "PyBullet": 56.4, "Isaac Sim": 42.5},
    "grasp, pinned grippers": {"GarmentDynamics": 24.2, "PyBullet": 38.6, "Isaac Sim": 39.6},
    "fling, pinned grippers": {"GarmentDynamics": 41.4, "PyBullet": 63.5, "Isaac Sim": 60.7},
}
"""One-way Chamfer distance from the real points to the simulated ones, in the L1 norm [mm]."""


def published_rows(fabric: Fabric, edge_length: float) -> Iterator[Row]:
    """The published figures beside what ours needs."""
    del fabric, edge_length  # who has the data runs experiments.benchmarks.cloth.rgbench
    for task, figures in PUBLISHED.items():
        shown = ", ".join(f"{name} {value:.1f}" for name, value in figures.items())
        ours = "needs the data" if "whole robot" not in task else "no robot arms in this simulator"
        yield Row(
            "RGBench",
            "7 garments",
            f"{task}: Chamfer, real to simulated",
            f"{shown} mm ({SOURCE})",
            ours,
            "3 captures each",
        )
