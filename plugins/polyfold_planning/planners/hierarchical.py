"""The paper's planner (Sec. IV): a language model splits the instruction into folds, another finds each fold line."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import Field

from polyfold.geometry import FoldLine
from polyfold.plugins.interfaces import Conversation
from polyfold.types import Scene, Subgoal
from polyfold_planning.answers.lines import check_fold_line, check_lifted
from polyfold_planning.answers.replies import fold_line_in
from polyfold_planning.decomposition import DecompositionConfig
from polyfold_planning.scene_prompts import prompts_for_scenes
from polyfold_planning.stepwise import Stepwise


class HierarchicalPlanner(Stepwise):
    """Subgoal decomposition, then one fold line per subgoal, both by prompts and with a repair loop."""

    class Config(DecompositionConfig):
        """Prompt versions and limits."""

        fold_line_prompt: str = Field(default="v2", description="version of the prompt that finds fold lines")

    def __init__(self, config: Config | None = None) -> None:
        config = config or self.Config()
        super().__init__(config)
        self._version = config.fold_line_prompt

    @classmethod
    def prompts_read(cls, config: Config) -> list[str]:
        """The prompts that it may use with these parameters, each as ``role@version``."""
        return [f"subgoals@{config.subgoals_prompt}", *prompts_for_scenes("fold_line", config.fold_line_prompt)]

    def plan(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> FoldLine | Subgoal:
        """Find the fold line of a subgoal on the scene as seen now, or an earlier subgoal that has come open.

        Raises:
            PlanError: if no valid answer came.
        """

        def read(content: Mapping[str, Any]) -> FoldLine:
            line = fold_line_in(content)
            check_fold_line(line, scene)
            check_lifted(line, subgoal.text, scene)
            return line

        return self._asked("fold_line", self._version, subgoal, scene, conversation, read)
