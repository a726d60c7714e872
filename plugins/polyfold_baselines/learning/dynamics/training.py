"""The training of ``vcd``: both its networks at once, and how far off they are on garments held out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np
import torch
from pydantic import Field
from torch import Tensor
from torch.nn import functional

from polyfold_baselines.demos.store import Demos
from polyfold_baselines.learning.dynamics.network import AT_ONCE, VisibleDynamics, evenly
from polyfold_baselines.learning.dynamics.transitions import Transitions, make_transitions
from polyfold_baselines.learning.learner import LearnConfig, Learner, learn

MOST_SIZE = 0.25
"""Cloth and drag are made so much larger or smaller together, since random drags have but three lengths."""


class Row(Protocol):
    """A baseline that is trained so; its agent's class."""

    row: ClassVar[str]

    @classmethod
    def network(cls, config: Mapping[str, Any]) -> VisibleDynamics:
        """The untrained network of what ``fit.json`` says."""
        ...


class DynamicsConfig(LearnConfig):
    """What to learn, from what, for how long; it decides the weights."""

    passes: int = Field(default=200_000, ge=1, description="drags looked at, each as often as it comes")
    learning_rate: float = Field(default=1e-3, gt=0, description="largest, of AdamW")
    weight_decay: float = Field(default=0.01, ge=0, description="of AdamW")
    width: int = Field(default=64, ge=16, description="of a node's features")
    depth: int = Field(default=6, ge=1, description="rounds of messages")


def fit_dynamics(
    config: DynamicsConfig, row: type[Row], out: Path, device: str = "auto", progress: bool = True
) -> Path:
    """Train, or go on with training, and return the path of the weights.

    Args:
        config: what to do.
        row: the baseline.
        out: folder for ``weights.safetensors``, ``checkpoint.safetensors`` and ``metrics.jsonl``.
        device: ``cpu``, ``cuda`` or ``auto``.
        progress: show progress bars.

    Raises:
        ConfigError: if the folder holds another training or is in use, or the demonstrations hold no particles.
    """
    demos = Demos.read(config.demos)
    note = {**config.model_dump(exclude={"demos"}), "demos": demos.hash, "arms": demos.plan.arms}
    return learn(lambda: _Dynamics(config, row, note, demos, device, progress), note, out, progress)


class _Dynamics(Learner):
    """Both networks while they learn."""

    network: VisibleDynamics

    def __init__(
        self, config: DynamicsConfig, row: type[Row], note: Mapping[str, Any], demos: Demos, device: str, progress: bool
    ) -> None:
        super().__init__(row.network(note), config, device)
        self._batch = config.batch
        self._learned, self._held = make_transitions(demos, progress)

    def loss(self, rng: np.random.Generator) -> Tensor:
        """Of drags that are turned, mirrored and resized."""
        chosen = rng.integers(len(self._learned), size=self._batch)
        return self.network.loss(_varied(self._learned.of(chosen, self.device), rng))

    def measure(self) -> dict[str, float]:
        """How far nodes are from where they came to lie, on garments held out, and how well edges are told apart.

        Beside the network's error stand those of saying that nothing moves, and that what is gripped moves alone. The
        accuracy of edges is the mean of that of joined and that of others: 0.5 is what saying the same of all gives.
        """
        self.network.eval()
        with torch.inference_mode():
            parts = np.array_split(np.arange(len(self._held)), math.ceil(len(self._held) / AT_ONCE))
            found = [self._compared(self._held.of(part, self.device)) for part in parts]
        logits, ends, still, gripped, held = (torch.cat(values) for values in zip(*found, strict=True))
        joined = self._held.joined
        said = {"node_error_mm": ends, "nothing_moves_mm": still, "only_gripped_mm": gripped}
        errors = {name: float(1000 * (where - held).norm(dim=-1).mean()) for name, where in said.items()}
        return {**errors, "edge_accuracy": float(evenly(((logits > 0) == joined).float(), joined))}

    def _compared(self, drags: Transitions) -> tuple[Tensor, ...]:
        """Logits of edges, where nodes come to lie by the network, by both simple rules, and in truth."""
        logits, ends = self.network.predicted(drags)
        by = functional.pad(drags.places - drags.picks, (0, 1))[:, None]
        gripped = drags.nodes + self.network.gripped(drags.nodes, drags.picks)[..., None] * by
        return tuple(values.cpu() for values in (logits, ends, drags.nodes, gripped, drags.ends))


def _varied(drags: Transitions, rng: np.random.Generator) -> Transitions:
    """Drags on the table that are turned any way, mirrored and resized, each by its own; heights stay."""
    count, device = len(drags), drags.nodes.device
    turn, size = rng.uniform(0, 2 * np.pi, count), 1 + rng.uniform(-MOST_SIZE, MOST_SIZE, count)
    mirror = rng.choice([-1.0, 1.0], count)
    rows = np.stack([np.cos(turn), np.sin(turn), -mirror * np.sin(turn), mirror * np.cos(turn)], -1)
    by = torch.from_numpy((size[:, None] * rows).reshape(count, 2, 2).astype(np.float32)).to(device)
    moved = {
        name: torch.cat([values[..., :2] @ by, values[..., 2:]], dim=-1)
        for name, values in (("nodes", drags.nodes), ("ends", drags.ends))
    }
    picks, places = ((points[:, None] @ by)[:, 0] for points in (drags.picks, drags.places))
    return replace(drags, **moved, picks=picks, places=places)
