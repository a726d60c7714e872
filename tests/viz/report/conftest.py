import json

import pytest
from made_up_runs import BAD, GOOD, TASKS, picture, record

from polyfold.studies import Study


@pytest.fixture
def make_run(tmp_path):
    """Writes a run directory: ``make_run(records, variants)``; pictured records get a picture."""

    def make(records, variants, pictured=True, tail=""):
        study = Study(
            name="made-up",
            tasks=tuple(TASKS),
            garments=2,
            first_seed=2000,
            seed=11,
            variants={variant: {} for variant in variants},
        )
        folder = tmp_path / "run"
        (folder / "pictures").mkdir(parents=True)
        content = {
            "schema_version": 1,
            "config": {"study": study.model_dump(mode="json")},
            "versions": {"numpy": "2.4.6"},
        }
        (folder / "run.json").write_text(json.dumps(content))
        lines = []
        for number, made in enumerate(records):
            if pictured:
                path = f"pictures/{number}.webp"
                (folder / path).write_bytes(picture())
                made = {**made, "picture": path}
            lines.append(json.dumps(made) + "\n")
        (folder / "episodes.jsonl").write_text("".join(lines) + tail)
        return folder

    return make


@pytest.fixture
def full_run(make_run):
    """Two variants on three tasks and two garments: the first is good, the second fails."""
    records = [
        record(variant, task, seed, metrics)
        for variant, metrics in (("ours", GOOD), ("theirs", BAD))
        for task in TASKS
        for seed in (2000, 2001)
    ]
    return make_run(records, ["ours", "theirs"])
