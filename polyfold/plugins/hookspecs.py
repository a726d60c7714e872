"""Every hook a plugin can implement.

A plugin is a module (or any object) named by an entry point in the group ``polyfold``::

    [project.entry-points.polyfold]
    my-plugin = "my_package.hooks"

    # my_package/hooks.py
    from polyfold import hookimpl

    @hookimpl
    def register_policies(register):
        register("centre", "my_package.centre:Centre", "picks nearest the centre of the flap")

Each ``register_*`` hook gets a function ``register(name, target, summary="", needs=())``:

* ``name``: what users type, lower case, e.g. ``csam+caso``;
* ``target``: ``"package.module:Class"``, so that listing the plugin imports nothing heavy;
* ``summary``: one line for ``polyfold plugins``;
* ``needs``: distributions to install before the component can be used, as pip names them; a missing one is answered
  with the pip command.

What the class must do stands in :mod:`polyfold.plugins.interfaces`, for cameras and robots in
:mod:`polyfold.plugins.hardware`. The ``on_*`` hooks observe: what they return is
ignored, and an error in one is recorded against its plugin without disturbing the run. A hook may take fewer arguments
than its specification has. No hook sits in the data path.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from pydantic import BaseModel

    from polyfold.types import Episode, EpisodeStart, Role, Step


__all__ = ["KINDS", "hookimpl"]

hookspec = pluggy.HookspecMarker("polyfold")
hookimpl = pluggy.HookimplMarker("polyfold")

KINDS = (
    "simulators",
    "cameras",
    "robots",
    "segmenters",
    "groundings",
    "planners",
    "policies",
    "llms",
    "agents",
    "garments",
    "fabrics",
    "tasks",
    "metrics",
    "criteria",
)
"""The kinds of component, plural, in the order of the data flow."""

Register = Callable[..., None]


def singular(kind: str) -> str:
    """``policies`` to ``policy``: what one component of a kind is called, and its field in an experiment."""
    return {"policies": "policy", "criteria": "criterion"}.get(kind, kind.removesuffix("s"))


def plural(field: str) -> str:
    """``policy`` to ``policies``: the kind of component that an experiment names in a field."""
    return {"policy": "policies", "criterion": "criteria"}.get(field, f"{field}s")


@hookspec
def register_simulators(register: Register) -> None:
    """Register simulators: :class:`polyfold.plugins.interfaces.Simulator`, cloth on a table under a camera."""


@hookspec
def register_cameras(register: Register) -> None:
    """Register cameras: :class:`polyfold.plugins.hardware.DepthCamera`, what measures colour and depth."""


@hookspec
def register_robots(register: Register) -> None:
    """Register robots: :class:`polyfold.plugins.hardware.Robot`, arms that carry out picks and places.

    Constructing one must not move it, nor open a connection.
    """


@hookspec
def register_segmenters(register: Register) -> None:
    """Register segmenters: :class:`polyfold.plugins.interfaces.Segmenter`, picture to mask."""


@hookspec
def register_groundings(register: Register) -> None:
    """Register groundings: :class:`polyfold.plugins.interfaces.Grounding`, picture and mask to scene."""


@hookspec
def register_planners(register: Register) -> None:
    """Register planners: :class:`polyfold.plugins.interfaces.Planner`, sentence to subgoals to fold lines."""


@hookspec
def register_policies(register: Register) -> None:
    """Register policies: :class:`polyfold.plugins.interfaces.Policy`, fold line to picks and places."""


@hookspec
def register_llms(register: Register) -> None:
    """Register language-model backends: :class:`polyfold.plugins.interfaces.LLM`, messages to reply."""


@hookspec
def register_agents(register: Register) -> None:
    """Register agents: :class:`polyfold.plugins.interfaces.Agent`, instruction and pictures to actions.

    An agent made of components names their kinds: :class:`polyfold.plugins.interfaces.UsesComponents`.
    """


@hookspec
def register_garments(register: Register) -> None:
    """Register kinds of garment: :class:`polyfold.plugins.interfaces.GarmentKind`, polygon template and generator.

    The name is the kind, as users type it: ``--garment skirt``. Its class may say what it is usually made of
    (:class:`polyfold.plugins.interfaces.MadeOf`; else it is poplin) and, in a tuple ``also_called``, by which other
    names people ask for it.
    """


@hookspec
def register_fabrics(register: Register) -> None:
    """Register fabrics: :class:`polyfold.plugins.interfaces.FabricKind`, what garments are made of.

    The name is what users type: ``--fabric denim``. ``usual`` is taken: it stands for the fabric that a kind of garment
    is usually made of (:class:`polyfold.plugins.interfaces.MadeOf`).
    """


@hookspec
def register_tasks(register: Register) -> None:
    """Register task suites: tasks and goals in files.

    ``target`` is ``"package:path/within/it.toml"``. A suite holds tasks, whose folds are given
    (:class:`polyfold.tasks.Task`), goals, which say what counts as done and leave the folds to the planner
    (:class:`polyfold.tasks.OpenTask`), or both. ``polyfold evaluate`` runs it when a study names it.
    """


@hookspec
def register_metrics(register: Register) -> None:
    """Register metrics: :class:`polyfold.plugins.interfaces.Metric`, final state and reference to a number."""


@hookspec
def register_criteria(register: Register) -> None:
    """Register success criteria: :class:`polyfold.plugins.interfaces.SuccessCriterion`, bounds on metrics."""


@hookspec
def register_commands(register: Register) -> None:
    """Register CLI verbs. ``target`` is a class or module with ``configure(parser)`` and ``run(arguments) -> int``.

    The parser knows three types of options by name besides argparse's own: ``type="seed"`` takes whole numbers from 0,
    ``"count"`` from 1, and ``"metres"`` lengths above zero.
    """


@hookspec
def register_prompts(register: Register) -> None:
    """Register prompt folders: ``target`` is ``"package:folder"`` with one sub-folder per role."""


@hookspec
def on_study_start(study: BaseModel) -> None:
    """A study begins or goes on: fires in the process that was asked to run it.

    Args:
        study: what is run, a :class:`polyfold.Study`.
    """


@hookspec
def on_episode_start(start: EpisodeStart, role: Role) -> None:
    """An episode begins: the garment lies on the table and the subgoals are known.

    Fires where the episode runs, which in a study with workers is a worker process; so do ``on_step`` and
    ``on_episode_end``. An agent that refuses before it has subgoals has no start, and an end nevertheless.

    Args:
        start: what is known by then.
        role: ``method`` for an episode that was asked for; ``reference`` for the oracle's own, which a study compares
            with and keeps, so that it runs once and is then read from the cache.
    """


@hookspec
def on_step(step: Step, role: Role) -> None:
    """One fold was executed.

    Args:
        step: what was decided and done, and the true state after it.
        role: as for :func:`on_episode_start`.
    """


@hookspec
def on_episode_end(episode: Episode, role: Role) -> None:
    """An episode ended, well or not; ``episode.failure`` says which.

    In ``polyfold fold`` it is judged by then; in a study its scores are in the run's log, after it.

    Args:
        episode: everything that happened.
        role: as for :func:`on_episode_start`.
    """


@hookspec
def on_study_end(study: BaseModel, finished: int) -> None:
    """A study ended, or was interrupted: fires where ``on_study_start`` did.

    Args:
        study: what was run, a :class:`polyfold.Study`.
        finished: episodes that are finished; fewer than the study has if it was interrupted.
    """
