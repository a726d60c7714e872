"""A small data set of real random folds, shared by the tests of everything that learns."""

import pytest
from few_folds import FOLDS, interaction
from polyfold_fgpnp.data.collect import collect
from polyfold_fgpnp.data.dataset import load_dataset


@pytest.fixture(scope="session")
def folds_folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("folds")
    collect(interaction(), FOLDS, out, progress=False)
    return out


@pytest.fixture(scope="session")
def folds(folds_folder):
    return load_dataset(folds_folder)
