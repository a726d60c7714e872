import json
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import polyfold
from polyfold.config import ComponentSpec
from polyfold.errors import ConfigError, GroundingError, SimulationError
from polyfold.evaluation import suite
from polyfold.evaluation._references import reference_for
from polyfold.logs import read_run
from polyfold.studies._cells import cells
from polyfold.studies._run import evaluate
from polyfold.studies._study import experiment_of

SMALL = {"name": "small", "tasks": ("square-corner-*",), "garments": 2, "first_seed": 2000, "edge_length": 0.03}
TIMES = {"seconds", "calls", "started", "finished", "peak_memory_mb"}


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("POLYFOLD_CACHE", str(tmp_path_factory.getbasetemp() / "cache"))


def untimed(records):
    """All that is not a time; steps are without their seconds."""
    dumped = [record.model_dump(exclude=TIMES) for record in records]
    return [{**record, "steps": [{**step, "seconds": None} for step in record["steps"]]} for record in dumped]


def test_cells_are_every_combination_once_with_seeds_of_their_own():
    study = polyfold.ablate(polyfold.Study(**SMALL), "policy", ["affordance-pair", "farthest"])
    found = list(cells(study))
    assert len({cell.key for cell in found}) == len(found) == 4 * 2 * 2
    assert [cell.agent_seed for cell in found] == [cell.agent_seed for cell in cells(study)]
    assert {cell.wording for cell in found} == {0, 1}, "the wordings take turns"


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("polcy", "sets 'polcy'; did you mean 'policy'"),
        ("policy.gama", "did you mean 'policy.gamma'"),
        ("fabric.thicknes", "did you mean 'fabric.thickness'"),
        ("simulator.thickness", "use fabric.thickness instead"),
        ("guidance.words", "'guidance' has no parameters"),
    ],
)
def test_a_mistyped_override_names_the_path_and_the_nearest_right_one(path, says):
    with pytest.raises(ConfigError, match=says):
        polyfold.ablate(polyfold.Study(**SMALL), path, [1])


def test_an_override_fills_in_a_table_among_the_parameters():
    base = {"simulator": {"name": "pybullet", "arms": {"speed": 0.5}}}
    study = polyfold.ablate(polyfold.Study(**SMALL, base=base), "simulator.arms.robot", ["panda", "yumi"])
    arms = [experiment_of(study, variant).simulator.params["arms"] for variant in study.variants]
    assert arms == [{"speed": 0.5, "robot": "panda"}, {"speed": 0.5, "robot": "yumi"}]


def test_grid_combines_settings():
    study = polyfold.grid(
        polyfold.Study(**SMALL), {"policy": ["affordance-pair", "farthest"], "policy.gamma": [0.0, 0.04]}
    )
    assert len(study.variants) == 4
    assert experiment_of(study, "farthest, 0.0").policy.params == {"gamma": 0.0}


def test_study_files_say_what_is_wrong(tmp_path):
    path = tmp_path / "study.toml"
    for text, says in (("garmnts = 3", "did you mean 'garments'"), ("garments = 0", "garments"), ("x = [", "TOML")):
        path.write_text(text)
        with pytest.raises(ConfigError, match=says):
            polyfold.load(path)
    path.write_text('tasks = ["tshrt-*"]')
    with pytest.raises(ConfigError, match="no task of 'polyfold70' matches"):
        list(cells(polyfold.load(path)))


def test_oracle_is_perfect_beside_itself_and_noop_never_succeeds(tmp_path):
    study = polyfold.ablate(polyfold.Study(**SMALL, reference="oracle"), "agent", ["oracle", "noop"])
    results = polyfold.run(study, tmp_path, progress=False)
    perfect = {"miou": 1.0, "moved-part": 0.0, "mppe": 0.0}
    assert all({name: record.metrics[name] for name in perfect} == perfect for record in results.of("oracle"))
    assert not any(record.succeeded for record in results.of("noop"))
    text = polyfold.table(results).markdown()
    assert "| oracle * | square | 8 |" in text, "privileged agents are marked"
    difference = polyfold.compare(results, "oracle", "noop")
    assert dict(zip(difference.headers, difference.rows[-1], strict=True))["success %"].startswith("+100.0")


def test_two_workers_give_the_same_as_one_and_the_table_prints_in_every_format(tmp_path):
    study = polyfold.Study(**SMALL)
    one = evaluate(study, tmp_path / "one", progress=False)
    two = evaluate(study, tmp_path / "two", workers=2, progress=False)
    assert untimed(one) == untimed(two)
    table = polyfold.table(polyfold.open(tmp_path / "two"))
    assert table.csv().count("\n") == table.markdown().count("| polyfold |") == 2
    assert "<td>square</td>" in table.html()
    assert r"success \%" in table.latex()


