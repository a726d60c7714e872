"""The same half folds in our simulator and in other engines: ``python -m experiments.benchmarks.cloth.engines``.

Needs ``pip install newton mujoco``; an engine that isn't installed is skipped. Times are processor seconds per fold,
loading and compiling left out. Every other engine has the settings of the cloth among its own examples, nobody tuned
them for these folds, while our simulator was developed on such folds: with other settings they may do better.

The grippers hold all layers within 15 mm of the picks and turn them along half an ellipse at the speed at which our
simulator's grippers move. In our simulator they take their own path, which depends on the cloth.

Every fold is kept in ``folds.jsonl`` under ``--out``; what is there already isn't done again.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from experiments.benchmarks.cloth.engines.by_mujoco import drape
from experiments.benchmarks.cloth.engines.by_newton import style3d, vbd
from experiments.benchmarks.cloth.engines.child import in_child
from experiments.benchmarks.cloth.engines.job import Engine, Floats, Job
from experiments.benchmarks.cloth.engines.table import OURS, table
from experiments.benchmarks.cloth.folding import Fold, Script, Trial, mask_of
from experiments.benchmarks.cloth.measures import crossing_edges, strain
from polyfold import plugins
from polyfold.garments import Garment
from polyfold.geometry import iou
from polyfold.types import Action, SimState

SQUARE = Script(
    "half fold of a square",
    "square",
    (Fold(("bottom_left+bottom_right>top_left+top_right",), ("bottom_left", "bottom_right")),),
)
TSHIRT = Script(
    "half fold of a t-shirt",
    "tshirt",
    (Fold(("hem_left+hem_right>shoulder_left+shoulder_right",), ("hem_left", "hem_right")),),
)
FINE, COARSE = 0.0155, 0.03
"""Edge lengths of the meshes [m]: the one of the data for training, and one on which slow engines finish t-shirts."""
FOLDS = ((SQUARE, FINE), (TSHIRT, COARSE), (TSHIRT, FINE))

PATIENCE = 300.0
"""Processor time that an engine may use for one fold [s]. One that gave up isn't asked for that fold again."""


@dataclass(frozen=True)
class Contender:
    """Another engine.

    Attributes:
        name: of the engine and its solver.
        settings: whose its settings are.
        package: what it needs.
        fold: folds with it.
    """

    name: str
    settings: str
    package: str
    fold: Engine


CONTENDERS = (
    Contender("newton SolverStyle3D", "newton's example_cloth_style3d", "newton", style3d),
    Contender("newton SolverVBD", "newton's example_cloth_franka", "newton", vbd),
    Contender("MuJoCo flex, discrete", "MuJoCo's model/flex/drape.xml", "mujoco", drape),
)


