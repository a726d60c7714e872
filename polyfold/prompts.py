"""Prompt files by role and version: found, checked and rendered to chat messages.

A prompt file is ``<folder>/<role>/<version>.md``. Its YAML front matter names what it takes and gives::

    ---
    id: fold_line
    version: v1
    inputs: {model: json, subgoal: text}
    output: fold_line
    params: {temperature: 0.0}
    examples: v1.examples.jsonl
    max_attempts: 3
    ---
    {# role: system #}
    You plan ...
    {# role: user #}
    Subgoal: {{ subgoal }}

A line ``{# include: NAME #}`` stands for the text of ``<folder>/shared/NAME.txt``, so that what several prompts explain
is written once. The body is Jinja2, rendered in a sandbox in which an unknown name is an error. Inputs enter as JSON
only: a ``text`` becomes a quoted string, a ``json`` a decoded and re-encoded object, so that no input can pose as an
instruction's frame. An ``image`` is not named in the body: it follows the user's text as a PNG. Examples are JSONL, one
``{"inputs": {...}, "answer": "..."}`` a line, rendered by the same user template, without images. What never changes
comes first in every message list, so that providers can keep it in their caches.
"""

from __future__ import annotations

import base64
import hashlib
import io
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from polyfold.errors import ConfigError, did_you_mean
from polyfold.types import Message

__all__ = ["Prompt", "load_prompt", "prompt_names"]

MAX_TEXT = 2000
"""Longest text input, in characters."""

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_ .:-]{0,39}")
_INCLUDE = re.compile(r"^\{#\s*include:\s*([a-z0-9_-]+)\s*#\}\s*?$", re.MULTILINE)
_MARKER = re.compile(r"^\{#\s*role:\s*(system|user)\s*#\}\s*$", re.MULTILINE)
_FRONT = re.compile(r"\A---\n(.*?)\n---\n(.*)\Z", re.DOTALL)
_ROLE = re.compile(r"[a-z][a-z0-9_-]{0,39}")
_FIELDS = {"id", "version", "inputs", "output", "params", "examples", "max_attempts"}


@dataclass(frozen=True)
class Example:
    """One worked example: inputs as for :meth:`Prompt.render`, and the whole answer expected for them."""

    inputs: Mapping[str, Any]
    answer: str


@dataclass(frozen=True)
class Prompt:
    """One prompt file.

    Attributes:
        id, version: what it is; both stand in the file's path too.
        inputs: input name -> ``text``, ``json`` or ``image``.
        output: key of the answer's JSON object.
        params: parameters for the language model, such as the temperature.
        max_attempts: how many answers the repair loop may ask for.
        examples: few-shot examples, in order.
        sections: (chat role, Jinja2 source), in order.
        sha256: of the prompt file, what it includes and its examples.
        path: where it was read from.
    """

    id: str
    version: str
    inputs: Mapping[str, str]
    output: str
    params: Mapping[str, Any] = field(default_factory=dict)
    max_attempts: int = 3
    examples: tuple[Example, ...] = ()
    sections: tuple[tuple[str, str], ...] = ()
    sha256: str = ""
    path: Path = Path()

    @property
    def name(self) -> str:
        """``id@version``, for logs."""
        return f"{self.id}@{self.version}"

    def render(self, **values: Any) -> list[Message]:
        """Chat messages: the system's, the examples as exchanges, then the user's.

        Args:
            values: one for each of ``inputs``: a string for ``text``; a JSON text or plain data for ``json``; colours,
                uint8, shape (H, W, 3), for ``image``.

        Raises:
            ConfigError: for a missing, unknown, overlong or badly named input.
        """
        if set(values) != set(self.inputs):
            raise ConfigError(
                f"prompt {self.name} takes the inputs {sorted(self.inputs)}, got {sorted(values)}; give exactly those"
            )
        messages: list[Message] = []
        for role, source in self.sections:
            if role == "user":
                for example in self.examples:
                    messages.append({"role": "user", "content": self._fill(source, example.inputs)})
                    messages.append({"role": "assistant", "content": example.answer})
            text = self._fill(source, values)
            images = [_image_part(values[name]) for name in self.images] if role == "user" else []
            content = [{"type": "text", "text": text}, *images] if images else text
            messages.append({"role": role, "content": content})
        return messages

    @property
    def images(self) -> tuple[str, ...]:
        """Names of the inputs that are images."""
        return tuple(name for name, kind in self.inputs.items() if kind == "image")

    def _fill(self, source: str, values: Mapping[str, Any]) -> str:
        from jinja2 import StrictUndefined, TemplateError
        from jinja2.sandbox import SandboxedEnvironment

        written = [name for name in self.inputs if name not in self.images]
        if missing := sorted(set(written) - set(values)):
            raise ConfigError(f"an example of prompt {self.name} lacks the inputs {missing}; add them")
        quoted = {name: _quoted(name, values[name], self.inputs[name]) for name in written}
        environment = SandboxedEnvironment(undefined=StrictUndefined, keep_trailing_newline=False, autoescape=False)
        try:
            return environment.from_string(source).render(**quoted).strip()
        except TemplateError as error:
            raise ConfigError(f"prompt {self.path} can't be rendered: {error}; correct the template") from error


