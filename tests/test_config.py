import pytest

from polyfold import config
from polyfold.errors import ConfigError


def test_a_file_says_what_an_experiment_is_made_of(tmp_path):
    path = tmp_path / "experiment.toml"
    path.write_text('policy = "farthest"\n\n[fabric]\nname = "denim"\nthickness = 0.0012\n')
    experiment = config.Experiment.of(policy="farthest", fabric={"name": "denim", "thickness": 0.0012})
    assert config.Experiment.load(path) == experiment


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('polcy = "affordance-pair"', "did you mean 'policy'"),
        ("policy = 3", "3 names no component; write a name"),
        ("policy = [", "not valid TOML.*; correct it"),
        (r'llm = "replay:C:\x\new.jsonl"', r"in single quotes, 'replay:C:\\x\\new\.jsonl'$"),
        ('llm = "replay:C:\\\\new.jsonl"\npolicy = [', "not valid TOML.*; correct it"),
        (r'llm = {name = "replay", path = "C:\Users\new.jsonl"}', r"single quotes, 'C:\\Users\\new\.jsonl'"),
        ("[policy]\ngamma = 1.0", "policy"),
    ],
)
def test_wrong_files_say_what_is_wrong(tmp_path, text, says):
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=says):
        config.Experiment.load(path)


def test_a_fabric_s_table_needs_no_name(tmp_path):
    path = tmp_path / "experiment.toml"
    path.write_text("[fabric]\nthickness = 0.0012\n")
    assert config.Experiment.load(path).fabric == config.ComponentSpec(name="usual", params={"thickness": 0.0012})
    path.write_text('fabric = "denim"\n')
    assert config.Experiment.load(path).fabric.name == "denim"


def test_missing_file():
    with pytest.raises(ConfigError, match="there is no file"):
        config.Experiment.load("nowhere.toml")


def test_override_leaves_the_original_alone():
    experiment = config.Experiment()
    changed = experiment.override({"policy": "farthest"})
    assert (experiment.policy.name, changed.policy.name) == ("affordance-pair", "farthest")
    assert changed.override({"policy": "affordance-pair"}) == experiment
