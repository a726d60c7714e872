"""Seen tasks, one after the other, to learn from by trying: a Gymnasium environment in which an action is a fold."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.errors import ActionError, SimulationError
from polyfold.garments import Mesh
from polyfold.plugins.interfaces import Simulator
from polyfold.tasks import Task, fold_lines
from polyfold.types import Action, Observation, SimState
from polyfold_baselines.demos.window import SIDE, Window, on_cloth
from polyfold_baselines.learning.examples import TALL
from polyfold_baselines.learning.sampling import farthest_first

Floats = NDArray[np.float64]

PIXELS = 84
PARTICLES = 100
CHANNELS = 3
GOOD = 0.6
"""A fold that takes away less of the distance to its goal ends an episode: what follows has no sense."""
SMALLEST = 0.01
"""Distances are counted over at least this one [m]."""


OBSERVATIONS = gymnasium.spaces.Dict({
    "image": gymnasium.spaces.Box(0.0, 1.0, (CHANNELS, PIXELS, PIXELS), np.float32),
    "particles": gymnasium.spaces.Box(-4.0, 4.0, (4 * PARTICLES,), np.float32),
})  # fmt: skip
ACTIONS = gymnasium.spaces.Box(-1.0, 1.0, (8,), np.float32)


class FoldingTasks(gymnasium.Env):
    """A seen task on a training garment; each fold has the ideal after it as its goal.

    Observations are ``image``, float32, shape (CHANNELS, PIXELS, PIXELS), of heights, cloth and the goal's silhouette,
    and ``particles``, where some of them are and should be, in the view from -1 to 1, float32, shape (4 PARTICLES,).
    Actions are pick and place of both arms in the view, from -1 to 1, shape (8,); picks are moved onto the cloth. The
    reward is the share of the distance to the goal, the mean over all particles, that a fold takes away.

    Args:
        tasks: to draw from.
        seeds: first and last garment.
        edge_length: of meshes [m].
        seed: of what is drawn.
    """

    def __init__(self, tasks: list[Task], seeds: tuple[int, int], edge_length: float, seed: int) -> None:
        self._tasks, self._seeds, self._edge_length = tasks, seeds, edge_length
        super().reset(seed=seed)
        self._simulator: Simulator = plugins.create("simulators", "xpbd")
        self._segmenter = plugins.create("segmenters", "colour")
        self.observation_space, self.action_space = OBSERVATIONS, ACTIONS

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Lay another garment for another task."""
        super().reset(seed=seed)
        task = self._tasks[self.np_random.integers(len(self._tasks))]
        garment_seed = int(self.np_random.integers(self._seeds[0], self._seeds[1] + 1))
        garment = plugins.generate_garment(task.garment, garment_seed, self._edge_length)
        self._seen = self._simulator.reset(garment, garment_seed)
        flat = self._simulator.state()
        self._view = TaskView(garment.mesh, Window.around(self._segmenter.segment(self._seen)))
        self._goals = goals_of(task, flat)
        self._step = 0
        return self._observation(), {"task": task.id}

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Fold once."""
        goal = self._goals[self._step]
        before = _distance(self._simulator.state(), goal)
        mask = self._segmenter.segment(self._seen)
        try:
            self._seen = self._simulator.execute(self._view.action(np.asarray(action, float), mask, self._seen))
            after = _distance(self._simulator.state(), goal)
        except (ActionError, SimulationError):
            after = before
        reward = float(np.clip((before - after) / max(before, SMALLEST), -1.0, 1.0))
        self._step += 1
        done = self._step == len(self._goals) or reward < GOOD
        self._step = min(self._step, len(self._goals) - 1)
        return self._observation(), reward, done, False, {}

    def close(self) -> None:
        """Release the simulator."""
        self._simulator.close()

    def _observation(self) -> dict[str, Any]:
        mask = self._segmenter.segment(self._seen)
        return self._view.observation(self._seen, mask, self._simulator.state(), self._goals[self._step])


class TaskView:
    """What of a garment and its goal is shown, and what an action means: the same in training and after.

    Args:
        mesh: of the garment.
        window: through which it is seen.
    """

    def __init__(self, mesh: Mesh, window: Window) -> None:
        self._mesh, self.window = mesh, window
        chosen = farthest_first(mesh.vertices, PARTICLES)
        rest = mesh.vertices[chosen]
        # From left to right and bottom to top, so that an input means a place whatever the garment.
        self._chosen = chosen[np.lexsort([rest[:, 0].round(2), rest[:, 1].round(2)])]

    def observation(
        self, seen: Observation, mask: NDArray[np.bool_], state: SimState, goal: Floats
    ) -> dict[str, NDArray[np.float32]]:
        """Of the cloth, masked bool, shape (H, W), in a state, with its goal [m], shape (N, 3)."""
        heights = np.nan_to_num(seen.camera.elevation - seen.depth)
        wanted = self._silhouette(seen, goal)
        views = [self.window.view(picture) for picture in (heights / TALL, mask, wanted)]
        particles = [self._in_view(seen, positions[self._chosen]) for positions in (state.positions, goal)]
        return {
            "image": np.stack([_resized(view) for view in views]).clip(0.0, 1.0),
            "particles": np.concatenate(particles).ravel().clip(-4.0, 4.0).astype(np.float32),
        }

    def action(self, numbers: Floats, mask: NDArray[np.bool_], seen: Observation) -> Action:
        """What eight numbers mean: picks go to the nearest cloth, bool, shape (H, W)."""
        points = self.window.to_pixels((numbers.reshape(4, 2) + 1) / 2 * (SIDE - 1))
        limit = np.array([seen.camera.width, seen.camera.height]) - 1.0
        return Action(on_cloth(points[::2], mask), np.clip(points[1::2], 0.0, limit))

    def _in_view(self, seen: Observation, positions: Floats) -> Floats:
        return self.window.to_view(seen.camera.to_pixels(positions)) / (SIDE - 1) * 2 - 1

    def _silhouette(self, seen: Observation, goal: Floats) -> NDArray[np.uint8]:
        import cv2

        drawn = np.zeros((seen.camera.height, seen.camera.width), np.uint8)
        corners = np.round(seen.camera.to_pixels(goal)[self._mesh.triangles]).astype(np.int32)
        for triangle in corners:
            cv2.fillConvexPoly(drawn, triangle, 1)
        return drawn


def goals_of(task: Task, flat: SimState) -> list[Floats]:
    """Where every particle should be after each fold, seen from above [m], shape (N, 3)."""
    pixels, goals = flat.camera.to_pixels(flat.positions[:, :2]), []
    for line in fold_lines(task, flat.keypoint_pixels()):
        pixels = line.fold(pixels)
        goals.append(flat.camera.to_world(pixels))
    return goals


def _distance(state: SimState, goal: Floats) -> float:
    return float(np.linalg.norm(state.positions[:, :2] - goal[:, :2], axis=1).mean())


def _resized(view: NDArray[np.float32]) -> NDArray[np.float32]:
    import cv2

    return np.asarray(cv2.resize(view, (PIXELS, PIXELS), interpolation=cv2.INTER_AREA), np.float32)
