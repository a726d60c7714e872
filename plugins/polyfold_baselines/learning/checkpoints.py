"""A folder that belongs to one training, and where that has come to: tensors with plain data beside them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from polyfold.errors import ConfigError
from polyfold.logs import exclusive

_TOLD = "told"


@contextmanager
def training_in(out: Path, note: Mapping[str, Any]) -> Iterator[None]:
    """Have a folder to oneself for the training that ``fit.json`` says.

    Raises:
        ConfigError: if it holds another one, or is in use.
    """
    said = json.dumps(dict(note), indent=2)
    out.mkdir(parents=True, exist_ok=True)
    with exclusive(out):
        held = out / "fit.json"
        if held.exists() and _told(held) != json.loads(said):
            raise ConfigError(f"{out} holds another training; choose another folder")
        held.write_text(said, encoding="utf-8")
        yield


def _told(held: Path) -> Any:
    """What ``fit.json`` says, whatever the order; None if it was cut off."""
    try:
        return json.loads(held.read_text(encoding="utf-8"))
    except ValueError:
        return None


def write(path: Path, tensors: Mapping[str, Tensor], told: Mapping[str, Any]) -> None:
    """Write a checkpoint, whole or not at all."""
    from safetensors.torch import save_file

    stored = {name: tensor.detach().cpu().contiguous().clone() for name, tensor in tensors.items()}
    stored[_TOLD] = torch.tensor(list(json.dumps(dict(told)).encode()), dtype=torch.uint8)
    part = path.with_suffix(".part")
    save_file(stored, part)
    part.replace(path)


def read(path: Path) -> tuple[dict[str, Tensor], dict[str, Any]] | None:
    """The tensors and plain data of a checkpoint; None where there is none."""
    from safetensors.torch import load_file

    if not path.exists():
        return None
    stored = load_file(path)
    return stored, json.loads(bytes(stored.pop(_TOLD).numpy()).decode())