def load_prompt(role: str, version: str | None = None, folders: Sequence[Path] = ()) -> Prompt:
    """The prompt of a role and version.

    Args:
        role: folder name, ``subgoals``, ``fold_line``, ...
        version: file name without ending; by default the newest ``v1``, ``v2``, ...
        folders: searched first; then the folders of plugins, then PolyFold's own.

    Raises:
        ConfigError: if there is none or it is malformed.
    """
    version = version or _newest(role, folders)
    for name in (role, version):
        if not _ROLE.fullmatch(name):
            raise ConfigError(f"{name!r} is no prompt name; take lower-case letters, digits, _ and -, 40 at most")
    places = [*folders, *prompt_folders()]
    for folder in places:
        path = Path(folder) / role / f"{version}.md"
        if path.is_file():
            return _read(path, _modified(path))
    name = f"{role}@{version}"
    raise ConfigError(f"there is no prompt {name}; {did_you_mean(name, prompt_names(folders))}")


def _newest(role: str, folders: Sequence[Path]) -> str:
    """The highest numbered version of a role; ``v1`` if there is none."""
    versions = [name.partition("@")[2] for name in prompt_names(folders) if name.startswith(f"{role}@")]
    numbers = [int(version[1:]) for version in versions if re.fullmatch(r"v\d+", version)]
    return f"v{max(numbers, default=1)}"


def prompt_names(folders: Sequence[Path] = ()) -> list[str]:
    """Every ``role@version`` that :func:`load_prompt` finds, sorted."""
    found = {
        f"{path.parent.name}@{path.stem}" for folder in (*folders, *prompt_folders()) for path in folder.glob("*/*.md")
    }
    return sorted(found)


def prompt_folders() -> list[Path]:
    """Folders with prompts: those that plugins registered, then PolyFold's own."""
    return [*_plugin_folders(), _own_folder()]


def _own_folder() -> Path:
    packaged = Path(str(files("polyfold"))) / "_prompts"
    return packaged if packaged.is_dir() else Path(str(files("polyfold"))).parent / "prompts"


def _plugin_folders() -> Iterator[Path]:
    from polyfold.plugins import catalog

    for component in (entry for entries in catalog().components["prompts"].values() for entry in entries):
        package, _, folder = str(component.target).partition(":")
        yield Path(str(files(package))) / folder


def _modified(path: Path) -> tuple[int, ...]:
    """When a prompt and what prompts share was last written."""
    return tuple(file.stat().st_mtime_ns for file in [path, *sorted((path.parent.parent / "shared").glob("*.txt"))])


@cache
def _read(path: Path, _modified: tuple[int, ...]) -> Prompt:
    """Read and check a file; the times make it be read again where something was edited."""
    import yaml

    text = path.read_text("utf-8")
    parts = _FRONT.match(text.replace("\r\n", "\n"))
    if parts is None:
        raise ConfigError(f"prompt {path} has no front matter; begin it with a block between two lines of ---")
    try:
        front = yaml.safe_load(parts[1])
    except yaml.YAMLError as error:
        raise ConfigError(f"prompt {path}: the front matter is not valid YAML ({error}); correct it") from error
    _check_front(front, path)
    body = _INCLUDE.sub(lambda found: _included(found[1], path), parts[2])
    digest = hashlib.sha256(text.encode())
    if body != parts[2]:
        digest.update(body.encode())
    examples: tuple[Example, ...] = ()
    if front.get("examples"):
        source = path.parent / str(front["examples"])
        examples = _examples(source)
        digest.update(source.read_bytes())
    return Prompt(
        front["id"],
        front["version"],
        dict(front["inputs"]),
        front["output"],
        dict(front.get("params") or {}),
        int(front.get("max_attempts", 3)),
        examples,
        _sections(body, path),
        digest.hexdigest(),
        path,
    )


