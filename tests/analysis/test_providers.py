"""Language models side by side: a small run against the loopback server, and what its table says."""

import json

import pytest
from polyfold_offline import OfflineLLM
from polyfold_offline.loopback import Sent, answering, completion, serve

import polyfold
from polyfold.analysis import Results, provider_table, share
from polyfold.analysis._columns import shared
from polyfold.analysis._providers import MEASURES, measured
from polyfold.cli import main
from polyfold.errors import ConfigError, LLMAccessError
from polyfold.logs._accounts import accounts
from polyfold.logs._writing import transcript_lines
from polyfold.rollout._transcript import Transcript
from polyfold.types import Failure, Reply
from polyfold.viz import provider_figure

TASKS = ("square-corner-top_left", "square-corners-top_left-top_right")
ASKED, ANSWERED, PRICE = 100, 20, 0.25

solver = answering(OfflineLLM())


def answer(request):
    """``paid`` as `offline`, with a price; ``hasty`` forgets the JSON of fold lines at first, ``mute`` that of all."""
    if request.body["model"] == "mute":
        return Sent(completion("no JSON"))
    body = solver(request).body
    if request.body["model"] == "paid":
        usage = {"prompt_tokens": ASKED, "completion_tokens": ANSWERED, "total_tokens": ASKED + ANSWERED}
        return Sent({**body, "usage": {**usage, "cost": PRICE}})
    repaired = len(request.body["messages"]) > 2 and request.body["messages"][-2]["content"] == "no JSON"
    if repaired:
        return Sent(completion(OfflineLLM().complete(request.body["messages"][:-2], {}).text))
    asks_for_line = "fold_line" in body["choices"][0]["message"]["content"]
    return Sent(completion("no JSON")) if asks_for_line else Sent(body)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("providers")
    with pytest.MonkeyPatch.context() as patch, serve(answer) as server:
        patch.setenv("NO_PROXY", "127.0.0.1")
        patch.setenv("POLYFOLD_CACHE", str(folder / "cache"))
        llms = {
            name: {"name": f"litellm:openai/{name}", "api_base": server.address} for name in ("paid", "hasty", "mute")
        }
        study = polyfold.Study(
            name="llms", tasks=TASKS, first_seed=2000, instructions="first", edge_length=0.03,
            variants={"offline": {}, **{name: {"llm": llm} for name, llm in llms.items()}, "noop": {"agent": "noop"}},
        )  # fmt: skip
        polyfold.run(study, folder / "run", progress=False, pictures="none")
    return folder / "run"


@pytest.fixture(scope="module")
def results(folder):
    return polyfold.open(folder)


def rows(results):
    table = provider_table(results)
    return {row[0]: dict(zip(table.headers, row, strict=True)) for row in table.rows}


def test_first_answers_and_repaired_ones_are_told_apart(results):
    found = rows(results)
    for name in ("offline", "paid"):
        assert found[name]["valid at once %"].startswith("100.0")
    # One decomposition at once for each episode; of its one and two fold lines, none.
    assert found["hasty"]["valid at once %"] == "40.0 [0.5, 98.9]"
    assert found["hasty"]["valid after repair %"] == "100.0 [34.2, 100.0]"
    assert found["hasty"]["success %"] == found["offline"]["success %"]


def test_a_model_whose_answers_can_never_be_used_fails_at_the_subgoals(results):
    found = rows(results)["mute"]
    assert found["valid at once %"] == found["valid after repair %"] == "0.0 [0.0, 65.8]"
    assert found["subgoal failures %"] == "100.0 [34.2, 100.0]"
    assert found["tokens out"] == "3 [3, 3]", "three answers"


def test_tokens_and_cost_are_those_of_an_episode_and_latency_that_of_a_call(results):
    # Two and three calls in the two episodes.
    found = rows(results)["paid"]
    assert found["tokens in"].startswith(f"{2.5 * ASKED:.0f} ")
    assert found["tokens out"].startswith(f"{2.5 * ANSWERED:.0f} ")
    assert found["cost [US$]"].startswith(f"{2.5 * PRICE:.4f} ")
    of_paid = [account for record in results.of("paid") for account in record.language.values()]
    per_call = sum(account.latency_s for account in of_paid) / 5
    assert measured(results.of("paid"), "latency [s/call]").mean == pytest.approx(per_call)


def test_what_is_unknown_is_a_dash_and_never_nothing(results):
    found = rows(results)
    assert found["hasty"]["cost [US$]"] == "–"
    assert found["offline"]["cost [US$]"] == "free"
    assert found["offline"]["tokens in"] == "–"
    without_model = set(MEASURES) - {"success %", "subgoal failures %", "fold-line failures %"}
    assert {found["noop"][name] for name in without_model} == {"–"}
    assert "provider (paid)" in provider_table(results).note, "the source of a cost is named"


def test_success_is_the_same_figure_as_in_every_table(results):
    for variant in results.study.variants:
        records = results.of(variant)
        assert measured(records, "success %") == share([r.succeeded for r in records], *shared(records))


