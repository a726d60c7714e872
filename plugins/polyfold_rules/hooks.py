"""Registers the offline solver."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_llms(register):
    """Register the backend."""
    register("rules", "polyfold_rules.rules:RulesLLM", "deterministic solver of fold language; no key, no network")
