"""Studies that cross settings: levels along two sides, and what each setting does by itself."""

import math

import pytest

import polyfold
from polyfold.analysis import Results
from polyfold.errors import ConfigError
from polyfold.studies import Study

SMALL = {"name": "crossed", "tasks": ("square-corner-*",), "garments": 2, "edge_length": 0.04}


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    base = Study(**SMALL, base={"simulator": {"name": "faulty"}})
    study = polyfold.grid(base, {"policy": ["affordance-pair", "farthest"], "simulator.miss": [0.0, 1.0]})
    return polyfold.run(study, tmp_path_factory.mktemp("crossed") / "run", progress=False)


def cell(table, row, column):
    return next(one for one in table.cells if one[0] == row)[list(table.headers).index(column)]


def test_a_pivot_has_one_setting_down_and_another_across(results):
    table = results.pivot("policy", "simulator.miss", "miou")
    assert list(table.headers)[1:] == ["0.0", "1.0"]
    assert [row[0] for row in table.cells] == ["affordance-pair", "farthest"]
    found = cell(table, "farthest", "1.0").value
    mine = [record.metrics["miou"] for record in results.of("farthest, 1.0")]
    assert found.mean == pytest.approx(sum(mine) / len(mine))
    assert "n = 8 a cell" in table.note


def test_effects_are_differences_over_all_values_of_the_others(results):
    table = results.effects("mppe")
    assert [row[0] for row in table.cells] == [
        "policy: farthest − affordance-pair",
        "simulator.miss: 1.0 − 0.0",
        "policy: farthest − affordance-pair × simulator.miss: 1.0 − 0.0",
    ]
    means = {
        name: sum(record.metrics["mppe"] for record in results.of(name)) / len(results.of(name))
        for name in results.study.variants
    }
    a0, a1, f0, f1 = (
        means[name] for name in ("affordance-pair, 0.0", "affordance-pair, 1.0", "farthest, 0.0", "farthest, 1.0")
    )
    policy, miss, both = (row[1].value.mean for row in table.cells)
    assert policy == pytest.approx((f0 + f1) / 2 - (a0 + a1) / 2)
    assert miss == pytest.approx((a1 + f1) / 2 - (a0 + f0) / 2)
    assert both == pytest.approx((f1 - a1) - (f0 - a0))
    assert miss > 4  # where every grasp misses, nothing is folded


def test_an_effect_of_nothing_is_none(results):
    doubled = polyfold.grid(Study(**SMALL), {"policy": ["caso", "farthest"], "agent.retries": [1, 2]})
    same = Results(
        results.run.model_copy(update={"asked": {"study": doubled.model_dump(mode="json")}}),
        [
            record.model_copy(update={"variant": name})
            for name in doubled.variants
            for record in results.of("farthest, 0.0")
        ],
    )
    assert [row[1].value.mean for row in same.effects("mppe").cells] == [0.0, 0.0, 0.0]


def test_what_is_not_crossed_or_not_finished_says_so(results):
    with pytest.raises(ConfigError, match="did you mean 'policy'"):
        results.pivot("polcy", "simulator.miss")
    unfinished = Results(results.run, [record for record in results.records if record.variant != "farthest, 1.0"])
    with pytest.raises(ConfigError, match="run it on"):
        unfinished.effects()
    assert unfinished.pivot("policy", "simulator.miss").rows[1][2] == "–"
    plain = results.run.model_copy(update={"asked": {"study": Study(**SMALL).model_dump(mode="json")}})
    with pytest.raises(ConfigError, match=r"polyfold\.grid"):
        Results(plain, []).effects()


def test_all_variants_are_compared_with_one_at_once(results):
    table = polyfold.compare(results, columns=["mppe"])
    assert table.headers[:3] == ["variant", "kind", "n"]
    others = list(results.study.variants)[1:]
    assert [row[0] for row in table.cells] == [name for name in others for _ in ("square", "all")]
    one = polyfold.compare(results, "farthest, 1.0", "affordance-pair, 0.0", ["mppe"])
    same = [row for row in table.cells if row[0] == "farthest, 1.0"]
    assert [row[3].value.mean for row in same] == [row[2].value.mean for row in one.cells]
    assert {row[0] for row in polyfold.compare(results, baseline="farthest, 1.0").cells} == {
        "affordance-pair, 0.0", "affordance-pair, 1.0", "farthest, 0.0",
    }  # fmt: skip


def test_a_study_says_what_it_will_run_before_it_runs(results):
    lines = str(results.study).splitlines()
    assert len(lines) == 5
    assert lines[0] == "study crossed: 32 episodes"
    assert lines[1].startswith("4 variants: affordance-pair, 0.0")
    assert len(results.records) == 32
    assert "32 episodes" in results.study._repr_html_()


def test_tables_in_notebooks_keep_figures_on_one_line_and_sort_by_value(results):
    html = polyfold.table(results, ["mppe"])._repr_html_()
    assert "onclick" in html
    assert html.count("white-space:nowrap") > 8
    values = [float(part.split('"')[1]) for part in html.split("data-value=")[1:]]
    assert any(not math.isclose(value, round(value)) for value in values)
    assert "onclick" not in polyfold.table(results).html()  # reports forbid scripts of their own


def test_grids_whose_variants_cannot_be_told_apart_are_refused():
    base = Study(**SMALL)
    found = polyfold.ablate(base, "policy", [{"name": "affordance-pair", "gamma": gamma} for gamma in (0.1, 0.2)])
    assert list(found.variants) == ["affordance-pair gamma=0.1", "affordance-pair gamma=0.2"]
    for settings in ({"policy": "farthest"}, {}, {"policy": []}, {"policy": ["caso", "caso"]}):
        with pytest.raises(ConfigError):
            polyfold.grid(base, settings)


def test_what_does_not_differ_has_no_interval(results):
    same = [record.model_copy(update={"metrics": {**record.metrics, "miou": 0.5}}) for record in results.records]
    cells = Results(results.run, same).effects("miou").cells
    assert not any(cell.has_interval for _, cell in cells)
    with pytest.raises(ConfigError, match="both down and across"):
        results.pivot("policy", "policy")
