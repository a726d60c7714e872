"""Plans of folds: where two arms take cloth and how they carry it, without touching each other or anything else."""

from polyfold_pybullet.planning.folds import FoldPlanner, PlannerConfig
from polyfold_pybullet.planning.plans import FoldPlan, Infeasible, Motion

__all__ = ["FoldPlan", "FoldPlanner", "Infeasible", "Motion", "PlannerConfig"]
