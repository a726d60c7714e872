"""Runs that go on after something changed: what they depend on is compared, and a difference is refused or recorded."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import polyfold
from polyfold import plugins
from polyfold.cli import main
from polyfold.errors import ConfigError
from polyfold.evaluation import suite
from polyfold.evaluation._references import reference_for
from polyfold.logs import read_run

PROMPTS = Path(__file__).parents[2] / "prompts"

MODULE = '''
from polyfold_fgpnp.policies.geometric import AffordancePair
from polyfold import hookimpl


class Shifted(AffordancePair):
    """Picks as affordance-pair does, version {version}."""


@hookimpl
def register_policies(register):
    register("shifted", "my_plugin.policy:Shifted", "as affordance-pair")


@hookimpl
def register_prompts(register):
    register("mine", "my_plugin:prompts")
'''


class MyPlugin:
    """A third-party plugin in a folder, as pip would have installed it."""

    def __init__(self, folder):
        self.folder = folder
        self.package = folder / "my_plugin"
        (self.package / "prompts" / "subgoals").mkdir(parents=True)
        (self.package / "__init__.py").write_text("")
        self.prompt = self.package / "prompts" / "subgoals" / "mine.md"
        text = (PROMPTS / "subgoals" / "v2.md").read_text("utf-8")
        self.prompt.write_text(text.replace("version: v2", "version: mine", 1))
        for examples in (PROMPTS / "subgoals").glob("v2.*.jsonl"):
            shutil.copy(examples, self.prompt.parent)
        self.install("0.1.0")

    def install(self, version):
        (self.package / "policy.py").write_text(MODULE.format(version=version))
        for old in self.folder.glob("*.dist-info"):
            shutil.rmtree(old)
        described = self.folder / f"my_plugin-{version}.dist-info"
        described.mkdir()
        (described / "METADATA").write_text(f"Metadata-Version: 2.1\nName: my-plugin\nVersion: {version}\n")
        (described / "entry_points.txt").write_text("[polyfold]\nmy-plugin = my_plugin.policy\n")
        plugins.refresh()


@pytest.fixture
def my_plugin(tmp_path, monkeypatch):
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path / "cache"))
    forget_modules()
    yield MyPlugin(folder)
    monkeypatch.undo()
    forget_modules()
    plugins.refresh()


def forget_modules():
    """Each test installs the plugin into a folder of its own."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "my_plugin"]:
        del sys.modules[name]


@pytest.fixture
def study():
    return polyfold.Study(
        name="changing",
        tasks=("square-corner-top_left", "square-corner-top_right"),
        first_seed=2000,
        edge_length=0.03,
        base={"policy": "shifted", "planner": {"name": "hierarchical", "subgoals_prompt": "mine"}},
    )


def interrupted(study, out):
    """Run a study and take its last episode away, as if it had been killed before that."""
    polyfold.run(study, out, progress=False)
    episodes = out / "episodes.jsonl"
    lines = episodes.read_text("utf-8").splitlines(keepends=True)
    episodes.write_text("".join(lines[:-1]), "utf-8")
    return out


def test_a_run_goes_on_where_nothing_changed(my_plugin, study, tmp_path):
    results = polyfold.run(study, interrupted(study, tmp_path / "run"), progress=False)
    assert len(results.records) == 2
    assert results.run.fingerprint.distributions["my-plugin"] == "0.1.0"
    assert "subgoals@mine" in results.run.fingerprint.prompts
    assert results.run.changes == ()


