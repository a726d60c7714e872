"""The one loop of an episode: see, decide, fold, see again."""

from polyfold.rollout._loop import run_episode
from polyfold.rollout._transcript import request_place, without_pictures

__all__ = [
    "request_place",
    "run_episode",
    "without_pictures",
]
