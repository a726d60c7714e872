"""Tasks show what is asked: the cloth before each fold with its line, and how it should lie in the end."""

import numpy as np
import pytest

from polyfold.errors import ConfigError
from polyfold.evaluation import suite
from polyfold.evaluation._suites import accepted_tasks
from polyfold.tasks import Task
from polyfold.viz._draw._cloth import TABLE
from polyfold.viz._tasks import SIDE, _end, _ends, _folds, task_sheet
from polyfold.viz._values import picture_of


def cloth(picture):
    """Pixels that are not the bare table."""
    return int((np.abs(picture.astype(int) - TABLE).max(axis=2) > 25).sum())


@pytest.mark.parametrize("task_id", ["rectangle-half-left", "pants-half-left", "square-triangle-top_left"])
def test_half_of_the_cloth_is_left_in_the_end(task_id):
    task = suite("polyfold70").task(task_id)
    (before,) = _folds(task)
    assert before.shape == _end(task).shape == (SIDE, SIDE, 3)
    assert 0.4 * cloth(before) < cloth(_end(task)) < 0.62 * cloth(before)


def test_each_fold_has_its_picture_and_starts_where_the_last_one_ended():
    task = suite("polyfold70").task("pants-block-left-thirds")
    folds = _folds(task)
    assert len(folds) == 3
    first_only = task.model_copy(update={"steps": task.steps[:1]})
    done = _end(first_only)
    drawn_over = np.abs(folds[1].astype(int) - done).max(axis=2) > 25
    assert cloth(folds[1]) > 0.4 * cloth(folds[0])
    assert 0.01 < drawn_over.mean() < 0.25, "the same cloth, with the next line and what it lifts"


def test_a_goal_shows_ends_that_differ_and_the_flat_garment_if_it_accepts_none():
    goals = {goal.id: goal for goal in suite("ambiguous").goals}
    block, quarter = goals["tshirt-organize-block"], goals["tshirt-quarter"]
    assert len(accepted_tasks("ambiguous", block)) == 2
    assert len(_ends(block, accepted_tasks("ambiguous", block))) == 1, "both orders of the sleeves end alike"
    assert not accepted_tasks("ambiguous", quarter)
    assert cloth(_ends(quarter, ())[0]) > 1.5 * cloth(_ends(block, accepted_tasks("ambiguous", block))[0])


def test_nothing_to_draw_is_an_error_and_a_task_in_a_notebook_is_its_picture():
    with pytest.raises(ConfigError, match="at least one"):
        task_sheet([])
    task = suite("wardrobe").task("skirt-half-hem")
    assert isinstance(task, Task)
    assert (picture_of(task) == task_sheet([task])).all()
