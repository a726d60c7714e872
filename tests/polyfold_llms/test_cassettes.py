"""Cassettes: what was recorded answers again, what was not is named, exported and filled in; nothing secret is kept."""

from __future__ import annotations

import contextlib
import io
import json
import subprocess
import sys

import pytest
from polyfold_llms.request_keys import describe_difference, normalized_request

from experiments.benchmarks.language.understanding import laid_garment, plan_ideally
from polyfold.api import run
from polyfold.cli import main
from polyfold.errors import ConfigError, LLMAccessError, LLMError
from polyfold.logs._accounts import accounts
from polyfold.logs._writing import transcript_lines
from polyfold.plugins import create
from polyfold.prompts import load_prompt
from polyfold.rollout import request_place
from polyfold.rollout._transcript import Transcript
from polyfold.studies import Study
from polyfold.types import Reply

SENTENCE = "fold the left sleeve in, then the right one, then in half"
PLACE = {"task": None, "garment": "square-2001", "seed": 1, "instruction": "fold"}


def lines_of(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


def plan(llm, text=SENTENCE):
    return plan_ideally(text, laid_garment("tshirt", 2001), create("planners", "hierarchical"), llm)


def cli(*arguments):
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        status = main([str(argument) for argument in arguments])
    return status, out.getvalue()


@pytest.fixture
def cassette(tmp_path):
    return tmp_path / "cassette.jsonl"


def test_a_replay_decides_as_the_recording_did_and_says_that_it_is_one(cassette):
    recorded = plan(create("llms", f"record:{cassette}"))
    assert len(lines_of(cassette)) == 4
    conversation = Transcript(create("llms", f"replay:{cassette}"))
    replayed = plan_ideally(
        SENTENCE, laid_garment("tshirt", 2001), create("planners", "hierarchical"), conversation_llm(conversation)
    )
    assert replayed == recorded
    assert accounts(conversation.calls)["any"].origins == ("recorded",)


def conversation_llm(conversation):
    class Passing:
        def complete(self, messages, params):
            return conversation.ask("any", messages, params)

    return Passing()


def test_what_is_recorded_is_not_asked_again(cassette):
    asked = []

    class Counting:
        model = "counting"

        def complete(self, messages, params):
            asked.append(messages)
            return Reply(f"answer {len(asked)}", cost=0.5, cost_source="provider", latency_s=2.0)

    from polyfold import plugins

    plugins.register("llms", "counting", Counting)
    try:
        llm = create("llms", f"record:{cassette}", {"inner": "counting"})
        first = llm.complete([{"role": "user", "content": "a"}], {})
        again = create("llms", f"record:{cassette}", {"inner": "counting"}).complete(
            [{"role": "user", "content": "a"}], {}
        )
        other = create("llms", f"record:{cassette}", {"inner": "counting", "sample": 1})
        assert other.complete([{"role": "user", "content": "a"}], {}).text == "answer 2"
    finally:
        plugins.unregister("llms", "counting")
    assert (first.text, first.origin) == ("answer 1", "live")
    assert (again.text, again.origin, again.cost, again.latency_s) == ("answer 1", "recorded", 0.5, 2.0)
    assert len(asked) == 2


def test_a_changed_prompt_misses_with_a_readable_difference(cassette):
    plan(create("llms", f"record:{cassette}"))
    prompt = load_prompt("subgoals")
    messages = prompt.render(template=create("garments", "tshirt").template().to_text(), instruction=SENTENCE)
    messages[0] = {
        **messages[0],
        "content": messages[0]["content"].replace("Refuse, with the reason", "Decline, with a reason"),
    }
    with pytest.raises(LLMError, match="not on the cassette") as caught:
        create("llms", f"replay:{cassette}").complete(messages, prompt.params)
    assert "message 1 (system) differs at character" in str(caught.value)
    assert "Refuse, with the reason" in str(caught.value)
    assert "Decline, with a reason" in str(caught.value)


def test_changed_parameters_and_models_miss(cassette):
    messages = [{"role": "user", "content": "a"}]
    create("llms", f"record:{cassette}").complete(messages, {"temperature": 0.0})
    for params, model in (({"temperature": 0.5}, "offline"), ({"temperature": 0.0}, "other")):
        with pytest.raises(LLMError, match=r"params: recorded|model: recorded"):
            create("llms", f"replay:{cassette}", {"model": model}).complete(messages, params)


@pytest.mark.parametrize(
    ("asked", "found"), [("x: 101, y: -7.5", True), ("x: 140, y: -7.5", False), ("x: 100, z: -7.5", False)]
)
def test_coordinates_may_differ_a_little_at_the_same_place_and_nothing_else_may(cassette, asked, found):
    def ask(llm, text, **place):
        transcript = Transcript(llm, {**PLACE, **place})
        transcript.step = 1
        return transcript.ask("fold_line", [{"role": "system", "content": "10 px"}, {"role": "user", "content": text}])

    ask(create("llms", f"record:{cassette}"), "x: 100, y: -7.5")
    replay = create("llms", f"replay:{cassette}")
    if found:
        assert ask(replay, asked).origin == "recorded nearby"
        with pytest.raises(LLMError):
            ask(replay, asked, seed=2)
        with pytest.raises(LLMError):
            ask(create("llms", f"replay:{cassette}", {"tolerance": 0.5}), asked)
    else:
        with pytest.raises(LLMError, match="differs at character"):
            ask(replay, asked)


def test_an_episode_that_asked_the_same_as_another_has_its_place_on_the_cassette_too(cassette):
    def ask(llm, text, seed):
        return Transcript(llm, {**PLACE, "seed": seed}).ask("fold_line", [{"role": "user", "content": text}])

    record = create("llms", f"record:{cassette}")
    for seed in (1, 2, 2):
        ask(record, "x: 100", seed)
    assert len(lines_of(cassette)) == 2
    replay = create("llms", f"replay:{cassette}")
    assert [ask(replay, "x: 101", seed).origin for seed in (1, 2)] == ["recorded nearby"] * 2
    with pytest.raises(LLMError):
        ask(replay, "x: 101", 3)


def test_a_number_in_the_prompt_is_no_coordinate(cassette):
    def ask(llm, system):
        return Transcript(llm, PLACE).ask(
            "r", [{"role": "system", "content": system}, {"role": "user", "content": "1"}]
        )

    ask(create("llms", f"record:{cassette}"), "at least 10 px")
    with pytest.raises(LLMError, match="at least 11 px"):
        ask(create("llms", f"replay:{cassette}"), "at least 11 px")


def test_backends_learn_the_place_of_a_request_only_while_it_is_under_way():
    seen = []

    class Looking:
        def complete(self, messages, params):
            seen.append(dict(request_place()))
            return Reply("x")

    transcript = Transcript(Looking(), {"task": "t"})
    transcript.ask("subgoals", [])
    transcript.step = 2
    transcript.ask("fold_line", [])
    transcript.ask("fold_line", [])
    assert [(place["task"], place["role"], place["step"], place["attempt"]) for place in seen] == [
        ("t", "subgoals", None, 1),
        ("t", "fold_line", 2, 1),
        ("t", "fold_line", 2, 2),
    ]
    assert request_place() == {}


def test_pictures_are_kept_as_hash_and_length(cassette, tmp_path):
    url = "data:image/png;base64," + "A" * 5000
    messages = [
        {"role": "user", "content": [{"type": "text", "text": "?"}, {"type": "image_url", "image_url": {"url": url}}]}
    ]
    transcript = Transcript(create("llms", f"record:{cassette}"))
    transcript.ask("r", messages)
    (tmp_path / "transcript.jsonl").write_text(transcript_lines(transcript.calls))
    for path in (cassette, tmp_path / "transcript.jsonl"):
        assert "AAAA" not in path.read_text()
        assert '"sha256"' in path.read_text()
    create("llms", f"replay:{cassette}").complete(messages, {})
    messages[0]["content"][1]["image_url"]["url"] = url + "A"
    with pytest.raises(LLMError):
        create("llms", f"replay:{cassette}").complete(messages, {})


def test_a_secret_is_not_recorded_and_not_sent(cassette, monkeypatch):
    monkeypatch.setenv("SOME_API_KEY", "correct-horse-battery")
    for secret in ("correct-horse-battery", "sk-proj-" + "z" * 24):
        with pytest.raises(LLMError, match="holds a key"):
            create("llms", f"record:{cassette}").complete([{"role": "user", "content": f"use {secret}"}], {})
    assert not cassette.exists()


@pytest.mark.parametrize("damage", ["edited reply key", "no JSON", "NaN", "unknown field"])
def test_a_damaged_line_is_named(cassette, damage):
    create("llms", f"record:{cassette}").complete([{"role": "user", "content": "a"}], {})
    entry = lines_of(cassette)[0]
    if damage == "edited reply key":
        entry["request"]["params"]["temperature"] = 1
    elif damage == "unknown field":
        entry["reply"]["command"] = "rm"
    elif damage == "NaN":
        entry["reply"]["cost"] = float("nan")
    line = "{" if damage == "no JSON" else json.dumps(entry)
    other = cassette.with_name("damaged.jsonl")
    other.write_text(cassette.read_text() + line + "\n")
    with pytest.raises(ConfigError, match="line 2"):
        create("llms", f"replay:{other}")


def test_a_line_cut_in_half_by_a_kill_is_dropped(cassette):
    def record(text):
        create("llms", f"record:{cassette}").complete([{"role": "user", "content": text}], {})

    record("a")
    with cassette.open("ab") as file:
        file.write(b'{"key": "12')
    assert create("llms", f"replay:{cassette}").complete([{"role": "user", "content": "a"}], {}).text
    record("b")
    assert [entry["request"]["messages"][0]["content"] for entry in lines_of(cassette)] == ["a", "b"]


def test_processes_append_at_once_without_mixing_lines(cassette):
    code = (
        "import sys; from polyfold.plugins import create; llm = create('llms', 'record:' + sys.argv[1]);"
        "[llm.complete([{'role': 'user', 'content': sys.argv[2] + 'x' * 20000 + str(i)}], {}) for i in range(8)]"
    )
    running = [subprocess.Popen([sys.executable, "-c", code, str(cassette), name]) for name in "abc"]
    assert [process.wait() for process in running] == [0, 0, 0]
    assert len({entry["key"] for entry in lines_of(cassette)}) == 24


def test_several_models_on_one_cassette_must_be_told_apart(cassette):
    messages = [{"role": "user", "content": "a"}]
    create("llms", f"record:{cassette}").complete(messages, {})
    entry = lines_of(cassette)[0]
    from polyfold_llms.cassette import append_line
    from polyfold_llms.request_keys import request_key

    request = normalized_request("other", messages, {}, 0)
    append_line(cassette, {**entry, "request": request, "key": request_key(request)})
    with pytest.raises(ConfigError, match="it holds offline, other"):
        create("llms", f"replay:{cassette}")
    assert create("llms", f"replay:{cassette}", {"model": "other"}).complete(messages, {}).text


def test_a_missing_cassette_is_reported_before_anything_is_folded(tmp_path):
    with pytest.raises(LLMAccessError, match="no cassette"):
        create("llms", f"replay:{tmp_path / 'none.jsonl'}")


def test_a_difference_names_settings_and_the_number_of_messages():
    a = normalized_request("m", [{"role": "user", "content": "a"}], {}, 0)
    b = normalized_request("n", [{"role": "user", "content": "a"}, {"role": "user", "content": "b"}], {}, 1)
    assert (
        describe_difference(a, b)
        == "model: recorded 'm', asked 'n'; sample: recorded 0, asked 1; recorded are 1 messages, asked 2"
    )


def answered(form, exported):
    """What a batch service makes of an exported line: the offline reader's answer, in the form's way."""
    messages = exported.get("messages") or exported.get("body", exported.get("params"))["messages"]
    if form == "anthropic":
        messages = [{"role": "system", "content": exported["params"]["system"]}, *messages]
    text = create("llms", "offline").complete(messages, {}).text
    if form == "plain":
        return {"key": exported["key"], "text": text}
    if form == "openai":
        choice = {"message": {"content": text}, "finish_reason": "stop"}
        body = {"choices": [choice], "model": "gpt", "usage": {"prompt_tokens": 1000, "completion_tokens": 100}}
        return {"custom_id": exported["custom_id"], "error": None, "response": {"status_code": 200, "body": body}}
    message = {"content": [{"type": "text", "text": text}], "model": "c", "stop_reason": "end_turn", "usage": {}}
    return {"custom_id": exported["custom_id"], "result": {"type": "succeeded", "message": message}}


@pytest.mark.parametrize("form", ["plain", "openai", "anthropic"])
def test_a_study_is_filled_in_round_by_round_from_another_program(cassette, tmp_path, form):
    requests, batch, answers = (tmp_path / f"{name}.jsonl" for name in ("requests", "batch", "answers"))
    llm = {"name": f"replay:{cassette}", "model": "openrouter/openai/gpt-4o", "missing": str(requests)}
    study = Study(
        name="batch",
        tasks=("square-triangle-bottom_left", "square-triangle-top_left"),
        first_seed=2001,
        edge_length=0.04,
        base={"llm": llm},
    )
    for _ in range(3):
        records = run(study, tmp_path / "run", progress=False).records
        if not any(record.cause == "infrastructure" for record in records):
            break
        assert cli("cassette", "missing", requests, "--form", form, "--out", batch)[0] == 0
        exported = lines_of(batch)
        assert all(len(line.get("custom_id") or line["key"]) == 64 for line in exported)
        answers.write_text("\n".join(json.dumps(answered(form, line)) for line in exported))
        status, out = cli("cassette", "fill", cassette, requests, "--answers", answers)
        assert (status, "0 requests are still missing" in out) == (0, True), out
    assert [record.failure for record in records] == [None, None]
    assert len(lines_of(cassette)) == 4
    status, out = cli("cassette", "show", cassette, "--json")
    summary = json.loads(out)
    assert {row["role"]: row["requests"] for row in summary} == {"subgoals": 2, "fold_line": 2}
    if form == "openai":
        assert summary[0]["cost"] == pytest.approx(2 * (1000 * 2.5 + 100 * 10) / 1e6)


def test_missing_requests_can_be_asked_of_a_backend(cassette, tmp_path):
    requests = tmp_path / "requests.jsonl"
    replay = create("llms", f"replay:{cassette}", {"model": "offline", "missing": str(requests)})
    with pytest.raises(LLMError, match=r"added to .*requests.jsonl"):
        plan(replay)
    status, out = cli("cassette", "fill", cassette, requests, "--llm", "offline")
    assert (status, "1 filled in" in out) == (0, True), out
    with pytest.raises(LLMError):
        plan(replay)
    assert len(lines_of(requests)) == 2
    status, out = cli("cassette", "fill", cassette, requests, "--llm", "offline", "--set", "speed=2")
    assert (status, "the llm 'offline' has no parameters" in out) == (1, True), out


def test_failed_and_foreign_answers_are_counted_and_not_recorded(cassette, tmp_path):
    requests, answers = tmp_path / "requests.jsonl", tmp_path / "answers.jsonl"
    replay = create("llms", f"replay:{cassette}", {"model": "offline", "missing": str(requests)})
    with pytest.raises(LLMError):
        plan(replay)
    key = lines_of(requests)[0]["key"]
    failed = {"custom_id": key, "response": {"status_code": 500, "body": "overloaded"}, "error": None}
    answers.write_text(json.dumps(failed) + "\n" + json.dumps({"key": "0" * 64, "text": "x"}) + "\n")
    status, out = cli("cassette", "fill", cassette, requests, "--answers", answers)
    assert status == 1
    assert "0 filled in, 1 failed, 1 answers to nothing" in out
    assert "overloaded" in out
    assert not cassette.exists()
    answers.write_text('{"neither": 1}\n')
    status, out = cli("cassette", "fill", cassette, requests, "--answers", answers)
    assert "line 1 is no answer" in out
