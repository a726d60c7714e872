"""Where a local server is asked: at the address that the environment tells, as its own tools are."""

import pytest
from polyfold_llms.model_table import default_api_base


@pytest.mark.parametrize(
    ("variables", "name", "address"),
    [
        ({}, "ollama/llama3", "http://127.0.0.1:11434"),
        ({"OLLAMA_API_BASE": "http://box:1"}, "ollama_chat/llama3", "http://box:1"),
        ({"OLLAMA_HOST": "box"}, "ollama/llama3", "http://box:11434"),
        ({"OLLAMA_HOST": "0.0.0.0:8000"}, "ollama/llama3", "http://127.0.0.1:8000"),
        ({"OLLAMA_HOST": "https://box"}, "ollama/llama3", "https://box:443"),
        ({"OLLAMA_HOST": "box", "OLLAMA_API_BASE": "http://other:2"}, "ollama/llama3", "http://other:2"),
        ({"HOSTED_VLLM_API_BASE": "http://box:9/v1"}, "hosted_vllm/x", "http://box:9/v1"),
        ({"OPENAI_API_BASE": "http://box:9/v1"}, "openai/gpt-4o", None),
    ],
)
def test_the_environment_tells_where(monkeypatch, variables, name, address):
    for variable in ("OLLAMA_HOST", "OLLAMA_API_BASE", "HOSTED_VLLM_API_BASE"):
        monkeypatch.delenv(variable, raising=False)
    for variable, value in variables.items():
        monkeypatch.setenv(variable, value)
    assert default_api_base(name) == address
