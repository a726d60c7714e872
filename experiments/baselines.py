"""``python -m experiments.baselines``: everything that the rows of ``baselines.toml`` learn from, and their training.

Each step is a command that goes on where it was killed; run the same again to go on. With ``--cuda`` the budgets are
twenty times as large.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Step:
    """A command of ``polyfold``.

    Attributes:
        name: of its folder.
        minutes: about, on two cores.
        command: its arguments but for ``--out``; ``{out}`` is the folder of all steps.
        at_large: further arguments with ``--cuda``, which take the place of those before.
    """

    name: str
    minutes: int
    command: tuple[str, ...]
    at_large: tuple[str, ...] = ()


def _demos(name: str, minutes: int, *options: str) -> Step:
    return Step(name, minutes, ("demos", *options), ("--garments", "430"))


def _fit(name: str, minutes: int, demos: str, passes: int, *options: str) -> Step:
    command = ("fit", name, "--demos", f"{{out}}/{demos}", "--passes", str(passes), *options)
    return Step(name, minutes, command, ("--passes", str(20 * passes), "--device", "cuda"))


STEPS = (
    _demos("demos-1arm", 15, "--arms", "1", "--garments", "20", "--workers", "2"),
    _demos("demos-2arm", 15, "--arms", "2", "--garments", "20", "--workers", "2"),
    _demos("drags", 60, "--agent", "random-drags", "--arms", "1", "--garments", "40", "--workers", "2"),
    _fit("bifold", 25, "demos-2arm", 100_000),
    _fit("ltf", 40, "drags", 300_000),
    _fit("vcd", 60, "drags", 200_000),
    _fit("foldsformer", 45, "demos-1arm", 60_000),
    _fit("foldsformer-2arm", 45, "demos-2arm", 60_000),
    _fit("langdef", 30, "demos-1arm", 80_000, "--width", "192"),
    _fit("langdef-2arm", 30, "demos-2arm", 80_000, "--width", "192"),
    _fit("metafold-like", 30, "demos-2arm", 80_000, "--width", "192"),
    Step("ppo", 80, ("fit", "ppo", "--passes", "12000"), ("--passes", "240000", "--device", "cuda")),
)
"""In the order in which they are run."""


def main(arguments: list[str] | None = None) -> int:
    """Run the steps that are not finished; returns 1 if one failed."""
    parser = argparse.ArgumentParser(description="Train the baselines; resumable.")
    parser.add_argument("--out", type=Path, default=Path("runs/baselines"), help="default: runs/baselines")
    names = [step.name for step in STEPS]
    parser.add_argument("--only", nargs="+", choices=names, metavar="STEP", default=names, help="only these steps")
    parser.add_argument("--cuda", action="store_true", help="twenty times the budgets, on a GPU")
    parser.add_argument("--list", action="store_true", help="print the steps with their minutes, and run nothing")
    chosen = parser.parse_args(arguments)
    steps = [step for step in STEPS if step.name in chosen.only]
    if chosen.list:
        print("\n".join(f"{step.name:<18} {step.minutes:>4} min" for step in steps))
        return 0
    failed = [step.name for step in steps if not _run(step, chosen.out, chosen.cuda)]
    return 1 if failed else 0


def _run(step: Step, out: Path, cuda: bool) -> bool:
    """Run one, and note how long it took; one that fails does not keep the others from being run."""
    noted = out / f"{step.name}.done"
    if noted.exists():
        return True
    options = (*step.command, *(step.at_large if cuda else ()))
    filled = [option.format(out=out) for option in options]
    begun = time.monotonic()
    print(f"{step.name} (about {step.minutes} min on two cores)", flush=True)
    command = [sys.executable, "-m", "polyfold", *filled, "--out", str(out / step.name)]
    if subprocess.run(command, check=False).returncode != 0:
        print(f"  {step.name} failed, and is run again by the same command", file=sys.stderr)
        return False
    noted.write_text(f"{(time.monotonic() - begun) / 60:.1f} min\n", "utf-8")
    return True


if __name__ == "__main__":
    sys.exit(main())
