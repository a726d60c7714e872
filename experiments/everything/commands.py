"""The measurements that are commands of their own: what they print is what is recorded."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class CommandStep:
    """A command of ``experiments.benchmarks``, or several whose outputs stand below each other.

    Attributes:
        name: of its file of results.
        hours: of two cores.
        commands: module and arguments of each; ``{out}`` is a folder of its own, ``{data}`` the data of real garments.
        headings: what stands above each output; none if empty.
        needs: packages besides the project's own.
    """

    name: str
    hours: float
    commands: tuple[tuple[str, ...], ...]
    headings: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()

    @property
    def needs_data(self) -> bool:
        """Whether it measures on outlines of real garments."""
        return any("{data}" in command for command in self.commands)

    def lacks(self, data: Path | None) -> str:
        """What it can't run without, in words; empty if nothing."""
        missing = [name for name in self.needs if importlib.util.find_spec(name) is None]
        if missing:
            return f"pip install {' '.join(missing)}"
        return "--data DIR, the outlines of aRTF Clothes" if self.needs_data and data is None else ""

    def run(self, folder: Path, data: Path | None) -> dict[str, bytes]:
        """Run every command; returns the content of its file of results by name."""
        texts = []
        for number, (module, *arguments) in enumerate(self.commands):
            own = folder / f"{self.name}-{number}"
            filled = [argument.format(out=own, data=data) for argument in arguments]
            command = [sys.executable, "-m", f"experiments.benchmarks.{module}", *filled]
            printed = subprocess.run(command, stdout=subprocess.PIPE, text=True, encoding="utf-8", check=True).stdout
            heading = f"{self.headings[number]}\n\n" if self.headings else ""
            texts.append(f"{heading}{printed.strip()}\n")
        return {f"{self.name}.md": "\n".join(texts).encode()}


ONCE = "Garments 600–619, never looked at while anything was tuned:"

COMMANDS = (
    CommandStep(
        "loop",
        0.5,
        (
            ("loop", "--agent", "polyfold", "--agent", "noop", "--n", "20", "--out", "{out}"),
            ("loop", "--agent", "polyfold", "--n", "20", "--first-seed", "600", "--out", "{out}"),
        ),
        headings=("Garments 0–19:", ONCE),
    ),
    CommandStep("physics", 0.4, (("cloth.physics", "--seed", "0", "--folds", "400", "--scaling", "--garments", "10"),)),
    CommandStep("extremes", 0.7, (("cloth.extremes", "--folds", "1000", "--out", "{out}"),)),
    CommandStep("reality", 1.0, (("cloth.reality", "--fabric", "poplin,jersey,denim"),), needs=("ipctk",)),
    CommandStep("engines", 1.0, (("cloth.engines", "--out", "{out}"),), needs=("newton", "mujoco")),
    CommandStep("twins", 0.1, (("twins", "--data", "{data}", "--out", "{out}"),)),
    CommandStep(
        "fitting",
        0.3,
        (
            ("fitting", "--n", "200", "--first-seed", "0"),
            ("fitting", "--folds", "--n", "24", "--first-seed", "0"),
            ("fitting", "--real", "--data", "{data}"),
            ("fitting", "--creases", "--n", "20", "--first-seed", "0"),
        ),
    ),
    CommandStep(
        "segmentation",
        0.3,
        (("segmentation",), ("segmentation", "--data", "{data}", "--first-seed", "2000")),
        headings=("Garments of the package's own kinds:", "Outlines of real t-shirts, towels and shorts:"),
    ),
    CommandStep("cell", 0.3, (("cell.reach", "--robots", "panda"), ("cell.folds",))),
    CommandStep(
        "cell_yumi",
        0.4,
        (("cell.reach", "--robots", "yumi"), ("cell.folds", "--robot", "yumi", "--folds", "100")),
        needs=("rtbdata",),
    ),
    CommandStep("cell_grips", 0.1, (("cell.grips",),)),
    CommandStep("coverage", 0.1, (("coverage",),)),
    CommandStep("tokens", 0.1, (("language.tokens",),)),
    CommandStep("folders", 0.2, (("folders",),)),
    CommandStep("speed", 0.1, (("speed",),)),
    CommandStep("running", 0.2, (("running",),)),
)
"""In the order in which they are run."""
