"""The backend litellm: what is checked before anything is folded, what is sent, what is accounted, where keys go."""

from __future__ import annotations

import contextlib
import io
import json
import logging
import subprocess
import sys

import pytest
from loopback_server import FAKE_KEY, GOOD, ROUTES, Script, error, said
from polyfold_llms import models
from polyfold_llms.redaction import contains_secret, redact
from polyfold_offline import OfflineLLM
from polyfold_offline.loopback import Sent, answering, completion, serve

from polyfold.api import run
from polyfold.cli import main
from polyfold.errors import ConfigError, LLMAccessError
from polyfold.logs import read_episodes
from polyfold.plugins import create
from polyfold.studies import Study

QUESTION = [{"role": "system", "content": "Answer."}, {"role": "user", "content": "Well?"}]
PICTURE = {"type": "image_url", "image_url": {"url": "data:image/png;base64,AAAA"}}


@pytest.fixture
def server(monkeypatch):
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.setenv("OPENROUTER_API_KEY", FAKE_KEY)
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    with serve() as server:
        yield server


def connect(server, route=ROUTES[0], **settings):
    return create("llms", f"litellm:{route}", {"api_base": server.address, "first_wait_s": 0.01, **settings})


def test_a_missing_key_is_reported_before_anything_is_folded_and_litellm_stays_out(monkeypatch, tmp_path):
    monkeypatch.delenv("OPENROUTER_API_KEY", raising=False)
    monkeypatch.setitem(sys.modules, "litellm", None)
    err = io.StringIO()
    with contextlib.redirect_stderr(err):
        status = main(["fold", "fold it in half", "--llm", f"litellm:{ROUTES[1]}", "--out", str(tmp_path / "out")])
    assert status == 1
    assert "OPENROUTER_API_KEY is not set" in err.getvalue()
    assert not (tmp_path / "out" / "episode.json").exists()


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("gpt-4o", "openai/gpt-4o"),
        ("openai/gpt-4oo", "did you mean 'openai/gpt-4o'"),
        ("nobody/gpt-4o", "no route 'nobody'"),
        ("openrouter/openai/gpt-40", "openrouter/openai/gpt-4o"),
    ],
)
def test_an_unknown_model_is_reported_with_near_names(server, name, hint):
    with pytest.raises(LLMAccessError, match=r"unlisted|route") as caught:
        create("llms", f"litellm:{name}")
    assert hint in str(caught.value)


def test_an_unlisted_model_can_be_used_all_the_same(server):
    create("llms", "litellm:openrouter/new/model", {"unlisted": True})


def test_a_model_without_vision_gets_no_picture(server):
    blind = connect(server, "openrouter/openai/gpt-3.5-turbo")
    with pytest.raises(LLMAccessError, match="does not take pictures"):
        blind.complete([{"role": "user", "content": [PICTURE]}], {})
    assert server.received == []
    server.script = Script(said(GOOD))
    connect(server, "openrouter/openai/gpt-4o").complete([{"role": "user", "content": [PICTURE]}], {})
    assert server.received[0].body["messages"][0]["content"][0]["image_url"] == PICTURE["image_url"]


