"""Weights on disk: safetensors with what they were trained from, under one hash that loading checks."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polyfold.errors import ConfigError

if TYPE_CHECKING:
    from torch import Tensor

    from polyfold_fgpnp.policies.networks import ValueNetwork


SCHEMA = "2"


@dataclass(frozen=True)
class Provenance:
    """Where weights come from.

    Attributes:
        config: the training configuration, plain data; ``config["network"]`` is the network's.
        data: hashes of the data sets they were trained from.
        mean, deviation: of the labels; the network's values are labels standardised by them.
        folds: how many of the data's folds taught it, those held out for validation apart; 0 if that was not recorded.
    """

    config: Mapping[str, Any]
    data: tuple[str, ...]
    mean: float
    deviation: float
    folds: int = 0

    @property
    def config_hash(self) -> str:
        """SHA-256 of the configuration."""
        return hashlib.sha256(json.dumps(self.config, sort_keys=True).encode()).hexdigest()


def shipped_weights() -> dict[str, Path]:
    """The weights that come with the package, name -> file."""
    found = (Path(__file__).parents[1] / "weights").glob("*.safetensors")
    return {file.stem: file for file in sorted(found, key=lambda file: file.stem)}


def weights_file(name: str) -> Path:
    """The file of the weights with a name: one that comes with the package, or else a path.

    Raises:
        ConfigError: if it is neither.
    """
    shipped = shipped_weights()
    file = shipped.get(name, Path(name))
    if not file.is_file():
        raise ConfigError(
            f"there are no weights {name!r}: it is no file, and with the package come {', '.join(shipped) or 'none'}; "
            "give one of these, or train your own with: polyfold train CONFIG.toml --out DIR"
        )
    return file


def file_hash(file: Path) -> str:
    """SHA-256 of a file of weights, by which data and results that came from it are told apart."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def save_weights(path: str | Path, network: ValueNetwork, provenance: Provenance) -> None:
    """Write a network's weights with their provenance, whole or not at all."""
    from safetensors.torch import save_file

    tensors = {name: tensor.detach().cpu().contiguous() for name, tensor in network.state_dict().items()}
    metadata = {
        "schema": SCHEMA,
        "config": json.dumps(provenance.config, sort_keys=True),
        "config_hash": provenance.config_hash,
        "data": json.dumps(provenance.data),
        "labels": json.dumps([provenance.mean, provenance.deviation]),
        "folds": str(provenance.folds),
    }
    metadata["hash"] = _hash(tensors, metadata)
    part = Path(path).with_suffix(".part")
    save_file(tensors, part, metadata)
    part.chmod(0o644)
    part.replace(path)


def load_weights(path: str | Path, *variants: str) -> tuple[ValueNetwork, Provenance]:
    """Read a network, ready to predict, and where it comes from.

    Args:
        path: a file of :func:`save_weights`.
        variants: one of which the network must be; any if none is given.

    Raises:
        ConfigError: if there is no such file, it is no such file, its hash does not match, or it is another variant.
    """
    from safetensors import SafetensorError, safe_open

    try:
        from torch import channels_last
    except ModuleNotFoundError as error:
        raise ConfigError("networks that value picks need torch; pip install 'polyfold[torch]'") from error
    from polyfold_fgpnp.policies.networks import NetworkConfig, ValueNetwork

    if not Path(path).exists():
        raise ConfigError(f"there are no weights {path}; train some with `polyfold train`, or give another path")
    try:
        with safe_open(path, "pt") as stream:
            metadata = stream.metadata() or {}
            tensors = {name: stream.get_tensor(name) for name in stream.keys()}  # noqa: SIM118
    except SafetensorError as error:
        raise ConfigError(f"{path} can't be read as safetensors ({error}); train or install it again") from error
    if metadata.get("schema") != SCHEMA:
        raise ConfigError(
            f"{path} was not written by `polyfold train`, or by another version; run the same training again, "
            "which takes what is finished from its checkpoint"
        )
    if metadata.pop("hash", None) != _hash(tensors, metadata):
        raise ConfigError(
            f"{path} does not match its own hash: it is damaged or was changed; train or install it again"
        )
    mean, deviation = json.loads(metadata["labels"])
    config, data = json.loads(metadata["config"]), tuple(json.loads(metadata["data"]))
    found = Provenance(config, data, mean, deviation, int(metadata.get("folds", 0)))
    shape = NetworkConfig(**found.config["network"])
    if variants and shape.variant not in variants:
        raise ConfigError(f"{path} holds weights for {shape.variant}, not for {' or '.join(variants)}; give others")
    network = ValueNetwork(shape)
    network.load_state_dict(tensors)
    return network.eval().to(memory_format=channels_last), found  # pyright: ignore[reportCallIssue]  (no stub for it)


def _hash(tensors: Mapping[str, Tensor], metadata: Mapping[str, str]) -> str:
    """SHA-256 of all that a file says: names, types, shapes and values of its tensors, and its metadata."""
    whole = hashlib.sha256(json.dumps(metadata, sort_keys=True).encode())
    for name, tensor in sorted(tensors.items()):
        whole.update(json.dumps([name, str(tensor.dtype), list(tensor.shape)]).encode() + tensor.numpy().tobytes())
    return whole.hexdigest()
