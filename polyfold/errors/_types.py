"""The typed hierarchy of errors. Every message ends in what the reader can do about it."""

from __future__ import annotations


class PolyfoldError(Exception):
    """Base of every error that PolyFold raises on purpose."""


class PluginError(PolyfoldError):
    """A plugin is broken, missing, or collides with another."""


class ConfigError(PolyfoldError):
    """A setting has an unknown name or an impossible value."""


class GarmentError(PolyfoldError):
    """A garment, mesh, mask or outline can't be used."""


class GroundingError(PolyfoldError):
    """The camera image can't be explained by the garment's template."""


class PlanError(PolyfoldError):
    """The planner or its language model gave no usable answer."""


class RefusedError(PlanError):
    """The instruction was understood to be impossible, or not understood at all; nothing is folded."""


class LLMError(PolyfoldError):
    """A language-model backend failed: transport, credentials, or an unusable reply."""


class LLMAccessError(LLMError):
    """No call can succeed until a person acts: the key, the credit, the address or the model's name. It ends a run."""


class ActionError(PolyfoldError):
    """An action has a wrong shape, is not finite, or lies outside the image."""


class RobotError(PolyfoldError):
    """A robot or camera is not connected, was stopped, or can't do what it was told."""


class SimulationError(PolyfoldError):
    """The simulation diverged; the message carries what reproduces the episode."""
