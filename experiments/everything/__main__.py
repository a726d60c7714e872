"""``python -m experiments.everything``: every recorded result again, one step after the other.

Each step keeps its episodes in a folder of its own and goes on where it was killed; a finished step is left alone until
its mark is removed (``--again``). What a step needs and is not there is said, and the step is passed over.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from experiments.everything.commands import COMMANDS, CommandStep
from experiments.everything.studies import EXPERIMENTS, STUDIES, StudyStep

STEPS = (*STUDIES, *COMMANDS)

BY_HAND = b"<!-- by hand -->"
"""Words below this line of a file of results stay when its tables are made again."""


def main(arguments: list[str] | None = None) -> None:
    """Run the steps that are not finished yet."""
    names = [step.name for step in STEPS]
    parser = argparse.ArgumentParser(description="Make every recorded result again; resumable.")
    parser.add_argument("--out", type=Path, default=Path("runs/results"), help="default: runs/results")
    parser.add_argument("--into", type=Path, default=EXPERIMENTS / "results", help="where the tables are written")
    parser.add_argument("--workers", type=int, default=2, help="processes of a study (default: 2)")
    parser.add_argument("--data", type=Path, metavar="DIR", help="outlines of real garments (aRTF Clothes)")
    parser.add_argument("--only", nargs="+", choices=names, metavar="STEP", help="only these steps")
    parser.add_argument("--again", nargs="+", choices=names, default=[], metavar="STEP", help="finished, but once more")
    parser.add_argument("--accept-change", action="store_true", help="go on with studies begun with other code")
    parser.add_argument("--list", action="store_true", help="print the steps with their hours, and run nothing")
    chosen = parser.parse_args(arguments)
    steps = [step for step in STEPS if chosen.only is None or step.name in chosen.only]
    if chosen.list:
        print("\n".join(_line(step, chosen.out) for step in steps))
        return
    for name in chosen.again:
        _mark(chosen.out, name).unlink(missing_ok=True)
    waiting = [step for step in steps if not _mark(chosen.out, step.name).exists()]
    for number, step in enumerate(waiting, 1):
        left = sum(other.hours for other in waiting[number - 1 :])
        print(f"{step.name} ({number} of {len(waiting)}, about {left:.1f} hours left)", flush=True)
        _finish(step, chosen)


def _finish(step: StudyStep | CommandStep, chosen: argparse.Namespace) -> None:
    """Run a step to its end and write its tables; only then is it marked as finished."""
    began = time.monotonic()
    chosen.out.mkdir(parents=True, exist_ok=True)
    chosen.into.mkdir(parents=True, exist_ok=True)
    if isinstance(step, CommandStep):
        missing = step.lacks(chosen.data)
        if missing:
            print(f"  passed over: it needs {missing}", flush=True)
            return
        files = step.run(chosen.out, chosen.data)
    else:
        files = step.run(chosen.out, chosen.workers, chosen.accept_change)
    for name, content in files.items():
        path = chosen.into / name
        path.write_bytes(content + _by_hand(path))
    _mark(chosen.out, step.name).write_text(f"{(time.monotonic() - began) / 3600:.2f} hours\n", encoding="utf-8")


def _by_hand(path: Path) -> bytes:
    """What was written by hand below a table, to stand below the new one too."""
    _, mark, words = path.read_bytes().partition(BY_HAND) if path.exists() else (b"", b"", b"")
    return b"\n" + mark + words if mark else b""


def _mark(out: Path, name: str) -> Path:
    return out / f"{name}.finished"


def _line(step: StudyStep | CommandStep, out: Path) -> str:
    state = "finished" if _mark(out, step.name).exists() else f"about {step.hours:.1f} hours"
    return f"{step.name:12} {state}"


if __name__ == "__main__":
    main()
