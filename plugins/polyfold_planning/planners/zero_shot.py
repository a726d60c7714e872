"""The planner ``zero-shot-vlm``: picture and instruction in, picks and places out, nothing in between."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field

from polyfold.plugins.interfaces import Conversation
from polyfold.polygon import Template
from polyfold.prompts import load_prompt
from polyfold.types import Action, Reply, Scene, Subgoal
from polyfold_planning.answers.actions import check_action
from polyfold_planning.answers.repair import ask_until_valid
from polyfold_planning.answers.replies import action_in, answer_object, says_done
from polyfold_planning.scene_prompts import prompt_inputs


class ZeroShotVLM:
    """Asks a vision model for one fold after the other until it says that the instruction is carried out.

    It gets the picture as it is now, the instruction and its own picks and places so far; neither polygon nor subgoals
    nor fold lines (paper, Table IV, *Zero-Shot VLM*). Use it with the grounding ``image``.
    """

    decomposes: ClassVar[bool] = False

    class Config(BaseModel):
        """Prompt version and limits."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        prompt: str = Field(default="v2", description="version of the prompt")
        max_folds: int = Field(default=8, ge=1, le=30, description="folds after which it is not asked again")
        max_attempts: int | None = Field(
            default=None, ge=1, le=10, description="answers asked for; None: as the prompt says"
        )
        params: dict[str, Any] = Field(default_factory=dict, description="parameters for the model, over the prompt's")

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()
        self._done: list[dict[str, Any]] = []
        self._last = False

    @classmethod
    def prompts_read(cls, config: Config) -> list[str]:
        """The prompt that it uses with these parameters, as ``role@version``."""
        return [f"zero_shot@{config.prompt}"]

    def subgoals(self, instruction: str, template: Template, conversation: Conversation) -> list[Subgoal]:
        """The instruction as it is."""
        self._done, self._last = [], False
        return [Subgoal(instruction)]

    def plan(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> Action | None:
        """The next picks and places, or None when the model said that it is done, or after ``max_folds``.

        Raises:
            PlanError: if no valid answer came.
            ConfigError: if the scene has no picture.
        """

        def read(reply: Reply) -> Action | None:
            content = answer_object(reply)
            if says_done(content):
                return None
            action = action_in(content, (1, 2))
            check_action(action, scene)
            self._last = content.get("last") is True
            return action

        if self._last or len(self._done) >= self._config.max_folds:
            return None
        prompt = load_prompt("zero_shot", self._config.prompt)
        values = prompt_inputs(scene, prompt, instruction=subgoal.text, folds=self._done, garment=_garment(scene))
        attempts = self._config.max_attempts or prompt.max_attempts
        action = ask_until_valid(prompt, values, read, conversation, self._config.params, attempts)
        if action is not None:
            self._done.append({"picks": action.picks.round(1).tolist(), "places": action.places.round(1).tolist()})
        return action


def _garment(scene: Scene) -> dict[str, Any]:
    width, height = scene.image_size
    return {"garment": scene.kind, "image": {"width": width, "height": height}}