def test_killed_at_any_moment_it_goes_on_without_loss_or_repetition(tmp_path):
    config = tmp_path / "study.toml"
    config.write_text(
        'name = "small"\ntasks = ["square-corner-*"]\ngarments = 3\nfirst_seed = 2000\nedge_length = 0.03\n'
    )
    command = [sys.executable, "-m", "polyfold", "evaluate", str(config), "--out", str(tmp_path / "run")]
    episodes = tmp_path / "run" / "episodes.jsonl"
    for more in (1, 3):
        before = episodes.read_bytes().count(b"\n") if episodes.exists() else 0
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and child.poll() is None:
            if episodes.exists() and episodes.read_bytes().count(b"\n") >= before + more:
                break
            time.sleep(0.01)
        os.kill(child.pid, signal.SIGKILL)
        child.wait()
    resumed = polyfold.run(polyfold.load(config), tmp_path / "run", progress=False).records
    keys = [json.loads(line)["key"] for line in episodes.read_text().splitlines()]
    assert len(keys) == len(set(keys)) == 12
    assert polyfold.run(polyfold.load(config), tmp_path / "run", workers=2, progress=False).records == resumed, (
        "nothing is missing"
    )
    undisturbed = polyfold.run(polyfold.load(config), tmp_path / "other", progress=False).records
    assert untimed(resumed) == untimed(undisturbed)


def test_a_component_of_a_notebook_reaches_worker_processes(tmp_path):
    class Local:
        """Picks the lifted point that is farthest to the right."""

        def act(self, fold_line, scene, rng):
            lifted = scene.contour[fold_line.lifts(scene.contour)]
            pick = lifted[lifted[:, 0].argmax()]
            return polyfold.Action([pick], [fold_line.mirror(pick)])

    polyfold.register("policies", "local", Local)
    study = polyfold.Study(**SMALL, base={"policy": "local"})
    try:
        alone = evaluate(study, tmp_path / "one", progress=False)
        together = evaluate(study, tmp_path / "two", workers=2, progress=False)
        assert read_run(tmp_path / "one").fingerprint == read_run(tmp_path / "two").fingerprint
    finally:
        polyfold.plugins.unregister("policies", "local")
    assert untimed(alone) == untimed(together)


def test_a_component_that_cannot_be_sent_is_refused_by_workers_that_need_it_with_the_reason(tmp_path):
    lock = threading.Lock()

    class Local:
        def act(self, fold_line, scene, rng):
            with lock:
                raise NotImplementedError

    polyfold.register("policies", "local", Local)
    try:
        with pytest.raises(ConfigError, match="such as a lock"):
            evaluate(polyfold.Study(**SMALL, base={"policy": "local"}), tmp_path / "used", workers=2, progress=False)
        unused = polyfold.Study(**{**SMALL, "garments": 1}, base={"agent": "noop"})
        assert len(evaluate(unused, tmp_path / "unused", workers=2, progress=False)) == 4
    finally:
        polyfold.plugins.unregister("policies", "local")


def test_cloth_that_is_out_of_sight_scores_nothing_and_the_study_goes_on(tmp_path):
    class Blind:
        """Sees no cloth, as when it was carried out of the picture."""

        def segment(self, observation):
            raise GroundingError("no cloth is in sight; put it back on the table")

    polyfold.register("segmenters", "blind", Blind)
    try:
        study = polyfold.Study(**SMALL, base={"agent": "noop", "segmenter": "blind"})
        records = evaluate(study, tmp_path, progress=False)
    finally:
        polyfold.plugins.unregister("segmenters", "blind")
    assert [record.metrics["miou"] for record in records] == [0.0] * 8
    assert not any(record.succeeded for record in records)


def test_a_policy_that_places_outside_the_image_fails_its_episode_and_no_study(tmp_path):
    class Astray:
        def act(self, fold_line, scene, rng):
            return polyfold.Action([[200.0, 200.0]], [[-50.0, 200.0]])

    polyfold.register("policies", "astray", Astray)
    try:
        study = polyfold.Study(**{**SMALL, "garments": 1}, base={"policy": "astray"})
        records = evaluate(study, tmp_path, progress=False)
    finally:
        polyfold.plugins.unregister("policies", "astray")
    assert {record.failure.stage for record in records} == {"policy"} == {record.cause for record in records}
    assert all("inside" in record.failure.reason for record in records)


def test_a_run_needs_a_worker(tmp_path):
    with pytest.raises(ConfigError, match="give 1 or more"):
        evaluate(polyfold.Study(**SMALL), tmp_path, workers=0)


def test_references_have_no_faults():
    task = suite("polyfold70").task("square-corner-top_left")
    cloth = polyfold.garment("square", seed=2000, edge_length=0.03)
    plain = reference_for(task, cloth, 2000, ComponentSpec(name="xpbd"))
    faulty = reference_for(
        task, cloth, 2000, ComponentSpec(name="faulty", params={"miss": 1.0, "inner_params": {"order": 3}})
    )
    assert (plain.outcome.end.positions == faulty.outcome.end.positions).all()
    assert np.abs(plain.outcome.end.positions - plain.outcome.start.positions).max() > 0.05


