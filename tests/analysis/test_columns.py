"""A metric and a criterion of a plugin stand in every table and picture as the bundled ones do."""

import csv
import json
from typing import ClassVar

import numpy as np
import pytest

import polyfold
from polyfold import plugins
from polyfold.errors import ConfigError
from polyfold.types import Threshold
from polyfold.viz._report import report_html


class CoveredArea:
    """How much of the table the cloth still covers, of what it covered flat."""

    label: ClassVar[str] = "covered"
    unit: ClassVar[str] = "%"
    digits: ClassVar[int] = 2
    higher_is_better: ClassVar[bool] = False

    def score(self, result, references):
        span = [np.ptp(state.positions[:, :2], axis=0).prod() for state in (result.end, result.start)]
        return 100.0 * span[0] / span[1]


class Compact:
    """At most nine tenths are covered."""

    thresholds: ClassVar[tuple[Threshold, ...]] = (Threshold("covered-area", 90.0),)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("columns")
    polyfold.register("metrics", "covered-area", CoveredArea, "share of the table that is still covered")
    polyfold.register("criteria", "compact", Compact, "covered <= 90 %")
    base = polyfold.Study(
        name="columns",
        tasks=("square-triangle-top_left", "square-corner-top_left"),
        first_seed=2000,
        edge_length=0.03,
        criteria=("compact", "lenient"),
    )
    study = polyfold.grid(base, {"agent": ["oracle", "noop"], "policy": ["affordance-pair"]})
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("POLYFOLD_CACHE", str(folder / "cache"))
        polyfold.run(study, folder / "run", progress=False)
    yield folder / "run"
    for kind, name in plugins.by_hand():
        plugins.unregister(kind, name)


@pytest.fixture
def results(folder):
    return polyfold.open(folder)


def test_its_metric_decides_success(results):
    oracle, noop = (
        {r.task: r for r in results.of(name)} for name in ("oracle, affordance-pair", "noop, affordance-pair")
    )
    for record in oracle.values():
        assert record.success == {"compact": record.metrics["covered-area"] <= 90.0, "lenient": True}
        assert record.succeeded == record.success["compact"], "the study's own criterion is the first"
    assert not any(record.succeeded for record in noop.values())
    assert all(record.cause is not None for record in noop.values())
    assert [record.metrics["covered-area"] for record in noop.values()] == [100.0, 100.0]


def test_it_stands_in_tables_and_differences_with_unit_and_digits(results):
    table = polyfold.table(results)
    assert table.headers[3] == "success %", "what was asked for comes first"
    metrics = [header for header in table.headers[3:] if not header.endswith(" %")]
    assert metrics[0] == "covered [%]", "of metrics, what the study's own criterion bounds"
    assert table.headers[3:5] == ["success %", "lenient %"]
    assert "100.00 [100.00, 100.00]" in table.markdown()
    rows = list(csv.DictReader(table.csv().splitlines()))
    assert ("100", "100", "100") in [tuple(r[f"covered [%]{end}"] for end in ("", " low", " high")) for r in rows]
    assert "covered [%]" in polyfold.compare(results, "oracle, affordance-pair", "noop, affordance-pair").headers
    assert polyfold.table(results, ["covered-area", "compact"]).headers[3:] == ["covered [%]", "success %"]


def test_it_can_be_plotted_by_its_name_or_heading(results):
    for name in ("covered-area", "covered [%]", "covered"):
        assert results.plot(name).axes[0].get_ylabel() == "covered [%]"
    assert results.plot().axes[0].get_ylabel() == "success %"
    with pytest.raises(ConfigError, match="did you mean 'covered-area'"):
        results.plot("coverd-area")


def test_the_report_shows_it_without_the_plugin(folder, results):
    for kind, name in plugins.by_hand():
        plugins.unregister(kind, name)
    page = report_html(folder)
    assert "covered ≤ 90 %".replace(" ", "\N{NO-BREAK SPACE}") in page
    assert "share of the table that is still covered" in page
    assert "100.00" in page
    polyfold.register("metrics", "covered-area", CoveredArea, "share of the table that is still covered")
    polyfold.register("criteria", "compact", Compact, "covered <= 90 %")


def test_factors_of_a_grid_are_columns_of_a_data_frame(results):
    frame = results.dataframe()
    assert len(frame) == 4
    effect = frame.pivot_table(index="agent", values=["covered-area", "success_lenient"])
    assert effect.loc["noop", "covered-area"] == 100.0
    assert set(frame["policy"]) == {"affordance-pair"}


def test_a_criterion_that_nobody_registered_is_named(folder):
    study = polyfold.Study(name="wrong", criteria=("lenent",))
    with pytest.raises(polyfold.PolyfoldError, match="did you mean 'lenient'"):
        polyfold.run(study, folder.parent / "wrong", progress=False)


def test_runs_of_schema_version_1_open_and_are_not_resumed(tmp_path):
    study = polyfold.Study(name="old", tasks=("square-corner-top_left",), first_seed=2000)
    asked = {k: v for k, v in study.model_dump(mode="json").items() if k not in ("criteria", "factors")}
    described = {"schema_version": 1, "config": {"study": asked}, "versions": {"numpy": "2.0.0"}}
    (tmp_path / "run.json").write_text(json.dumps(described))
    line = {
        "key": "polyfold/square-corner-top_left/2000/0",
        "variant": "polyfold",
        "task": "square-corner-top_left",
        "type": "S-Corner",
        "split": "seen",
        "steps_wanted": 1,
        "garment": "square",
        "garment_seed": 2000,
        "wording": 0,
        "instruction": "Fold the corner.",
        "subgoals": ["fold the corner"],
        "steps": 1,
        "retries": 0,
        "values_picks": False,
        "metrics": {"miou": 0.97, "moved-part": 3.0, "mppe": 1.5},
        "done": None,
        "step_errors_mm": [1.5],
        "success": {"polyfold": True, "strict": True},
        "failure": None,
        "cause": None,
        "privileged": False,
        "language": {},
        "seconds": {"reset": 0.1},
        "peak_memory_mb": 200,
    }
    (tmp_path / "episodes.jsonl").write_text(json.dumps(line) + "\n")
    results = polyfold.open(tmp_path)
    assert results.records[0].folds == 1
    table = polyfold.table(results).markdown()
    assert "| 100.0 [20.7, 100.0]" in table
    assert "| 1.5 | 0.970 | 3.0 |" in table
    page = report_html(tmp_path)
    assert "1 episode" in page
    assert "2.0.0" in page, "versions were all that such a run kept of what it depends on"
    with pytest.raises(ConfigError, match="no longer resumed"):
        polyfold.run(study, tmp_path, progress=False)
