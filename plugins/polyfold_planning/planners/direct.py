"""Planners without fold lines (paper, Table IV b): subgoals, then picks and places from the language model itself."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import Field

from polyfold.plugins.interfaces import Conversation
from polyfold.types import Action, Scene, Subgoal
from polyfold_planning.answers.actions import check_action
from polyfold_planning.answers.replies import action_in
from polyfold_planning.decomposition import DecompositionConfig
from polyfold_planning.scene_prompts import prompts_for_scenes
from polyfold_planning.stepwise import Stepwise


class _Direct(Stepwise):
    """Decomposes as ``hierarchical`` does, then asks for picks and places on what the scene shows."""

    role: ClassVar[str]
    arms: ClassVar[tuple[int, ...]]

    class Config(DecompositionConfig):
        """Prompt versions and limits."""

        motion_prompt: str = Field(default="v2", description="version of the prompt that asks for picks and places")

    def __init__(self, config: Config | None = None) -> None:
        config = config or self.Config()
        super().__init__(config)
        self._version = config.motion_prompt

    @classmethod
    def prompts_read(cls, config: Config) -> list[str]:
        """The prompts that it may use with these parameters, each as ``role@version``."""
        return [f"subgoals@{config.subgoals_prompt}", *prompts_for_scenes(cls.role, config.motion_prompt)]

    def plan(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> Action | Subgoal:
        """Picks and places for a subgoal on the scene as seen now, or an earlier subgoal that has come open.

        Raises:
            PlanError: if no valid answer came.
        """

        def read(content: Mapping[str, Any]) -> Action:
            action = action_in(content, self.arms)
            check_action(action, scene)
            return action

        return self._asked(self.role, self._version, subgoal, scene, conversation, read)


class DirectOneArm(_Direct):
    """Subgoals, then one pick and place each."""

    role = "direct_1arm"
    arms = (1,)


class DirectTwoArms(_Direct):
    """Subgoals, then picks and places of two arms each; one arm where a single corner moves."""

    role = "direct_2arm"
    arms = (1, 2)
