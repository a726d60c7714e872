"""``polyfold cell``: look through the cell's camera, take views to calibrate it, and park the arms.

The cell is the one that ``polyfold fold --config FILE`` folds in: the file's ``[simulator]`` is ``real-cell``.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from polyfold.config import Experiment
from polyfold.errors import ConfigError, PolyfoldError

if TYPE_CHECKING:
    from polyfold.plugins.hardware import RgbdFrame
    from polyfold.types import Observation
    from polyfold_pybullet.real.table import RealCell

Floats = NDArray[np.float64]

EXAMPLE = 'simulator = { name = "real-cell", camera = "realsense", robot = { name = "ur", ... } }'


class CellCommand:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the actions and their options."""
        from polyfold_pybullet.views import BOARD

        actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
        look = actions.add_parser("look", help="what the camera measures, as a picture; moves nothing")
        look.add_argument("--out", type=Path, default=Path("look.png"), metavar="PNG", help="default: look.png")
        views = actions.add_parser("views", help="take views of a board in a hand, for polyfold calibrate")
        views.add_argument("folder", type=Path, help="where to; goes on with those that are there")
        views.add_argument("--arm", default="0", help="which arm holds the board, by number or name (default: 0)")
        views.add_argument("--board", default=BOARD, help=f"the board, to say at once if it is seen (default: {BOARD})")
        park = actions.add_parser("park", help="open the hands and bring the arms to where they wait, once you agree")
        for action in (look, views, park):
            action.add_argument(
                "--config", type=Path, required=True, metavar="FILE", help="TOML file whose [simulator] is real-cell"
            )

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Do one action; whatever happens, camera and arms are released."""
        cell = _cell(arguments.config, located=arguments.action == "look")
        try:
            {"look": _look, "views": _views, "park": _park}[arguments.action](cell, arguments)
        finally:
            cell.close()
        return 0


def _cell(path: Path, located: bool) -> RealCell:
    """The cell of a file. With ``located`` its camera's calibration is read, which may be yet to be made."""
    from polyfold.plugins import create

    spec = Experiment.load(path).simulator
    if spec.name != "real-cell":
        raise ConfigError(f"the simulator of {path} is {spec.name!r}; name the real cell, for example {EXAMPLE}")
    params = spec.params if located else {**spec.params, "calibration": None}
    return create("simulators", "real-cell", params)


def _look(cell: RealCell, arguments: argparse.Namespace) -> None:
    from polyfold_pybullet.real.table import table_heights

    cell.camera.connect()
    frame = cell.camera.get_rgbd(cell.config.frames)
    height, width = frame.depth.shape
    print(f"{width} x {height}, depth measured in {np.isfinite(frame.depth).mean():.1%} of the picture")
    try:
        above = cell.seen(frame)
        low, high = 1000 * np.array([table_heights(above).min(), table_heights(above).max()])
        print(f"the table is measured {low:+.1f} to {high:+.1f} mm from where the robot's world has it (z = 0)")
    except PolyfoldError as error:
        above = None
        print(f"no view from above: {error}")
    _draw(frame, above, arguments.out)
    print(f"picture: {arguments.out}")


def _draw(frame: RgbdFrame, above: Observation | None, path: Path) -> None:
    """Colours, depth and, if it is known where the camera is, the view from above with heights."""
    from matplotlib.figure import Figure

    figure = Figure((13, 3.6) if above is not None else (9, 3.6), layout="constrained")
    axes = figure.subplots(1, 3 if above is not None else 2)
    axes[0].imshow(frame.rgb)
    axes[0].set_title("as the camera sees it")
    depth = axes[1].imshow(frame.depth, cmap="viridis")
    axes[1].set_title("distance [m], white where none is measured")
    figure.colorbar(depth, ax=axes[1])
    if above is not None:
        axes[2].imshow(above.rgb)
        risen = axes[2].imshow(1000 * (above.camera.elevation - above.depth), cmap="coolwarm", alpha=0.5)
        risen.set_clim(-20, 20)
        axes[2].set_title("from above; height over z = 0 [mm]")
        figure.colorbar(risen, ax=axes[2])
    for one in axes:
        one.set_axis_off()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)


def _views(cell: RealCell, arguments: argparse.Namespace) -> None:
    from polyfold_pybullet.real.asking import wants_more
    from polyfold_pybullet.real.viewing import Views

    views = Views.of(arguments.folder, arguments.board)
    cell.camera.connect()
    _tool(cell, arguments.arm)
    held = f"the board in the hand of arm {arguments.arm}"
    while wants_more(f"{len(views)} views. Turn {held} otherwise, let go of it, and keep it in sight"):
        print(f"  {views.take(cell.camera.get_rgbd(1), _tool(cell, arguments.arm))}")
    print(f"{len(views)} views in {arguments.folder}; next: polyfold calibrate {arguments.folder}")


def _tool(cell: RealCell, arm: str) -> Floats:
    """Where an arm's tool is now, shape (4, 4). It is let go of again, so that it can be moved by its own pendant."""
    cell.robot.connect()
    try:
        return cell.robot.tcp_pose(_number(arm, cell.robot.arms))
    finally:
        cell.robot.close()


def _number(name: str, arms: tuple[str, ...]) -> int:
    known = {**{arm: number for number, arm in enumerate(arms)}, **{str(n): n for n in range(len(arms))}}
    if name not in known:
        raise ConfigError(f"there is no arm {name!r}; give one of {', '.join(known)}")
    return known[name]


def _park(cell: RealCell, arguments: argparse.Namespace) -> None:
    cell.robot.connect()
    cell.park("Step back: the hands open, and the arms go to where they wait.")
    print("the arms are parked")
