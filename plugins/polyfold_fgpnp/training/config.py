"""What to train, from what and how."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from polyfold.config import read_toml
from polyfold.errors import ConfigError, validation_problem
from polyfold_fgpnp.policies.networks import NetworkConfig


class TrainingConfig(BaseModel):
    """What to train, from what and how; read from TOML.

    Snapshots are the weights after some epochs, for learning curves. They come from one training whose learning rate
    falls along a cosine, so early ones are noisier than the end of a training of that length. They change nothing else:
    neither the final weights, nor what these say they were trained from, nor which folder a training belongs to.
    A training that is gone on with has no snapshots of epochs that were over before they were asked for.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    data: tuple[str, ...] = Field(min_length=1, description="data sets of `polyfold collect`")
    network: NetworkConfig = NetworkConfig()
    folds: int | None = Field(default=None, ge=1, description="use the first so many folds of each data set")
    reward: Literal["contour", "particles", "both"] = Field(default="particles", description="what counts as good")
    scale: Literal["linear", "log"] = Field(default="log", description="how rewards become labels")
    state_weight: float = Field(
        default=1.0, ge=0, description="weight of the error that all picks of a state share; 1: MSE"
    )
    epochs: int = Field(default=60, ge=1, description="passes over all states")
    snapshots: tuple[int, ...] = Field(default=(), description="epochs after which the weights so far are kept as well")
    batch: int = Field(default=32, ge=1, description="states in a step")
    learning_rate: float = Field(default=2e-3, gt=0, description="largest, of AdamW")
    weight_decay: float = Field(default=1e-2, ge=0, description="of AdamW")
    held_out: float = Field(default=0.1, gt=0, lt=1, description="share of the garments kept for validation")
    precision: Literal["float32", "bfloat16"] = Field(default="float32", description="of the convolutions in training")
    seed: int = Field(default=0, ge=0, description="of weights, order and augmentation")

    @model_validator(mode="after")
    def _snapshots_are_epochs(self) -> TrainingConfig:
        for epoch in self.snapshots:
            if not 1 <= epoch <= self.epochs:
                raise ValueError(f"snapshots has {epoch}, and epochs go from 1 to {self.epochs}")
        return self

    def plain(self) -> dict[str, Any]:
        """What decides the weights, as plain data."""
        return self.model_dump(mode="json", exclude={"snapshots"})


def read_config(path: str | Path, **changes: object) -> TrainingConfig:
    """A training configuration from TOML, with some values replaced where they are not None.

    With other ``epochs`` the snapshots are those of the file that fall within them.

    Raises:
        ConfigError: naming the field that is wrong.
    """
    content = {**read_toml(path), **{name: value for name, value in changes.items() if value is not None}}
    if changes.get("epochs") is not None and isinstance(content.get("snapshots"), list):
        content["snapshots"] = [epoch for epoch in content["snapshots"] if epoch <= content["epochs"]]
    try:
        return TrainingConfig(**content)
    except ValidationError as error:
        raise ConfigError(f"{path} {validation_problem(error, TrainingConfig.model_fields)}") from error
