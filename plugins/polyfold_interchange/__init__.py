"""Folds for other people's tools: an environment for Gymnasium, data sets for LeRobot."""

from polyfold_interchange.environment import FoldingEnv
from polyfold_interchange.lerobot import write_dataset

__all__ = ["FoldingEnv", "write_dataset"]
