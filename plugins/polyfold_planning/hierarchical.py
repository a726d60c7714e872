"""The paper's planner (Sec. IV): a language model splits the instruction into folds, another finds each fold line."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine, signed_distance
from polyfold.plugins.interfaces import Conversation
from polyfold.polygon import Template
from polyfold.types import Reply, Scene, Subgoal
from polyfold_planning.decomposition import DecompositionConfig, decompose
from polyfold_planning.repair import ask_until_valid
from polyfold_planning.replies import answer_object, fold_line_in
from polyfold_planning.scene_prompts import prompt_for, prompt_inputs, prompts_for_scenes

MIN_LENGTH = 10.0
"""Shortest fold line with a trustworthy direction [px]."""

MIN_SHARE = 0.005
"""Each side of a fold line needs this share of the visible cloth."""


class HierarchicalPlanner:
    """Subgoal decomposition, then one fold line per subgoal, both by prompts and with a repair loop."""

    class Config(DecompositionConfig):
        """Prompt versions and limits."""

        fold_line_prompt: str = Field(default="v1", description="version of the prompt that finds fold lines")

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()

    @classmethod
    def prompts_read(cls, config: Config) -> list[str]:
        """The prompts that it may use with these parameters, each as ``role@version``."""
        return [f"subgoals@{config.subgoals_prompt}", *prompts_for_scenes("fold_line", config.fold_line_prompt)]

    def subgoals(self, instruction: str, template: Template, conversation: Conversation) -> list[Subgoal]:
        """Split an instruction. Raises RefusedError with the reason when it can't or must not be done."""
        return decompose(instruction, template, conversation, self._config)

    def plan(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> FoldLine:
        """Find the fold line of a subgoal on the scene as seen now. Raises PlanError if no valid answer came."""

        def read(reply: Reply) -> FoldLine:
            line = fold_line_in(answer_object(reply))
            check_fold_line(line, scene)
            return line

        prompt = prompt_for(scene, "fold_line", self._config.fold_line_prompt)
        values = prompt_inputs(scene, prompt, subgoal=subgoal.text)
        attempts = self._config.max_attempts or prompt.max_attempts
        return ask_until_valid(prompt, values, read, conversation, self._config.params, attempts)


def check_fold_line(line: FoldLine, scene: Scene) -> None:
    """Inside the image, long enough, cloth on both sides.

    Raises:
        PlanError: saying what is wrong, in words for the model that wrote it.
    """
    width, height = scene.image_size
    for end, (x, y) in (("start", line.start), ("end", line.end)):
        if not (-0.5 <= x <= width - 0.5 and -0.5 <= y <= height - 0.5):
            raise PlanError(f"{end} ({x:.0f}, {y:.0f}) lies outside the {width} x {height} image; move it inside")
    if not line.length >= MIN_LENGTH:
        raise PlanError(
            f"the fold line is {line.length:.0f} px long; choose two points at least {MIN_LENGTH:.0f} px apart "
            "(vertices that an earlier fold brought together coincide: use the crease's ends)"
        )
    ys, xs = np.nonzero(scene.mask)
    distance = signed_distance(np.column_stack([xs, ys]), line.start, line.end)
    for share, side in ((np.mean(distance > 0), "left"), (np.mean(distance < 0), "right")):
        if share < MIN_SHARE:
            raise PlanError(
                f"there is no cloth to the {side} of the fold line; move it onto the cloth, or swap start and end"
            )
    if scene.model is not None:
        scene.model.fold(line)
