"""Where a run happened: results differ in their last bits between processors, so the log names them."""

from __future__ import annotations

import os
import platform
from functools import cache
from pathlib import Path

from pydantic import BaseModel, ConfigDict


class HostRecord(BaseModel):
    """The machine of a run.

    Attributes:
        name: of the machine in its network.
        system: operating system and architecture.
        processor: model, with its widest vector instructions where they are known.
        cores: logical processors.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    system: str
    processor: str
    cores: int


def this_host() -> HostRecord:
    """The machine this runs on."""
    return HostRecord(
        name=platform.node(), system=platform.platform(), processor=processor(), cores=os.cpu_count() or 1
    )


@cache
def processor() -> str:
    """Model of the processor, with its widest vector instructions where the system tells them."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    facts = {name.strip(): value.strip() for name, _, value in (line.partition(":") for line in reversed(lines))}
    model = facts.get("model name") or platform.processor() or platform.machine()
    flags = facts.get("flags", "").split()
    widest = next((name for name in ("avx512f", "avx2", "avx", "sse4_2") if name in flags), None)
    return f"{model} ({widest})" if widest else model
