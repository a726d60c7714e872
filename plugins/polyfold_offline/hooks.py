"""Registers the offline reader and the verb that trains it."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_llms(register):
    """Register the backend."""
    register(
        "offline",
        "polyfold_offline.backend:OfflineLLM",
        "a small network reads, exact geometry folds; no key, offline",
    )


@hookimpl
def register_commands(register):
    """Register the verb."""
    register(
        "train-language",
        "polyfold_offline.training.command:TrainLanguage",
        "learn to read sentences from written ones",
        ("polyfold[torch]",),
    )
