"""``clasp-like``: a language model plans skills on the garment's named keypoints, carried out one after the other.

Y. Deng, C. Tang, C. Yu, L. Li, D. Hsu, CLASP: General-Purpose Clothes Manipulation with Semantic Keypoints, 2025,
arXiv:2507.19983 (before: Y. Deng, D. Hsu, 2024, arXiv:2408.08160). It is newer than the paper of PolyFold and not in
its tables. Its detector and skills are not public as a whole, hence *-like*.

The same here: keypoints with names that mean something, such as *left sleeve*, stand between language and motion; a
language model plans over their names alone, before anything moves; prepared skills carry the plan out where the
keypoints are seen then. Different: one skill, carrying one or two keypoints to others, of theirs, since nothing is
hung or flattened here; keypoints are the vertices of what the grounding has fitted, instead of found by a network that
was trained on rendered clothes; a place may lie midway between two keypoints, without which no cloth folds to a middle
line; the model is told of the garment's kind and names, and sees no picture.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from polyfold.errors import PlanError
from polyfold.geometry import FoldLine
from polyfold.plugins.interfaces import Goal, Grounding, Segmenter
from polyfold.types import Action, Decision, Observation, Scene, Subgoal
from polyfold_baselines.agents.asking.conversing import Answer, ask
from polyfold_baselines.demos.window import on_cloth

Floats = NDArray[np.float64]

MOST_SKILLS = 12


class _Skill(Answer):
    """One carry: each pick is a keypoint; each place one, or the middle between two."""

    pick: list[str] = Field(min_length=1, max_length=2)
    place: list[str | tuple[str, str]] = Field(min_length=1, max_length=2)


class _Plan(Answer):
    plan: list[_Skill] = Field(min_length=1, max_length=MOST_SKILLS)


class ClaspLike:
    """Carries keypoints to where a language model's plan says."""

    requires: ClassVar[frozenset[str]] = frozenset({"instruction", "subgoal_texts"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter", "grounding")

    def __init__(self, segmenter: Segmenter, grounding: Grounding) -> None:
        self._segmenter, self._grounding = segmenter, grounding

    @classmethod
    def prompts_read(cls, config: None) -> list[str]:
        """The prompt, as ``role@version``."""
        return ["keypoint_skills@v1"]

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Ask for the whole plan: once for each sentence that is told."""
        if goal.conversation is None:
            raise PlanError("clasp-like needs a language model; choose one")
        self._template = goal.template
        self._before: tuple[Scene, FoldLine] | None = None
        names = list(goal.template.names)

        def read(answer: _Plan) -> list[_Skill]:
            for skill in answer.plan:
                _check(skill, names)
            return answer.plan

        self._pending: list[_Skill] = []
        for sentence in goal.subgoal_texts or ():
            told = {"garment": {"garment": goal.kind, "keypoints": names}, "sentence": sentence}
            self._pending += ask("keypoint_skills", told, _Plan, read, goal.conversation)
        self._pending.reverse()
        return tuple(Subgoal(_in_words(skill)) for skill in reversed(self._pending))

    def decide(self, observation: Observation) -> Decision | None:
        """The next skill, where its keypoints are seen; None after the last."""
        if not self._pending:
            return None
        skill = self._pending.pop()
        mask = self._segmenter.segment(observation)
        scene = self._grounding.ground(observation, mask, self._template, *(self._before or (None, None)))
        points = _keypoints(scene)
        limit = [observation.camera.width - 1.0, observation.camera.height - 1.0]
        picks = on_cloth([points[name] for name in skill.pick], mask)
        places = np.clip([_where(place, points) for place in skill.place], 0.0, limit)
        line = FoldLine.moving(picks.mean(axis=0), places.mean(axis=0))
        self._before = scene, line
        return Decision(Action(picks, places), Subgoal(_in_words(skill)), line, scene)


def _check(skill: _Skill, names: Sequence[str]) -> None:
    """Raise PlanError, in words for the model, unless a skill can be carried out."""
    used = [*skill.pick, *(name for place in skill.place for name in ([place] if isinstance(place, str) else place))]
    if unknown := sorted(set(used) - set(names)):
        raise PlanError(f"there are no keypoints {', '.join(unknown)}; use only {', '.join(names)}")
    if len(skill.pick) != len(skill.place):
        raise PlanError("every pick needs one place; give as many places as picks, in the same order")
    if len(set(skill.pick)) < len(skill.pick):
        raise PlanError("both arms pick at one keypoint; name two, or use one arm")
    if any(pick == place for pick, place in zip(skill.pick, skill.place, strict=True)):
        raise PlanError("a pick and its place are the same keypoint, so nothing would move")


def _keypoints(scene: Scene) -> Mapping[str, Floats]:
    if scene.model is None:
        raise PlanError(
            f"{scene.grounding or 'the grounding'} names no keypoints; choose one that fits a model: polygon"
        )
    return scene.model.points()


def _where(place: str | tuple[str, str], points: Mapping[str, Floats]) -> Floats:
    names = [place] if isinstance(place, str) else list(place)
    return np.mean([points[name] for name in names], axis=0)


def _in_words(skill: _Skill) -> str:
    places = [place if isinstance(place, str) else f"between {place[0]} and {place[1]}" for place in skill.place]
    carried = (f"{pick} to {place}" for pick, place in zip(skill.pick, places, strict=True))
    return f"carry {' and '.join(carried)}".replace("_", " ")
