"""``make results``: what is missing is made, what can't be is said, and nothing that was kept is lost."""

import pytest

import polyfold
from experiments.everything import __main__ as command
from experiments.everything.commands import CommandStep
from experiments.everything.studies import StudyStep, _table


class OneTask(StudyStep):
    def study(self):
        return polyfold.Study(name=self.name, tasks=("square-corner-top_left",), edge_length=0.03)


SMOKE = OneTask("smoke", 0.01, _table)
BROKEN = CommandStep("broken", 0.01, (("no_such_benchmark",),))
REAL = CommandStep("real", 0.01, (("coverage", "--data", "{data}"),))


@pytest.fixture
def results(monkeypatch, tmp_path, capfd):
    """Runs the command on three steps; returns its status and what it printed."""
    monkeypatch.setattr(command, "STEPS", (BROKEN, REAL, SMOKE))

    def run(*arguments, into="results"):
        status = command.main(
            ["--out", str(tmp_path / "kept"), "--into", str(tmp_path / into), "--workers", "1", *arguments]
        )
        return status, "".join(capfd.readouterr())

    return run


def test_a_step_that_fails_or_lacks_something_is_said_and_the_others_are_made(results, tmp_path):
    status, said = results()
    assert status == 1
    assert "failed, and to be run again once that is mended: broken" in said
    assert "real is passed over: it needs --data" in said
    assert "smoke" in (tmp_path / "results" / "smoke.md").read_text()
    assert "Traceback" not in said
    status, said = results("--list")
    assert status == 0
    assert "smoke        finished" in said
    assert "about 0.0 hours" in said

    results("--only", "smoke", into="elsewhere")
    assert (tmp_path / "elsewhere" / "smoke.md").exists(), "finished is what stands where it is wanted"

    episodes = tmp_path / "kept" / "smoke" / "episodes.jsonl"
    before = episodes.read_text()
    results("--again", "smoke")
    assert episodes.read_text() == before
    results("--afresh", "smoke")
    assert len(list((tmp_path / "kept").glob("smoke.until-*"))) == 1


def test_a_folder_of_data_that_is_not_there_is_refused_at_once(results, capfd):
    with pytest.raises(SystemExit):
        results("--data", "nowhere")
    assert "there is no folder nowhere" in capfd.readouterr().err
