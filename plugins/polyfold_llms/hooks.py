"""Registers the language-model backends and the verb for cassettes."""

from polyfold.plugins.hookspecs import hookimpl


@hookimpl
def register_llms(register):
    """Register the backends."""
    backend = "polyfold_llms.litellm_backend:LiteLLM"
    register("litellm", backend, "litellm:ROUTE/MODEL, any provider or local server", ("polyfold[llm]",))
    register("record", "polyfold_llms.recording:RecordLLM", "record:CASSETTE, another backend, recorded")
    register("replay", "polyfold_llms.recording:ReplayLLM", "replay:CASSETTE, what was recorded; no key, no network")


@hookimpl
def register_commands(register):
    """Register the verb."""
    register(
        "cassette",
        "polyfold_llms.cassette_command:CassetteCommand",
        "look into recorded language models and fill what is missing",
    )
