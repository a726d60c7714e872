"""Held-out garments: picks are compared within states, garments are drawn whole, and what was folded is kept."""

import json
import shutil

import numpy as np
import pytest
from few_folds import interaction
from polyfold_fgpnp.data.dataset import Dataset, DatasetFolder, load_dataset
from polyfold_fgpnp.policies.actions import PickConfig
from polyfold_fgpnp.policies.affordance import affordance
from polyfold_fgpnp.policies.networks import NetworkConfig
from polyfold_fgpnp.policies.region import fold_region
from polyfold_fgpnp.training.config import TrainingConfig
from polyfold_fgpnp.training.training import train

import polyfold
from experiments.benchmarks.policies import heldout
from experiments.benchmarks.policies.heldout_tables import correlation_table, over_garments, regret_table, tried
from polyfold import analysis, plugins
from polyfold.errors import PlanError
from polyfold.logs import JsonLines


@pytest.fixture(scope="module")
def folder(folds_folder, tmp_path_factory):
    """A data set of its own, in which the policies' folds are kept."""
    return shutil.copytree(folds_folder, tmp_path_factory.mktemp("heldout") / "folds")


def with_outcomes(folds, flap_mm):
    return Dataset(folds.description, {**folds.columns, "flap_mm": flap_mm.astype(np.float32), "rest_mm": 0 * flap_mm})


def column(table, name):
    return {row[0]: row[table.headers.index(name)] for row in table.rows}


def mean(cell):
    return float(cell.partition(" ")[0])


def test_tables_of_policies_and_maps(folder, capsys):
    network = NetworkConfig(variant="csam", base=4, levels=2)
    weights = train(TrainingConfig(data=(str(folder),), network=network, epochs=1), folder / "t", "cpu", progress=False)
    heldout.main([str(folder), "affordance-pair", f"csam+caso={weights}"])
    text = capsys.readouterr().out
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("| ")]
    first, second = (rows[:4], rows[4:])
    assert [row[0] for row in first[1:]] == ["distance", "affordance", f"csam+caso={weights}"]
    assert [row[0] for row in second[1:]] == [
        "random first pick",
        "affordance-pair",
        rows[3][0],
        "best of the picks tried",
    ]
    table = dict(zip((row[0] for row in second[1:]), second[1:], strict=True))
    data = load_dataset(folder)
    outcomes = [data.error_mm[trials] for trials in tried(data)]
    executed = [record["error_mm"] for record in JsonLines(folder / "policies" / "affordance-pair.jsonl").read()]
    for name, errors in (
        ("random first pick", [found.mean() for found in outcomes]),
        ("best of the picks tried", [found.min() for found in outcomes]),
        ("affordance-pair", executed),
    ):
        assert table[name][1] == str(data.states)
        assert mean(table[name][2]) == pytest.approx(np.mean(errors), abs=0.06), name
    assert "over 2 garments" in text


def test_a_policy_that_refuses_counts_as_leaving_the_cloth_as_it_is(folder):
    polyfold.register("policies", "refusing", Refusing, "a test's policy")
    try:
        heldout.main([str(folder), "refusing"])
    finally:
        plugins.unregister("policies", "refusing")
    records = JsonLines(folder / "policies" / "refusing.jsonl").read()
    errors = [error for record in sorted(records, key=lambda record: record["job"]) for error in record["error_mm"]]
    assert errors == pytest.approx(load_dataset(folder)["travel_mm"], rel=1e-6)


class Refusing:
    """Picks nowhere."""

    def act(self, fold_line, scene, rng):
        raise PlanError("nothing to see here; move on")


