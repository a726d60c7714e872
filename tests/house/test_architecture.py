"""The shape of the house: who imports whom, what is public, how large a room may be."""

import ast
import os
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import grimp
import networkx
import pytest
from public_names import ROOT, is_private, public_modules, python_files

CORE = python_files("polyfold")
PLUGINS = python_files("plugins")
BENCHMARKS = python_files("experiments")
BUNDLED = sorted(folder.name for folder in (ROOT / "plugins").glob("polyfold_*"))

LARGEST_MODULE = 15_000  # bytes
MOST_MODULES_OF_A_PACKAGE = 12
MOST_PUBLIC_NAMES = 183


def name_of(path):
    return str(path.relative_to(ROOT))


def imports(path):
    """(module, name or None) of every import statement in a file, wherever it stands."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name_of(path)}:{node.lineno}: write the package's full name"
            yield from ((node.module, alias.name) for alias in node.names)


def of_core(path):
    return [(module, name) for module, name in imports(path) if module.split(".")[0] == "polyfold"]


def test_the_contracts_of_pyproject_hold():
    command = [str(Path(sys.executable).with_name("lint-imports")), "--no-cache", "--no-logo"]
    source = os.pathsep.join([str(ROOT), str(ROOT / "plugins")])
    result = subprocess.run(
        command, cwd=ROOT, env={**os.environ, "PYTHONPATH": source}, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout + result.stderr


def test_every_bundled_plugin_is_under_the_contracts():
    import tomllib

    rules = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    assert set(rules["root_packages"]) == {"polyfold", *BUNDLED}
    for contract in rules["contracts"]:
        for listed in (contract.get("modules"), contract.get("source_modules"), contract.get("forbidden_modules")):
            plugins = {name for name in listed or () if name.startswith("polyfold_")}
            assert plugins in (set(), set(BUNDLED)), contract["name"]


def test_no_files_import_each_other_in_a_circle():
    graph = grimp.build_graph("polyfold", *BUNDLED, cache_dir=None)
    edges = [(module, other) for module in graph.modules for other in graph.find_modules_directly_imported_by(module)]
    circles = [sorted(found) for found in networkx.strongly_connected_components(networkx.DiGraph(edges))]
    assert not [circle for circle in circles if len(circle) > 1]


@pytest.mark.parametrize("path", PLUGINS, ids=name_of)
def test_outside_the_core_only_public_names_are_used(path):
    public = {module: names for module, names in public_modules().items() if names is not None}
    for module, name in of_core(path):
        assert not is_private(module), f"{module} is private; import from {module.split('._')[0]}"
        if name is None:
            continue
        is_public = module in public and (name in public[module] or f"{module}.{name}" in public)
        assert is_public, f"{module}.{name} is not public: no __all__ lists it"


def test_every_public_module_lists_its_names():
    assert not [module for module, names in public_modules().items() if names is None]


def test_every_symbol_is_public_in_one_place():
    homes = defaultdict(list)
    for module, names in public_modules().items():
        for name in names or () if module != "polyfold" else ():
            homes[name].append(module)
    assert not {name: modules for name, modules in homes.items() if len(modules) > 1}


def test_public_names_can_be_counted_on_a_page():
    names = {name for names in public_modules().values() for name in names or ()}
    assert len(names) <= MOST_PUBLIC_NAMES, "see tests/house/public_names.py"


@pytest.mark.parametrize("path", [*CORE, *PLUGINS, *BENCHMARKS], ids=name_of)
def test_modules_are_small(path):
    assert path.stat().st_size <= LARGEST_MODULE


@pytest.mark.parametrize("folder", sorted({path.parent for path in [*CORE, *PLUGINS, *BENCHMARKS]}), ids=name_of)
def test_packages_are_small(folder):
    assert len([path for path in folder.glob("*.py") if path.stem != "__init__"]) <= MOST_MODULES_OF_A_PACKAGE
