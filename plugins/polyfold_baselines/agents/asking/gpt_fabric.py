"""``gpt-fabric-like``: corners of the cloth as text to a language model, which answers with a pick and a place.

V. Raval, E. Zhao, H. Zhang, S. Nikolaidis, D. Seita, GPT-Fabric: Smoothing and Folding Fabric by Leveraging Pre-Trained
Foundation Models, 2024, arXiv:2406.09640. It is newer than the paper of PolyFold and not in its tables. Which model
answers decides what it can do, and the source's own prompts are not repeated here, hence *-like*.

The same here: corners found in the picture and the cloth's middle are told in pixels; a language model that has seen no
example answers with one pick and one place for each step, and is told what was done before. Different: prompts of our
own; each step's sentence is given (or the whole instruction), instead of written by a vision model from pictures of a
demonstration; corners by Shi and Tomasi in the cloth's silhouette and its heights at once, instead of in the depth
picture; a pick beside the cloth goes to its nearest pixel, and one far from it is asked for again.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from polyfold.errors import PlanError
from polyfold.plugins.interfaces import Goal, Segmenter
from polyfold.types import Action, Decision, Observation, Subgoal
from polyfold_baselines.agents.asking.conversing import Answer, ask
from polyfold_baselines.agents.goals import InTurn
from polyfold_baselines.demos.window import on_cloth

MOST_CORNERS = 12
QUALITY = 0.15
"""Corners that are so much weaker than the strongest are none."""
TALL = 0.004
"""What rises by this [m] is as clear in a picture of heights as the cloth's own edge."""
BESIDE = 12.0
"""A pick this far from the cloth [px] is a mistake."""
LEAST_WAY = 10.0
"""Shorter ways [px] fold nothing."""


class _Move(Answer):
    pick: tuple[float, float]
    place: tuple[float, float]


class GptFabricLike:
    """Tells a language model where the cloth's corners are, and carries what it says to where it says."""

    requires: ClassVar[frozenset[str]] = frozenset({"instruction", "subgoal_texts", "fold_count"})
    uses: ClassVar[tuple[str, ...]] = ("segmenter",)

    def __init__(self, segmenter: Segmenter) -> None:
        self._segmenter = segmenter

    @classmethod
    def prompts_read(cls, config: None) -> list[str]:
        """The prompt, as ``role@version``."""
        return ["corner_moves@v1"]

    def begin(self, goal: Goal, observation: Observation) -> Sequence[Subgoal]:
        """Hear what to do."""
        if goal.conversation is None:
            raise PlanError("gpt-fabric-like needs a language model; choose one")
        self._conversation = goal.conversation
        self._sentences = InTurn(goal.subgoal_texts or (), goal.fold_count)
        self._done: list[dict[str, Any]] = []
        return ()

    def decide(self, observation: Observation) -> Decision | None:
        """What the model says to move next; None after the last fold."""
        if (sentence := self._sentences.next()) is None:
            return None
        mask = self._segmenter.segment(observation)
        heights = np.nan_to_num(observation.camera.elevation - observation.depth)

        def read(move: _Move) -> Action:
            return _action(move, mask)

        told = {"cloth": seen(mask, heights), "done": self._done, "sentence": sentence}
        action = ask("corner_moves", told, _Move, read, self._conversation)
        pick, place = (np.round(points[0]).tolist() for points in (action.picks, action.places))
        self._done.append({"sentence": sentence, "pick": pick, "place": place})
        return Decision(action, Subgoal(sentence))


def seen(mask: NDArray[np.bool_], heights: NDArray[np.floating]) -> dict[str, Any]:
    """What a model is told of the cloth: the picture's size, corners and the middle, in whole pixels.

    Args:
        mask: the cloth, shape (H, W).
        heights: above the table [m], shape (H, W).
    """
    import cv2

    picture = np.where(mask, 0.5 + 0.5 * np.clip(heights / TALL, 0.0, 1.0), 0.0).astype(np.float32)
    apart = max(6.0, 0.12 * float(np.sqrt(mask.sum())))
    found = cv2.goodFeaturesToTrack(picture, MOST_CORNERS, QUALITY, apart, blockSize=7)
    corners = [] if found is None else [[round(x), round(y)] for x, y in found.reshape(-1, 2).tolist()]
    rows, columns = np.nonzero(mask)
    middle = [round(float(values.mean())) for values in (columns, rows)] if len(rows) else []
    return {"width": mask.shape[1], "height": mask.shape[0], "corners": sorted(corners), "middle": middle}


def _action(move: _Move, mask: NDArray[np.bool_]) -> Action:
    pick, place = np.array(move.pick), np.array(move.place)
    for what, (x, y) in (("pick", pick), ("place", place)):
        if not (0 <= x < mask.shape[1] and 0 <= y < mask.shape[0]):
            raise PlanError(f"the {what} ({x:.0f}, {y:.0f}) lies outside the {mask.shape[1]} x {mask.shape[0]} picture")
    nearest = on_cloth(pick[None], mask)[0]
    if np.hypot(*(nearest - pick)) > BESIDE:
        x, y = nearest
        raise PlanError(f"the pick ({pick[0]:.0f}, {pick[1]:.0f}) is beside the cloth, nearest at ({x:.0f}, {y:.0f})")
    if np.hypot(*(place - nearest)) < LEAST_WAY:
        raise PlanError(f"the place is less than {LEAST_WAY:.0f} px from the pick, so nothing would move")
    return Action(nearest[None], place[None])
