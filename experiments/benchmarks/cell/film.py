"""A garment folded in the robot cell, as a film: ``python -m experiments.benchmarks.cell.film --out cell.gif``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from polyfold_pybullet.planning import FoldPlan
from polyfold_pybullet.simulator import CellSimulator

from polyfold import viz
from polyfold.config import Experiment
from polyfold.plugins import generate_garment
from polyfold.rollout import run_episode

Floats = NDArray[np.float64]

STEP = 0.25
"""Time between two pictures [s]."""
EYE, TARGET = (1.3, 0.8, 0.8), (0.0, -0.14, 0.16)


class FilmedCell(CellSimulator):
    """The cell, with a picture from the side every quarter of a second while the arms move.

    Cloth and arms move on clocks of their own: the cloth's motion is spread over the time for which the arms carry.
    """

    size = (420, 320)

    def __init__(self, config: CellSimulator.Config | None = None) -> None:
        super().__init__(config)
        self.frames: list[NDArray[np.uint8]] = []

    def reset(self, garment: Any, seed: int) -> Any:
        """As ever, and remember what the cloth is made of."""
        self._garment = garment
        return super().reset(garment, seed)

    def _do(self, action: Any, plan: Any, picks: Floats, places: Floats) -> None:
        before = self._cloth.state().positions
        moved: list[Floats] = [before]
        self._cloth.record(lambda _: moved.append(self._cloth.state().positions), 12.0)
        super()._do(action, plan, picks, places)
        self._cloth.record(None)
        moved.append(self._cloth.state().positions)
        self.frames += self._filmed(plan, moved)

    def _filmed(self, plan: FoldPlan, moved: Sequence[Floats]) -> Iterator[NDArray[np.uint8]]:
        """Pictures of a plan; the cloth moves while hands are closed, and rests before and after."""
        colour = tuple(channel / 255 for channel in self._garment.colours[0])

        def drape(carried: float) -> None:
            positions = moved[round(carried * (len(moved) - 1))]
            self._arms.cell.drape(positions, self._garment.mesh.triangles, colour)

        return self._arms.film(plan, STEP, self.size, drape, eye=EYE, target=TARGET)


def main(arguments: Sequence[str] | None = None) -> None:
    """Fold, film and write."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cell.film", description=__doc__)
    parser.add_argument("sentence", nargs="?", default="fold the t-shirt into a neat block")
    parser.add_argument("--garment", default="tshirt")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--size", type=float, default=0.45, help="longest side [m] (default 0.45)")
    parser.add_argument("--robot", choices=("panda", "yumi"), default="panda")
    parser.add_argument("--out", type=Path, default=Path("cell.gif"))
    options = parser.parse_args(arguments)
    garment = generate_garment(options.garment, options.seed, 0.012, size=options.size)
    simulator = FilmedCell(CellSimulator.Config.model_validate({"arms": {"robot": options.robot}}))
    try:
        run_episode(Experiment(), garment, options.sentence, options.seed, simulator=simulator)
    finally:
        simulator.close()
    changing = [simulator.frames[0], *(b for a, b in pairwise(simulator.frames) if (a != b).any())]
    viz.gif(changing, options.out, fps=10)
    print(options.out)


if __name__ == "__main__":
    main()
