"""Sentences fall into the same word pieces as by Hugging Face's tokenizers, which the reader does without."""

import random
from importlib.resources import files
from pathlib import Path

import pytest
from polyfold_offline.reading.pieces import MAX_PIECES, Pieces

tokenizers = pytest.importorskip("tokenizers")
WEIGHTS = Path(str(files("polyfold_offline") / "weights"))
SENTENCES = Path(__file__).parent
ODD = [
    "", "  ", "Fold it — in ½!", "naïve façade, 3.5cm", "袖を中央へ fold", "über-große Ärmel\tand\ncuffs", "a" * 101,
    "[unused1] of the way, then #2", "don't… “do” that", "½ of 10×20 $5 ~ ^ `x`", "i̇stanbul", "\u200bzero\u00adwidth",
]  # fmt: skip


@pytest.fixture(scope="module")
def both():
    theirs = tokenizers.Tokenizer.from_file(str(WEIGHTS / "pieces.json"))
    theirs.no_padding()
    theirs.no_truncation()
    return Pieces.load(WEIGHTS), theirs


def lines():
    told = [line for file in sorted(SENTENCES.glob("*.toml")) for line in file.read_text("utf-8").splitlines()]
    rng = random.Random(0)
    kinds = [(32, 127), (0xA0, 0x250), (0x3000, 0x9FFF), (0x1F300, 0x1F600), (9, 11)]
    drawn = ["".join(chr(rng.randrange(*rng.choice(kinds))) for _ in range(20)) for _ in range(300)]
    return [*ODD, *told, *drawn]


def test_pieces_are_those_of_the_library(both):
    ours, theirs = both
    assert len(lines()) > 500
    for line in lines():
        assert ours.spell(line) == theirs.encode(line, add_special_tokens=False).ids, line
    assert ours.vocabulary == theirs.get_vocab_size()


def test_the_garment_stands_in_front_and_long_sentences_are_cut(both):
    ours, theirs = both
    assert ours.read("fold it in half", "tshirt") == theirs.encode("shirt", "fold it in half").ids
    assert len(ours.read("fold it in half " * 99, "pants")) == MAX_PIECES
