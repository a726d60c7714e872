import pytest

from polyfold.cli._options.components import _value


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
