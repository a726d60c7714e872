"""A task as a Gymnasium environment: what its checker asks for, and that folding well is what it rewards."""

import numpy as np
import pytest

from polyfold.errors import ConfigError
from polyfold.evaluation import suite
from polyfold.tasks import fold_lines

gymnasium = pytest.importorskip("gymnasium")
from polyfold_interchange.environment import FoldingEnv, register  # noqa: E402
from polyfold_interchange.numbers import as_action, as_numbers  # noqa: E402

TRIANGLE = "square-triangle-top_left"


@pytest.fixture
def environment():
    made = FoldingEnv(TRIANGLE, edge_length=0.025, render_mode="rgb_array")
    yield made
    made.close()


def right_action(environment):
    """The task's own fold, from the true corner."""
    from polyfold import Action

    task = suite("polyfold70").task(environment.task)
    state = environment._simulator.state()
    (line,) = fold_lines(task, state.keypoint_pixels())
    corner = state.keypoint_pixels()["top_left"]
    inward = line.mirror(corner) - corner
    pick = corner + 0.02 * inward
    return as_numbers(Action([pick], [line.mirror(pick)]), environment._seen.camera)


def test_gymnasium_s_own_checker_finds_no_fault(environment):
    from gymnasium.utils.env_checker import check_env

    check_env(environment)


def test_the_right_fold_succeeds_and_ends_the_episode(environment):
    _, info = environment.reset(seed=3)
    assert not info["is_success"]
    observation, reward, terminated, truncated, info = environment.step(right_action(environment))
    assert info["is_success"], info
    assert (reward, terminated, truncated) == (1.0, True, False)
    assert info["iou"] > 0.8
    assert environment.observation_space.contains(observation)


def test_folding_nothing_is_no_success_and_is_cut_off(environment):
    environment.reset(seed=3)
    nothing = np.full(8, -1.0, np.float32)  # a pick in the corner of the picture, where no cloth is
    found = [environment.step(nothing) for _ in range(3)]
    assert [one[3] for one in found] == [False, False, True]
    assert not any(one[4]["is_success"] for one in found)


def test_the_same_seed_lays_the_same_garment_in_the_same_way(environment):
    one, first = environment.reset(seed=7)
    other, second = environment.reset(seed=7)
    np.testing.assert_array_equal(one["pixels"], other["pixels"])
    assert first["garment"] == second["garment"]
    _, asked = environment.reset(seed=7, options={"garment": 1050})
    assert asked["garment"] == 1050


def test_a_vector_of_them_tells_success_in_the_step_that_ends_it():
    from gymnasium.vector import AutoresetMode, SyncVectorEnv

    vector = SyncVectorEnv([lambda: FoldingEnv(TRIANGLE, edge_length=0.025)], autoreset_mode=AutoresetMode.SAME_STEP)
    vector.reset(seed=3)
    *_, info = vector.step(right_action(vector.envs[0])[None])
    assert info["final_info"]["is_success"].tolist() == [True]
    assert vector.call("task_description")[0]
    vector.close()


def test_every_task_can_be_made_by_its_name():
    register()
    made = gymnasium.make(f"polyfold/{TRIANGLE}", edge_length=0.025, disable_env_checker=True)
    assert made.task_description  # as LeRobot looks for it, through no wrapper
    made.reset(seed=0)
    assert made.unwrapped.task == TRIANGLE
    made.close()
    with pytest.raises(ConfigError, match="did you mean"):
        FoldingEnv("square-triangle-top_lft")


def test_numbers_are_actions_and_back():
    from polyfold.geometry import Camera

    camera, rng = Camera(), np.random.default_rng(0)
    for _ in range(50):
        numbers = rng.uniform(-1, 1, 8).astype(np.float32)
        action = as_action(numbers, camera)
        action.check_inside(camera)
        if action.arms == 2:
            np.testing.assert_allclose(as_numbers(action, camera), numbers, atol=1e-6)
    one = as_action(as_numbers(as_action(np.tile(numbers[:4], 2), camera), camera), camera)
    assert one.arms == 1


def test_a_fold_before_a_reset_or_after_the_end_is_refused(environment):
    with FoldingEnv(max_folds=1, edge_length=0.03) as fresh, pytest.raises(gymnasium.error.ResetNeeded):
        fresh.step(np.zeros(8))
    environment.reset(seed=0)
    for _ in range(10):
        if any(environment.step(np.zeros(8))[2:4]):
            break
    with pytest.raises(gymnasium.error.ResetNeeded, match="over"):
        environment.step(np.zeros(8))
    with pytest.raises(ConfigError, match="rgb_array"):
        FoldingEnv(render_mode="human")
