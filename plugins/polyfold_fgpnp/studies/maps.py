"""``polyfold maps``: spatial action maps over garments, and the folds that they lead to (the paper's Fig. 9)."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from polyfold import plugins
from polyfold.config import Experiment
from polyfold.errors import ConfigError, did_you_mean
from polyfold.evaluation import known_tasks
from polyfold.plugins.interfaces import Policy, ValuesPicks
from polyfold.tasks import Task, fold_lines
from polyfold_fgpnp.policies.region import fold_region

if TYPE_CHECKING:
    from polyfold.viz import Card


FOUR_TASKS = ("square-corner-bottom_left", "rectangle-half-left", "tshirt-half-left", "pants-half-left")
"""The paper's: a corner of a square, a rectangle, a t-shirt and trousers in half."""


class _Mapped(Policy, ValuesPicks, Protocol):
    """A policy with an action map."""


class Maps:
    """The verb."""

    @staticmethod
    def configure(parser: argparse.ArgumentParser) -> None:
        """Add the options."""
        parser.add_argument("--policy", default="csam+caso", metavar="NAME", help="default: csam+caso")
        parser.add_argument("--weights", default="", metavar="FILE", help="or name, instead of the default")
        parser.add_argument("--task", action="append", metavar="ID", help="first fold of this task; may be repeated")
        parser.add_argument(
            "--fabric", default="usual", metavar="NAME", help="default: usual, what each kind usually is"
        )
        parser.add_argument("--seed", type="seed", default=2000, help="of the garments (default: 2000)")
        parser.add_argument("--out", type=Path, default=Path("maps.png"), metavar="PNG", help="default: maps.png")

    @staticmethod
    def run(arguments: argparse.Namespace) -> int:
        """Draw the sheet."""
        weights = {"weights": arguments.weights} if arguments.weights else {}
        policy = plugins.create("policies", arguments.policy, weights)
        arguments.out.parent.mkdir(parents=True, exist_ok=True)
        experiment = Experiment.of(fabric=arguments.fabric)
        action_map_sheet(policy, arguments.task or FOUR_TASKS, arguments.seed, arguments.out, experiment)
        print(f"maps: {arguments.out}")
        return 0


def action_map_sheet(
    policy: Policy,
    tasks: Sequence[str] = FOUR_TASKS,
    seed: int = 2000,
    path: str | Path | None = None,
    experiment: Experiment | None = None,
) -> NDArray[np.uint8]:
    """For the first fold of each task: the fold line, the values over the lifted contour with the picks, the result.

    Args:
        policy: one with a map (:class:`polyfold.plugins.interfaces.ValuesPicks`).
        tasks: ids of tasks of the installed suites.
        seed: of the garments.
        path: PNG to write.
        experiment: which fabric, simulator, segmenter and grounding; by default those of every experiment.

    Returns:
        The sheet, uint8, shape (H, W, 3).

    Raises:
        ConfigError: if the policy has no map, or a task is unknown.
    """
    from polyfold.viz import score_sheet

    if not isinstance(policy, ValuesPicks):
        raise ConfigError("this policy has no action map to show; choose a learned one, such as csam+caso")
    known = {task.id: task for kind in plugins.names("garments") for task in known_tasks(kind)}
    unknown = [task for task in tasks if task not in known]
    if unknown:
        otherwise = "see the ids in the suite polyfold70"
        raise ConfigError(f"no task is called {unknown[0]!r}; {did_you_mean(unknown[0], known, otherwise)}")
    cards = [_card(policy, known[task], seed, experiment or Experiment()) for task in tasks]
    return score_sheet(
        cards, "Where to pick: dark low, yellow high", path, columns=1 if len(cards) < 4 else 2, side=260
    )


def _card(policy: _Mapped, task: Task, seed: int, experiment: Experiment) -> Card:
    from polyfold.viz import Card, overlay, value_map
    from polyfold_fgpnp.data.outcomes import expect

    simulator, segmenter, grounding = (
        plugins.create_chosen(experiment, field) for field in ("simulator", "segmenter", "grounding")
    )
    picture = simulator.reset(plugins.generate_garment(task.garment, seed, fabric=experiment.fabric), seed)
    before = simulator.state()
    line = fold_lines(task, before.keypoint_pixels())[0]
    template = plugins.create("garments", task.garment).template()
    scene = grounding.ground(picture, segmenter.segment(picture), template)
    action = policy.act(line, scene, np.random.default_rng(seed))
    points, values = policy.action_map(line, scene)
    expectation = expect(fold_region(line, scene), scene.mask, before)
    after = simulator.execute(action)
    outcome = expectation.judge(segmenter.segment(after), simulator.state())
    pictures = (overlay(picture, fold_line=line), value_map(picture.rgb, points, values, line, action), after.rgb)
    return Card(pictures, task.id, f"flap off by {outcome.flap_mm:.0f} of {expectation.travel_mm:.0f} mm")
