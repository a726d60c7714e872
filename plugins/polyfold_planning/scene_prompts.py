"""How a scene gets into a prompt: the prompt that explains what the scene shows, and its inputs."""

from __future__ import annotations

from typing import Any

from polyfold.errors import ConfigError
from polyfold.prompts import Prompt, load_prompt, prompt_names
from polyfold.types import Scene


def prompt_for(scene: Scene, role: str, version: str) -> Prompt:
    """The prompt of a role for what the scene shows: ``v1`` for a polygon, else ``keypoints-image-v1`` and the like.

    Raises:
        ConfigError: if the role has no prompt for that.
    """
    if scene.shown == ("polygon",):
        return load_prompt(role, version)
    shown = "-".join(scene.shown)
    try:
        return load_prompt(role, f"{shown}-{version}")
    except ConfigError as error:
        maker = scene.grounding or "the grounding"
        raise ConfigError(f"{maker} says that its scene shows {shown} (scene.shown), and {error}") from error


def prompts_for_scenes(role: str, version: str) -> list[str]:
    """What :func:`prompt_for` may choose, whatever a scene shows, each as ``role@version``."""
    found = [name.partition("@")[2] for name in prompt_names() if name.startswith(f"{role}@")]
    return [f"{role}@{name}" for name in found if name == version or name.endswith(f"-{version}")]


def prompt_inputs(scene: Scene, prompt: Prompt, **more: Any) -> dict[str, Any]:
    """Inputs for a prompt: the scene's text as ``model``, its picture as ``picture``, whichever it takes, and ``more``.

    Raises:
        ConfigError: if the prompt takes a picture and the scene has none.
    """
    if "picture" in prompt.inputs and scene.picture is None:
        raise ConfigError(f"the prompt {prompt.name} takes a picture; choose a grounding with one, such as image")
    offered = {"model": scene.text, "picture": scene.picture}
    return {name: value for name, value in offered.items() if name in prompt.inputs} | more