def test_a_key_goes_to_its_own_provider_only(server, monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", FAKE_KEY)
    server.script = Script(said(GOOD))
    connect(server).complete(QUESTION, {})
    connect(server, key_env="OPENAI_API_KEY").complete(QUESTION, {})
    assert [FAKE_KEY in received.headers["Authorization"] for received in server.received] == [False, True]


@pytest.mark.parametrize(
    "settings",
    [
        {"params": {"api_key": "anything"}},
        {"params": {"num_retries": 3}},
        {"params": {"user": FAKE_KEY}},
        {"api_base": f"http://127.0.0.1/{FAKE_KEY}"},
    ],
)
def test_parameters_hold_no_key_and_no_transport(server, settings):
    with pytest.raises(ConfigError, match="environment") as caught:
        create("llms", f"litellm:{ROUTES[1]}", settings)
    assert FAKE_KEY not in str(caught.value)


@pytest.mark.parametrize("route", ["hosted_vllm/llama", "lm_studio/llama", "llamafile/llama", "openai/llama"])
def test_local_servers_need_no_key_and_no_table(server, route):
    server.script = Script(said(GOOD))
    reply = connect(server, route).complete(QUESTION, {"max_tokens": 77})
    assert reply.text == GOOD
    assert server.received[0].body["model"] == "llama"
    assert server.received[0].body["max_tokens"] == 77
    assert reply.cost is None


def test_ollama_s_own_api(server):
    message = {"role": "assistant", "content": GOOD}
    counts = {"prompt_eval_count": 5, "eval_count": 7}
    server.script = Script(Sent({"model": "llama3.1:8b", "message": message, "done": True, **counts}))
    reply = connect(server, "ollama_chat/llama3.1:8b").complete(QUESTION, {"temperature": 0.0})
    assert reply.text == GOOD
    assert (reply.usage["prompt_tokens"], reply.usage["completion_tokens"], reply.cost) == (5, 7, None)
    assert server.received[0].path.endswith("/api/chat")


@pytest.mark.parametrize("route", ROUTES)
def test_reply_accounts_for_tokens_reasoning_and_cost(server, route):
    body = completion(GOOD, reasoning="let me see")
    body["usage"] |= {"cost": 0.0123, "completion_tokens_details": {"reasoning_tokens": 5}}
    server.script = Script(Sent(body))
    reply = connect(server, route).complete(QUESTION, {})
    assert reply.reasoning == "let me see"
    assert (reply.cost, reply.cost_source) == (0.0123, "provider")
    assert reply.usage["prompt_tokens"] == 10
    assert reply.usage["reasoning_tokens"] == 5
    assert reply.model_served == "loopback"
    assert 0 < reply.latency_s <= reply.wall_s
    assert reply.origin == "live"


@pytest.mark.parametrize("reported", [None, "NaN", -1, True])
def test_without_a_usable_figure_the_dated_table_counts_and_an_unknown_price_is_none(server, reported):
    body = completion(GOOD)
    body["usage"] |= {"prompt_tokens": 1_000_000, "completion_tokens": 100_000}
    if reported is not None:
        body["usage"]["cost"] = float(reported) if reported == "NaN" else reported
    server.script = Script(Sent(body))
    priced = connect(server, "openrouter/openai/gpt-4o").complete(QUESTION, {})
    assert priced.cost == pytest.approx(2.5 + 1.0)
    assert "20" in priced.cost_source
    unpriced = connect(server, "openrouter/google/gemini-pro-1.5").complete(QUESTION, {})
    assert (unpriced.cost, unpriced.cost_source) == (None, "")


def test_models_get_no_parameter_that_they_refuse_and_room_to_reason(server):
    server.script = Script(said(GOOD))
    connect(server, "openrouter/openai/gpt-5").complete(QUESTION, {"temperature": 0.0, "max_tokens": 1500})
    sent = server.received[0].body
    assert "temperature" not in sent
    assert sent.get("max_tokens", sent.get("max_completion_tokens")) == 1500 + 16000
    connect(server, params={"temperature": 0.7}).complete(QUESTION, {"temperature": 0.0})
    assert server.received[1].body["temperature"] == 0.7


def test_what_is_asked_is_left_as_it_was(server):
    messages = json.loads(json.dumps(QUESTION))
    connect(server, "openrouter/anthropic/claude-opus-4.1").complete(messages, {"max_tokens": 5})
    assert messages == QUESTION


def test_the_table_has_the_paper_s_models_with_dated_prices():
    paper = {model.label: model for model in models("paper")}
    assert set(paper) == {
        *("gpt-3.5", "gpt-4o", "gpt-5", "claude-3-opus", "claude-4.1-opus"),
        *("gemini-1.5-pro", "gemini-2.5-flash", "gemini-2.5-pro"),
    }
    assert len(models("current")) >= 5
    for model in models():
        assert model.price is None or (
            model.price.input > 0 and model.price.as_of.startswith("20") and model.price.source
        )
    assert paper["gpt-3.5"].vision is False


def echo(request):
    key = request.headers["Authorization"]
    return error(401, f"Incorrect API key provided: {key} ({FAKE_KEY[:18]}****)", headers={"x-key": FAKE_KEY})


def files_with(text, folder):
    return [path for path in folder.rglob("*") if path.is_file() and text.encode() in path.read_bytes()]


@pytest.mark.parametrize("route", ROUTES)
def test_an_echoed_key_is_in_no_error_log_or_repr(server, route, caplog):
    server.script = echo
    llm = connect(server, route, key_env="OPENROUTER_API_KEY")
    with caplog.at_level(logging.DEBUG), pytest.raises(LLMAccessError, match="401") as caught:
        llm.complete(QUESTION, {})
    told = [str(caught.value), repr(caught.value), repr(llm), repr(vars(llm)), caplog.text]
    assert not [text for text in told if FAKE_KEY[:18] in text]
    assert caught.value.__cause__ is caught.value.__context__ is None


def test_a_run_with_a_key_leaves_it_nowhere_on_disk(server, tmp_path):
    solver = OfflineLLM()

    def chatty(request):
        """Refuses once, then answers; both with the key in every place that is kept."""
        if len(server.received) == 1:
            return error(503, f"busy, {FAKE_KEY}")
        reply = solver.complete(request.body["messages"], {})
        body = completion(f"Key {FAKE_KEY}. {reply.text}", model=FAKE_KEY, reasoning=f"I saw {FAKE_KEY}")
        return Sent({**body, "id": FAKE_KEY})

    server.script = chatty
    inner = {"api_base": server.address, "key_env": "OPENROUTER_API_KEY", "first_wait_s": 0.01}
    out, cassette = tmp_path / "out", tmp_path / "cassette.jsonl"
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        status = main(
            [
                *("fold", "fold it in half", "--garment", "square", "--seed", "2001", "--edge-length", "0.03"),
                *("--out", str(out), "--llm", f"record:{cassette}", "--set", f"llm.inner=litellm:{ROUTES[1]}"),
                *("--set", f"llm.inner_params={json.dumps(inner)}"),
            ]
        )
    assert status == 0, printed.getvalue()
    assert all(FAKE_KEY in received.headers["Authorization"] for received in server.received)
    assert "[hidden]" in cassette.read_text()
    assert "waited" in (out / "transcript.jsonl").read_text()
    assert files_with(FAKE_KEY[:18], tmp_path) == []
    assert FAKE_KEY[:18] not in printed.getvalue()


def test_a_study_with_a_key_leaves_it_nowhere_on_disk(server, tmp_path):
    server.script = lambda request: error(400, f"bad request by {request.headers['Authorization']}")
    study = study_of(server, "echo", key_env="OPENROUTER_API_KEY")
    records = run(study, tmp_path / "run", progress=False).records
    assert ["bad request by" in record.failure.reason for record in records] == [True, True]
    assert len(server.received) == 2
    assert files_with(FAKE_KEY[:18], tmp_path) == []


def test_secrets_are_recognised_by_value_and_by_form(monkeypatch):
    monkeypatch.setenv("MY_SERVICE_TOKEN", "correct-horse-battery")
    assert redact("a correct-horse-battery b") == "a [hidden] b"
    for key in ("sk-ant-api03-" + "x" * 30, "AIza" + "b" * 35, "AKIA" + "A" * 16, "gsk_" + "c" * 40):
        assert contains_secret(f"key={key}.")
    for harmless in ("fold the task-oriented-risk-assessment-sheet", "sha256 " + "0f" * 32, "half_" + "a" * 40):
        assert not contains_secret(harmless)


def study_of(server, name, **settings):
    inner = {"name": f"litellm:{ROUTES[0]}", "api_base": server.address, "first_wait_s": 0.01, **settings}
    tasks = ("square-triangle-bottom_left", "square-triangle-top_left")
    return Study(name=name, tasks=tasks, first_seed=2001, edge_length=0.04, base={"llm": inner})


def test_faults_lose_no_finished_episode_and_are_tried_again(server, tmp_path):
    healthy = answering(OfflineLLM())
    study = study_of(server, "faults")
    server.script = lambda request: healthy(request) if len(server.received) <= 2 else error(500)
    first, second = run(study, tmp_path / "run", progress=False).records
    assert first.failure is None
    assert (second.failure.stage, second.cause) == ("unanswered", "infrastructure")
    server.script = lambda request: error(401)
    with pytest.raises(LLMAccessError):
        run(study, tmp_path / "run", progress=False)
    assert read_episodes(tmp_path / "run") == [first, second]
    server.script = healthy
    again = run(study, tmp_path / "run", progress=False).records
    assert again[0] == first
    assert [record.failure for record in again] == [None, None]


def test_the_default_never_imports_litellm():
    code = (
        "import sys, polyfold; from polyfold.plugins import create, names; names('llms'); create('llms', 'offline'); "
        "import polyfold_llms.litellm_backend, polyfold_llms.recording; "
        "sys.exit('litellm' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_what_repeats_is_marked_for_claudes_cache_and_what_came_from_a_cache_is_counted(server):
    usage = {"prompt_tokens": 900, "completion_tokens": 9, "prompt_tokens_details": {"cached_tokens": 800}}
    server.script = Script(Sent({**completion(GOOD), "usage": usage}))
    examples = [{"role": "user", "content": "One?"}, {"role": "assistant", "content": "1"}]
    question = [QUESTION[0], *examples, QUESTION[1]]
    reply = connect(server, "openrouter/anthropic/claude-sonnet-4.5", unlisted=True).complete(question, {})
    assert reply.usage["cached_tokens"] == 800
    sent = server.received[0].body["messages"]
    assert [isinstance(message["content"], list) for message in sent] == [True, False, True, False]
    assert all("cache_control" in sent[at]["content"][0] for at in (0, 2))
    connect(server, ROUTES[1]).complete(question, {})
    assert all(isinstance(message["content"], str) for message in server.received[1].body["messages"])


def test_a_json_answer_asked_of_anthropic_itself_goes_as_a_schema_and_comes_back_as_prompts_want_it(server):
    """litellm 1.106.2 drops json_object on this route."""
    told = json.dumps({"reasoning": "One fold.", "answer": '{"subgoals": ["fold the left edge to the right edge"]}'})
    body = {
        "id": "msg_1",
        "type": "message",
        "role": "assistant",
        "model": "claude-sonnet-4-5",
        "content": [{"type": "text", "text": told}],
        "stop_reason": "end_turn",
        "usage": {"input_tokens": 5, "output_tokens": 7},
    }
    server.script = Script(Sent(body))
    model = connect(server, "anthropic/claude-sonnet-4-5", unlisted=True)
    reply = model.complete(QUESTION, {"response_format": {"type": "json_object"}})
    assert set(server.received[0].body["output_format"]["schema"]["properties"]) == {"reasoning", "answer"}
    assert reply.text == 'One fold.\n\n```json\n{"subgoals": ["fold the left edge to the right edge"]}\n```'
