"""The network in torch, for training: MiniLM reads, a small decoder spells the program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from torch import Tensor, nn
from torch.nn import functional

from polyfold_offline.reading.tokens import MAX_TOKENS, TOKENS

WIDTH, HEADS, DEEP = 384, 12, 6
"""Of MiniLM-L6-H384 (doi:10.48550/arXiv.2002.10957)."""

INNER = 4 * WIDTH
DECODER_LAYERS = 2
NEVER = -1e4


@dataclass(frozen=True, eq=False)
class Batch:
    """Sentences and programs, padded.

    Attributes:
        pieces: word pieces, shape (N, T).
        seen: which of them are none of the padding, shape (N, T).
        tokens: family, then the program's tokens, shape (N, 1 + S).
        allowed: what may stand in each place, shape (N, S, len(TOKENS)).
        counted: which tokens count, shape (N, S).
    """

    pieces: Tensor
    seen: Tensor
    tokens: Tensor
    allowed: Tensor
    counted: Tensor


class Attention(nn.Module):
    """Attention of several heads, with BERT's names of parameters."""

    def __init__(self) -> None:
        super().__init__()
        self.query, self.key, self.value, self.out = (nn.Linear(WIDTH, WIDTH) for _ in range(4))

    def forward(self, x: Tensor, over: Tensor, mask: Tensor | None, causal: bool = False) -> Tensor:
        """Attend from ``x`` (N, S, WIDTH) over ``over`` (N, T, WIDTH); mask (N, 1, 1, T)."""

        def split(y: Tensor) -> Tensor:
            return y.unflatten(-1, (HEADS, -1)).transpose(1, 2)

        query, key, value = split(self.query(x)), split(self.key(over)), split(self.value(over))
        got = functional.scaled_dot_product_attention(query, key, value, attn_mask=mask, is_causal=causal)
        return self.out(got.transpose(1, 2).flatten(2))


class Layer(nn.Module):
    """A layer of a transformer, normalised after each part; with ``across`` it attends to the sentence too."""

    def __init__(self, drop: float, across: bool = False) -> None:
        super().__init__()
        self.attention, self.attended = Attention(), nn.LayerNorm(WIDTH, eps=1e-12)
        self.across = Attention() if across else None
        self.crossed = nn.LayerNorm(WIDTH, eps=1e-12) if across else None
        self.rise, self.fall = nn.Linear(WIDTH, INNER), nn.Linear(INNER, WIDTH)
        self.done = nn.LayerNorm(WIDTH, eps=1e-12)
        self.drop = nn.Dropout(drop)

    def forward(self, x: Tensor, mask: Tensor | None, read: Tensor | None = None) -> Tensor:
        """Shapes as of ``Attention``; ``read``: the sentence's states, which ``mask`` is then about."""
        own = None if read is not None else mask
        x = self.attended(x + self.drop(self.attention(x, x, own, causal=read is not None)))
        if self.across is not None and self.crossed is not None and read is not None:
            x = self.crossed(x + self.drop(self.across(x, read, mask)))
        return self.done(x + self.drop(self.fall(functional.gelu(self.rise(x), approximate="tanh"))))


class ReaderNetwork(nn.Module):
    """Sentence to program."""

    def __init__(self, vocabulary: int, drop: float = 0.1) -> None:
        super().__init__()
        self.words, self.places = nn.Embedding(vocabulary, WIDTH), nn.Embedding(512, WIDTH)
        self.embedded = nn.LayerNorm(WIDTH, eps=1e-12)
        self.encoder = nn.ModuleList(Layer(drop) for _ in range(DEEP))
        self.tokens, self.steps = nn.Embedding(len(TOKENS), WIDTH), nn.Embedding(MAX_TOKENS + 1, WIDTH)
        self.decoder = nn.ModuleList(Layer(drop, across=True) for _ in range(DECODER_LAYERS))
        self.spell = nn.Linear(WIDTH, len(TOKENS))
        self.drop = nn.Dropout(drop)

    def read(self, pieces: Tensor, seen: Tensor) -> tuple[Tensor, Tensor]:
        """States of a sentence (N, T, WIDTH) and the mask of what counts (N, 1, 1, T)."""
        x = self.words(pieces) + self.places.weight[: pieces.shape[1]]
        x, mask = self.drop(self.embedded(x)), seen[:, None, None, :]
        for layer in self.encoder:
            x = layer(x, mask)
        return x, mask

    def forward(self, batch: Batch) -> Tensor:
        """Log probabilities of the program's tokens, shape (N, S, len(TOKENS))."""
        read, mask = self.read(batch.pieces, batch.seen)
        told = batch.tokens[:, :-1]
        x = self.drop(self.tokens(told) + self.steps.weight[: told.shape[1]])
        for layer in self.decoder:
            x = layer(x, mask, read)
        return functional.log_softmax(self.spell(x).masked_fill(~batch.allowed, NEVER), -1)


def load_pretrained(network: ReaderNetwork, weights: Mapping[str, Tensor]) -> None:
    """Begin with BERT's weights of the encoder; the decoder's layers begin as the encoder's last."""
    prefix = "bert." if any(name.startswith("bert.") for name in weights) else ""

    def take(module: nn.Module, name: str) -> None:
        for part in ("weight", "bias"):
            if isinstance(parameter := getattr(module, part, None), nn.Parameter):
                parameter.data.copy_(weights[f"{prefix}{name}.{part}"])

    take(network.words, "embeddings.word_embeddings")
    take(network.places, "embeddings.position_embeddings")
    network.words.weight.data += weights[f"{prefix}embeddings.token_type_embeddings.weight"][0]
    take(network.embedded, "embeddings.LayerNorm")
    last = range(DEEP - DECODER_LAYERS, DEEP)
    for layer, number in [*zip(network.encoder, range(DEEP), strict=True), *zip(network.decoder, last, strict=True)]:
        assert isinstance(layer, Layer)
        base = f"encoder.layer.{number}."
        for attention in (layer.attention, layer.across):
            if attention is not None:
                for part in ("query", "key", "value"):
                    take(getattr(attention, part), f"{base}attention.self.{part}")
                take(attention.out, f"{base}attention.output.dense")
        for norm in (layer.attended, layer.crossed):
            if norm is not None:
                take(norm, f"{base}attention.output.LayerNorm")
        take(layer.rise, f"{base}intermediate.dense")
        take(layer.fall, f"{base}output.dense")
        take(layer.done, f"{base}output.LayerNorm")
