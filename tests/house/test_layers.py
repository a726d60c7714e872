"""The layering that keeps plugins honest: core never imports a plugin, plugins use only public names."""

import ast
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CORE = sorted((ROOT / "polyfold").rglob("*.py"))
PLUGINS = sorted(path for path in (ROOT / "plugins").rglob("*.py"))


ORDER = """
    errors geometry types polygon garments scoring interfaces hookspecs catalog plugins config prompts transcript goals
    tasks ideal guidance store record view pictures episode recovery agent judging sources folding
    references attribution study thumbnails evaluation runner statistics tables plots results providers report
    benchmark cli __main__
""".split()  # noqa: SIM905
"""The core from the ground up: a module's top-level imports come from above it, or from its own package."""


def imports(path):
    """(module, name or None) of every import statement in a file, wherever it stands."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.module, alias.name) for alias in node.names)


@pytest.mark.parametrize("path", CORE, ids=lambda path: str(path.relative_to(ROOT)))
def test_core_imports_no_plugin(path):
    assert not [module for module, _ in imports(path) if module and module.startswith("polyfold_")]


@pytest.mark.parametrize("path", CORE, ids=lambda path: str(path.relative_to(ROOT)))
def test_core_modules_import_only_what_stands_below_them(path):
    parts = path.relative_to(ROOT / "polyfold").with_suffix("").parts
    if parts == ("__init__",):
        return
    own = ORDER.index(parts[0])
    for node in ast.parse(path.read_text("utf-8")).body:
        if not isinstance(node, ast.ImportFrom) or not node.module.startswith("polyfold"):
            continue
        names = [alias.name for alias in node.names] if node.module == "polyfold" else [node.module.split(".")[1]]
        assert all(ORDER.index(name) <= own for name in names), ast.unparse(node)


@pytest.mark.parametrize("path", PLUGINS, ids=lambda path: str(path.relative_to(ROOT)))
def test_plugins_use_public_names_and_never_each_other(path):
    own = next(part for part in reversed(path.relative_to(ROOT).parts) if part.startswith("polyfold_"))
    for module, name in imports(path):
        if module.startswith("polyfold_"):
            assert module.split(".")[0] == own, f"imports another plugin: {module}"
        elif module.split(".")[0] == "polyfold":
            assert name is not None, f"write 'from {module} import ...'"
            found = import_module(module)
            assert name in found.__all__, f"{module}.{name} is not public"


@pytest.mark.parametrize("path", [*CORE, *PLUGINS], ids=lambda path: str(path.relative_to(ROOT)))
def test_modules_are_small(path):
    assert path.stat().st_size < 20_000
