"""Plans of folds: where two arms take cloth and how they carry it, without touching each other or anything else."""

from polyfold.plugins.hardware import Infeasible
from polyfold_pybullet.planning.folds import FoldPlanner
from polyfold_pybullet.planning.moves import PlannerConfig
from polyfold_pybullet.planning.plans import FoldPlan, Motion

__all__ = ["FoldPlan", "FoldPlanner", "Infeasible", "Motion", "PlannerConfig"]
