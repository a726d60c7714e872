"""Training: the same weights for the same seed wherever it was stopped, and numpy reads what torch learned."""

from __future__ import annotations

import json
from random import Random

import numpy as np
import pytest
import torch
from polyfold_offline.meaning.program import parse_program
from polyfold_offline.reading.network import Network
from polyfold_offline.reading.pieces import Pieces
from polyfold_offline.reading.tokens import INDEX, advance, begin, spell
from polyfold_offline.training.batches import Batches, collate
from polyfold_offline.training.corpus import Example, make_example, read_corpus
from polyfold_offline.training.generator import generate
from polyfold_offline.training.learner import Learner, Schedule
from polyfold_offline.training.learning import begin_with_reader, frequent_words, train
from polyfold_offline.training.network import DEEP, INNER, WIDTH, ReaderNetwork, load_pretrained
from polyfold_offline.training.variation import vary
from polyfold_offline.training.weights import export, reader_weights
from polyfold_offline.weights import FOLDER

from polyfold.cli import main
from polyfold.errors import ConfigError

PLAN = Schedule(steps=4, size=2, every=1)


def encoder(vocabulary: int) -> dict[str, torch.Tensor]:
    """Weights of BERT's shapes, drawn at random."""
    random = torch.Generator().manual_seed(0)

    def drawn(*shape: int) -> torch.Tensor:
        return torch.randn(*shape, generator=random) * 0.05

    told = {
        "embeddings.word_embeddings.weight": drawn(vocabulary, WIDTH),
        "embeddings.position_embeddings.weight": drawn(512, WIDTH),
        "embeddings.token_type_embeddings.weight": drawn(2, WIDTH),
    }
    for name in ["embeddings.LayerNorm"] + [
        f"encoder.layer.{n}.{part}" for n in range(DEEP) for part in ("attention.output.LayerNorm", "output.LayerNorm")
    ]:
        told |= {f"{name}.weight": torch.ones(WIDTH), f"{name}.bias": torch.zeros(WIDTH)}
    for n in range(DEEP):
        for part, out, into in (
            *((f"attention.self.{part}", WIDTH, WIDTH) for part in ("query", "key", "value")),
            ("attention.output.dense", WIDTH, WIDTH), ("intermediate.dense", INNER, WIDTH),
            ("output.dense", WIDTH, INNER),
        ):  # fmt: skip
            told |= {f"encoder.layer.{n}.{part}.weight": drawn(out, into), f"encoder.layer.{n}.{part}.bias": drawn(out)}
    return told


@pytest.fixture(scope="module")
def pieces():
    return Pieces.load(FOLDER)


@pytest.fixture(scope="module")
def examples():
    return generate(40, 0)


def learner(pieces: Pieces, examples: list[Example]) -> Learner:
    batches = Batches(examples, examples, pieces, PLAN.size, PLAN.seed)
    torch.manual_seed(PLAN.seed)
    network = ReaderNetwork(pieces.vocabulary)
    load_pretrained(network, encoder(pieces.vocabulary))
    return Learner(batches, network, PLAN)


@pytest.fixture(scope="module")
def trained(pieces, examples, tmp_path_factory):
    out = tmp_path_factory.mktemp("straight")
    straight = learner(pieces, examples)
    train(straight, PLAN, out)
    return straight


def test_a_training_that_was_stopped_ends_as_one_that_was_not(pieces, examples, trained, tmp_path):
    stopped = learner(pieces, examples)
    for _ in range(2):
        stopped.learn()
    stopped.save(tmp_path / "checkpoint.safetensors")
    resumed = learner(pieces, examples)
    train(resumed, PLAN, tmp_path)
    assert resumed.step == PLAN.steps
    for name, tensor in trained.network.state_dict().items():
        assert torch.equal(tensor, resumed.network.state_dict()[name]), name
    for name, tensor in trained.average.items():
        assert torch.equal(tensor, resumed.average[name]), name


def test_a_flipped_bit_of_a_checkpoint_is_found(pieces, examples, trained, tmp_path):
    trained.save(tmp_path / "checkpoint.safetensors")
    content = bytearray((tmp_path / "checkpoint.safetensors").read_bytes())
    content[-1000] ^= 1
    (tmp_path / "checkpoint.safetensors").write_bytes(bytes(content))
    with pytest.raises(ConfigError, match=r"is damaged.*remove it to learn from the beginning"):
        learner(pieces, examples).resume(tmp_path / "checkpoint.safetensors")


def test_numpy_reads_as_torch_does(pieces, trained, tmp_path):
    export(trained.average, tmp_path / "reader.safetensors", {"steps": "4"})
    assert (tmp_path / "reader.safetensors").stat().st_size < 30e6
    network, copy = Network.load(tmp_path / "reader.safetensors"), trained.network
    copy.load_state_dict(trained.average)
    copy.eval()
    example = Example("square", "top left corner in, then in half", parse_program("centre TL; half any")[0], "")
    ids = pieces.read(example.text, example.family)
    with torch.no_grad():
        batch = collate([(ids, example)])
        batch.allowed.fill_(True)
        wanted = copy(batch)[0].numpy()
    state, sentence, past = begin("square"), network.read(ids), None
    token = INDEX["family square"]
    for row, (following, _) in zip(wanted, spell(example.program, "square"), strict=True):
        raw, past = network.spell(sentence, np.array([token]), past)
        found = raw[0] - np.log(np.exp(raw[0].astype(float)).sum())
        assert np.abs(found - row).max() < 0.1  # bytes instead of floats
        token, state = following, advance(state, following)
    assert state.ended