def _included(name: str, path: Path) -> str:
    """The text of a shared file, without the line end that closes it."""
    shared = path.parent.parent / "shared" / f"{name}.txt"
    try:
        return shared.read_text("utf-8").rstrip("\n")
    except OSError as error:
        raise ConfigError(f"prompt {path} includes {shared}, which can't be read ({error.strerror}); add it") from error


def _check_front(front: Any, path: Path) -> None:
    if not isinstance(front, dict):
        raise ConfigError(f"prompt {path}: the front matter must be a YAML mapping; see polyfold.prompts")
    if unknown := sorted(set(front) - _FIELDS):
        raise ConfigError(f"prompt {path} has unknown fields {unknown}; known are {sorted(_FIELDS)}")
    if missing := sorted({"id", "version", "inputs", "output"} - set(front)):
        raise ConfigError(f"prompt {path} lacks {missing} in its front matter; add them")
    if (front["id"], front["version"]) != (path.parent.name, path.stem):
        raise ConfigError(f"prompt {path} calls itself {front['id']}@{front['version']}; make name and path agree")
    inputs = front["inputs"]
    if not isinstance(inputs, dict) or not set(inputs.values()) <= {"text", "json", "image"}:
        raise ConfigError(f"prompt {path}: inputs must map each name to 'text', 'json' or 'image'; correct them")
    attempts = front.get("max_attempts", 3)
    if not isinstance(attempts, int) or not 1 <= attempts <= 10:
        raise ConfigError(f"prompt {path}: max_attempts must be a whole number from 1 to 10, got {attempts!r}")


def _sections(body: str, path: Path) -> tuple[tuple[str, str], ...]:
    pieces = _MARKER.split(body)
    if pieces[0].strip():
        raise ConfigError(f"prompt {path} has text before its first {{# role: ... #}} marker; move it below one")
    sections = tuple(zip(pieces[1::2], pieces[2::2], strict=True))
    if [role for role, _ in sections] != ["system", "user"]:
        raise ConfigError(f"prompt {path} needs one system and then one user section, marked {{# role: system #}}")
    return sections


def _examples(path: Path) -> tuple[Example, ...]:
    try:
        lines = [json.loads(line) for line in path.read_text("utf-8").splitlines() if line.strip()]
        return tuple(Example(line["inputs"], line["answer"]) for line in lines)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ConfigError(
            f'{path} does not hold usable examples ({error!r}); write one {{"inputs": {{...}}, "answer": "..."}} a line'
        ) from error


def _image_part(picture: Any) -> dict[str, Any]:
    """A picture, uint8, shape (H, W, 3), as a content part that providers of chat models take."""
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, "PNG")
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    return {"type": "image_url", "image_url": {"url": f"data:image/png;base64,{data}"}}


def _quoted(name: str, value: Any, kind: str) -> str:
    if kind == "text":
        text = str(value)
        if len(text) > MAX_TEXT:
            raise ConfigError(f"the {name} is {len(text)} characters long; shorten it to {MAX_TEXT}")
        return json.dumps(text, ensure_ascii=False)
    data = json.loads(value) if isinstance(value, str) else value
    _check_names(data)
    return json.dumps(data, ensure_ascii=False, allow_nan=False)


def _check_names(data: Any) -> None:
    """Keys are names of garments, parts and vertices: they are kept short and plain, whoever wrote them."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            if not _NAME.fullmatch(str(key)) and not str(key).isdigit():
                raise ConfigError(
                    f"{str(key)[:60]!r} is no usable name; take letters, digits, _ and blanks, 40 at most"
                )
            _check_names(value)
        garment = data.get("garment")
        if garment is not None and not _NAME.fullmatch(str(garment)):
            raise ConfigError(
                f"{str(garment)[:60]!r} is no usable garment name; take letters, digits and _, 40 at most"
            )
    elif isinstance(data, list):
        for value in data:
            _check_names(value)
