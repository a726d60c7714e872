"""The sentences and the seen/unseen split of the suite polyfold70."""

from __future__ import annotations

from collections import Counter

import pytest

from polyfold.errors import ConfigError
from polyfold.tasks import Suite, load_suite


@pytest.fixture(scope="module")
def suite() -> Suite:
    return load_suite("polyfold_standard:tasks/polyfold70.toml")


def test_five_different_instructions_a_task(suite: Suite) -> None:
    for task in suite.tasks:
        assert len({_plain(sentence) for sentence in task.instructions}) == len(task.instructions) == 5, task.id


def test_no_sentence_asks_for_two_tasks(suite: Suite) -> None:
    times = Counter(_plain(sentence) for task in suite.tasks for sentence in task.instructions)
    assert [sentence for sentence, number in times.items() if number > 1] == []


def test_instructions_are_clean_text(suite: Suite) -> None:
    for task in suite.tasks:
        for sentence in task.instructions:
            assert sentence == " ".join(sentence.split())
            assert sentence.isascii(), sentence
            assert sentence[0].isupper(), sentence
            assert sentence.endswith((".", "?")), sentence


def test_every_task_is_seen_or_unseen_and_each_type_is_halved(suite: Suite) -> None:
    balance: Counter[tuple[str, bool]] = Counter()
    for task in suite.tasks:
        assert task.split in ("seen", "unseen"), task.id
        balance[task.type, len(task.steps) > 1] += 1 if task.split == "seen" else -1
    assert len(balance) == 15  # nine types; T-Half has no multi-step tasks, T-Block and P-Block no single-step ones
    assert all(abs(difference) <= 1 for difference in balance.values()), balance


def test_twenty_one_of_the_forty_three_multi_step_tasks_are_seen(suite: Suite) -> None:
    multi = Counter(task.split for task in suite.tasks if len(task.steps) > 1)
    assert multi == {"seen": 21, "unseen": 22}


def test_split_is_optional_but_checked(tmp_path) -> None:
    path = tmp_path / "suite.toml"
    text = (
        'schema_version = 1\nname = "own"\n[[task]]\nid = "a"\ngarment = "square"\ntype = "T"\n'
        'steps = [{ pairs = [["top_left", "bottom_right"]] }]\n'
    )
    path.write_text(text)
    assert load_suite(path).tasks[0].split is None
    path.write_text(text + 'split = "hidden"\n')
    with pytest.raises(ConfigError, match="task a has a bad value for 'split'"):
        load_suite(path)


def _plain(sentence: str) -> str:
    """The words alone: two sentences that differ only in case or punctuation are the same."""
    return " ".join("".join(letter if letter.isalnum() else " " for letter in sentence.lower()).split())
