"""The network in numpy, for use: no torch is needed to read a sentence."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]

HEADS = 12
_NORM = 1e-12
_SLOPE, _BEND = np.float32(np.sqrt(2 / np.pi)), np.float32(0.044715)
"""GELU by a hyperbolic tangent (arXiv:1606.08415), which takes a fifth of the time that the error function does."""


def stored_weights(path: Path) -> dict[str, Floats]:
    """The tensors of a safetensors file by name; matrices may be stored as bytes with a scale for each row."""
    from safetensors.numpy import load_file

    stored = load_file(path)
    scales = {name.removesuffix(".scale"): tensor for name, tensor in stored.items() if name.endswith(".scale")}
    weights = {}
    for name, tensor in stored.items():
        if not name.endswith(".scale"):
            wide = tensor.astype(np.float32)
            weights[name] = wide * scales[name].astype(np.float32)[:, None] if name in scales else wide
    return weights


class Network:
    """MiniLM, and a decoder that spells programs token by token."""

    def __init__(self, weights: Mapping[str, Floats]) -> None:
        """Weights by their names in :class:`polyfold_offline.training.network.ReaderNetwork`."""
        self._weights = weights
        self._layers = {
            part: 1 + max(int(name.split(".")[1]) for name in weights if name.startswith(f"{part}."))
            for part in ("encoder", "decoder")
        }

    @classmethod
    def load(cls, path: Path) -> Network:
        """Read the network of a safetensors file, see :func:`stored_weights`."""
        return cls(stored_weights(path))

    def read(self, pieces: list[int]) -> list[tuple[Floats, Floats]]:
        """A sentence of T word pieces as keys and values (heads, T, width) for each layer of the decoder."""
        w = self._weights
        x = w["words.weight"][pieces] + w["places.weight"][: len(pieces)]
        x = self._norm("embedded", x)
        for number in range(self._layers["encoder"]):
            name = f"encoder.{number}"
            attention = f"{name}.attention"
            got = _attend(*(_heads(self._linear(f"{attention}.{part}", x)) for part in ("query", "key", "value")))
            x = self._rest(name, self._norm(f"{name}.attended", x + self._linear(f"{attention}.out", _joined(got))))
        return [
            (_heads(self._linear(f"decoder.{n}.across.key", x)), _heads(self._linear(f"decoder.{n}.across.value", x)))
            for n in range(self._layers["decoder"])
        ]

    def spell(
        self, sentence: list[tuple[Floats, Floats]], tokens: NDArray[np.int64], past: Past | None
    ) -> tuple[Floats, Past]:
        """Scores of the tokens that may come next, for several programs at once.

        Args:
            sentence: what :meth:`read` gave.
            tokens: the last token of each program, shape (N,).
            past: what came before, of the same programs; None at the beginning.

        Returns:
            Scores, shape (N, tokens), and the past for the next call.
        """
        w = self._weights
        step = 0 if past is None else past[0][0].shape[2]
        x = w["tokens.weight"][tokens] + w["steps.weight"][step]
        now: Past = []
        for number, (keys, values) in enumerate(sentence):
            name = f"decoder.{number}"
            own = [_one(self._linear(f"{name}.attention.{part}", x)) for part in ("query", "key", "value")]
            if past is not None:
                own[1:] = [np.concatenate(both, 2) for both in zip(past[number], own[1:], strict=True)]
            now.append((own[1], own[2]))
            x = self._norm(f"{name}.attended", x + self._linear(f"{name}.attention.out", _flat(_attend(*own))))
            query = _one(self._linear(f"{name}.across.query", x))
            x = self._norm(
                f"{name}.crossed", x + self._linear(f"{name}.across.out", _flat(_attend(query, keys, values)))
            )
            x = self._rest(name, x)
        return self._linear("spell", x), now

    def _rest(self, name: str, x: Floats) -> Floats:
        inner = self._linear(f"{name}.rise", x)
        inner *= 0.5 * (1 + np.tanh(_SLOPE * (inner + _BEND * inner * inner * inner)))
        return self._norm(f"{name}.done", x + self._linear(f"{name}.fall", inner))

    def _linear(self, name: str, x: Floats) -> Floats:
        return x @ self._weights[f"{name}.weight"].T + self._weights[f"{name}.bias"]

    def _norm(self, name: str, x: Floats) -> Floats:
        x = x - x.mean(-1, keepdims=True)
        x /= np.sqrt((x * x).mean(-1, keepdims=True) + _NORM)
        return x * self._weights[f"{name}.weight"] + self._weights[f"{name}.bias"]


Past = list[tuple[Floats, Floats]]
"""Keys and values (N, heads, steps, width) of what was spelled, for each layer of the decoder."""


def _attend(query: Floats, keys: Floats, values: Floats) -> Floats:
    scores = query @ np.swapaxes(keys, -1, -2) / np.float32(np.sqrt(query.shape[-1]))
    scores -= scores.max(-1, keepdims=True)
    np.exp(scores, out=scores)
    return scores / scores.sum(-1, keepdims=True) @ values


def _heads(x: Floats) -> Floats:
    """(T, width) to (heads, T, width / heads)."""
    return np.ascontiguousarray(x.reshape(len(x), HEADS, -1).swapaxes(0, 1))


def _joined(x: Floats) -> Floats:
    return x.swapaxes(0, 1).reshape(x.shape[1], -1)


def _one(x: Floats) -> Floats:
    """(N, width) to (N, heads, 1, width / heads)."""
    return x.reshape(len(x), HEADS, 1, -1)


def _flat(x: Floats) -> Floats:
    return x.reshape(len(x), -1)
