"""The paper's planner (Sec. IV): a language model splits the instruction into folds, another finds each fold line."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import PlanError
from polyfold.geometry import signed_distance
from polyfold.interfaces import Conversation, Reply
from polyfold.polygon import Template
from polyfold.prompts import Prompt, load_prompt
from polyfold.types import FoldLine, Scene, Subgoal
from polyfold_planning.grammar import check_subgoal
from polyfold_planning.repair import ask_until_valid
from polyfold_planning.replies import answer_object, fold_line_in, subgoals_in

__all__ = ["HierarchicalPlanner"]

MIN_LENGTH = 10.0
"""Shortest fold line with a trustworthy direction [px]."""

MIN_SHARE = 0.005
"""Each side of a fold line needs this share of the visible cloth."""


class HierarchicalPlanner:
    """Subgoal decomposition, then one fold line per subgoal, both by prompts and with a repair loop."""

    class Config(BaseModel):
        """Prompt versions and limits."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        subgoals_prompt: str = Field("v1", description="version of the prompt that splits instructions")
        fold_line_prompt: str = Field("v1", description="version of the prompt that finds fold lines")
        max_attempts: int | None = Field(None, ge=1, le=10, description="answers asked for; None: as the prompt says")
        max_subgoals: int = Field(10, ge=1, le=30, description="longest plan accepted")
        check_grammar: bool = Field(True, description="hold subgoals to the anchored form and known parts")
        params: dict[str, Any] = Field(default_factory=dict, description="parameters for the model, over the prompt's")

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()

    @property
    def prompts(self) -> dict[str, str]:
        """Prompt ``id@version`` -> sha256, for logs."""
        return {prompt.name: prompt.sha256 for prompt in (self._prompt("subgoals"), self._prompt("fold_line"))}

    def subgoals(self, instruction: str, template: Template, conversation: Conversation) -> list[Subgoal]:
        """Split an instruction. Raises RefusedError with the reason when it can't or must not be done."""

        def read(reply: Reply) -> list[Subgoal]:
            texts = subgoals_in(answer_object(reply), self._config.max_subgoals)
            if self._config.check_grammar:
                for text in texts:
                    check_subgoal(text, template)
            return [Subgoal(text) for text in texts]

        return self._ask("subgoals", {"template": template.to_text(), "instruction": instruction}, read, conversation)

    def plan(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> FoldLine:
        """Find the fold line of a subgoal on the scene as seen now. Raises PlanError if no valid answer came."""

        def read(reply: Reply) -> FoldLine:
            line = fold_line_in(answer_object(reply))
            check_fold_line(line, scene)
            return line

        return self._ask("fold_line", {"model": scene.text, "subgoal": subgoal.text}, read, conversation)

    def _ask(self, role: str, values: dict[str, Any], read: Any, conversation: Conversation) -> Any:
        prompt = self._prompt(role)
        attempts = self._config.max_attempts or prompt.max_attempts
        return ask_until_valid(prompt, values, read, conversation, self._config.params, attempts)

    def _prompt(self, role: str) -> Prompt:
        return load_prompt(role, getattr(self._config, f"{role}_prompt"))


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
