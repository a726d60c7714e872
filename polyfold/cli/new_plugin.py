"""``polyfold new-plugin``: a complete package with one component of any kind, whose tests pass."""

from __future__ import annotations

import argparse
import keyword
import re
import sys
from pathlib import Path

from polyfold import plugins
from polyfold.errors import ConfigError, did_you_mean
from polyfold.plugins.hookspecs import KINDS, plural, singular

TEMPLATES = Path(__file__).parent / "_new_plugin"
NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")

ABOUT = {
    "simulators": (
        "cloth that folds as paper does",
        'polyfold fold "fold it in half" --garment square --simulator {name}',
    ),
    "cameras": ("frames from a file", 'polyfold cell look --config cell.toml    # with camera = "{name}"'),
    "robots": (
        "arms that write down what they would do",
        'polyfold cell park --config cell.toml    # with robot = "{name}"',
    ),
    "segmenters": (
        "what differs from the border",
        'polyfold fold "fold it in half" --garment square --segmenter {name}',
    ),
    "groundings": (
        "corners of the bounding rectangle",
        'polyfold fold "fold it in half" --garment square --grounding {name}',
    ),
    "planners": (
        "asks for a line at a time",
        'polyfold fold "fold it in half" --garment square --planner {name} --llm litellm:MODEL',
    ),
    "policies": ("picks farthest from the line", 'polyfold fold "fold it in half" --garment square --policy {name}'),
    "llms": (
        "a chat server of your own",
        'polyfold fold "fold it in half" --garment square --llm {name} --set llm.url=http://127.0.0.1:8000/v1',
    ),
    "agents": ("folds the lower half up", 'polyfold fold "fold it in half" --garment square --agent {name}'),
    "garments": ("skirts", 'polyfold fold "fold it in half" --garment {name}'),
    "fabrics": ("plain-woven linen", 'polyfold fold "fold it in half" --garment square --fabric {name}'),
    "tasks": ("a square in half", "polyfold tasks {name}"),
    "metrics": ("keypoints off by [mm]", 'polyfold plugins    # in a study: metrics = ["{name}"]'),
    "criteria": ("stricter than lenient", 'polyfold plugins    # in a study: criteria = ["{name}"]'),
}
"""One line about what each kind's example does, and how to try it."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("name", help="of the plugin, such as polyfold-widest")
    parser.add_argument("--kind", required=True, metavar="KIND", help=f"one of {', '.join(map(singular, KINDS))}")
    parser.add_argument("--out", default=".", metavar="DIR", help="folder to put it in (default: this one)")


def run(arguments: argparse.Namespace) -> int:
    """Write the package and say what comes next."""
    folder = write_plugin(arguments.name, arguments.kind, Path(arguments.out))
    print(f"{folder}: a {singular(_kind(arguments.kind))}, its registration and its tests")
    print(f"  pip install -e '{folder}[test]'\n  polyfold check {_short(arguments.name)}\n  pytest {folder}")
    return 0


def write_plugin(name: str, kind: str, out: Path) -> Path:
    """Write a plugin's package.

    Args:
        name: what it is called when installed; ``polyfold-widest`` registers ``widest``.
        kind: of its component, singular or plural.
        out: where its folder is made.

    Returns:
        Its folder.

    Raises:
        ConfigError: for a name that can't be one, an unknown kind, or a folder that is there already.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    kind = _kind(kind)
    if not NAME.fullmatch(name) or len(name) > 50:
        raise ConfigError(
            f"{name!r} is no name for a plugin; take lower-case letters, digits and hyphens: polyfold-widest"
        )
    if (short := _values(name, kind)["name"]) in plugins.names(kind):
        raise ConfigError(f"a {singular(kind)} is called {short!r} already; choose another name")
    package = name.replace("-", "_")
    if package == "polyfold" or package in sys.stdlib_module_names or keyword.iskeyword(_short(name)):
        raise ConfigError(
            f"a package {package!r} would hide Python's own or PolyFold; call it polyfold-{_short(name)}-mine"
        )
    folder = out / name
    if folder.exists():
        raise ConfigError(f"{folder} is there already; choose another name, or remove it")
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES), undefined=StrictUndefined, keep_trailing_newline=True,
        variable_start_string="<<", variable_end_string=">>",
    )  # fmt: skip
    values = _values(name, kind)
    for place, template in _files(kind, values).items():
        path = folder / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(environment.get_template(template).render(**values), encoding="utf-8", newline="\n")
    (folder / "src" / values["package"] / "__init__.py").write_text(
        f'"""{values["summary"].capitalize()}."""\n', "utf-8"
    )
    return folder


def _kind(kind: str) -> str:
    for one in (kind, plural(kind)):
        if one in KINDS:
            return one
    raise ConfigError(f"there is no kind {kind!r} of component; {did_you_mean(kind, list(map(singular, KINDS)))}")


def _short(name: str) -> str:
    return name.removeprefix("polyfold-")


def _values(name: str, kind: str) -> dict[str, str]:
    short, package = _short(name), name.replace("-", "_")
    word = short if kind != "garments" else short.replace("-", "_")
    summary, usage = ABOUT[kind]
    module = "tasks.toml" if kind == "tasks" else f"{singular(kind)}.py"
    cls = "".join(part.capitalize() for part in short.split("-"))
    target = f"{package}:tasks.toml" if kind == "tasks" else f"{package}.{singular(kind)}:{cls}"
    return {
        "distribution": name, "package": package, "name": word, "cls": cls, "kind": kind, "singular": singular(kind),
        "article": "An" if singular(kind)[0] in "aeiou" else "A", "module": module, "target": target,
        "summary": summary, "usage": f"    {usage.format(name=word)}",
    }  # fmt: skip


def _files(kind: str, values: dict[str, str]) -> dict[str, str]:
    """File of the package -> template."""
    source = f"src/{values['package']}"
    return {
        "pyproject.toml": "pyproject.toml.jinja",
        "README.md": "README.md.jinja",
        "tests/test_conformance.py": "test_conformance.py.jinja",
        f"{source}/hooks.py": "hooks.py.jinja",
        f"{source}/{values['module']}": f"{kind}.{'toml' if kind == 'tasks' else 'py'}.jinja",
    }
