"""Training of the reader: resumable, with progress, the same weights for the same seed on the same machine."""

from __future__ import annotations

import json
import math
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import torch

from polyfold.errors import ConfigError
from polyfold.logs import exclusive
from polyfold_offline.reading.pieces import Pieces
from polyfold_offline.reading.text import words_of
from polyfold_offline.training.batches import Batches
from polyfold_offline.training.generator import generate
from polyfold_offline.training.network import ReaderNetwork, load_pretrained
from polyfold_offline.weights import FOLDER

if TYPE_CHECKING:
    from polyfold_offline.training.corpus import Example


@dataclass(frozen=True)
class Schedule:
    """How long and how fast to learn.

    Attributes:
        steps: batches.
        size: sentences in a batch.
        rate: learning rate of the encoder.
        decoder_rate: of the decoder, which begins further from its end.
        seed: of the decoder's first weights, of all batches and of dropout.
        every: steps between checkpoints.
    """

    steps: int = 6000
    size: int = 32
    rate: float = 1e-4
    decoder_rate: float = 3e-4
    seed: int = 0
    every: int = 200

    @classmethod
    def going_on(cls, steps: int, seed: int) -> Schedule:
        """For a reader that was trained before: slower, so that it keeps what it knows."""
        return cls(steps=steps, seed=seed, rate=cls.rate / 3, decoder_rate=cls.decoder_rate / 3)


GOING_ON = 1500
"""Steps with which a trained reader learns from more sentences."""


def frequent_words(examples: Sequence[Example], least: int = 6) -> dict[str, int]:
    """Words of folding: those said in at least so many sentences of at least four registers."""
    sentences, registers = Counter[str](), dict[str, set[str]]()
    for example in examples:
        for word in set(words_of(example.text)):
            sentences[word] += 1
            registers.setdefault(word, set()).add(example.register)
    return {w: n for w, n in sorted(sentences.items()) if n >= least and len(registers[w]) >= 4 and len(w) > 2}


class Learner:
    """A network, its optimiser, and the average of its weights over the last steps."""

    def __init__(self, batches: Batches, network: ReaderNetwork, plan: Schedule) -> None:
        self.network = network
        self.network.words.requires_grad_(False)
        self.average = {name: tensor.clone() for name, tensor in self.network.state_dict().items()}
        self._batches, self._plan = batches, plan
        named = dict(self.network.named_parameters())
        given = [p for name, p in named.items() if name.startswith(("places", "embedded", "encoder"))]
        new = [p for name, p in named.items() if name.startswith(("tokens", "steps", "decoder", "spell"))]
        groups = [{"params": given, "rate": plan.rate}, {"params": new, "rate": plan.decoder_rate}]
        self.optimiser = torch.optim.AdamW(groups, lr=plan.rate, weight_decay=0.01, fused=True)
        self._moving = [(name, p) for name, p in named.items() if p.requires_grad]
        self.step = 0

    def learn(self) -> float:
        """Make one step and return its mean loss a token."""
        for group in self.optimiser.param_groups:
            group["lr"] = group["rate"] * _pace(self.step, self._plan.steps)
        torch.manual_seed(self._plan.seed * 1_000_003 + self.step)
        batch = self._batches(self.step)
        self.network.train()
        said = self.network(batch).gather(-1, batch.tokens[:, 1:, None])[..., 0]
        loss = -said[batch.counted].mean()
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), 1.0)
        self.optimiser.step()
        self.step += 1
        keep = min(_AVERAGED, self.step / (self.step + 10))
        with torch.no_grad():
            for name, parameter in self._moving:
                self.average[name].lerp_(parameter, 1 - keep)
        return float(loss.detach())

    def save(self, path: Path) -> None:
        """Write all that training needs to go on."""
        from safetensors.torch import save_file

        told = {f"network.{name}": tensor for name, tensor in self.network.state_dict().items()}
        told |= {f"average.{name}": tensor for name, tensor in self.average.items()}
        for number, state in self.optimiser.state_dict()["state"].items():
            told |= {f"optimiser.{number}.{name}": tensor for name, tensor in state.items()}
        part = path.with_suffix(".part")
        save_file({name: tensor.contiguous() for name, tensor in told.items()}, part, {"step": str(self.step)})
        part.replace(path)

    def resume(self, path: Path) -> None:
        """Go on from a checkpoint, if there is one."""
        from safetensors import SafetensorError, safe_open

        if not path.exists():
            return
        state: dict[int, dict[str, Any]] = {}
        try:
            with safe_open(path, "pt") as file:
                self.step = int(file.metadata()["step"])
                told = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 - it is no dictionary
        except (SafetensorError, KeyError, TypeError, ValueError) as error:
            raise ConfigError(f"{path} is damaged ({error}); remove it to learn from the beginning") from error
        self.network.load_state_dict(_under("network.", told))
        self.average = _under("average.", told)
        for name, tensor in told.items():
            if name.startswith("optimiser."):
                _, number, what = name.split(".", 2)
                state.setdefault(int(number), {})[what] = tensor
        self.optimiser.load_state_dict({"state": state, "param_groups": self.optimiser.state_dict()["param_groups"]})