def test_tasks_are_chosen_by_split_and_number_of_folds():
    def chosen(**settings):
        return {cell.task for cell in cells(polyfold.Study(name="some", **settings))}

    assert len(chosen(steps="multi")) == 43
    assert len(chosen(steps="multi", split="seen")) == 21
    assert chosen(steps="single") == chosen() - chosen(steps="multi")
    with pytest.raises(ConfigError, match="widen one of them"):
        chosen(tasks=("tshirt-block-*",), steps="single")


def test_the_same_folds_with_the_particles_in_another_order_give_the_noise_floor(tmp_path):
    base = polyfold.Study(**{**SMALL, "garments": 1}, base={"agent": "fold-lines"})
    results = polyfold.run(polyfold.ablate(base, "simulator.order", [1, 5]), tmp_path, progress=False)
    one, other = ([record.metrics["mppe"] for record in results.of(name)] for name in ("1", "5"))
    apart = np.abs(np.subtract(one, other))
    assert (apart > 0).all(), "another order"
    assert (apart < 5).all(), "the same physics"
    floor = polyfold.table(results, noise=results).note.partition("Noise floor")[2]
    assert "(n=4: square) differ by success %" in floor
    assert f"MPPE [mm] {apart.mean():.1f}" in floor


def test_against_the_ideal_a_good_fold_is_near_but_not_perfect(tmp_path):
    settings = {**SMALL, "garments": 1, "edge_length": 0.02}
    study = polyfold.Study(**settings, base={"agent": "oracle"})
    results = polyfold.run(study, tmp_path, progress=False)
    assert all(record.succeeded for record in results.records)
    assert all(record.metrics["mppe"] > 0.5 for record in results.records)
    assert "folded geometrically" in polyfold.table(results).note


def test_parameters_of_metrics_count_and_wrong_ones_are_refused(tmp_path):
    moved = {"agent": "fold-lines", "simulator": {"name": "faulty", "displace": 1.0}}
    one = {"garments": 1, "tasks": ("square-corner-top_left",), "reference": "oracle"}
    quick = {**SMALL, **one, "base": moved}
    plain, aligned = (
        polyfold.run(polyfold.Study(**quick, metrics=metrics), tmp_path / name, progress=False).records[0]
        for name, metrics in (("plain", {}), ("aligned", {"mppe": {"align": True}}))
    )
    assert aligned.metrics["mppe"] < 0.2 < 5 < plain.metrics["mppe"], "only the place on the table differs"
    assert aligned.metrics["moved-part"] == plain.metrics["moved-part"]
    with pytest.raises(ConfigError, match="did you mean 'align'"):
        list(cells(polyfold.Study(**quick, metrics={"mppe": {"aline": True}})))


def test_an_oracle_that_diverges_is_recorded_and_ends_no_study(tmp_path, monkeypatch):
    def diverges(*_):
        raise SimulationError("the cloth diverged; report it")

    monkeypatch.setattr("polyfold.studies._cell.reference_for", diverges)
    study = polyfold.Study(**{**SMALL, "garments": 1}, reference="oracle")
    records = evaluate(study, tmp_path, progress=False)
    assert [record.cause for record in records] == ["infrastructure"] * 4
    assert "the oracle failed" in records[0].failure.reason
    assert "–" in polyfold.table(polyfold.open(tmp_path)).markdown()


def test_policies_that_pick_at_vertices_run_on_oracle_fold_lines(tmp_path):
    base = {"agent": {"name": "fold-lines", "ground": True}, "policy": "vertex-random"}
    study = polyfold.Study(**{**SMALL, "garments": 1}, base=base)
    assert not any(record.failure for record in evaluate(study, tmp_path, progress=False))


def test_tables_by_step_and_beside_published_figures(tmp_path):
    settings = {"tasks": ("square-corner-top_left", "square-corners-*left*right*"), "garments": 1}
    study = polyfold.Study(**{**SMALL, **settings}, published={"paper": {"square": 94.0, "pants": 79.6}})
    results = polyfold.run(study, tmp_path, progress=False)
    assert {record.task for record in results.of_length("single").records} == {"square-corner-top_left"}
    assert len(results.of_length("single").records) + len(results.of_length("multi").records) == len(results.records)
    by_step = polyfold.table(results, groups="step").markdown()
    assert "step 2" in by_step
    table = polyfold.table(results)
    published = [dict(zip(table.headers, row, strict=True)) for row in table.rows if row[0] == "paper"]
    shown = [{column: entry for column, entry in row.items() if entry != "–"} for row in published]
    assert shown == [{"variant": "paper", "kind": "square", "success %": "94.0"}], "no pants were folded"
    assert "moved part [mm]" in polyfold.table(results, columns=["moved-part"]).headers
    with pytest.raises(ConfigError, match="did you mean 'moved-part'"):
        polyfold.table(results, columns=["moved"])
    with pytest.raises(ConfigError, match="choose from success %, strict %, MPPE"):
        polyfold.table(results, columns=["elapsed"])
