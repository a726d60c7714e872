"""Reading replies: one last fenced JSON object, plain numbers, nothing executed."""

from __future__ import annotations

import json

import pytest
from polyfold_planning.answers.replies import answer_object, fold_line_in, subgoals_in

from polyfold.errors import PlanError, RefusedError
from polyfold.types import Reply


def reply(body: str) -> Reply:
    return Reply(f"Some thoughts.\n\n```json\n{body}\n```\n")


LINE = '{"fold_line": {"start": {"x": 1, "y": 2.5}, "end": {"x": 30, "y": 40}}}'


def test_the_last_block_counts():
    text = f'First I thought\n```json\n{{"fold_line": 1}}\n```\nbut no:\n```json\n{LINE}\n```'
    line = fold_line_in(answer_object(Reply(text)))
    assert (line.start, line.end) == ((1.0, 2.5), (30.0, 40.0))


def test_a_bare_object_is_understood_too():
    assert fold_line_in(answer_object(Reply(LINE))).length > 10


@pytest.mark.parametrize(
    "text",
    [
        "",
        "no json at all",
        "```json\nnot json\n```",
        "```json\n[1, 2]\n```",
        '```json\n{"fold_line": NaN}\n```',
        '```json\n{"fold_line": Infinity}\n```',
        "```json\n__import__('os').system('true')\n```",
        "```json\n" + "[" * 100_000 + "\n```",
        "```json\n" + "[" * 5000 + "\n```",
    ],
)
def test_unusable_replies_are_plan_errors(text):
    with pytest.raises(PlanError):
        answer_object(Reply(text))


@pytest.mark.parametrize(
    "body",
    [
        '{"fold_line": {"start": {"x": 1, "y": 2}}}',
        '{"fold_line": {"start": {"x": "1", "y": 2}, "end": {"x": 3, "y": 4}}}',
        '{"fold_line": {"start": {"x": true, "y": 2}, "end": {"x": 3, "y": 4}}}',
        '{"fold_line": {"start": {"x": 1e999, "y": 2}, "end": {"x": 3, "y": 4}}}',
        '{"fold_line": {"start": [1, 2], "end": [3, 4]}}',
        f'{{"fold_line": {{"start": {{"x": {10**400}, "y": 2}}, "end": {{"x": 3, "y": 4}}}}}}',
        '{"subgoals": ["fold"]}',
    ],
)
def test_malformed_lines_are_plan_errors(body):
    with pytest.raises(PlanError):
        fold_line_in(answer_object(reply(body)))


@pytest.mark.parametrize(
    "body", ['{"subgoals": []}', '{"subgoals": "fold"}', '{"subgoals": [1]}', '{"subgoals": [" "]}']
)
def test_malformed_subgoals_are_plan_errors(body):
    with pytest.raises(PlanError):
        subgoals_in(answer_object(reply(body)), 5)


def test_too_many_subgoals_are_a_plan_error():
    with pytest.raises(PlanError, match="between 1 and 2"):
        subgoals_in(answer_object(reply('{"subgoals": ["a", "b", "c"]}')), 2)


def test_refusals_carry_their_reason():
    with pytest.raises(RefusedError, match="no sleeve"):
        answer_object(reply('{"refused": "a square has no sleeve"}'))
    with pytest.raises(RefusedError, match="policy"):
        answer_object(Reply("", finish="refusal", refusal="policy"))


def test_a_cut_off_answer_is_a_plan_error():
    with pytest.raises(PlanError, match="cut off"):
        answer_object(Reply("thinking", finish="length"))


@pytest.mark.parametrize(
    "text",
    [
        'So:\r\n```json\r\n{"subgoals": ["a"]}\r\n```\r\n',
        'So: ```json {"subgoals": ["a"]}```',
        'So:\n```json\n{"subgoals": ["a"]}',
        'So {not this}: {"subgoals": ["a"]}',
        '```\n{"other": 1}\n```\n```JSON\n{"subgoals": ["a"]}\n```',
    ],
)
def test_objects_are_found_however_they_are_fenced(text):
    assert answer_object(Reply(text)) == {"subgoals": ["a"]}


@pytest.mark.parametrize("nothing", [False, None, "", "  "])
def test_only_words_refuse(nothing):
    content = answer_object(Reply(json.dumps({"subgoals": ["a"], "refused": nothing})))
    assert content == {"subgoals": ["a"]}
    with pytest.raises(RefusedError, match="too thick"):
        answer_object(Reply('{"subgoals": [], "refused": "too thick"}'))