def changed(results, variant, **changes):
    """The results with the last record of a variant changed."""
    last = results.of(variant)[-1]
    return Results(results.run, [r.model_copy(update=changes) if r is last else r for r in results.records])


def accounted(record, **changes):
    """The accounts of an episode with some figures changed."""
    return {role: account.model_copy(update=changes) for role, account in record.language.items()}


def test_failures_are_counted_by_their_first_cause(results):
    failed = changed(results, "paid", cause="subgoal", success={"lenient": False, "strict": False})
    found = rows(failed)["paid"]
    assert found["subgoal failures %"].startswith("50.0")
    assert found["fold-line failures %"].startswith("0.0")


def test_a_cost_that_some_episodes_lack_says_on_how_many_it_rests(results):
    language = accounted(results.of("paid")[-1], cost=None)
    assert rows(changed(results, "paid", recorded_language=language))["paid"]["cost [US$]"].endswith("(n=1)")


def test_the_note_says_what_was_recorded_and_what_was_never_answered(results):
    language = accounted(results.of("paid")[-1], origins=("recorded",))
    assert "Answers: recorded (paid)" in provider_table(changed(results, "paid", recorded_language=language)).note
    unanswered = changed(results, "hasty", failure=Failure("unanswered", "429"))
    assert "hasty 1" in provider_table(unanswered).note
    assert "hasty 1" not in provider_table(results).note


def test_runs_from_before_validity_was_counted_still_open(results):
    uncounted = dict.fromkeys(("questions", "valid_at_once", "valid"))
    records = [r.model_copy(update={"recorded_language": accounted(r, **uncounted)}) for r in results.of("paid")]
    old = Results(results.run, records)
    assert rows(old)["paid"]["valid at once %"] == "–"


def test_the_command_line_prints_the_table_and_runs_some_of_the_variants(folder, results, capsys, tmp_path):
    assert main(["table", str(folder), "--by", "provider", "--format", "csv"]) == 0
    assert capsys.readouterr().out.strip() == provider_table(results).csv()
    (tmp_path / "s.toml").write_text(
        '[variants.still]\nagent = "noop"\n[variants.keyed]\nllm = "litellm:openai/gpt-4o"'
    )
    assert main(["evaluate", str(tmp_path / "s.toml"), "--out", str(tmp_path / "o"), "--variants", "stil"]) == 1
    assert "did you mean 'still'" in capsys.readouterr().err


def test_the_figure_shows_every_model_once_a_panel_with_a_dash_for_the_unknown(results, tmp_path):
    figure = provider_figure(results)
    assert figure.axes[0].get_title() == "success %"
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == list(results.study.variants)
    assert [text.get_text() for text in figure.axes[-1].texts] == ["free", "0.6250", "–", "–", "–"]
    figure.savefig(tmp_path / "figure.png")


class Scripted:
    """Answers with the given texts in turn; raises an error among them."""

    def __init__(self, *answers):
        self.answers = list(answers)

    def complete(self, messages, params):
        answer = self.answers.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return Reply(answer)


def asked(transcript, role, step, *rejected):
    """Ask once for each, and reject as told."""
    transcript.step = step
    for reason in rejected:
        transcript.ask(role, [{"role": "user", "content": "?"}])
        if reason:
            transcript.reject(reason)


def test_accounts_count_questions_and_not_answers():
    transcript = Transcript(Scripted(*"abcdef", ConfigError("down")))
    asked(transcript, "fold_line", 0, None)
    asked(transcript, "fold_line", 1, "no JSON", None)
    asked(transcript, "fold_line", 2, "no JSON", "no JSON", "no JSON")
    with pytest.raises(ConfigError):
        asked(transcript, "fold_line", 3, None)
    account = accounts(transcript.calls)["fold_line"]
    assert (account.calls, account.questions, account.valid_at_once, account.valid) == (7, 3, 1, 2)
    lines = [json.loads(line) for line in transcript_lines(transcript.calls).splitlines()]
    assert [line.get("rejected") for line in lines] == [None, "no JSON", None, *["no JSON"] * 3, None]


def test_a_key_that_one_variant_lacks_is_reported_before_the_others_fold(tmp_path, monkeypatch):
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    study = polyfold.Study(name="s", tasks=TASKS, variants={"offline": {}, "keyed": {"llm": "litellm:openai/gpt-4o"}})
    with pytest.raises(LLMAccessError, match="OPENAI_API_KEY"):
        polyfold.run(study, tmp_path / "run", progress=False)
    assert not polyfold.open(tmp_path / "run").records


@pytest.mark.parametrize("name", ["offline", "gpt-4o", "gemini-2.5-pro"])
def test_the_papers_models_can_be_chosen_one_by_one(name):
    from polyfold.studies import load
    from polyfold.studies._study import with_variants

    study = load("experiments/llms.toml")
    assert len(study.variants) == 9
    assert list(with_variants(study, [name]).variants) == [name]
