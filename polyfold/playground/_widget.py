"""The playground in JupyterLab: the mouse draws, the kernel folds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import traitlets

from polyfold.errors import PolyfoldError
from polyfold.geometry import FoldLine
from polyfold.playground._moves import Move
from polyfold.playground._picture import has_values, lying, planned
from polyfold.playground._playground import Playground
from polyfold.types import Action, Decision, Observation, Step
from polyfold.viz import png
from polyfold.viz._draw._style import ARMS, FOLD_LINE, css

COLOURS = {"line": css(FOLD_LINE), "arms": [css(colour) for colour in ARMS]}
HINT = "Draw a fold line over the cloth: what is on its left is lifted."


class PlaygroundWidget(anywidget.AnyWidget):
    """Shows a playground and passes on what is drawn, pressed and typed.

    The browser sends messages ``{"do": NAME, ...}`` with pixels of the camera's picture; what it shows are traits.
    """

    _esm = Path(__file__).with_name("widget.js")
    _css = Path(__file__).with_name("widget.css")

    picture = traitlets.Bytes(b"", help="PNG of the table with what is planned").tag(sync=True)
    size = traitlets.List([0, 0], help="of the camera's picture, width and height [px]").tag(sync=True)
    status = traitlets.Unicode(HINT).tag(sync=True)
    turns = traitlets.List([], help="what was done, in words").tag(sync=True)
    planned = traitlets.Bool(False, help="whether there is something to fold").tag(sync=True)
    busy = traitlets.Bool(False).tag(sync=True)
    polygon = traitlets.Bool(True, help="draw the polygon").tag(sync=True)
    values = traitlets.Bool(False, help="draw the policy's map").tag(sync=True)
    colours = traitlets.Dict(COLOURS, help="of the fold line and of each arm").tag(sync=True)
    text = traitlets.Unicode("", help="a task or code to take home").tag(sync=True)

    def __init__(self, playground: Playground) -> None:
        super().__init__()
        self._playground = playground
        self._plan: Decision | None = None
        self._move: Move | None = None
        self._lies: tuple[Observation | None, bool] = None, False
        self.on_msg(self._received)
        self.observe(self._draw_again, ["polygon", "values"])
        self.show()

    def show(self) -> None:
        """Take over what the playground holds now."""
        playground = self._playground
        lies = playground.observation, self.polygon
        if lies != self._lies:
            if playground.observation is not self._lies[0]:
                self._plan, self._move = None, None
            self._lies, self._drawn = lies, lying(playground, self.polygon)
        drawn = self._drawn
        if self._plan is not None:
            drawn = planned(playground.observation, drawn, self._plan, self.values)
        height, width = playground.observation.rgb.shape[:2]
        with self.hold_sync():
            self.size = [width, height]
            self.turns = [turn.in_words() for turn in playground.turns]
            self.planned = self._plan is not None
            self.picture = png(drawn)

    def _draw_again(self, change: Mapping[str, Any]) -> None:
        if change["name"] == "values" and self.values and not has_values(self._plan):
            self.status = (
                "a map is drawn once a fold line is, by a policy that values every place to pick; this one is "
                f"{self._playground.experiment.policy.name}, and csam+caso is one that does"
            )
        self.show()

    def _received(self, _: Any, content: Mapping[str, Any], buffers: Any) -> None:
        """Do what the browser asks for; what can't be done is said where the person looks."""
        actions: dict[str, Callable[[Mapping[str, Any]], None]] = {
            "line": self._drew_line,
            "picks": self._drew_picks,
            "flip": self._flip,
            "clear": self._clear,
            "fold": self._fold,
            "say": self._say,
            "undo": self._undo,
            "task": self._take_task,
            "code": self._take_code,
            "save": self._save,
        }
        try:
            if str(content["do"]) in ("task", "code", "save"):
                self.status = ""
            actions[str(content["do"])](content)
        except PolyfoldError as error:
            self.status = str(error)
        except (KeyError, TypeError, ValueError, IndexError) as error:
            self.status = (
                f"the page sent what can't be read ({type(error).__name__}: {error}); show the playground again"
            )
        finally:
            self.show()
            self.send({"do": "answered"})

    def _drew_line(self, told: Mapping[str, Any]) -> None:
        width, height = self.size
        start, end = np.clip(np.round([told["start"], told["end"]], 1), 0, [width - 1, height - 1])
        if np.hypot(*(end - start)) < 1.0:
            self.status = "that was a click; drag from where the fold line begins to where it ends"
            return
        self._think_of(FoldLine.between(start, end))

    def _drew_picks(self, told: Mapping[str, Any]) -> None:
        arrows = np.round(told["arrows"], 1)  # arms, pick and place, x and y
        self._think_of(Action(arrows[:, 0], arrows[:, 1]))

    def _think_of(self, move: FoldLine | Action) -> None:
        self._plan, self._move = None, None
        self._plan, self._move = self._playground.propose(move), move
        arms = "one arm" if self._plan.action.arms == 1 else "two arms"
        self.status = f"{arms}; Fold does it, Flip lifts the other side"

    def _flip(self, _: Mapping[str, Any]) -> None:
        if isinstance(self._move, FoldLine):
            self._think_of(self._move.reversed())
        else:
            self.status = "only a fold line has another side"

    def _clear(self, _: Mapping[str, Any]) -> None:
        self._plan, self._move, self.status, self.text = None, None, HINT, ""

    def _fold(self, _: Mapping[str, Any]) -> None:
        if self._move is not None:
            self._do(self._move, "folding")

    def _say(self, told: Mapping[str, Any]) -> None:
        if sentence := str(told["sentence"]).strip():
            self._do(sentence, "reading and folding")
        else:
            self.status = "type what to fold first, such as: fold it in half"

    def _do(self, move: Move, doing: str) -> None:
        self.busy, self.status = True, f"{doing} … (the kernel's stop button ends it)"
        try:
            with self._playground.motion.watched(self._show_motion):
                steps = self._playground.fold(move)
            self.status = self._told(steps)
        except KeyboardInterrupt:
            self.status = "stopped; the cloth lies as before that fold"
        finally:
            self.busy = False

    def _told(self, steps: Sequence[Step]) -> str:
        """What was folded, and how near all of it so far came to what was asked for or planned."""
        if not steps:
            return "nothing was left to fold"
        words = "; ".join(step.in_words() for step in steps)
        fidelity = self._playground.episode.fidelity
        return words if fidelity is None else f"{words}; beside the ideal: {fidelity.figures()}"

    def _show_motion(self, seen: Observation) -> None:
        self.send({"do": "frame"}, [png(seen.rgb)])

    def _undo(self, _: Mapping[str, Any]) -> None:
        self.status = "taken back" if self._playground.undo() else "nothing was folded yet"

    def _take_task(self, told: Mapping[str, Any]) -> None:
        self.text = self._playground.task(str(told["name"]) or "my-task")

    def _take_code(self, _: Mapping[str, Any]) -> None:
        self.text = self._playground.code()

    def _save(self, told: Mapping[str, Any]) -> None:
        folder = self._playground.save(str(told["name"]) or "my-task")
        self.status = f"episode.json, filmstrip.png and fold.gif are in {folder}"
