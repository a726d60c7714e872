import pytest
from demo_plan import PLAN
from polyfold_baselines.demos.command import collect


@pytest.fixture(scope="session")
def demonstrated(tmp_path_factory):
    """A few demonstrations on disk."""
    out = tmp_path_factory.mktemp("demos")
    collect(PLAN, out, progress=False)
    return out