def main(arguments: Sequence[str] | None = None) -> None:
    """Fold every garment with every engine that is installed and print the table."""
    parser = argparse.ArgumentParser(
        prog="python -m experiments.benchmarks.cloth.engines",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--out", type=Path, default=Path("runs/engines"), help="folder of the folds (runs/engines)")
    parser.add_argument("--garments", type=int, default=5, help="garments per fold (default 5)")
    parser.add_argument("--seed", type=int, default=0, help="first garment seed (default 0)")
    parser.add_argument("--patience", type=float, default=PATIENCE, help="CPU limit per fold [s] (default 300)")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / "folds.jsonl"
    rows = _read(path)
    contenders = [c for c in CONTENDERS if importlib.util.find_spec(c.package) is not None]
    for missing in sorted({c.package for c in CONTENDERS} - {c.package for c in contenders}):
        print(f"skipped: {missing} isn't installed", file=sys.stderr)
    with path.open("a") as file:
        for row in _measured(rows, contenders, range(options.seed, options.seed + options.garments), options.patience):
            file.write(json.dumps(row) + "\n")
            file.flush()
            rows.append(row)
    names = [name for name, _ in _titles()]
    order = [OURS, *(c.name for c in CONTENDERS)]
    print(table(sorted(rows, key=lambda row: (names.index(row["fold"]), order.index(row["engine"]), row["seed"]))))


def _read(path: Path) -> list[dict[str, Any]]:
    """Rows of a run before; a last line that was cut off is taken out of the file."""
    text = path.read_text() if path.exists() else ""
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        path.write_text(whole)
    return [json.loads(line) for line in whole.splitlines()]


def _titles() -> list[tuple[str, tuple[Script, float]]]:
    return [(f"{script.name}, {1000 * edge:.4g} mm mesh", (script, edge)) for script, edge in FOLDS]


def _measured(
    rows: list[dict[str, Any]], contenders: Sequence[Contender], seeds: Sequence[int], patience: float
) -> Iterator[dict[str, Any]]:
    """Rows that are still missing, the quickest fold first; all engines on a garment before the next garment."""
    known = {(row["fold"], row["engine"], row["seed"]) for row in rows}
    for title, (script, edge) in _titles():
        for seed in seeds:
            missing = [c for c in contenders if (title, c.name, seed) not in known and not _hopeless(rows, title, c)]
            if not missing and (title, OURS, seed) in known:
                continue
            scene = _Scene(script, plugins.generate_garment(script.kind, seed, edge), seed)
            if (title, OURS, seed) not in known:
                started = time.process_time()
                positions = scene.fold()
                seconds = time.process_time() - started
                yield _announced(scene.row(title, OURS, "ours", positions, seconds, "folded"))
            job = Job.of(scene.garment, scene.flat, scene.action, patience)
            for contender in missing:
                positions, seconds, outcome = in_child(contender.fold, job)
                yield _announced(scene.row(title, contender.name, contender.settings, positions, seconds, outcome))


def _hopeless(rows: Sequence[dict[str, Any]], title: str, contender: Contender) -> bool:
    same = [row for row in rows if (row["fold"], row["engine"]) == (title, contender.name)]
    return any(row["outcome"].startswith("gave up") for row in same)


def _announced(row: dict[str, Any]) -> dict[str, Any]:
    took = f"{row['outcome']} ({row['seconds']:.2f} s)"
    print(f"{row['fold']}, seed {row['seed']}: {row['engine']} {took}", file=sys.stderr, flush=True)
    return row


class _Scene:
    """A garment that lies flat, and what is to be done with it."""

    def __init__(self, script: Script, garment: Garment, seed: int) -> None:
        self._simulator = plugins.create("simulators", "xpbd")
        self._simulator.reset(garment, seed)
        self.garment, self.seed = garment, seed
        self.flat: SimState = self._simulator.state()
        self._trial = Trial(script, self.flat)
        self.action: Action = self._trial.act(script.folds[0], self.flat)
        self.fold()  # loads the compiled loop

    def fold(self) -> Floats:
        """Fold with our simulator; positions [m], shape (N, 3)."""
        self._simulator.restore(self.flat)
        self._simulator.execute(self.action)
        return self._simulator.state().positions

    def row(
        self, fold: str, engine: str, settings: str, positions: Floats | None, seconds: float, outcome: str
    ) -> dict[str, Any]:
        """What is kept of a fold; lengths in metres, shares from 0 to 1."""
        mesh, camera = self.garment.mesh, self.flat.camera
        row: dict[str, Any] = {"fold": fold, "engine": engine, "settings": settings, "seed": self.seed}
        row |= {"particles": len(mesh.vertices), "seconds": seconds, "outcome": outcome}
        if positions is None:
            return row
        if not np.isfinite(positions).all() or np.abs(positions).max() > 10:
            return row | {"outcome": "exploded"}
        state = SimState(positions, np.zeros_like(positions), self.flat.keypoints, camera)
        mask = mask_of(camera.to_pixels(positions), mesh.triangles, (camera.height, camera.width))
        return row | {
            "overlap": iou(mask, self._trial.ideal_mask(mesh.triangles)),
            "error": self._trial.flap_error(state)[0],
            "strain": float(np.percentile(np.abs(strain(mesh, positions)), 99)),
            "piercing": crossing_edges(mesh, positions),
        }


if __name__ == "__main__":
    main()
