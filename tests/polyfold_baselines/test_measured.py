"""What is told of trainings: how long, from what, and their picks beside those that no learning gives."""

import shutil

import pytest
from polyfold_baselines.agents.imitating.foldsformer import Foldsformer2Arm
from polyfold_baselines.demos.store import Demos
from polyfold_baselines.learning.examples import held_out
from polyfold_baselines.learning.fitting import FitConfig, fit

from experiments.benchmarks import baselines


@pytest.fixture(scope="module")
def runs(demonstrated, tmp_path_factory):
    out = tmp_path_factory.mktemp("runs")
    shutil.copytree(demonstrated, out / "demos-2arm")
    config = FitConfig(
        row="foldsformer-2arm", demos=str(out / "demos-2arm"), passes=16, batch=8, width=16, depth=1,
        precision="float32", most_error_mm=40.0,
    )  # fmt: skip
    fit(config, Foldsformer2Arm, out / "foldsformer-2arm", progress=False)
    return out


def test_a_training_stands_beside_a_copy_and_a_random_pixel(runs, capsys, tmp_path):
    assert baselines.main([str(runs), "--picture", str(tmp_path / "curves.png")]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("| ")]
    named = {line.split("|")[1].strip(): [cell.strip() for cell in line.split("|")[2:-1]] for line in lines}
    assert named["`foldsformer-2arm`"][:4] == ["seen tasks, two arms", "3", named["random pixel"][2], "16"]
    assert float(named["`foldsformer-2arm`"][-1]) > 0
    assert (tmp_path / "curves.png").stat().st_size > 5000
    nearest, random = (float(named[row][-1].split()[0]) for row in ("nearest demonstration", "random pixel"))
    assert nearest < random


def test_a_copy_is_never_of_the_same_garment_and_lies_on_the_cloth(runs):
    demos = Demos.read(runs / "demos-2arm")
    picks = baselines.copied(demos)
    assert picks.shape == (held_out(demos).sum(), 2, 2)
    masks = demos.masks[held_out(demos)]
    for found, mask in zip(picks, masks, strict=True):
        columns, rows = found.astype(int).T
        assert mask[rows, columns].all()
