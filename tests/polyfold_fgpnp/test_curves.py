"""Learning curves: the study that trainings make, and what is drawn and tabulated of it."""

import itertools
import json
from fnmatch import fnmatch
from pathlib import Path

import numpy as np
import pytest
from polyfold_fgpnp.studies import curves
from polyfold_fgpnp.studies.curve_tables import sizes_table, training_table
from polyfold_fgpnp.studies.scores import Scores
from polyfold_fgpnp.studies.variants import Learned, few_tasks, learned
from polyfold_fgpnp.training.runs import read_run

import polyfold
from polyfold.errors import ConfigError
from polyfold.evaluation import suite
from polyfold.logs import RunDirectory, StudyEpisodeRecord
from polyfold.logs._records import MetricRecord
from polyfold.studies import Study, load

EPOCHS = 4
TASKS = ("square-corner-top_left", "pants-half-left")


def training(folder, seed, folds=None, data_folds=10000, snapshots=(2, 4)):
    """A folder as `polyfold train` leaves it; the weights are empty files."""
    data = folder.parent / "data"
    data.mkdir(exist_ok=True, parents=True)
    (data / "dataset.json").write_text(
        json.dumps({"schema_version": 2, "parameters": {}, "counts": {"folds": data_folds}})
    )
    folder.mkdir()
    config = {"data": [str(data)], "network": {"variant": "csam"}, "folds": folds, "seed": seed, "epochs": EPOCHS}
    (folder / "training.json").write_text(json.dumps({"config": config}))
    entries = [
        {"epoch": n, "loss": 1 / n + 0.1 * seed, "rank_correlation": 0.2 * n - 0.02 * seed, "validation_loss": 1.0}
        for n in range(1, EPOCHS + 1)
    ]
    (folder / "metrics.jsonl").write_text("".join(json.dumps(entry) + "\n" for entry in entries))
    for epoch in snapshots:
        (folder / f"weights-{epoch:04d}.safetensors").touch()
    (folder / "weights.safetensors").touch()
    return folder


def evaluated(folder, study, wins, garments=(0, 1, 2, 3)):
    """A run directory in which ``wins`` (variant, kind, garment seed) says what succeeds."""
    run = run_directory(folder, study)
    for variant, task, seed in itertools.product(study["variants"], study["tasks"], garments):
        run.append(record(variant, task, seed, bool(wins(variant, task.partition("-")[0], seed))))
    return folder


def run_directory(folder, study):
    metrics = {"moved-part": MetricRecord(label="moved part", unit="mm", digits=1, higher_is_better=False)}
    asked = {"study": Study(**study).model_dump(mode="json")}
    return RunDirectory(folder, asked, StudyEpisodeRecord, metrics=metrics, criteria={"lenient": ()})


def record(variant, task, seed, won):
    kind = task.partition("-")[0]
    return StudyEpisodeRecord(
        key=f"{variant}/{task}/{seed}/0",
        variant=variant,
        task=task,
        type="T-Half",
        split=None,
        steps_wanted=1,
        wording=0,
        instruction=f"Do {task}.",
        garment={"kind": kind, "name": f"{kind}-{seed:04d}", "seed": seed, "size_m": 0.4, "particles": 500},
        pose_seed=0,
        agent_seed=0,
        agent="oracle",
        privileged=True,
        subgoals=(),
        steps=(),
        failure=None,
        seconds={},
        started=None,
        finished=None,
        processor=None,
        metrics={"moved-part": 5.0 if won else 50.0},
        success={"lenient": won},
        cause=None if won else "policy",
        peak_memory_mb=None,
    )


def study(points):
    variants = {"affordance-pair": {"policy": "affordance-pair"}} | {
        point.variant: {"policy": "csam+caso"} for point in points
    }
    return {"name": "made-up", "tasks": TASKS, "garments": 4, "variants": variants}


def cells(markdown, first):
    line = next(line for line in markdown.splitlines() if line.startswith(f"| {first} |"))
    return [cell.strip() for cell in line.strip("| ").split("|")]


def test_a_study_of_trainings_folds_with_each_of_their_weights_and_without(tmp_path, capsys):
    runs = [str(training(tmp_path / f"s{seed}", seed)) for seed in (0, 1)]
    assert curves.main(["study", *runs, "--garments", "2", "--name", "x"]) == 0
    file = tmp_path / "x.toml"
    file.write_text(capsys.readouterr().out)
    found = load(file)
    wanted = {Learned(10000, seed, epoch).variant: seed for seed in (0, 1) for epoch in (2, 4)}
    assert set(found.variants) == {"affordance-pair", *wanted}
    assert (found.garments, found.reference, len(found.tasks)) == (2, "ideal", 20)
    policy = found.variants["folds=10000,seed=1,epoch=2"]["policy"]
    assert policy == {"name": "csam+caso", "weights": f"{runs[1]}/weights-0002.safetensors"}
    assert curves.main(["study", *runs, "--last", "--steps", "multi"]) == 0
    file.write_text(capsys.readouterr().out)
    assert len(load(file).variants) == 3
    known = {task.id: task for task in suite("polyfold70").entries}
    assert all(len(known[task].steps) > 1 for task in load(file).tasks)


def test_the_chosen_tasks_are_the_same_number_of_every_kind_and_spread_over_the_ids():
    chosen = few_tasks(5)
    for kind in ("square", "rectangle", "tshirt", "pants"):
        ids = sorted(task.id for task in suite("polyfold70").entries if task.garment == kind)
        places = [ids.index(task) for task in chosen if fnmatch(task, f"{kind}-*")]
        assert len(places) == 5
        assert np.ptp(np.diff(places)) <= 1, "even steps"
        assert abs(places[0] - (len(ids) - 1 - places[-1])) <= 1, "both ends alike"
    assert len(few_tasks(99)) == 70


