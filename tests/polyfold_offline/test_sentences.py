"""The set of sentences in seven manners is well-formed, and either part of it can be judged alone."""

import tomllib
from collections import Counter
from pathlib import Path

import pytest

from experiments.benchmarks.language.understanding import main, part_of_set
from polyfold.tasks import load_suite

CONTENT = tomllib.loads(Path(__file__).with_name("sentences.toml").read_text("utf-8"))
ENTRIES = [*CONTENT["instruction"], *CONTENT["refuse"]]
SUITE = load_suite("polyfold_standard:tasks/polyfold70.toml")


def test_ids_and_texts_are_unique():
    assert len({entry["id"] for entry in ENTRIES}) == len(ENTRIES)
    assert len({(entry["garment"], entry["text"]) for entry in ENTRIES}) == len(ENTRIES)


def test_accepted_tasks_are_of_the_garment():
    for entry in CONTENT["instruction"]:
        assert entry["accept"], entry["id"]
        assert {SUITE.task(task_id).garment for task_id in entry["accept"]} == {entry["garment"]}, entry["id"]


def test_every_task_has_three_sentences():
    counts = Counter(task_id for entry in CONTENT["instruction"] for task_id in entry["accept"])
    assert [task.id for task in SUITE.tasks if counts[task.id] < 3] == []


@pytest.mark.parametrize("heading", ["instruction", "refuse"])
def test_about_a_third_is_held_out(heading):
    parts = [part_of_set(CONTENT, held_out)[heading] for held_out in (True, False)]
    assert len(parts[0]) + len(parts[1]) == len(CONTENT[heading])
    assert 0.25 < len(parts[0]) / len(CONTENT[heading]) < 0.4


@pytest.mark.parametrize(("option", "judged"), [("--held-out", 1), ("--developed", 2)])
def test_one_part_is_judged(option, judged, tmp_path, capsys):
    entry = '[[refuse]]\ngarment = "square"\ntext = "Wash the napkin."\n'
    path = tmp_path / "set.toml"
    path.write_text(f"{entry}\n{entry}held_out = false\n\n{entry}held_out = true\n", "utf-8")
    assert main(["--set", str(path), option, "--brief"]) == 0
    assert f"/{judged} (" in capsys.readouterr().out
