"""The first role of all planners that split instructions: a sentence and the garment's template to subgoals."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from polyfold.plugins.interfaces import Conversation
from polyfold.polygon import Template
from polyfold.prompts import load_prompt
from polyfold.types import Reply, Subgoal
from polyfold_planning.answers.grammar import check_subgoal
from polyfold_planning.answers.repair import ask_until_valid
from polyfold_planning.answers.replies import answer_object, subgoals_in


class DecompositionConfig(BaseModel):
    """Parameters of the decomposition."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    subgoals_prompt: str = Field(default="v2", description="version of the prompt that splits instructions")
    max_attempts: int | None = Field(
        default=None, ge=1, le=10, description="answers asked for; None: as the prompt says"
    )
    max_subgoals: int = Field(default=10, ge=1, le=30, description="longest plan accepted")
    check_grammar: bool = Field(default=True, description="hold subgoals to the anchored form and known parts")
    params: dict[str, Any] = Field(default_factory=dict, description="parameters for the model, over the prompt's")


def decompose(
    instruction: str, template: Template, conversation: Conversation, config: DecompositionConfig
) -> list[Subgoal]:
    """Split an instruction. Raises RefusedError with the reason when it can't or must not be done."""

    def read(reply: Reply) -> list[Subgoal]:
        texts = subgoals_in(answer_object(reply), config.max_subgoals)
        if config.check_grammar:
            for text in texts:
                check_subgoal(text, template)
        return [Subgoal(text) for text in texts]

    prompt = load_prompt("subgoals", config.subgoals_prompt)
    values = {"template": template.to_text(), "instruction": instruction}
    attempts = config.max_attempts or prompt.max_attempts
    return ask_until_valid(prompt, values, read, conversation, config.params, attempts)
