"""What is public: the names in ``__all__`` of the core's modules that have no leading underscore.

    python tests/house/public_names.py     # prints them, package by package, with their number

They are read from the source, so that printing them imports nothing. The verbs of the command line are run by it alone
and name nothing public.
"""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[2]


def python_files(*below):
    """The Python files under a folder of the repository, without an editor's checkpoints."""
    found = ROOT.joinpath(*below).rglob("*.py")
    return sorted(path for path in found if not any(part.startswith(".") for part in path.relative_to(ROOT).parts))


def module_of(path, source):
    """``polyfold/geometry/__init__.py`` to ``polyfold.geometry``."""
    return ".".join(path.relative_to(source).with_suffix("").parts).removesuffix(".__init__")


def is_private(module):
    return any(part.startswith("_") for part in module.split("."))


def names_in(path):
    """What a file's ``__all__`` lists; None where it has none."""
    for statement in ast.parse(path.read_text("utf-8")).body:
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "__all__":
            return ast.literal_eval(statement.value)
    return None


def public_modules():
    """Module -> its public names, or None where ``__all__`` is missing, over the core."""
    modules = {module_of(path, ROOT): path for path in python_files("polyfold")}
    return {
        module: names_in(path)
        for module, path in modules.items()
        if not is_private(module) and not module.startswith("polyfold.cli.")
    }


def main():
    listed = {module: names for module, names in public_modules().items() if names is not None}
    for module, names in listed.items():
        print(f"{module} ({len(names)}): {', '.join(names)}")
    print(f"{len({name for names in listed.values() for name in names})} public names")


if __name__ == "__main__":
    main()
