"""The one loop of an episode: see, decide, fold, see again."""

from polyfold.rollout._loop import MAX_STEPS, build_agent, run_episode
from polyfold.rollout._transcript import Transcript, request_place, without_pictures

__all__ = [
    "MAX_STEPS",
    "Transcript",
    "build_agent",
    "request_place",
    "run_episode",
    "without_pictures",
]