def test_what_was_folded_is_kept_and_not_folded_again(folder, capsys):
    heldout.main([str(folder), "affordance-pair"])
    before = capsys.readouterr().out
    kept = folder / "policies" / "affordance-pair.jsonl"
    records = [json.loads(line) for line in kept.read_text().splitlines()]
    assert [len(record["error_mm"]) for record in records] == [4, 4]
    changed = [{**record, "error_mm": [999.0] * 4} for record in records]
    kept.write_text("".join(json.dumps(record) + "\n" for record in changed) + '{"job": 0, "fl')
    heldout.main([str(folder), "affordance-pair"])
    assert "| affordance-pair | 8 | 999.0 [999.0, 999.0] |" in capsys.readouterr().out
    kept.unlink()
    heldout.main([str(folder), "affordance-pair"])
    assert capsys.readouterr().out == before


def test_states_that_come_out_differently_today_are_refused(folds, folds_folder, tmp_path):
    shutil.copytree(folds_folder / "shards", tmp_path / "shards")
    changed = DatasetFolder(tmp_path, interaction().model_dump(mode="json"))
    with np.load(tmp_path / "shards" / "00001.npz") as shard:
        changed.write(1, {**shard, "travel_mm": 1.1 * shard["travel_mm"]})
    changed.finish()
    with pytest.raises(SystemExit, match="can't be made again"):
        heldout.main([str(tmp_path), "affordance-pair"])


def test_a_prediction_that_orders_all_picks_right_has_rank_correlation_one(folds):
    distances = np.array([folds.line(s).distance(p) for s, p in zip(folds["trial_state"], folds["first"], strict=True)])
    table = correlation_table(with_outcomes(folds, 100 - distances), {})
    assert mean(column(table, "particles: median")["distance"]) == 1.0
    assert mean(column(table, "particles: mean")["distance"]) == 1.0
    reversed_ = correlation_table(with_outcomes(folds, 1 + distances), {})
    assert mean(column(reversed_, "particles: median")["distance"]) == -1.0
    assert column(table, "states")["distance"] == str(folds.states)
    assert column(table, "picks")["distance"] == "3-3"


def test_the_prediction_by_affordance_orders_picks_by_affordance(folds):
    scores = []
    for state, first, second in zip(folds["trial_state"], folds["first"], folds["second"], strict=True):
        region = fold_region(folds.line(state), folds.scene(state))
        scores.append(affordance(region, first.astype(float), second.astype(float), PickConfig().gamma))
    table = correlation_table(with_outcomes(folds, 2000 * (2 - np.array(scores))), {})
    assert mean(column(table, "particles: mean")["affordance"]) == 1.0


def test_regret_is_against_the_picks_tried_whoever_else_is_there(folds):
    best = np.array([folds.error_mm[trials].min() for trials in tried(folds)], float)
    errors = {"worse": best + 7.0}
    alone = column(regret_table(folds, errors), "regret [mm]")
    beside = column(regret_table(folds, {**errors, "perfect": np.zeros_like(best)}), "regret [mm]")
    assert alone["worse"] == beside["worse"] == "7.0 [7.0, 7.0]"
    assert mean(beside["perfect"]) == pytest.approx(-best.mean(), abs=0.06)


def test_a_fold_that_diverged_is_left_out_and_shows_in_the_count(folds):
    errors = np.full(folds.states, 5.0)
    errors[0] = np.nan
    table = regret_table(folds, {"first": np.full(folds.states, 4.0), "policy": errors})
    assert column(table, "states")["policy"] == str(folds.states - 1)
    assert column(table, "less first [mm]")["policy"] == "+1.0 [1.0, 1.0]"


def test_intervals_draw_whole_garments(folds):
    many = Dataset(folds.description, {"garment_seed": np.repeat(np.arange(10), 50)})
    values = np.repeat(np.arange(10) % 2, 50).astype(float)
    found, naive = over_garments(many, values), analysis.mean(values.tolist())
    assert found.mean == naive.mean == 0.5
    assert found.high - found.low > 4 * (naive.high - naive.low)
    values[:50] = np.nan
    assert over_garments(many, values).mean == pytest.approx(5 / 9)
