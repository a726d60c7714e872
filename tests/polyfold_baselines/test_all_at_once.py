"""The one command that makes what the rows of ``baselines.toml`` learn from, and trains them."""

from pathlib import Path

import pytest
from polyfold_baselines.learning.command import EVERY

import polyfold
from experiments import baselines
from polyfold.cli import _parser
from polyfold.studies._study import experiment_of

STUDY = Path(baselines.__file__).with_suffix(".toml")


@pytest.mark.parametrize("step", baselines.STEPS, ids=lambda step: step.name)
@pytest.mark.parametrize("cuda", [False, True])
def test_every_step_is_a_command(step, cuda):
    words = [*step.command, *(step.at_large if cuda else ()), "--out", "somewhere"]
    assert _parser(words).parse_args(words)


def test_every_row_that_learns_is_trained_and_every_training_is_a_row():
    study = polyfold.load(STUDY)
    given = [experiment_of(study, variant).agent.params for variant in study.variants]
    paths = {Path(str(value)) for params in given for key, value in params.items() if key in ("weights", "demos")}
    folders = {path.parent.name if path.suffix else path.name for path in paths}
    fitted = {step.name for step in baselines.STEPS if step.command[0] == "fit"}
    assert fitted == folders - {"demos-2arm"}
    assert {step.command[1] for step in baselines.STEPS if step.command[0] == "fit"} == set(EVERY)


def test_what_is_done_is_not_done_again_and_a_failure_is_told(tmp_path, capfd):
    (tmp_path / "bifold.done").write_text("1.0 min\n")
    assert baselines.main(["--out", str(tmp_path), "--only", "bifold"]) == 0
    assert baselines.main(["--out", str(tmp_path), "--only", "bifold", "langdef"]) == 1
    told = capfd.readouterr()
    assert "langdef failed" in told.err
    assert "polyfold demos" in told.err
