"""Registers the language-model backends."""

from polyfold.hookspecs import hookimpl


@hookimpl
def register_llms(register):
    """Register the backends."""
    register("rules", "polyfold_llms.rules:RulesLLM", "deterministic solver of fold language; no key, no network")
