"""The studies that come with PolyFold: they load, and the ablations' rows need neither key nor network."""

from pathlib import Path

import pytest

import polyfold
from polyfold.studies._study import experiment_of

STUDIES = {path.stem: path for path in sorted((Path(__file__).parents[2] / "experiments").glob("*.toml"))}


@pytest.mark.parametrize("name", STUDIES)
def test_every_study_loads(name):
    assert polyfold.load(STUDIES[name]).variants


@pytest.mark.parametrize(
    ("name", "rows"),
    [("groundings", {"polygon", "keypoints"}), ("planners", {"hierarchical", "plan", "direct-1arm", "direct-2arm"})],
)
def test_ablations_run_the_rows_without_vision_beside_all_published_ones(name, rows):
    study = polyfold.load(STUDIES[name])
    assert set(study.variants) == rows
    assert {experiment_of(study, variant).llm.name for variant in rows} == {"offline"}
    assert len(study.published) > len(rows - {"plan"}), "which the paper hasn't"
    assert all(set(row) == {"square", "rectangle", "tshirt", "pants"} for row in study.published.values())
