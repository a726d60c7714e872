"""The configurations that are recorded for training: valid, and those of one table alike."""

from pathlib import Path

import pytest
from polyfold_fgpnp.training.config import read_config


@pytest.mark.parametrize("path", sorted((Path(__file__).parents[2] / "experiments/training").glob("*.toml")))
def test_the_recorded_configurations_are_valid(path):
    assert read_config(path).data


def test_the_rows_of_the_papers_table_are_trained_alike_but_for_what_they_value_and_what_was_tried():
    folder = Path(__file__).parents[2] / "experiments/training"
    names = ("csam", "1sam", "2sam", "vertex-learned")
    configs = {name: read_config(folder / f"{name}.toml") for name in names}
    assert [config.network.variant for config in configs.values()] == list(names)
    assert len({config.data for config in configs.values()}) == len(names)
    own = {"data": ("same",), "snapshots": ()}
    alike = [
        config.model_copy(update={**own, "network": config.network.model_copy(update={"variant": "csam"})})
        for config in configs.values()
    ]
    assert all(config == alike[0] for config in alike)
    assert (alike[0].network.frame, alike[0].reward, alike[0].scale) == ("camera", "contour", "linear")
