"""What one plays with: the cloth as it lies, what was done to it, and what would be done next."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from polyfold import plugins
from polyfold.api._fold import folder_for, garment_for, save
from polyfold.config import Experiment, checked_seed
from polyfold.errors import ConfigError, GroundingError
from polyfold.evaluation import judge
from polyfold.garments import Garment
from polyfold.geometry import FoldLine, contour_of
from polyfold.playground._motion import Motion
from polyfold.playground._moves import Move, Turn, refuse_what_is_no_move
from polyfold.plugins._fabrics import garment_template
from polyfold.plugins.interfaces import action_map_later
from polyfold.rollout._inputs import Start
from polyfold.rollout._loop import build_agent
from polyfold.rollout._rollout import Mark, Rollout
from polyfold.rollout._sentences import plain
from polyfold.rollout._transcript import Transcript
from polyfold.types import Action, Decision, Episode, Observation, Scene, SimState, Step
from polyfold.types._views import view_of


def play(
    garment: str | Garment = "tshirt", seed: int = 0, *, experiment: Experiment | None = None, **components: Any
) -> Playground:
    """Lay a garment on the table and fold it by hand; the last line of a cell in JupyterLab shows a widget.

    There one draws a fold line or drags picks to their places, sees the policy's picks and the polygon, folds, takes
    back, types a sentence, and takes home what was done. Everything is there from code as well::

        playground = polyfold.play("tshirt")
        playground.fold("fold it in half")
        playground.fold(polyfold.FoldLine((120, 210), (280, 210)))
        playground.undo()

    Args:
        garment: a kind, of which ``seed`` picks the instance, or a garment made by :func:`polyfold.garment`.
        seed: picks the garment and how it lies, and the agent's random choices.
        experiment: the components; by default those that need no key and no GPU.
        components: single components instead: ``policy="farthest"``, ``fabric="denim"``.

    Raises:
        PluginError: if there is no such kind of garment, or no such component.
        ConfigError: if the agent can't follow sentences alone, or the seed is no whole number.
    """
    experiment, seed = (experiment or Experiment()).override(components), checked_seed(seed)
    return Playground(garment_for(experiment, garment, seed), seed, experiment)


class Playground:
    """Cloth on a table, folded move by move; :func:`play` makes one.

    Attributes:
        garment: what lies there.
        experiment: with which components.
        seed: of how it lay, and of the random choices.
        turns: what was asked for so far.
        motion: pictures of the cloth while it moves.
        widget: what shows it in JupyterLab, once it was shown.
    """

    def __init__(self, garment: Garment, seed: int, experiment: Experiment) -> None:
        self.garment, self.experiment, self.seed = garment, experiment, seed
        self._agent = build_agent(experiment)
        if self._agent.requires - {"instruction"}:
            raise ConfigError(
                f"the agent {experiment.agent.name!r} needs {', '.join(sorted(self._agent.requires))}, and here is a "
                "sentence at most; choose an agent that follows sentences, such as polyfold"
            )
        self._segmenter = plugins.create_chosen(experiment, "segmenter")
        self._grounding = plugins.create_chosen(experiment, "grounding")
        self._policy = plugins.create_chosen(experiment, "policy")
        self._simulator = plugins.create_chosen(experiment, "simulator")
        labels = {"task": None, "garment": garment.name, "seed": seed, "instruction": ""}
        self._transcript = Transcript(plugins.create_chosen(experiment, "llm"), labels)
        observation = self._simulator.reset(garment, seed)
        self._rollout = Rollout(
            Start(
                experiment, garment, "", None, observation, self._simulator.state(), self._transcript, self._simulator
            )
        )
        self.turns: list[Turn] = []
        self._closed: Episode | None = None
        self._scene: Scene | None = None
        self.motion = Motion(self._simulator, lambda: len(self.steps))
        self.widget: Any = None

    @property
    def steps(self) -> tuple[Step, ...]:
        """The folds so far."""
        return tuple(self._rollout.steps)

    @property
    def observation(self) -> Observation:
        """What the camera sees now."""
        return self._rollout.seen

    @property
    def state(self) -> SimState:
        """Where the cloth truly is, after the last fold that was finished."""
        return self.steps[-1].after if self.steps else self._rollout.start.state

    @property
    def scene(self) -> Scene:
        """What the grounding makes of it; without a polygon, and with the reason among the notes, where it can't.

        Raises:
            GroundingError: if no cloth is in sight.
        """
        if self._scene is None:
            self._scene = self._grounded()
        return self._scene

    def _grounded(self) -> Scene:
        last = self._rollout.steps[-1] if self._rollout.steps else None
        mask = self._segmenter.segment(self.observation)
        template = garment_template(self.garment.kind, self.garment.fabric)
        before = (None, None) if last is None else (last.scene, last.fold_line)
        try:
            return self._grounding.ground(self.observation, mask, template, *before)
        except GroundingError as error:
            height, width = mask.shape
            return Scene(self.garment.kind, (width, height), mask, contour_of(mask), None, "{}", notes=(str(error),))

    def propose(self, move: FoldLine | Action) -> Decision:
        """What a fold line would have done, by the policy's picks; picks and places are taken as they are.

        Raises:
            PlanError: if no cloth lies left of the line.
            ActionError: if a pick or place lies outside the picture.
            GroundingError: if no cloth is in sight.
        """
        self._refuse_if_closed()
        refuse_what_is_no_move(move, FoldLine | Action)
        scene = self.scene
        if isinstance(move, Action):
            move.check_inside(self.observation.camera)
            line = FoldLine.moving(move.picks.mean(axis=0), move.places.mean(axis=0))
            return Decision(move, None, line, scene)
        clock = time.perf_counter()
        # The same line has the same picks, however often it is looked at.
        rng = np.random.default_rng([self.seed, len(self.steps)])
        action = self._policy.act(move, scene, rng)
        spent = {"policy": time.perf_counter() - clock}
        return Decision(action, None, move, scene, spent, action_map=action_map_later(self._policy, move, scene))

    def fold(self, move: Move) -> tuple[Step, ...]:
        """Fold along a line with the policy's picks, from picks to places, or as a sentence says.

        A sentence goes through the experiment's agent, which may fold several times and set a fold right; it goes on
        from what was folded by hand.

        Returns:
            The folds that were made.

        Raises:
            RefusedError: if the sentence can't be understood or done.
            PolyfoldError: as of :meth:`propose`, or if planning or the simulation fail; folds made until then stay.
        """
        self._refuse_if_closed()
        refuse_what_is_no_move(move, str | FoldLine | Action)
        before = self._rollout.mark()
        try:
            if isinstance(move, str):
                self._follow(plain(move))
            else:
                self._rollout.execute(self.propose(move))
        except BaseException:
            self._keep_what_was_finished(before)
            raise
        made = self.steps[before.steps :]
        if made:
            self.turns.append(Turn(move, made, before))
            self._scene = None
        self._show()
        return made

    def _keep_what_was_finished(self, before: Mark) -> None:
        """After a fold that was broken off: the cloth lies as after the last whole one, each a move of its own."""
        self._simulator.restore(self.state)
        self.motion.forget_undone()
        for step in self.steps[before.steps :]:
            mark = before._replace(steps=step.index)
            self.turns.append(Turn(step.action, (step,), mark))
            self._scene = None

    def _follow(self, sentence: str) -> None:
        error = self._rollout.follow(self._agent, sentence, self.seed, self.seed)
        if error is not None:
            raise error

    def undo(self) -> bool:
        """Take back what the last :meth:`fold` did; False if nothing was done yet."""
        self._refuse_if_closed()
        if not self.turns:
            return False
        self._rollout.go_back(self.turns[-1].before)
        self.turns.pop()
        self.motion.forget_undone()
        self._scene = None
        self._show()
        return True

    def _show(self) -> None:
        """Have the widget, if one was shown, show what was done from code, too."""
        if self.widget is not None:
            self.widget.show()

    @property
    def episode(self) -> Episode:
        """What was done so far, judged as :func:`polyfold.fold` judges; it shows itself as a filmstrip."""
        done = self._closed or self._rollout.episode(self.seed, self.seed)
        return judge(replace(done, instruction=self._in_words()))

    def save(self, folder: str | Path) -> Path:
        """Write what was done as ``polyfold fold --out`` does: ``episode.json``, ``filmstrip.png``, ``fold.gif``.

        Raises:
            ConfigError: if nothing was done yet, or the folder can't be written to.
        """
        self._refuse_if_untouched()
        if not str(folder):
            raise ConfigError("name a folder to save to")
        folder = folder_for(Path(folder).expanduser())
        save(self.episode, folder, self.motion.moments)
        return folder

    def task(self, name: str = "my-task") -> str:
        """What was done as a task of a suite, in TOML, on the garment's keypoints, so that it fits others of its kind.

        Write it into a file, ``mine.toml``, and name that as a study's ``suite``, or in a plugin.

        Raises:
            ConfigError: if nothing was done yet, the name serves no task, or the cloth is real.
        """
        from polyfold.playground._tasks import as_task

        self._refuse_if_untouched()
        if not self._rollout.start.state.known:
            raise ConfigError(
                "a task is told by true keypoints, and of real cloth nobody knows them; play in simulation"
            )
        return as_task(self.garment, self._rollout.start.state.keypoint_pixels(), self._moves(), name)

    def code(self) -> str:
        """What was done as Python that does it again."""
        from polyfold.playground._code import as_code

        return as_code(self.garment, self.seed, self.experiment, [turn.move for turn in self.turns])

    def close(self) -> None:
        """Release the simulator; nothing can be folded afterwards, but what was done stays."""
        if self._closed is None:
            self._closed = self._rollout.episode(self.seed, self.seed)
            self._simulator.close()
            if self.widget is not None:
                self.widget.status = "this playground is closed; begin anew with polyfold.play(...)"

    def __enter__(self) -> Playground:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _moves(self) -> list[tuple[str | None, Sequence[Step]]]:
        """Each sentence, or None for a move by hand, with its folds."""
        return [(turn.move if isinstance(turn.move, str) else None, turn.steps) for turn in self.turns]

    def _in_words(self) -> str:
        """What was done: sentences as they were said, moves by hand by the keypoints."""
        from polyfold.playground._tasks import told

        said = [sentence or "a fold by hand" for sentence, _ in self._moves()]
        start = self._rollout.start.state
        if not start.known:
            return "; then ".join(said)
        try:
            return told(self.garment, start.keypoint_pixels(), self._moves())[1]
        except ConfigError:  # a fold without a line
            return "; then ".join(said)

    def _refuse_if_closed(self) -> None:
        if self._closed is not None:
            raise ConfigError("this playground is closed; begin anew with polyfold.play(...)")

    def _refuse_if_untouched(self) -> None:
        if not self.turns:
            raise ConfigError("nothing was folded yet; fold something first")

    def _repr_mimebundle_(self, **options: Any) -> dict[str, Any]:
        return view_of(self, "mimebundle", options)

    def __repr__(self) -> str:
        folds = "1 fold" if len(self.steps) == 1 else f"{len(self.steps)} folds"
        return f"<Playground: {self.garment.name}, {folds}>"
