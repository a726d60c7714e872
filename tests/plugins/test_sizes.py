"""Seeded garments as long as somebody wants them."""

import numpy as np
import pytest

import polyfold
from polyfold import plugins
from polyfold.errors import ConfigError, GarmentError
from polyfold.studies import Study


@pytest.mark.parametrize("kind", ["square", "rectangle", "tshirt", "pants"])
def test_the_longest_side_is_as_asked_and_all_else_in_proportion(kind):
    usual, small = (plugins.generate_garment(kind, 7, 0.02, size=size) for size in (None, 0.4))
    sides = [np.ptp(garment.mesh.vertices, axis=0) for garment in (usual, small)]
    assert sides[1].max() == pytest.approx(0.4, rel=2e-3)
    assert sides[1][0] / sides[1][1] == pytest.approx(sides[0][0] / sides[0][1], rel=2e-3)
    edges = small.mesh.vertices[small.mesh.triangles]
    assert 0.012 < np.median(np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1)) < 0.026
    assert small.name != usual.name


def test_the_seed_still_draws_the_proportions():
    one, other = (polyfold.garment("pants", seed=seed, size=0.5, edge_length=0.03) for seed in (1, 2))
    assert np.ptp(one.mesh.vertices, axis=0).min() != pytest.approx(
        np.ptp(other.mesh.vertices, axis=0).min(), rel=0.003
    )


@pytest.mark.parametrize("size", [0.004, 30.0])
def test_a_size_that_no_arms_fold_is_refused(size):
    with pytest.raises(GarmentError, match=r"from 0\.1 to 2"):
        polyfold.garment("square", size=size)


def test_a_study_folds_garments_of_its_sizes(tmp_path):
    study = Study(name="small", tasks=("square-corner-bottom_left",), sizes={"square": 0.2}, edge_length=0.03)
    (record,) = polyfold.run(study, tmp_path / "run", progress=False).records
    assert record.garment.size_m == pytest.approx(0.2, abs=0.001)


def test_a_size_for_a_kind_that_a_study_has_not_is_refused(tmp_path):
    study = Study(name="small", tasks=("square-*",), sizes={"squre": 0.2})
    with pytest.raises(ConfigError, match="did you mean 'square'"):
        polyfold.run(study, tmp_path / "run")


def test_a_mesh_too_coarse_for_the_size_is_said_in_what_was_given():
    with pytest.raises(GarmentError, match=r"an edge length of 0\.03 m does not suit a tshirt of 0\.1 m"):
        polyfold.garment("tshirt", size=0.1, edge_length=0.03)
