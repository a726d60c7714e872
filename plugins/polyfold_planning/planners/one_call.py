"""The planner ``plan``: all fold lines at once from the polygon, planned again when the cloth lies otherwise."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from polyfold.errors import ConfigError, PlanError
from polyfold.geometry import FoldLine
from polyfold.plugins.interfaces import Conversation
from polyfold.polygon import FoldedModel, Template
from polyfold.prompts import load_prompt
from polyfold.types import Reply, Scene, Subgoal
from polyfold_planning.answers.lines import check_fold_line, check_lifted
from polyfold_planning.answers.repair import ask_until_valid
from polyfold_planning.answers.replies import answer_object, plan_in


class OneCallPlanner:
    """Asks once for every subgoal and its fold line, and again only if what is seen differs from what was expected.

    After each fold the model that the last line should have led to is compared with the one that was fitted to the
    picture. Where they agree, the next line is the one that was answered. A t-shirt's block takes a fifth of the tokens
    that asking fold by fold takes.
    """

    decomposes: ClassVar[bool] = False

    class Config(BaseModel):
        """Prompt version and limits."""

        model_config = ConfigDict(frozen=True, extra="forbid")

        prompt: str = Field(default="v1", description="version of the prompt")
        astray: float = Field(
            default=0.04,
            gt=0,
            lt=1,
            description="mean distance of vertices from where they were expected that makes it plan again, as a share "
            "of the garment's size",
        )
        max_subgoals: int = Field(default=10, ge=1, le=30, description="longest plan accepted")
        max_attempts: int | None = Field(
            default=None, ge=1, le=10, description="answers asked for; None: as the prompt says"
        )
        params: dict[str, Any] = Field(default_factory=dict, description="parameters for the model")

    def __init__(self, config: Config | None = None) -> None:
        self._config = config or self.Config()
        self._begin()

    def _begin(self) -> None:
        self._done: list[str] = []
        self._left: list[tuple[str, FoldLine]] | None = None
        self._expected: FoldedModel | None = None

    @classmethod
    def prompts_read(cls, config: Config) -> list[str]:
        """The prompt that it uses with these parameters, as ``role@version``."""
        return [f"plan@{config.prompt}"]

    def subgoals(self, instruction: str, template: Template, conversation: Conversation) -> list[Subgoal]:
        """The instruction as it is."""
        self._begin()
        return [Subgoal(instruction)]

    def plan(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> FoldLine | None:
        """The next fold line; None when all folds are done.

        Raises:
            PlanError: if no valid answer came.
            ConfigError: if the scene shows no polygon model.
        """
        if scene.model is None:
            raise ConfigError("the planner plan needs a polygon model to reckon with; choose --grounding polygon")
        if self._left is None or (self._left and not self._as_expected(scene.model)):
            self._left = self._asked(subgoal, scene, conversation)
        if not self._left:
            return None
        text, line = self._left.pop(0)
        self._done.append(text)
        self._expected = scene.model.fold(line)
        return line

    def _as_expected(self, model: FoldedModel) -> bool:
        """Whether the garment's vertices lie where the last fold should have brought them."""
        assert self._expected is not None
        wanted, found = self._expected.points(), model.points()
        off = [np.hypot(*(found[name] - wanted[name])) for name in model.names]
        return float(np.mean(off)) <= self._config.astray * float(np.ptp(model.rest, axis=0).max())

    def _asked(self, subgoal: Subgoal, scene: Scene, conversation: Conversation) -> list[tuple[str, FoldLine]]:
        """Every fold that is left, each line checked on the cloth as it should lie then."""

        def read(reply: Reply) -> list[tuple[str, FoldLine]]:
            plan = plan_in(answer_object(reply), self._config.max_subgoals, bool(self._done))
            _check(plan, scene)
            return plan

        prompt = load_prompt("plan", self._config.prompt)
        values = {"model": scene.text, "done": self._done, "instruction": subgoal.text}
        attempts = self._config.max_attempts or prompt.max_attempts
        return ask_until_valid(prompt, values, read, conversation, self._config.params, attempts)


def _check(plan: list[tuple[str, FoldLine]], scene: Scene) -> None:
    """Fold the model along every line in turn."""
    import cv2

    for number, (text, line) in enumerate(plan, 1):
        try:
            check_fold_line(line, scene)
            check_lifted(line, text, scene)
            assert scene.model is not None
            folded = scene.model.fold(line)
        except PlanError as error:
            raise PlanError(f"fold {number}: {error}") from error
        mask = np.zeros(scene.mask.shape, np.uint8)
        cv2.fillPoly(mask, [np.rint(folded.outline()).astype(np.int32)], 1)
        scene = replace(scene, model=folded, mask=mask.astype(bool))