def test_a_run_does_not_go_on_with_another_version_of_a_plugin(my_plugin, study, tmp_path):
    out = interrupted(study, tmp_path / "run")
    my_plugin.install("0.2.0")
    with pytest.raises(ConfigError, match=r"version of my-plugin: 0\.1\.0 then, 0\.2\.0 now"):
        polyfold.run(study, out, progress=False)
    assert len(polyfold.open(out).records) == 1, "nothing was added"
    results = polyfold.run(study, out, progress=False, accept_change=True)
    (change,) = read_run(out).changes
    assert change.episodes == 1
    assert "version of my-plugin: 0.1.0 then, 0.2.0 now" in change.differences
    assert any(difference.startswith("source of my_plugin") for difference in change.differences)
    assert "0.1.0 then, 0.2.0 now" in polyfold.table(results).note


def test_a_run_does_not_go_on_with_another_prompt(my_plugin, study, tmp_path):
    out = interrupted(study, tmp_path / "run")
    my_plugin.prompt.write_text(my_plugin.prompt.read_text("utf-8") + "\nBe brief.\n", "utf-8")
    with pytest.raises(ConfigError, match="prompt subgoals@mine"):
        polyfold.run(study, out, progress=False)


def test_a_run_does_not_go_on_with_another_commit(my_plugin, study, tmp_path):
    def git(*arguments):
        identity = ("-c", "user.name=a", "-c", "user.email=a@example.org")
        command = ["git", "-C", str(my_plugin.folder), *identity, *arguments]
        subprocess.run(command, check=True, capture_output=True)

    git("init", "--quiet")
    git("add", "my_plugin/*.py")
    git("commit", "--quiet", "-m", "one")
    out = interrupted(study, tmp_path / "run")
    git("commit", "--quiet", "--allow-empty", "-m", "two")
    with pytest.raises(ConfigError, match="commit of my_plugin"):
        polyfold.run(study, out, progress=False)


def test_a_finished_run_can_be_tabulated_whatever_changed(my_plugin, study, tmp_path):
    polyfold.run(study, tmp_path / "run", progress=False)
    my_plugin.install("0.2.0")
    assert len(polyfold.run(study, tmp_path / "run", progress=False).records) == 2


def test_the_command_line_refuses_and_goes_on_when_told_to(my_plugin, tmp_path, capsys):
    config = tmp_path / "study.toml"
    config.write_text(
        'tasks = ["square-corner-top_left", "square-corner-top_right"]\nfirst_seed = 2000\nedge_length = 0.03\n'
        '[base]\npolicy = "shifted"\n'
    )
    out = interrupted(polyfold.load(config), tmp_path / "run")
    my_plugin.install("0.2.0")
    assert main(["evaluate", str(config), "--out", str(out)]) == 1
    assert "--accept-change" in capsys.readouterr().err
    assert main(["evaluate", str(config), "--out", str(out), "--accept-change"]) == 0


def test_references_are_made_anew_after_a_change_of_what_the_oracle_uses(my_plugin, monkeypatch, tmp_path):
    task = suite("polyfold70").task("square-corner-top_left")
    cloth = polyfold.garment("square", seed=2000, edge_length=0.03)
    simulator = polyfold.Experiment().simulator
    reference_for(task, cloth, 2000, simulator)
    (kept,) = (tmp_path / "cache" / "references").iterdir()
    reference_for(task, cloth, 2000, simulator)
    assert list((tmp_path / "cache" / "references").iterdir()) == [kept]
    monkeypatch.setattr("polyfold.logs._sources.digest_of_folder", lambda folder: folder.name)
    reference_for(task, cloth, 2000, simulator)
    assert len(list((tmp_path / "cache" / "references").iterdir())) == 2


def test_a_run_says_what_was_asked_with_all_defaults(my_plugin, study, tmp_path):
    run = polyfold.run(study, tmp_path / "run", progress=False).run
    assert run.asked["study"]["reference"] == "ideal"
    used = run.components["polyfold"]
    assert used["policy"].name == "shifted"
    assert "gamma" in used["policy"].params
    assert used["simulator"].params["order"] == 1
    assert used["fabric of square"].name == "poplin"
    assert used["fabric of square"].params["thickness"] > 0
    assert used["planner"].params["subgoals_prompt"] == "mine"
