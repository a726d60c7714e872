"""Engines run in processes of their own, so that none disturbs another or takes it down."""

from __future__ import annotations

import contextlib
import multiprocessing
import sys
from typing import Any

from experiments.benchmarks.cloth.engines.job import Engine, Floats, GaveUpError, Job

WAIT = 3600.0
"""An engine that hangs is stopped after this [s]."""


def in_child(fold: Engine, job: Job) -> tuple[Floats | None, float, str]:
    """Run an engine in a process of its own, so that none disturbs another; its positions, time [s] and outcome."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_send, args=(sender, fold, job), daemon=True)
    child.start()
    sender.close()
    try:
        if receiver.poll(WAIT):
            return receiver.recv()
        return None, job.limit, f"gave up after {WAIT:.0f} s of waiting"
    except EOFError:
        return None, 0.0, "crashed"
    finally:
        child.kill()
        child.join()


def _send(sender: Any, fold: Engine, job: Job) -> None:
    # Engines announce themselves; the table is what should be printed.
    with contextlib.redirect_stdout(sys.stderr):
        try:
            sender.send((*fold(job), "folded"))
        except GaveUpError:
            sender.send((None, job.limit, f"gave up after {job.limit:.0f} s"))
