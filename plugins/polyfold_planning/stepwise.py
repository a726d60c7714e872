"""What planners share that split an instruction and then plan one subgoal after the other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from polyfold.geometry import FoldLine
from polyfold.plugins.interfaces import Conversation
from polyfold.polygon import Template
from polyfold.types import Action, Reply, Scene, Subgoal
from polyfold_planning.answers.repair import ask_until_valid
from polyfold_planning.answers.replies import answer_object, undone_in
from polyfold_planning.decomposition import DecompositionConfig, decompose
from polyfold_planning.scene_prompts import prompt_for, prompt_inputs

Plan = TypeVar("Plan", FoldLine, Action)


class Stepwise:
    """Remembers which subgoals have been carried out, and tells the language model."""

    def __init__(self, config: DecompositionConfig) -> None:
        self._config = config
        self._done: list[str] = []

    def subgoals(self, instruction: str, template: Template, conversation: Conversation) -> list[Subgoal]:
        """Split an instruction. Raises RefusedError with the reason when it can't or must not be done."""
        self._done = []
        return decompose(instruction, template, conversation, self._config)

    def _asked(
        self,
        prompt_role: str,
        version: str,
        subgoal: Subgoal,
        scene: Scene,
        conversation: Conversation,
        read: Callable[[Mapping[str, Any]], Plan],
    ) -> Plan | Subgoal:
        """The plan of a subgoal, or an earlier one that has come open. Raises PlanError if no valid answer came.

        Args:
            prompt_role, version: of the prompt; what the scene shows decides the rest of its name.
            subgoal: what is to be planned.
            scene: the cloth as it is seen now.
            conversation: the language model.
            read: turns the answer's object into a plan, or raises PlanError with what is wrong.
        """

        def read_reply(reply: Reply) -> Plan | Subgoal:
            content = answer_object(reply)
            undone = undone_in(content, self._done)
            return read(content) if undone is None else Subgoal(undone)

        prompt = prompt_for(scene, prompt_role, version)
        values = prompt_inputs(scene, prompt, done=self._done, subgoal=subgoal.text)
        attempts = self._config.max_attempts or prompt.max_attempts
        found = ask_until_valid(prompt, values, read_reply, conversation, self._config.params, attempts)
        if isinstance(found, Subgoal):
            self._done = [text for text in self._done if text != found.text]
        else:
            self._done = [*self._done, subgoal.text]
        return found