def test_two_trainings_that_can_t_be_told_apart_are_refused(tmp_path, capsys):
    runs = [str(training(tmp_path / name, 0)) for name in ("a", "b")]
    assert curves.main(["study", *runs]) == 1
    assert "second training" in capsys.readouterr().err


def test_the_folds_of_a_training_are_those_it_used(tmp_path):
    assert read_run(training(tmp_path / "a", 0, folds=2500)).folds == 2500
    assert read_run(training(tmp_path / "b", 0, folds=20000)).folds == 10000
    with pytest.raises(ConfigError, match="holds no training"):
        read_run(tmp_path / "data")
    (tmp_path / "data").rename(tmp_path / "elsewhere")
    with pytest.raises(ConfigError, match="where the training was run"):
        read_run(tmp_path / "a")


def test_the_folds_of_a_training_on_a_packed_data_set_are_told_too(tmp_path):
    published = Path(__file__).parents[2] / "experiments" / "data" / "folds-1sam-0.zip"
    run = training(tmp_path / "a", 0)
    note = json.loads((run / "training.json").read_text())
    note["config"]["data"] = [str(published)]
    (run / "training.json").write_text(json.dumps(note))
    assert read_run(run).folds == 2292
    published = tmp_path / "none.zip"
    published.write_bytes(b"no archive")
    note["config"]["data"] = [str(published)]
    (run / "training.json").write_text(json.dumps(note))
    with pytest.raises(ConfigError, match="damaged"):
        read_run(run)


def test_names_of_variants_are_read_back():
    assert learned(Learned(2500, 3, 60).variant) == Learned(2500, 3, 60)
    assert learned("affordance-pair") is None


def test_the_training_curve_is_mean_and_deviation_over_seeds(tmp_path, capsys):
    runs = [training(tmp_path / f"s{seed}", seed) for seed in (0, 2)]
    points = [Learned(10000, seed, epoch) for seed in (0, 2) for epoch in (2, 4)]

    def wins(variant, kind, seed):
        point = learned(variant)
        return point is None or (kind == "square" if point.epoch == 2 else seed < 3 or point.seed == 2)

    out = evaluated(tmp_path / "evaluation", study(points), wins)
    png = tmp_path / "training.png"
    assert curves.main(["training", *map(str, runs), "--evaluation", str(out), "--out", str(png)]) == 0
    text = capsys.readouterr().out
    assert cells(text, 2)[:6] == ["2", "0.600 ± 0.141", "0.380 ± 0.028", "2", "100.0 ± 0.0", "0.0 ± 0.0"]
    assert cells(text, 4)[3:7] == ["2", "87.5 ± 17.7", "87.5 ± 17.7", "87.5 ± 17.7"]
    assert cells(text, "affordance-pair")[4:7] == ["100.0", "100.0", "100.0"]
    assert "the same 8 episodes: 2 tasks, 8 garments" in text
    assert png.stat().st_size > 10_000
    assert len(training_table([read_run(run) for run in runs]).rows) == EPOCHS


def test_data_sizes_are_compared_after_the_last_epoch(tmp_path, capsys):
    points = [Learned(2500, 0, 4), Learned(10000, 0, 2), Learned(10000, 0, 4)]
    out = evaluated(
        tmp_path / "evaluation", study(points), lambda variant, kind, seed: "10000" in variant and "epoch=4" in variant
    )
    assert curves.main(["sizes", str(out), "--out", str(tmp_path / "sizes.png")]) == 0
    text = capsys.readouterr().out
    assert cells(text, 2500)[1:] == ["1", "0.0", "0.0", "0.0", "0.0 [0.0, 0.0]"]
    assert cells(text, 10000)[1:] == ["1", "100.0", "100.0", "100.0", "100.0 [100.0, 100.0]"]
    assert (tmp_path / "sizes.png").stat().st_size > 10_000
    assert curves.main(["sizes", str(out), "--score", "moved-part", "--out", str(tmp_path / "sizes.png")]) == 0
    text = capsys.readouterr().out
    assert "| all, moved part [mm] |" in text
    assert cells(text, 10000)[4] == "5.0"
    assert cells(text, "affordance-pair")[4] == "50.0"
    run = training(tmp_path / "s0", 0)
    assert curves.main(["training", str(run), "--evaluation", str(out)]) == 1
    assert "several data sizes" in capsys.readouterr().err
    assert curves.main(["sizes", str(out), "--score", "moved-prt"]) == 1
    assert "did you mean 'moved-part'" in capsys.readouterr().err


def test_only_episodes_count_that_every_variant_has(tmp_path):
    made = study([Learned(10000, 0, 4)])
    out = evaluated(tmp_path / "evaluation", made, lambda variant, kind, seed: seed == 0, garments=(0,))
    run_directory(out, made).append(record("affordance-pair", TASKS[0], 1, False))
    found = Scores(polyfold.open(out))
    assert len(found.episodes) == 2
    assert found.mean("affordance-pair") == 100.0


def test_the_interval_draws_garments_and_not_episodes(tmp_path):
    many = {**study([Learned(10000, 0, 4)]), "tasks": tuple(few_tasks(99))}
    out = evaluated(tmp_path / "evaluation", many, lambda variant, kind, seed: seed % 2)
    last = sizes_table(Scores(polyfold.open(out))).rows[0][-1]
    low, high = map(float, last.partition("[")[2].rstrip("]").split(", "))
    assert high - low > 30, "16 garments, half of which always fail: 280 independent episodes would give 12"
