"""The values that flow through an episode: what a camera sees, what is planned, what is done, how it came out.

Frames and units: pixels are ``(x, y)``, y down, ``(0, 0)`` the centre of the top-left pixel. The world is in metres,
x right, y away from the viewer, z up from the table. :class:`polyfold.geometry.Camera` is the only converter.
"""

from polyfold.types._conversation import Call, Message, Reply
from polyfold.types._decisions import Action, ActionMap, Decision, Subgoal
from polyfold.types._episode import Episode, EpisodeStart, Failure, Role, Step
from polyfold.types._fidelity import Fidelity
from polyfold.types._perception import Observation, Scene
from polyfold.types._scores import Outcome, Threshold
from polyfold.types._state import SimState

__all__ = [
    "Action",
    "ActionMap",
    "Call",
    "Decision",
    "Episode",
    "EpisodeStart",
    "Failure",
    "Fidelity",
    "Message",
    "Observation",
    "Outcome",
    "Reply",
    "Role",
    "Scene",
    "SimState",
    "Step",
    "Subgoal",
    "Threshold",
]
