import pytest

from polyfold.cli._options.components import _value
from polyfold.config import ComponentSpec
from polyfold.errors import ConfigError


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.5", 0.5),
        ("true", True),
        ('{"a": 1}', {"a": 1}),
        ("{a = 1}", {"a": 1}),
        ("[1, 2,]", [1, 2]),
        ("caso", "caso"),
        ("gpt.jsonl", "gpt.jsonl"),
        ("C:\\new", "C:\\new"),
        ("", ""),
        ("[" * 100_000, "[" * 100_000),
    ],
)
def test_values_are_read_as_json_or_toml_or_text(text, value):
    assert _value(text) == value


@pytest.mark.parametrize(
    ("assignment", "says"),
    [
        ("policy.gamma=true", "'gamma': true is no number"),
        ("policy.gamma=NaN", "'gamma': nan is no number"),
        ("fabric.thickness=nan", "nan"),
        ("llm={a=1}", "KIND.PARAM=VALUE"),
        ("policy.gamma.a=1", "'gamma'"),
        ("policy.gama.a=1", "did you mean 'gamma'"),
    ],
)
def test_a_wrong_value_is_named(polyfold, assignment, says):
    result = polyfold("fold", "fold it", "--set", assignment)
    assert result.status == 1
    assert says in result.err


def test_a_verb_takes_parameters_of_the_components_that_it_uses_and_of_no_others(polyfold):
    result = polyfold("ground", "shirt.png", "--garment", "tshirt", "--set", "fabric.thickness=0.002")
    assert result.status == 1
    assert "with KIND one of grounding, segmenter; for example --set grounding.PARAM=VALUE" in result.err


def test_a_table_among_the_parameters_is_filled_in_by_dots():
    spec = ComponentSpec(name="pybullet", params={"arms": {"speed": 0.5}})
    assert spec.with_parameter("arms.robot", "yumi").params == {"arms": {"speed": 0.5, "robot": "yumi"}}
    assert spec.with_parameter("cloth_params.thickness.low", 1).params["cloth_params"] == {"thickness": {"low": 1}}
    with pytest.raises(ConfigError, match=r"'pybullet.arms.speed.x' can't be set, for 'speed' is 0.5 and no table"):
        spec.with_parameter("arms.speed.x", 1)


def test_such_a_parameter_reaches_its_component(polyfold):
    arms = ("--simulator", "pybullet", "--set", "simulator.arms.robot=panda", "--set", "simulator.arms.speed=7")
    result = polyfold("fold", "fold it", *arms)
    assert result.status == 1
    assert "'arms.speed'" in result.err
