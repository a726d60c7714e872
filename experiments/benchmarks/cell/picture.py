"""What the cell looks like while both arms carry: ``python -m experiments.benchmarks.cell.picture --out cell.png``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from PIL import Image
from polyfold_pybullet.cell import Cell
from polyfold_pybullet.planning import FoldPlanner, Infeasible
from polyfold_pybullet.robots import robot_model

PICKS, PLACES = ((-0.18, -0.12, 0.004), (0.18, -0.12, 0.004)), ((-0.18, 0.16, 0.004), (0.18, 0.16, 0.004))


def main(arguments: Sequence[str] | None = None) -> None:
    """Plan a fold in half and render it, from the side."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cell.picture", description=__doc__)
    parser.add_argument("--robot", choices=("panda", "yumi"), default="panda")
    parser.add_argument("--share", type=float, default=0.5, help="how far the arms have carried (default 0.5)")
    parser.add_argument("--out", default="cell.png")
    options = parser.parse_args(arguments)
    with Cell(robot_model(options.robot)) as cell:
        plan = FoldPlanner(cell).plan(PICKS, PLACES)
        if isinstance(plan, Infeasible):
            sys.exit(plan.reason)
        carry = next(motion for motion in plan.motions if motion.name == "carry")
        for arm, joints in enumerate(carry.joints):
            cell.set_arm(arm, joints[round(options.share * (len(joints) - 1))])
            cell.set_hand(arm, cell.model.arms[arm].closed_width)
        Image.fromarray(cell.picture(960, 720)).save(options.out)


if __name__ == "__main__":
    main()
