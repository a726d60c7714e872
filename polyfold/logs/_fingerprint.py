"""What results depend on besides the configuration: code, versions, prompts, weights.

The same fingerprint guards a resumed run and keys the cache of references, so that neither mixes what different code
made.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import platform
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.logs._components import components_in_use
from polyfold.plugins import hookspecs
from polyfold.plugins._inspection import files_read, prompts_read
from polyfold.prompts import load_prompt

CORE = (
    "config.py",
    "prompts.py",
    "geometry",
    "polygon",
    "garments",
    "types",
    "tasks",
    "plugins",
    "rollout",
    "evaluation",
    "studies",
)
"""What of the core decides how an episode comes out; pictures, tables and the command line do not."""

UNREADABLE = "unreadable"
"""Stands for the digest of what can't be read: nobody knows whether it changed."""

NUMERICS = ("numpy", "scipy", "numba", "opencv-python-headless", "shapely", "torch")
"""Distributions whose arithmetic results depend on."""

SOURCES = {".py", ".toml", ".txt", ".json", ".csv", ".md"}
"""Endings of files that count as a plugin's source."""


class GitState(BaseModel):
    """The checkout that a package is used from."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    commit: str
    dirty: bool


class Fingerprint(BaseModel):
    """What results depend on besides the configuration.

    Attributes:
        distributions: versions by name: Python, PolyFold, those of the plugins in use, and of numerical libraries.
        sources: SHA-256 by package: of the core's that decide results, and of every plugin in use.
        prompts: SHA-256 by ``role@version``, of those in use.
        files: SHA-256 by package and name of what components read besides their source, such as weights.
        git: commit and whether it had local changes, by the first package that is used from a checkout.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    distributions: dict[str, str] = Field(default_factory=dict)
    sources: dict[str, str] = Field(default_factory=dict)
    prompts: dict[str, str] = Field(default_factory=dict)
    files: dict[str, str] = Field(default_factory=dict)
    git: dict[str, GitState] = Field(default_factory=dict)

    def differences(self, other: Fingerprint) -> tuple[str, ...]:
        """What is otherwise in ``other``, one line each; what could not be read counts as otherwise.

        A commit alone is a difference too, although :meth:`digest` is the same: it may change what is not looked at.
        """
        lines: list[str] = []
        for what, mine, theirs in (
            ("version of", self.distributions, other.distributions),
            ("source of", self.sources, other.sources),
            ("prompt", self.prompts, other.prompts),
            ("file", self.files, other.files),
            ("commit of", _shown(self.git), _shown(other.git)),
        ):
            for name in sorted({*mine, *theirs}):
                old, new = mine.get(name, "absent"), theirs.get(name, "absent")
                if old != new or new == UNREADABLE:
                    lines.append(f"{what} {name}: {_short(old)} then, {_short(new)} now")
        return tuple(lines)

    def digest(self) -> str:
        """SHA-256 of all that decides results; a commit alone that changes no source does not."""
        content = self.model_dump(mode="json", exclude={"git"})
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _shown(states: Mapping[str, GitState]) -> dict[str, str]:
    return {name: f"{state.commit[:12]}{' with changes' if state.dirty else ''}" for name, state in states.items()}


def _short(value: str) -> str:
    """A digest by its first letters, anything else whole."""
    return value[:12] if len(value) == 64 else value


def fingerprint(
    experiments: Iterable[Experiment], also: Iterable[tuple[str, str]] = (), commits: bool = True
) -> Fingerprint:
    """The fingerprint of experiments.

    Args:
        experiments: what will run; components that they name but do not use count for nothing.
        also: further components, as (kind, name), for example ``("metrics", "mppe")``.
        commits: whether to ask git for the state of checkouts; :meth:`Fingerprint.digest` needs none.

    Raises:
        PluginError: if a component is not installed.
    """
    specs = [spec for experiment in experiments for spec in _specs(experiment)]
    specs += [(kind, ComponentSpec(name=name)) for kind, name in also]
    core = Path(__file__).parents[1]
    distributions, prompts, files = _libraries(), {}, {}
    sources = {f"polyfold.{name.removesuffix('.py')}": _digest_of(core / name) for name in CORE}
    folders = {"polyfold": core}
    for kind, spec in _once_each(specs):
        component = plugins.find(kind, spec.name.partition(":")[0])
        if component.plugin.distribution:
            distributions[component.plugin.distribution] = component.plugin.version
        source = _source_of(component.target)
        sources[source.name] = source.digest
        if source.folder is not None:
            folders[source.name] = source.folder
        if kind == "tasks":  # a file, and no class
            continue
        for name in prompts_read(kind, spec):
            role, _, prompt_version = name.partition("@")
            prompt = load_prompt(role, prompt_version)
            prompts[prompt.name] = prompt.sha256
        for path in files_read(kind, spec):
            name = f"{source.name}: {path.name}"
            # Two files of one name, as variants may read, count together.
            files[name] = _joined(files.get(name), _digest_of_file(path))
    git = _git_states(folders) if commits else {}
    return Fingerprint(distributions=distributions, sources=sources, prompts=prompts, files=files, git=git)


