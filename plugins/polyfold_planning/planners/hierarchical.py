"""The paper's planner (Sec. IV): a language model splits the instruction into folds, another finds each fold line."""

from __future__ import annotations

from pydantic import Field

from polyfold.geometry import FoldLine
from polyfold.plugins.interfaces import Conversation
from polyfold.polygon import Template
from polyfold.types import Reply, Scene, Subgoal
from polyfold_planning.answers.lines import check_fold_line, check_lifted
from polyfold_planning.answers.repair import ask_until_valid
from polyfold_planning.answers.replies import answer_object, fold_line_in, undone_in
from polyfold_planning.decomposition import DecompositionConfig, decompose
from polyfold_planning.history import after
from polyfold_planning.scene_prompts import prompt_for, prompt_inputs, prompts_for_scenes


class HierarchicalPlanner:
    """Subgoal decomposition, then one fold line per subgoal, both by prompts and with a repair loop."""

    class Config(DecompositionConfig):
        """Prompt versions and limits."""

        fold_line_prompt: str = Field(default="v2", description="version of the prompt that finds fold lines")

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()
        self._done: list[str] = []

    @classmethod
    def prompts_read(cls, config: Config) -> list[str]:
        """The prompts that it may use with these parameters, each as ``role@version``."""
        return [f"subgoals@{config.subgoals_prompt}", *prompts_for_scenes("fold_line", config.fold_line_prompt)]

    def subgoals(self, instruction: str, template: Template, conversation: Conversation) -> list[Subgoal]:
        """Split an instruction. Raises RefusedError with the reason when it can't or must not be done."""
        self._done = []
        return decompose(instruction, template, conversation, self._config)

    def plan(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> FoldLine | Subgoal:
        """Find the fold line of a subgoal on the scene as seen now, or an earlier subgoal that has come open.

        Raises:
            PlanError: if no valid answer came.
        """

        def read(reply: Reply) -> FoldLine | Subgoal:
            content = answer_object(reply)
            if (undone := undone_in(content, self._done)) is not None:
                return Subgoal(undone)
            line = fold_line_in(content)
            check_fold_line(line, scene)
            check_lifted(line, subgoal.text, scene)
            return line

        prompt = prompt_for(scene, "fold_line", self._config.fold_line_prompt)
        values = prompt_inputs(scene, prompt, done=self._done, subgoal=subgoal.text)
        attempts = self._config.max_attempts or prompt.max_attempts
        found = ask_until_valid(prompt, values, read, conversation, self._config.params, attempts)
        self._done = after(self._done, subgoal, found)
        return found
