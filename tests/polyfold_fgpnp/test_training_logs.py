"""Metrics that were damaged between two runs of a training: what can be read is kept, and what is gone is said."""

import json
import warnings

import pytest
from polyfold_fgpnp.training.logs import Logs


@pytest.fixture
def file(tmp_path):
    with Logs(tmp_path, 0) as logs:
        for epoch in range(1, 6):
            logs.write(epoch, {"loss": 1 / epoch})
    return tmp_path / "metrics.jsonl"


def epochs(file):
    return [json.loads(line)["epoch"] for line in file.read_text("utf-8").splitlines()]


def test_epochs_after_the_checkpoint_and_those_that_stand_twice_are_dropped_in_silence(file):
    file.write_text(2 * file.read_text("utf-8"), "utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Logs(file.parent, 3)
    assert epochs(file) == [1, 2, 3]


@pytest.mark.parametrize("foreign", [b"what is this?", b"\xff", b'{"epoch": "two"}', b"[]"])
def test_a_damaged_line_is_set_aside_and_its_epoch_named(file, foreign):
    lines = file.read_bytes().splitlines()
    file.write_bytes(b"\n".join([lines[0], foreign, *lines[2:]]) + b"\n")
    with pytest.warns(UserWarning, match="lacks epoch 2"), pytest.warns(UserWarning, match="set aside"):
        Logs(file.parent, 5)
    assert epochs(file) == [1, 3, 4, 5]
    assert foreign in (file.parent / "metrics.damaged.jsonl").read_bytes()


def test_metrics_that_are_gone_are_missed(file):
    file.unlink()
    with pytest.warns(UserWarning, match="lacks epoch 1, 2;"):
        Logs(file.parent, 2)