def _once_each(specs: Iterable[tuple[str, ComponentSpec]]) -> list[tuple[str, ComponentSpec]]:
    return list({(kind, spec.model_dump_json()): (kind, spec) for kind, spec in specs}.values())


def _specs(experiment: Experiment) -> Iterator[tuple[str, ComponentSpec]]:
    """Every component in use, also one that another of its kind names as a parameter, as a fault injector does."""
    for field, spec in components_in_use(experiment).items():
        kind = hookspecs.plural(field)
        yield kind, getattr(experiment, field)
        known = plugins.names(kind)
        for value in spec.params.values():
            if isinstance(value, str) and value.partition(":")[0] in known:
                yield kind, ComponentSpec(name=value)


def _libraries() -> dict[str, str]:
    found = {"python": platform.python_version()}
    for name in ("polyfold", *NUMERICS):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


@dataclass(frozen=True)
class _Source:
    """The code of a component.

    Attributes:
        name: of the package it belongs to; of the class where that is all there is.
        digest: SHA-256.
        folder: of the package; None for a lone module or a class of a notebook.
    """

    name: str
    digest: str
    folder: Path | None


def _source_of(target: type | str) -> _Source:
    module = target.partition(":")[0] if isinstance(target, str) else target.__module__
    package = module.partition(".")[0]
    spec = None if package == "__main__" else find_spec(package)
    if spec is not None and spec.submodule_search_locations:
        folder = Path(next(iter(spec.submodule_search_locations)))
        return _Source(package, _digest_of_folder(folder), folder)
    if spec is not None and spec.origin:
        return _Source(package, _digest_of_file(Path(spec.origin)), None)
    if isinstance(target, str):
        return _Source(package, UNREADABLE, None)
    return _Source(f"{module}.{target.__qualname__}", _digest_of_class(target), None)


def _digest_of_class(target: type) -> str:
    """Of a class typed into a notebook or a script."""
    try:
        return hashlib.sha256(inspect.getsource(target).encode()).hexdigest()
    except (OSError, TypeError):
        return UNREADABLE


def _joined(known: str | None, digest: str) -> str:
    if known in (None, digest):
        return digest
    return hashlib.sha256(f"{known} {digest}".encode()).hexdigest()


def _digest_of(path: Path) -> str:
    return _digest_of_folder(path) if path.is_dir() else _digest_of_file(path)


def _digest_of_folder(folder: Path) -> str:
    passed_over = {"__pycache__", ".ipynb_checkpoints"}
    files = sorted(p for p in folder.rglob("*") if p.suffix in SOURCES and passed_over.isdisjoint(p.parts))
    digest = hashlib.sha256()
    for path in files:
        digest.update(str(path.relative_to(folder)).encode())
        digest.update(_digest_of_file(path).encode())
    return digest.hexdigest()


def _digest_of_file(path: Path) -> str:
    try:
        seen = path.stat()
    except OSError:
        return UNREADABLE
    return _digest(path, seen.st_mtime_ns, seen.st_size)


@lru_cache(maxsize=4096)
def _digest(path: Path, _modified: int, _size: int) -> str:
    """Read once for as long as its time of modification and its size stay."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _git_states(folders: Mapping[str, Path]) -> dict[str, GitState]:
    """The state of each checkout, under the first package that is used from it; none for installed packages."""
    found: dict[str, GitState] = {}
    seen: set[Path] = set()
    for name, folder in folders.items():
        checkout = next((parent for parent in folder.parents if (parent / ".git").exists()), None)
        # A package may be installed into an environment that lies inside of somebody's checkout.
        if checkout is None or checkout in seen or not _git(checkout, "ls-files", "--", str(folder)):
            continue
        seen.add(checkout)
        state = _git_state(checkout)
        if state is not None:
            found[name] = state
    return found


def _git_state(checkout: Path) -> GitState | None:
    commit = _git(checkout, "rev-parse", "HEAD")
    changed = _git(checkout, "status", "--porcelain", "--untracked-files=no")
    return GitState(commit=commit, dirty=bool(changed)) if commit else None


def _git(checkout: Path, *arguments: str) -> str | None:
    command = ["git", "-C", str(checkout), *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=30, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()
