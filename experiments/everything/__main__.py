"""``python -m experiments.everything``: every recorded result again, one step after the other.

Each step keeps its episodes in a folder of its own and goes on where it was killed. A finished step whose files of
results are there is left alone, unless ``--again`` names it: then its tables are made again from the episodes kept, or
with ``--afresh`` the episodes too, the former ones put aside. What a step needs and is not there is said, and the step
is passed over; one that fails is said too, and does not keep the others from being made.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from pathlib import Path

from experiments.everything.commands import COMMANDS, CommandStep
from experiments.everything.studies import EXPERIMENTS, STUDIES, StudyStep
from polyfold.errors import PolyfoldError

STEPS = (*STUDIES, *COMMANDS)

BY_HAND = b"<!-- by hand -->"
"""Words below this line of a file of results stay when its tables are made again."""


def main(arguments: list[str] | None = None) -> int:
    """Run the steps that are not finished yet; returns 1 if one of them failed."""
    chosen = _chosen(arguments)
    steps = [step for step in STEPS if chosen.only is None or step.name in chosen.only]
    if chosen.list:
        print("\n".join(_line(step, chosen) for step in steps))
        return 0
    for name in {*chosen.again, *chosen.afresh}:
        _mark(chosen.out, name).unlink(missing_ok=True)
    for name in chosen.afresh:
        _put_aside(chosen.out, name)
    waiting = [step for step in steps if not _finished(step, chosen) and not _passed_over(step, chosen)]
    failed = []
    for number, step in enumerate(waiting, 1):
        left = sum(other.hours for other in waiting[number - 1 :])
        print(f"{step.name} ({number} of {len(waiting)}, about {left:.1f} hours left)", flush=True)
        try:
            _finish(step, chosen)
        except (PolyfoldError, subprocess.CalledProcessError) as error:
            failed.append(step.name)
            print(f"  failed: {error}", file=sys.stderr, flush=True)
    if failed:
        print(f"failed, and to be run again once that is mended: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


def _chosen(arguments: list[str] | None) -> argparse.Namespace:
    names = [step.name for step in STEPS]
    parser = argparse.ArgumentParser(description="Make every recorded result again; resumable.")
    parser.add_argument("--out", type=Path, default=Path("runs/results"), help="default: runs/results")
    parser.add_argument("--into", type=Path, default=EXPERIMENTS / "results", help="where the tables are written")
    parser.add_argument("--workers", type=int, default=2, help="processes of a study (default: 2)")
    parser.add_argument("--data", type=Path, metavar="DIR", help="outlines of real garments (aRTF Clothes)")
    parser.add_argument("--only", nargs="+", choices=names, metavar="STEP", help="only these steps")
    parser.add_argument("--again", nargs="+", choices=names, default=[], metavar="STEP", help="tables made again")
    parser.add_argument("--afresh", nargs="+", choices=names, default=[], metavar="STEP", help="episodes made again")
    parser.add_argument("--accept-change", action="store_true", help="go on with studies begun with other code")
    parser.add_argument("--list", action="store_true", help="print the steps with their hours, and run nothing")
    chosen = parser.parse_args(arguments)
    if chosen.data is not None and not chosen.data.is_dir():
        parser.error(f"--data: there is no folder {chosen.data}; give the one that aRTF Clothes was unpacked into")
    if chosen.only is None and (chosen.again or chosen.afresh):
        chosen.only = [*chosen.again, *chosen.afresh]
    return chosen


def _put_aside(out: Path, name: str) -> None:
    """Rename what a step has kept, so that it begins again and nothing is lost."""
    now = time.strftime("%Y-%m-%d-%H%M%S")
    for kept in [out / name, *out.glob(f"{name}-[0-9]")]:
        if kept.exists():
            kept.rename(kept.with_name(f"{kept.name}.until-{now}"))


def _passed_over(step: StudyStep | CommandStep, chosen: argparse.Namespace) -> bool:
    """Whether something is missing that it needs, which is said."""
    missing = step.lacks(chosen.data) if isinstance(step, CommandStep) else ""
    if missing:
        print(f"{step.name} is passed over: it needs {missing}", flush=True)
    return bool(missing)


def _finish(step: StudyStep | CommandStep, chosen: argparse.Namespace) -> None:
    """Run a step to its end and write its tables; only then is it marked as finished."""
    began = time.monotonic()
    chosen.out.mkdir(parents=True, exist_ok=True)
    chosen.into.mkdir(parents=True, exist_ok=True)
    if isinstance(step, CommandStep):
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


def _finished(step: StudyStep | CommandStep, chosen: argparse.Namespace) -> bool:
    """Whether it has been run to its end, and its file of results is where it is wanted."""
    return _mark(chosen.out, step.name).exists() and (chosen.into / f"{step.name}.md").exists()


def _line(step: StudyStep | CommandStep, chosen: argparse.Namespace) -> str:
    state = "finished" if _finished(step, chosen) else f"about {step.hours:.1f} hours"
    return f"{step.name:12} {state}"


if __name__ == "__main__":
    sys.exit(main())
