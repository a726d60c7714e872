"""What experiments depend on, found out: versions, sources, prompts, weights, commits."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterable, Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.logs._components import components_in_use
from polyfold.logs._fingerprint import UNREADABLE, Fingerprint
from polyfold.logs._sources import digest_of, digest_of_file, git_states, source_of
from polyfold.plugins import hookspecs
from polyfold.plugins._fabrics import chosen_fabric
from polyfold.plugins._inspection import files_read, prompts_read
from polyfold.prompts import load_prompt
from polyfold.tasks._suite import is_file

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

NUMERICS = ("numpy", "scipy", "numba", "opencv-python-headless", "shapely", "torch")
"""Distributions whose arithmetic results depend on."""


def fingerprint(
    experiments: Iterable[Experiment], also: Iterable[tuple[str, str]] = (), commits: bool = True
) -> Fingerprint:
    """The fingerprint of experiments.

    Args:
        experiments: what will run; components that they name but do not use count for nothing.
        also: further components, as (kind, name), for example ``("metrics", "mppe")``; the fabrics of kinds of garment
            among them count too.
        commits: whether to ask git for the state of checkouts; :meth:`Fingerprint.digest` needs none.

    Raises:
        PluginError: if a component is not installed.
    """
    experiments, also = list(experiments), list(also)
    specs = [spec for experiment in experiments for spec in _specs(experiment)]
    specs += [(kind, ComponentSpec(name=name)) for kind, name in also]
    garments = [name for kind, name in also if kind == "garments"]
    specs += [("fabrics", chosen_fabric(each.fabric, garment)) for each in experiments for garment in garments]
    core = Path(__file__).parents[1]
    distributions, prompts, files = _libraries(), {}, {}
    sources = {f"polyfold.{name.removesuffix('.py')}": digest_of(core / name) for name in CORE}
    folders = {"polyfold": core}
    for kind, spec in _once_each(specs):
        if kind == "tasks" and is_file(spec.name):
            files[spec.name] = digest_of_file(Path(spec.name))
            continue
        component = plugins.find(kind, spec.name.partition(":")[0])
        if component.plugin.distribution:
            distributions[component.plugin.distribution] = component.plugin.version
        source = source_of(component.target)
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
            files[name] = _joined(files.get(name), digest_of_file(path))
    git = git_states(folders) if commits else {}
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


def _joined(known: str | None, digest: str) -> str:
    if known in (None, digest) or digest == UNREADABLE:
        return digest
    if known == UNREADABLE:
        return known
    return hashlib.sha256(f"{known} {digest}".encode()).hexdigest()
