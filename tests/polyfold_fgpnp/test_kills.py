"""Killed by SIGKILL: nothing finished is lost, nobody is left behind, and the end is that of an undisturbed run."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import torch
from polyfold_fgpnp.data.collect import collect
from polyfold_fgpnp.data.dataset import load_dataset
from polyfold_fgpnp.data.interaction import Interaction
from polyfold_fgpnp.policies.weights import load_weights
from polyfold_fgpnp.training.config import read_config
from polyfold_fgpnp.training.training import train

INTERACTION = Interaction(seeds=(2000, 2001), edge_length=0.05, mix={"uniform": 1})
FOLDS = 32

TRAINING = """
epochs = 8
batch = 8
[network]
base = 4
levels = 2
"""


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    out = tmp_path_factory.mktemp("undisturbed")
    collect(INTERACTION, FOLDS, out, progress=False)
    return out


def started(*arguments):
    """``polyfold`` in a process group of its own, whose id is the process's."""
    command = [sys.executable, "-m", "polyfold", *map(str, arguments)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    return subprocess.Popen(command, start_new_session=True, env={**os.environ, "OMP_NUM_THREADS": "1"}, **quiet)


def members(group):
    """Living processes of a group, as far as the system has /proc."""
    found = []
    for file in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, its_group = file.read_text().rpartition(")")[2].split()[:3]
        except (OSError, ValueError):
            continue  # it has just ended
        if int(its_group) == group and state not in "ZX":
            found.append(int(file.parent.name))
    return found


def wait_until(reached, seconds=60):
    deadline = time.monotonic() + seconds
    while not reached() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert reached()


def shards(out):
    return {file.name: file.stat().st_mtime_ns for file in out.glob("shards/*.npz")}


def test_a_killed_collection_loses_nothing_and_leaves_nobody_behind(undisturbed, tmp_path):
    out = tmp_path / "folds"
    options = ["--seeds", "2000-2001", "--edge-length", "0.05", "--mix", "uniform=1", "--workers", "2"]
    for kill in (os.killpg, os.kill):
        before = shards(out)
        child = started("collect", "--out", out, "--folds", FOLDS, *options)
        try:
            # The first new shard is the parent's own, so with the second one the workers are at work.
            wait_until(lambda before=before: len(shards(out)) >= len(before) + 2)
            assert child.poll() is None, "it was killed in the middle"
            assert len(members(child.pid)) >= 3 or not Path("/proc/self").exists()
            kill(child.pid, signal.SIGKILL)
            child.wait()
            wait_until(lambda group=child.pid: not members(group))
        finally:
            _end(child)
        assert before.items() <= shards(out).items(), "what was finished is not done again"
    killed = shards(out)
    assert len(killed) < FOLDS // 4
    found = collect(INTERACTION, FOLDS, out, progress=False)
    assert killed.items() <= shards(out).items()
    assert found == load_dataset(undisturbed).description
    assert load_dataset(out).folds == FOLDS


def test_a_killed_training_ends_in_the_very_weights_of_an_undisturbed_one(undisturbed, tmp_path):
    config = tmp_path / "small.toml"
    config.write_text(f'data = ["{undisturbed}"]\n{TRAINING}')
    out, metrics = tmp_path / "killed", tmp_path / "killed" / "metrics.jsonl"
    child = started("train", config, "--out", out, "--device", "cpu")
    try:
        wait_until(lambda: metrics.exists() and metrics.read_bytes().count(b"\n") >= 3)
        child.kill()
        child.wait()
    finally:
        _end(child)
    assert not (out / "weights.safetensors").exists(), "it was killed in the middle"
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        files = [train(read_config(config), folder, "cpu", progress=False) for folder in (out, tmp_path / "whole")]
    finally:
        torch.set_num_threads(threads)
    resumed, whole = (load_weights(file)[0].state_dict() for file in files)
    assert resumed.keys() == whole.keys()
    assert all(torch.equal(resumed[name], whole[name]) for name in whole)
    assert metrics.read_text() == (tmp_path / "whole" / "metrics.jsonl").read_text()


def _end(child):
    """Whatever a failed test has left running."""
    try:
        os.killpg(child.pid, signal.SIGKILL)
    except ProcessLookupError:
        return
    child.wait()
