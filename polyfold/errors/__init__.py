"""The typed hierarchy of errors, and the phrases that their messages share. Every message ends in what to do."""

from polyfold.errors._hints import did_you_mean, validation_problem
from polyfold.errors._types import (
    ActionError,
    ConfigError,
    GarmentError,
    GroundingError,
    LLMAccessError,
    LLMError,
    PlanError,
    PluginError,
    PolyfoldError,
    RefusedError,
    RobotError,
    SimulationError,
)

__all__ = [
    "ActionError",
    "ConfigError",
    "GarmentError",
    "GroundingError",
    "LLMAccessError",
    "LLMError",
    "PlanError",
    "PluginError",
    "PolyfoldError",
    "RefusedError",
    "RobotError",
    "SimulationError",
    "did_you_mean",
    "validation_problem",
]
