import pytest
from polyfold_baselines.demos.command import collect
from polyfold_baselines.demos.demonstrating import DemoPlan

PLAN = DemoPlan(
    tasks=("square-corner-bottom_left", "square-triangle-top_left-then-top_right", "rectangle-middle-left"),
    seeds=(1000, 1002),
    edge_length=0.022,
)


@pytest.fixture(scope="session")
def demonstrated(tmp_path_factory):
    """A few demonstrations on disk."""
    out = tmp_path_factory.mktemp("demos")
    collect(PLAN, out, progress=False)
    return out
