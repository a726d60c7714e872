import json

import pytest
from PIL import Image

import polyfold
from polyfold.cli import main
from polyfold.errors import ConfigError
from polyfold.logs._disk.files import picture_path
from polyfold.studies._cell import evaluate_cell
from polyfold.studies._cells import cells
from polyfold.studies._run import evaluate
from polyfold.viz._thumbnails import LIMIT, thumbnail

SMALL = {"name": "small", "tasks": ("square-corner-*",), "garments": 2, "first_seed": 2000, "edge_length": 0.03}
TIMES = {"seconds", "steps", "calls", "started", "finished", "peak_memory_mb", "picture"}


def untimed(record):
    return record.model_dump(exclude=TIMES)


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path_factory.getbasetemp() / "cache"))


@pytest.fixture
def study():
    return polyfold.ablate(polyfold.Study(**SMALL), "agent", ["fold-lines", "noop"])


def pictured(records):
    return {(record.variant, record.garment.seed) for record in records if record.picture}


def rendered(study, out, **options):
    """Run a study with its pictures."""
    return evaluate(study, out, render=thumbnail, **options)


def test_failures_and_the_first_garment_are_pictured_unless_asked_otherwise(study, tmp_path):
    default = rendered(study, tmp_path / "default", progress=False)
    assert pictured(default) == {("fold-lines", 2000), ("noop", 2000), ("noop", 2001)}
    for record in default:
        if record.picture:
            path = tmp_path / "default" / record.picture
            assert 0 < path.stat().st_size <= LIMIT
            with Image.open(path) as picture:
                assert picture.width // picture.height == record.folds + 1, "a panel per fold and the result"
    everything = rendered(study, tmp_path / "all", pictures="all", progress=False)
    assert all(record.picture for record in everything)
    assert not pictured(rendered(study, tmp_path / "none", pictures="none", progress=False))
    assert not (tmp_path / "none" / "pictures").exists()


def test_apart_from_the_picture_the_record_is_that_of_the_episode(study, tmp_path):
    cell = next(iter(cells(study)))
    (found, *_) = rendered(study, tmp_path, progress=False)
    plain, _ = evaluate_cell(study, cell)
    assert untimed(found) == untimed(plain)


def test_a_run_resumes_with_other_pictures_and_no_half_written_file_is_left(study, tmp_path):
    rendered(study, tmp_path, pictures="none", progress=False)
    lines = (tmp_path / "episodes.jsonl").read_text().splitlines(keepends=True)
    (tmp_path / "episodes.jsonl").write_text("".join(lines[:-2]) + lines[-2][:30])
    resumed = rendered(study, tmp_path, pictures="all", progress=False)
    assert sum(record.picture is not None for record in resumed) == 2
    assert all(path.suffix == ".webp" and not path.name.startswith(".") for path in (tmp_path / "pictures").iterdir())


def test_workers_send_pictures_back(study, tmp_path):
    records = rendered(study, tmp_path, workers=2, pictures="all", progress=False)
    assert all((tmp_path / record.picture).is_file() for record in records)


def test_unknown_choice_of_pictures(study, tmp_path):
    with pytest.raises(ConfigError, match="choose one of none, failed, all"):
        rendered(study, tmp_path, pictures="some", progress=False)


def test_paths_are_distinct_and_safe():
    keys = ["a, b/c/1/0", "a b/c/1/0", "../../x", "ä/ö", "x" * 300, "."]
    paths = [picture_path(key) for key in keys]
    assert len(set(paths)) == len(keys)
    for path in paths:
        name = path.removeprefix("pictures/")
        assert "/" not in name
        assert len(name) < 120
        assert not name.startswith(".")
        assert name.isascii()


def test_evaluate_then_report(tmp_path):
    config = tmp_path / "study.toml"
    config.write_text(
        'tasks = ["square-corner-top_left"]\nfirst_seed = 2000\nedge_length = 0.03\n[variants.noop]\nagent = "noop"\n'
    )
    assert main(["evaluate", str(config), "--out", str(tmp_path / "run"), "--pictures", "all"]) == 0
    assert main(["report", str(tmp_path / "run")]) == 0
    (record,) = polyfold.open(tmp_path / "run").records
    assert json.dumps(record.instruction)[1:-1] in (tmp_path / "run" / "report.html").read_text("utf-8")
