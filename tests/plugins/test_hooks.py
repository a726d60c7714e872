"""Every hook that is declared is called, and an author can rely on where."""

import ast
import inspect
from pathlib import Path

import polyfold
from polyfold.plugins import hookspecs
from polyfold.plugins._host import Host

CORE = sorted(Path(polyfold.__file__).parent.rglob("*.py"))
EVENTS = "on_"
REGISTRATIONS = "register_"


def declared(prefix):
    """Names of the hooks with a prefix, as the specification has them."""
    found = {name for name, value in vars(hookspecs).items() if hasattr(value, "polyfold_spec")}
    return {name for name in found if name.startswith(prefix)}


def told():
    """Hook -> arguments of each place in the core that tells observers."""
    found = {}
    for path in CORE:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", None) == "notify":
                hook, *_ = node.args
                assert isinstance(hook, ast.Constant), f"{path.name}: name the hook where it is told"
                found.setdefault(hook.value, []).append({keyword.arg for keyword in node.keywords})
    return found


def test_every_event_has_one_caller_that_gives_all_its_arguments():
    calls = told()
    assert set(calls) == declared(EVENTS)
    for hook, places in calls.items():
        wanted = set(inspect.signature(getattr(hookspecs, hook)).parameters)
        assert places == [wanted], f"{hook} is told in {len(places)} places"


def test_every_hook_registers_or_observes():
    assert {name for name, value in vars(hookspecs).items() if hasattr(value, "polyfold_spec")} == declared(
        EVENTS
    ) | declared(REGISTRATIONS)


def test_every_registration_is_called(tmp_path, monkeypatch):
    names = sorted(declared(REGISTRATIONS))
    lines = ["from polyfold import hookimpl"]
    for name in names:
        lines += ["@hookimpl", f"def {name}(register):", f"    register('from-{name[9:]}', 'nowhere:Nothing')"]
    (tmp_path / "everything.py").write_text("\n".join(lines) + "\n")
    info = tmp_path / "everything-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: everything\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[polyfold]\neverything = everything\n")
    monkeypatch.syspath_prepend(tmp_path)
    components = Host().catalog().components
    assert all(f"from-{name[9:]}" in components[name[9:]] for name in names)
    assert {name.removeprefix(REGISTRATIONS) for name in names} == {*hookspecs.KINDS, "commands", "prompts"}
