"""Fabric as an axis of studies: varied, recorded, part of what a run and the oracle's cache belong to."""

import json

import pytest

import polyfold
from polyfold.errors import ConfigError, PluginError
from polyfold.evaluation import suite
from polyfold.evaluation._references import ideal_reference, reference_for
from polyfold.logs import read_episodes, read_run
from polyfold.studies._run import evaluate
from polyfold.studies._study import experiment_of, made_of

SMALL = {"name": "small", "tasks": ("square-corner-top_left",), "first_seed": 2000, "edge_length": 0.03}
TASK = suite("polyfold70").task("square-corner-top_left")


@pytest.fixture(autouse=True)
def references(tmp_path, monkeypatch):
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "references"


def test_fabric_is_an_axis_and_every_record_says_what_lay_on_the_table(tmp_path, references):
    base = polyfold.Study(**SMALL, reference="oracle", base={"agent": "oracle"})
    study = polyfold.ablate(base, "fabric", ["jersey", "denim"])
    results = polyfold.run(study, tmp_path / "run", progress=False)
    fabrics = {record.variant: record.garment.fabric for record in results.records}
    assert {variant: fabric.name for variant, fabric in fabrics.items()} == {"jersey": "jersey", "denim": "denim"}
    assert fabrics["denim"].constants["thickness"] == 0.00095
    assert all(record.metrics["mppe"] == 0.0 for record in results.records), "each is compared with its own oracle"
    assert len(list(references.iterdir())) == 2
    components = read_run(tmp_path / "run").components
    assert components["denim"]["fabric"].params["thickness"] == 0.00095
    assert results.dataframe()["fabric"].tolist() == ["jersey", "denim"]


def test_a_constant_varies_on_whatever_each_kind_is_made_of():
    study = polyfold.ablate(polyfold.Study(**SMALL), "fabric.thickness", [0.0008, 0.002])
    fabric = experiment_of(study, "0.002").fabric
    assert polyfold.plugins.make_fabric(fabric, "tshirt").bending_length_warp == 0.012
    assert polyfold.plugins.make_fabric(fabric, "pants").bending_length_warp == 0.020
    with pytest.raises(ConfigError, match=r"did you mean 'fabric\.thickness'"):
        polyfold.ablate(polyfold.Study(**SMALL), "fabric.thicknes", [0.002])
    with pytest.raises(ConfigError, match=r"use fabric\.thickness instead"):
        polyfold.ablate(polyfold.Study(**SMALL), "simulator.thickness", [0.002])


def test_a_run_belongs_to_its_fabric_and_is_resumed_with_it(tmp_path):
    study = polyfold.Study(**SMALL, base={"agent": "noop"})
    first = evaluate(study, tmp_path / "run", progress=False)
    assert evaluate(study, tmp_path / "run", progress=False) == first
    with pytest.raises(ConfigError, match=r"study\.base\.fabric"):
        evaluate(made_of(study, "felt"), tmp_path / "run", progress=False)
    assert read_run(tmp_path / "run").components["polyfold"]["fabric of square"].name == "poplin"


def test_an_unknown_fabric_is_refused_before_anything_is_folded(tmp_path):
    with pytest.raises(PluginError, match="no fabric is called 'demin'; did you mean 'denim'"):
        evaluate(polyfold.Study(**SMALL, base={"fabric": "demin"}), tmp_path / "run", progress=False)
    with pytest.raises(ConfigError, match="thickness"):
        evaluate(polyfold.Study(**SMALL, base={"fabric.thickness": 3}), tmp_path / "run", progress=False)


def test_logs_from_before_garments_had_a_fabric_are_read(tmp_path):
    run = tmp_path / "run"
    polyfold.run(polyfold.Study(**SMALL, base={"agent": "noop"}), run, progress=False)
    episode = json.loads((run / "episodes.jsonl").read_text())
    del episode["garment"]["fabric"]
    (run / "episodes.jsonl").write_text(json.dumps(episode) + "\n")
    (record,) = read_episodes(run)
    assert record.garment.fabric is None
    assert polyfold.open(run).dataframe()["fabric"].isna().all()


def test_the_oracle_s_cache_keeps_fabrics_apart(references):
    simulator = polyfold.Experiment().simulator
    thin, thick = (polyfold.garment("square", seed=2000, edge_length=0.03, fabric=name) for name in ("poplin", "felt"))
    for cloth in (thin, thick, thick):
        reference_for(TASK, cloth, 2000, simulator)
    assert len(list(references.iterdir())) == 2


def test_ideal_references_are_as_high_as_the_fabric(references):
    thick = polyfold.garment("square", seed=2000, edge_length=0.03, fabric={"name": "felt", "thickness": 0.003})
    simulator = polyfold.plugins.create("simulators", "xpbd")
    simulator.reset(thick, 2000)
    heights = ideal_reference(TASK, thick, simulator.state()).outcome.end.positions[:, 2]
    assert heights.max() - heights.min() == pytest.approx(0.003)


def test_evaluate_makes_all_variants_of_a_fabric_but_those_that_name_one():
    study = polyfold.Study(**SMALL, base={"fabric.weight": 0.5}, variants={"all": {}, "own": {"fabric": "felt"}})
    changed = made_of(study, "denim")
    assert experiment_of(changed, "all").fabric.name == "denim"
    assert experiment_of(changed, "all").fabric.params == {"weight": 0.5}
    assert experiment_of(changed, "own").fabric.name == "felt"