_AVERAGED = 0.998
"""Share of the average that a step leaves."""


def _under(prefix: str, tensors: Mapping[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    return {name.removeprefix(prefix): tensor for name, tensor in tensors.items() if name.startswith(prefix)}


def _pace(step: int, steps: int) -> float:
    """The share of the learning rate: up in the first part, then down along a cosine."""
    rise = max(1, steps // 25)
    if step < rise:
        return (step + 1) / rise
    return 0.02 + 0.98 * 0.5 * (1 + math.cos(math.pi * (step - rise) / max(1, steps - rise)))


def train(learner: Learner, plan: Schedule, out: Path) -> None:
    """Learn to the end, with a checkpoint and a line in ``log.jsonl`` every so many steps."""
    from tqdm import tqdm

    checkpoint = out / "checkpoint.safetensors"
    learner.resume(checkpoint)
    losses, began = [], time.monotonic()
    with tqdm(total=plan.steps, initial=learner.step, unit="step", desc="reading") as bar:
        while learner.step < plan.steps:
            losses.append(learner.learn())
            bar.update()
            if learner.step % plan.every == 0 or learner.step == plan.steps:
                learner.save(checkpoint)
                mean = sum(losses) / len(losses)
                spent = round(time.monotonic() - began, 1)
                with (out / "log.jsonl").open("a", encoding="utf-8") as log:
                    log.write(json.dumps({"step": learner.step, "loss": round(mean, 4), "seconds": spent}) + "\n")
                bar.set_postfix(loss=f"{mean:.3f}")
                losses, began = [], time.monotonic()


_MADE = 20_000
"""Sentences of the generator, those that a task suite asks with left out."""


def wordings_of_suites() -> set[str]:
    """What the installed suites say, in plain words: nothing is learned from what measures it."""
    from polyfold import plugins
    from polyfold.evaluation import suite

    suites = [suite(name) for name in plugins.names("tasks")]
    said = [text for found in suites for task in found.tasks for text in task.instructions]
    said += [goal.text for found in suites for goal in found.goals]
    return {plain_words(text) for text in said}


def plain_words(text: str) -> str:
    """A sentence in small letters, without its signs."""
    return " ".join(words_of(text))


@dataclass(frozen=True)
class Beginning:
    """Where training begins: a network, and the words of folding that it was taught with."""

    network: ReaderNetwork
    words: Mapping[str, int] = field(default_factory=dict)


def begin_with_encoder(path: Path | None, seed: int) -> Beginning:
    """A decoder that knows nothing yet, on MiniLM-L6.

    Args:
        path: MiniLM-L6's weights; None for those of the installed package.
        seed: of the decoder's weights.
    """
    from polyfold_offline.training.weights import pretrained_encoder

    tensors = pretrained_encoder(path)
    torch.manual_seed(seed)
    network = ReaderNetwork(Pieces.load(FOLDER).vocabulary)
    load_pretrained(network, tensors)
    return Beginning(network)


def begin_with_reader(folder: Path) -> Beginning:
    """A reader that was trained before, to go on with.

    Raises:
        ConfigError: if the folder holds none.
    """
    from polyfold_offline.training.weights import reader_weights

    network = ReaderNetwork(Pieces.load(FOLDER).vocabulary)
    try:
        network.load_state_dict(reader_weights(folder))
        words = json.loads((folder / "words.json").read_text(encoding="utf-8"))
        return Beginning(network, {str(word): int(count) for word, count in words.items()})
    except (RuntimeError, OSError, ValueError, TypeError, AttributeError) as error:
        raise ConfigError(f"{folder} holds no reader to go on from: {str(error).splitlines()[0]}") from error


def train_reader(examples: Sequence[Example], out: Path, beginning: Beginning, plan: Schedule) -> Path:
    """Train a reader on written sentences; what it needs to read stands in ``out`` then.

    Args:
        examples: sentences with their meanings, see :func:`polyfold_offline.training.corpus.read_corpus`.
        out: folder for ``reader.safetensors``, ``pieces.json``, ``words.json``, the log and the checkpoint.
        beginning: the network to train.
        plan: how long and how fast to learn.

    Returns:
        The file of the weights.
    """
    with exclusive(out):
        return _trained(examples, beginning, out, plan)


def _trained(examples: Sequence[Example], beginning: Beginning, out: Path, plan: Schedule) -> Path:
    from polyfold_offline.training.weights import export

    words = dict(sorted({**frequent_words(examples), **beginning.words}.items()))
    (out / "words.json").write_text(json.dumps(words, ensure_ascii=False), encoding="utf-8")
    (out / "pieces.json").write_bytes((FOLDER / "pieces.json").read_bytes())
    pieces = Pieces.load(out)
    tested = wordings_of_suites()
    made = [example for example in generate(_MADE, plan.seed) if plain_words(example.text) not in tested]
    batches = Batches(examples, made, pieces, plan.size, plan.seed)
    learner = Learner(batches, beginning.network, plan)
    train(learner, plan, out)
    export(learner.average, out / "reader.safetensors", {"sentences": str(len(examples)), "steps": str(plan.steps)})
    return out / "reader.safetensors"
