import pytest
from polyfold_pybullet.cell import Cell
from polyfold_pybullet.planning import FoldPlanner
from polyfold_pybullet.robots import panda


@pytest.fixture(scope="session")
def pandas():
    """The default cell, loaded."""
    with Cell(panda()) as cell:
        yield cell


@pytest.fixture(scope="session")
def planner(pandas):
    return FoldPlanner(pandas)
