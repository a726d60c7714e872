import pytest
from made_up_runs import BAD, GOOD, TASKS, picture, record, run_record

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
        (folder / "run.json").write_text(run_record(study).model_dump_json())
        lines = []
        for number, made in enumerate(records):
            if pictured:
                path = f"pictures/{number}.webp"
                (folder / path).write_bytes(picture())
                made = made.model_copy(update={"picture": path})
            lines.append(made.model_dump_json() + "\n")
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
