"""Training by trying: proximal policy optimisation on the seen tasks, with checkpoints."""

from __future__ import annotations

import time
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import torch
from pydantic import BaseModel, ConfigDict, Field
from torch import Tensor

from polyfold.errors import ConfigError
from polyfold.evaluation import suite
from polyfold.logs import JsonLines
from polyfold.tasks import Task
from polyfold_baselines.learning import checkpoints
from polyfold_baselines.learning.checkpoints import training_in
from polyfold_baselines.learning.weights import Weights, save


class TryConfig(BaseModel):
    """What to try, for how long; it decides the weights."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    row: str = Field(description="which baseline")
    passes: int = Field(default=20_000, ge=1, description="folds tried")
    seeds: tuple[int, int] = Field(default=(1000, 1019), description="first and last garment seed")
    edge_length: float = Field(default=0.022, gt=0.005, le=0.05, description="of the meshes [m]")
    round: int = Field(default=512, ge=8, description="folds between two changes of the policy")
    batch: int = Field(default=64, ge=2, description="folds in a step of the optimiser")
    epochs: int = Field(default=8, ge=1, description="times that a round's folds are learned from")
    learning_rate: float = Field(default=3e-4, gt=0, description="of Adam")
    log_std: float = Field(default=-1.0, description="logarithm of the first standard deviation of actions")
    seed: int = Field(default=0, ge=0, description="of weights and of what is tried")


def policy_of(config: Mapping[str, Any]) -> Any:
    """The untrained policy of what ``fit.json`` says: pictures by convolutions, particles beside them."""
    from stable_baselines3.ppo import MultiInputPolicy

    from polyfold_baselines.learning.trying.environment import ACTIONS, OBSERVATIONS

    return MultiInputPolicy(OBSERVATIONS, ACTIONS, lambda _: config["learning_rate"], **_shape(config["log_std"]))


def reinforce(config: TryConfig, out: Path, device: str = "auto", progress: bool = True) -> Path:
    """Train, or go on with training, and return the path of the weights.

    Args:
        config: what to do.
        out: folder for ``weights.safetensors``, ``checkpoint.safetensors`` and ``metrics.jsonl``.
        device: ``cpu``, ``cuda`` or ``auto``.
        progress: show a progress bar.

    Raises:
        ConfigError: if the folder holds another training or is in use, or stable-baselines3 is not installed.
    """
    if find_spec("stable_baselines3") is None:
        raise ConfigError("learning by trying needs stable-baselines3; pip install 'polyfold[baselines]'")
    note = {**config.model_dump(), "arms": 2}
    with training_in(out, note):
        minutes, last, policy = _tried(config, out, device, progress)
        save(out / "weights.safetensors", Weights(policy, note, minutes, last))
    return out / "weights.safetensors"


def _tried(config: TryConfig, out: Path, device: str, progress: bool) -> tuple[float, dict[str, float], Any]:
    from tqdm.auto import tqdm

    model, env = _model(config, device)
    checkpoint, metrics = out / "checkpoint.safetensors", JsonLines(out / "metrics.jsonl")
    done, minutes, last = _resumed(model, checkpoint)
    try:
        with tqdm(total=config.passes, initial=done, unit="fold", disable=not progress) as bar:
            while done < config.passes:
                begun = time.monotonic()
                model.learn(config.round, reset_num_timesteps=False)
                rewards = [float(episode["r"]) for episode in model.ep_info_buffer or ()]
                done += config.round
                minutes += (time.monotonic() - begun) / 60
                last = {"reward": sum(rewards) / max(1, len(rewards))}
                metrics.append({"passes": done, "minutes": round(minutes, 2), **last})
                _save(model, checkpoint, {"done": done, "minutes": minutes, "last": last})
                bar.update(config.round)
                bar.set_postfix({"reward": f"{last['reward']:.2f}"}, refresh=False)
    finally:
        env.close()
    return minutes, last, model.policy


def _model(config: TryConfig, device: str) -> tuple[Any, Any]:
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor

    from polyfold_baselines.learning.trying.environment import FoldingTasks

    tasks = [entry for entry in suite("polyfold70").tasks if isinstance(entry, Task) and entry.split == "seen"]
    env = VecMonitor(DummyVecEnv([lambda: FoldingTasks(tasks, config.seeds, config.edge_length, config.seed)]))
    model = PPO(
        "MultiInputPolicy", env, config.learning_rate, n_steps=config.round, batch_size=config.batch,
        n_epochs=config.epochs, gamma=0.9, seed=config.seed, device=device, policy_kwargs=_shape(config.log_std),
    )  # fmt: skip
    return model, env


def _shape(log_std: float) -> dict[str, Any]:
    return {"log_std_init": log_std, "normalize_images": False}


def _resumed(model: Any, path: Path) -> tuple[int, float, dict[str, float]]:
    """Folds done, minutes and the last measure of a checkpoint, which the model goes on from; nothing without one."""
    if (found := checkpoints.read(path)) is None:
        return 0, 0.0, {}
    stored, told = found
    model.policy.load_state_dict({name[2:]: value for name, value in stored.items() if name.startswith("n/")})
    optimiser = model.policy.optimizer.state_dict()
    optimiser["state"] = {}
    for name, value in stored.items():
        if name.startswith("o/"):
            _, index, key = name.split("/")
            optimiser["state"].setdefault(int(index), {})[key] = value
    model.policy.optimizer.load_state_dict(optimiser)
    return told["done"], told["minutes"], told["last"]


def _save(model: Any, path: Path, told: Mapping[str, Any]) -> None:
    tensors: dict[str, Tensor] = {f"n/{name}": value for name, value in model.policy.state_dict().items()}
    for index, state in model.policy.optimizer.state_dict()["state"].items():
        tensors |= {f"o/{index}/{key}": torch.as_tensor(value) for key, value in state.items()}
    checkpoints.write(path, tensors, told)
