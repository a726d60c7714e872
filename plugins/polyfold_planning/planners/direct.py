"""Planners without fold lines (paper, Table IV b): subgoals, then picks and places from the language model itself."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from polyfold.plugins.interfaces import Conversation
from polyfold.polygon import Template
from polyfold.types import Action, Reply, Scene, Subgoal
from polyfold_planning.answers.actions import check_action
from polyfold_planning.answers.repair import ask_until_valid
from polyfold_planning.answers.replies import action_in, answer_object, undone_in
from polyfold_planning.decomposition import DecompositionConfig, decompose
from polyfold_planning.history import after
from polyfold_planning.scene_prompts import prompt_for, prompt_inputs, prompts_for_scenes


class _Direct:
    """Decomposes as ``hierarchical`` does, then asks for picks and places on what the scene shows."""

    role: ClassVar[str]
    arms: ClassVar[tuple[int, ...]]

    class Config(DecompositionConfig):
        """Prompt versions and limits."""

        motion_prompt: str = Field(default="v2", description="version of the prompt that asks for picks and places")

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()
        self._done: list[str] = []

    @classmethod
    def prompts_read(cls, config: Config) -> list[str]:
        """The prompts that it may use with these parameters, each as ``role@version``."""
        return [f"subgoals@{config.subgoals_prompt}", *prompts_for_scenes(cls.role, config.motion_prompt)]

    def subgoals(self, instruction: str, template: Template, conversation: Conversation) -> list[Subgoal]:
        """Split an instruction. Raises RefusedError with the reason when it can't or must not be done."""
        self._done = []
        return decompose(instruction, template, conversation, self._config)

    def plan(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> Action | Subgoal:
        """Picks and places for a subgoal on the scene as seen now, or an earlier subgoal that has come open.

        Raises:
            PlanError: if no valid answer came.
        """

        def read(reply: Reply) -> Action | Subgoal:
            content = answer_object(reply)
            if (undone := undone_in(content, self._done)) is not None:
                return Subgoal(undone)
            action = action_in(content, self.arms)
            check_action(action, scene)
            return action

        prompt = prompt_for(scene, self.role, self._config.motion_prompt)
        values = prompt_inputs(scene, prompt, done=self._done, subgoal=subgoal.text)
        attempts = self._config.max_attempts or prompt.max_attempts
        found = ask_until_valid(prompt, values, read, conversation, self._config.params, attempts)
        self._done = after(self._done, subgoal, found)
        return found


class DirectOneArm(_Direct):
    """Subgoals, then one pick and place each."""

    role = "direct_1arm"
    arms = (1,)


class DirectTwoArms(_Direct):
    """Subgoals, then picks and places of two arms each; one arm where a single corner moves."""

    role = "direct_2arm"
    arms = (1, 2)
