"""Weights of a row as safetensors: with what they were learned from, how long it took, and a hash of all of it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torch import Tensor, nn

from polyfold.errors import ConfigError

SCHEMA = "polyfold-baseline-1"


@dataclass(frozen=True, eq=False)
class Weights:
    """A trained network.

    Attributes:
        network: ready to predict; a row's own class.
        config: what it was learned from and how, ``row``, ``arms`` and the hash of the demonstrations among it.
        minutes: that it took.
        measured: on garments held out.
    """

    network: Any
    config: Mapping[str, Any]
    minutes: float
    measured: Mapping[str, float]


def save(path: Path, weights: Weights) -> None:
    """Write them, whole or not at all."""
    from safetensors.torch import save_file

    tensors = {name: tensor.detach().cpu().contiguous() for name, tensor in _once_each(weights.network).items()}
    told = {"schema": SCHEMA, "config": json.dumps(dict(weights.config)), "minutes": f"{weights.minutes:.1f}"}
    told["measured"] = json.dumps(dict(weights.measured))
    told["hash"] = _hash(tensors, told)
    part = path.with_suffix(".part")
    save_file(tensors, part, told)
    part.chmod(0o644)
    part.replace(path)


def load(path: Path, row: str, build: Callable[[Mapping[str, Any]], nn.Module]) -> Weights:
    """Read the weights of a row.

    Args:
        path: the file.
        row: which baseline's they must be.
        build: makes the network of what they were learned by.

    Raises:
        ConfigError: if there are none, they are damaged, or another row's.
    """
    from safetensors import SafetensorError, safe_open

    if not path.is_file():
        raise ConfigError(f"there are no weights {path}; make them with 'polyfold fit {row}'")
    try:
        with safe_open(path, "pt") as stream:
            told = dict(stream.metadata() or {})
            tensors = {name: stream.get_tensor(name) for name in stream.keys()}  # noqa: SIM118
    except SafetensorError as error:
        raise ConfigError(f"{path} can't be read as safetensors ({error}); make it again") from error
    if told.get("schema") != SCHEMA or told.pop("hash", None) != _hash(tensors, told):
        raise ConfigError(f"{path} is no file of 'polyfold fit', or was changed; make it again")
    config = json.loads(told["config"])
    if config["row"] != row:
        raise ConfigError(f"{path} holds weights of {config['row']}, not of {row}; give others")
    network = build(config)
    if tensors.keys() != _once_each(network).keys():
        raise ConfigError(f"{path} holds weights of another version of {row}; make it again")
    network.load_state_dict(tensors, strict=False)
    return Weights(network.eval(), config, float(told["minutes"]), json.loads(told["measured"]))


def _once_each(network: nn.Module) -> dict[str, Tensor]:
    """A network's tensors; one that several parts share stands under its first name alone."""
    found: dict[int, str] = {}
    state = network.state_dict()
    for name, tensor in state.items():
        found.setdefault(tensor.data_ptr(), name)
    return {name: state[name] for name in found.values()}


def _hash(tensors: Mapping[str, Tensor], told: Mapping[str, str]) -> str:
    whole = hashlib.sha256(json.dumps(dict(told), sort_keys=True).encode())
    for name, tensor in sorted(tensors.items()):
        whole.update(json.dumps([name, str(tensor.dtype), list(tensor.shape)]).encode() + tensor.numpy().tobytes())
    return whole.hexdigest()