def test_a_trained_reader_learns_from_sentences_of_ones_own(tmp_path, capsys):
    told = [
        {"garment": "square", "meaning": "centre TL", "text": f"zibble the top left corner in {n} times"}
        for n in range(8)
    ]
    (tmp_path / "mine").mkdir()
    for register in "abcd":
        (tmp_path / "mine" / f"{register}.jsonl").write_text("\n".join(map(json.dumps, told)), "utf-8")
    command = ["train-language", str(tmp_path / "mine"), "--from", str(FOLDER), "--out", str(tmp_path / "out")]
    assert main([*command, "--steps", "1"]) == 0
    assert "reader.safetensors" in capsys.readouterr().out
    words = json.loads((tmp_path / "out" / "words.json").read_text("utf-8"))
    assert words["zibble"] == 32
    assert words.keys() > json.loads((FOLDER / "words.json").read_text("utf-8")).keys()
    assert main([*command, "--steps", "2"]) == 1
    assert "holds a training with another plan; choose another folder" in capsys.readouterr().err
    assert main([*command, "--steps", "1", "--keep", "0.9"]) == 1, "what is kept decides the weights too"
    before, after = reader_weights(FOLDER), reader_weights(tmp_path / "out")
    assert before.keys() == after.keys()
    assert 0 < _largest_change(before, after) < 0.05
    assert main([*command[:-1], str(tmp_path / "same"), "--steps", "1", "--keep", "1"]) == 0
    assert _largest_change(before, reader_weights(tmp_path / "same")) < 1e-6


def _largest_change(before, after):
    return max((after[name] - before[name]).abs().max() for name in before)


def test_what_is_no_trained_reader_is_named(tmp_path):
    with pytest.raises(ConfigError, match=r"reader\.safetensors can't be read"):
        begin_with_reader(tmp_path)
    export({"x": torch.zeros(2, 2)}, tmp_path / "reader.safetensors", {})
    with pytest.raises(ConfigError, match="holds no reader to go on from"):
        begin_with_reader(tmp_path)


def test_a_written_meaning_names_the_lengths_of_its_text():
    example = make_example("square", "4 cm are too little: five centimetres at the top", "strip T 5cm", "x")
    assert example is not None
    assert (example.text, str(example.program[0])) == ("#1 cm are too little: #2 cm at the top", "strip T #2")
    assert make_example("square", "turn in a bit", "strip T 5cm", "x") is None


def test_bad_lines_are_named(tmp_path):
    (tmp_path / "a.jsonl").write_text('{"garment": "square", "meaning": "half L", "text": "x"}\n{"text": 1}\n', "utf-8")
    with pytest.raises(ConfigError, match=r"a\.jsonl, line 2"):
        read_corpus(tmp_path)
    with pytest.raises(ConfigError, match="no sentences"):
        read_corpus(tmp_path / "empty")


def test_variations_can_be_said_and_mean_what_they_say(examples):
    others = {family: [e for e in examples if e.family == family] for family in {e.family for e in examples}}
    random = Random(0)
    for example in examples * 20:
        varied = vary(example, others, random)
        assert spell(varied.program, varied.family)
        assert varied.text


def test_a_mirrored_sentence_means_the_mirrored_folds():
    from polyfold_offline.training.variation import _flip, _mirror

    example = make_example("square", "Left edge over, then the top right corner in", "half L; centre TR", "x")
    assert example is not None
    mirrored = _mirror(example, {}, Random(0))
    assert (mirrored.text, "; ".join(map(str, mirrored.program))) == (
        "Right edge over, then the top left corner in",
        "half R; centre TL",
    )
    flipped = _flip(example, {}, Random(0))
    assert (flipped.text, "; ".join(map(str, flipped.program))) == (
        "Left edge over, then the bottom right corner in",
        "half L; centre BR",
    )


def test_words_of_folding_are_those_of_many_registers():
    said = [
        make_example("square", text, "half L", register) for register in "abcd" for text in ("fold over", "fold it")
    ]
    assert frequent_words([e for e in said if e]) == {"fold": 8}


def test_the_command_says_what_is_missing(tmp_path, capsys):
    (tmp_path / "a.jsonl").write_text(json.dumps({"garment": "square", "meaning": "half L", "text": "over"}), "utf-8")
    command = ["train-language", str(tmp_path), "--out", str(tmp_path / "out")]
    assert main([*command, "--encoder", str(tmp_path / "encoder.safetensors")]) == 1
    assert "encoder.safetensors is missing" in capsys.readouterr().err
    with pytest.raises(SystemExit, match="2"):
        main([*command, "--steps", "0"])
    assert "--steps" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
