import pytest
from demo_plan import PLAN
from polyfold_baselines.demos.command import collect


@pytest.fixture(scope="session")
def demonstrated(tmp_path_factory):
    """A few demonstrations on disk."""
    out = tmp_path_factory.mktemp("demos")
    collect(PLAN, out, progress=False)
    return out


@pytest.fixture(scope="session")
def dragged(tmp_path_factory):
    """A few random drags on disk."""
    out = tmp_path_factory.mktemp("drags")
    collect(PLAN.model_copy(update={"agent": "random-drags", "arms": 1}), out, progress=False)
    return out
