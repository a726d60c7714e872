"""A folding task as a Gymnasium environment: a step is a fold, from picks to places."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.config import Experiment
from polyfold.errors import ActionError, ConfigError, SimulationError
from polyfold.evaluation import judge, suite
from polyfold.types import Episode, Observation, Step
from polyfold_interchange.numbers import as_action, state_after

SPARE = 2
"""Folds beyond those that a task takes, after which an episode is cut off."""


class FoldingEnv(gymnasium.Env):
    """Fold a garment as a task says; each reset lays another garment of its kind on the table.

    Observations are ``pixels``, what the camera sees, uint8, shape (H, W, 3), and ``agent_pos``, where each arm last
    let go, float32, shape (4,). Actions are float32, shape (8,): pick and place of the first arm, then of the second,
    each from −1 (left, top) to 1 (right, bottom); arms whose picks are together fold as one. The reward is 1 when the
    task is done and 0 before: when it is at least ``fair`` beside the ideal (:class:`polyfold.types.Fidelity`); then
    the episode ends. ``info`` has ``is_success``, ``iou`` and ``moved_part_mm``.

    Args:
        task: id of a task, for example ``"square-triangle-top_left"``.
        suite_name: of which suite.
        seeds: first and last garment; a reset draws one, or takes ``options={"garment": SEED}``. By default those that
            baselines may train on.
        max_folds: after which an episode is cut off; by default two more than the task takes.
        edge_length: of the mesh [m].
        experiment: simulator and fabric; by default those that need no key and no GPU.
        render_mode: ``rgb_array``, or None.

    Raises:
        ConfigError: if there is no such task.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 1}  # noqa: RUF012  (the base class's)

    def __init__(
        self,
        task: str = "square-triangle-top_left",
        suite_name: str = "polyfold70",
        seeds: tuple[int, int] = (1000, 1099),
        max_folds: int | None = None,
        edge_length: float = 0.018,
        experiment: Experiment | None = None,
        render_mode: str | None = None,
    ) -> None:
        if seeds[0] > seeds[1]:
            raise ConfigError(f"seeds are the first and the last garment, not {seeds}; give them in order")
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ConfigError(f"render_mode is rgb_array or None, not {render_mode!r}; there is no window")
        self._task = suite(suite_name).task(task)
        self._seeds, self._edge_length = seeds, edge_length
        self._most = len(self._task.steps) + SPARE if max_folds is None else max_folds
        self._experiment = experiment or Experiment()
        self.render_mode = render_mode
        self._simulator = plugins.create_chosen(self._experiment, "simulator")
        self._begun: Episode | None = None
        self._steps: list[Step] = []
        self._numbers: NDArray[np.float32] | None = None
        camera = self._lie(seeds[0], 0).camera
        self._begun = None  # a look at the picture's size is no reset
        self.observation_space = gymnasium.spaces.Dict({
            "pixels": gymnasium.spaces.Box(0, 255, (camera.height, camera.width, 3), np.uint8),
            "agent_pos": gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32),
        })  # fmt: skip
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (8,), np.float32)

    @property
    def task(self) -> str:
        """The task's id."""
        return self._task.id

    @property
    def task_description(self) -> str:
        """The task as a sentence."""
        return self._task.instructions[0] if self._task.instructions else self._task.id

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Lay a garment on the table: drawn, or the one that ``options`` names."""
        super().reset(seed=seed)
        options = dict(options or {})
        garment = options.pop("garment", None)
        if options or not isinstance(garment, int | np.integer | None):
            raise ConfigError(f"a reset takes options={{'garment': SEED}} and nothing else, not {options or garment!r}")
        if garment is None:
            garment = int(self.np_random.integers(self._seeds[0], self._seeds[1] + 1))
        self._lie(int(garment), int(self.np_random.integers(2**31)))
        return self._observation(), {"garment": int(garment), "is_success": False}

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Fold once."""
        if self._begun is None:
            raise gymnasium.error.ResetNeeded("the episode is over or was not begun; call reset before step")
        numbers = np.asarray(action, np.float32)
        if numbers.shape != (8,) or not np.isfinite(numbers).all():
            raise ConfigError(
                "an action is 8 finite numbers, of which those beyond -1 to 1 count as the end: pick and place of each "
                "arm, x and y"
            )
        numbers = np.clip(numbers, -1.0, 1.0)
        info: dict[str, Any] = {}
        try:
            self._fold(numbers)
            self._numbers = numbers
        except (ActionError, SimulationError) as error:
            info["fault"] = str(error)  # the cloth lies as before
        told = judge(self._episode(), self._task).fidelity
        done = told is not None and told.verdict in ("good", "fair")
        if told is not None:
            info |= {"iou": told.iou, "moved_part_mm": told.moved_part_error_mm}
        info["is_success"] = done
        self._count += 1
        observation, cut_off = self._observation(), not done and self._count >= self._most
        if done or cut_off:
            self._begun = None
        return observation, float(done), done, cut_off, info

    def render(self) -> NDArray[np.uint8] | None:
        """What the camera sees."""
        return None if self.render_mode is None else self._seen.rgb

    def close(self) -> None:
        """Release the simulator."""
        self._simulator.close()

    def _lie(self, garment: int, seed: int) -> Observation:
        """A garment, flat, and nothing folded yet."""
        chosen = plugins.generate_garment(self._task.garment, garment, self._edge_length, self._experiment.fabric)
        self._seen = self._simulator.reset(chosen, seed)
        state = self._simulator.state()
        self._steps, self._numbers, self._count = [], None, 0
        self._begun = Episode(
            instruction=self.task_description, garment=chosen, seed=seed, agent_seed=seed, experiment=self._experiment,
            privileged=False, subgoals=(), steps=(), start=self._seen, final=self._seen, initial_state=state,
            final_state=state, calls=(), seconds={},
        )  # fmt: skip
        return self._seen

    def _fold(self, numbers: NDArray[np.float32]) -> None:
        action, before = as_action(numbers, self._seen.camera), self._seen
        self._seen = self._simulator.execute(action)
        after = self._simulator.state()
        self._steps.append(Step(len(self._steps), None, None, None, action, before, seconds={}, after=after))

    def _episode(self) -> Episode:
        assert self._begun is not None
        return replace(self._begun, steps=tuple(self._steps), final=self._seen, final_state=self._simulator.state())

    def _observation(self) -> dict[str, Any]:
        return {"pixels": self._seen.rgb.copy(), "agent_pos": state_after(self._numbers)}


def register() -> None:
    """Make the environment known to Gymnasium as ``polyfold/TASK``, for every task of the paper's suite."""
    for task in suite("polyfold70").tasks:
        name = f"polyfold/{task.id}"
        if name not in gymnasium.registry:
            gymnasium.register(
                name, entry_point="polyfold_interchange.environment:FoldingEnv", kwargs={"task": task.id},
                order_enforce=False,  # it refuses by itself, and a wrapper would hide task_description (gymnasium 1.4)
            )  # fmt: skip
