import json
import sys

COARSE = ("--garment", "square", "--seed", 2001, "--edge-length", "0.03")


def test_a_prompt_is_shown_as_the_model_gets_it_with_its_length(polyfold, monkeypatch):
    monkeypatch.setitem(sys.modules, "litellm", None)
    result = polyfold("prompt", "show", "subgoals", *COARSE, "--instruction", "fold it like a letter")
    assert result.status == 0, result.err
    assert result.out.startswith("--- system\nYou plan how a robot")
    assert 'Instruction: "fold it like a letter"' in result.out
    assert "tokens (estimated" in result.out.splitlines()[-1]
    assert '"temperature": 0.0' in result.out.splitlines()[-1]


def test_a_later_step_shows_the_cloth_as_it_lies_then(polyfold):
    twice = ("--instruction", "fold it in half, then in half again", "--json")
    shown = [
        json.loads(polyfold("prompt", "show", "fold_line", *COARSE, *twice, "--step", step).out) for step in (0, 1)
    ]
    assert [prompt["step"] for prompt in shown] == [0, 1]
    assert ["fold1_start" in prompt["messages"][-1]["content"] for prompt in shown] == [False, True]


def test_tokens_are_counted_by_the_model_s_tokenizer_when_one_is_named(polyfold):
    estimated, counted = (
        json.loads(polyfold("prompt", "show", "subgoals", *COARSE, "--json", *more).out)
        for more in ((), ("--model", "openai/gpt-4o"))
    )
    assert counted["counted"] == "by the tokenizer of openai/gpt-4o"
    assert abs(estimated["tokens"] / counted["tokens"] - 1) < 0.25


def test_roles_and_steps_that_were_not_asked_are_answered_with_those_that_were(polyfold):
    result = polyfold("prompt", "show", "poem", *COARSE)
    assert result.status == 1
    assert "subgoals, fold_line" in result.err
    result = polyfold("prompt", "show", "fold_line", *COARSE, "--step", 7)
    assert "not asked at step 7, but at 0" in result.err


def test_prompts_are_listed(polyfold):
    assert {"subgoals@v2", "fold_line@v2"} <= set(polyfold("prompt", "list").out.split())


def test_without_a_role_the_roles_are_listed(polyfold):
    assert polyfold("prompt", "show", *COARSE).out.split() == ["subgoals", "fold_line"]
    result = polyfold("prompt", "show", *COARSE, "--agent", "noop")
    assert result.status == 1
    assert "no language model is asked" in result.err


def test_pictures_count_and_it_is_said_how(polyfold):
    asked = ("prompt", "show", "fold_line", *COARSE, "--json")
    words, both = (
        json.loads(polyfold(*asked, "--grounding", grounding).out) for grounding in ("polygon", "polygon+image")
    )
    assert both["tokens"] > words["tokens"] + 255
    assert "each picture taken as 255" in both["counted"]
    assert "picture" not in words["counted"]
