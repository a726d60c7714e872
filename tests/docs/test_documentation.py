"""The documentation says what the code does: nothing is left out, its examples run, its commands exist."""

import re
import shlex
from importlib import import_module
from pathlib import Path

import pytest

from docs.making import command_line, kinds, modules, results, studies
from docs.making.components import bundled
from polyfold import plugins
from polyfold.api._describe import about
from polyfold.cli import _parser
from polyfold.cli._boundary import answer
from polyfold.plugins import hookspecs
from polyfold.plugins.hookspecs import KINDS, plural
from polyfold.studies import Study

ROOT = Path(__file__).parents[2]
PAGES = sorted(ROOT.glob("docs/*.md"))
TOLD = [*PAGES, ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "plugins/polyfold-example/README.md"]


def id_of(page):
    return str(page.relative_to(ROOT))


@pytest.mark.parametrize("kind", KINDS)
def test_every_component_and_every_parameter_is_told_of(kind):
    for name in bundled(kind):
        told = about(kind, name)
        assert told.summary, f"the {kind} {name} has no summary"
        assert told.words or kind == "tasks", f"the class of {kind} {name} has no docstring"
        missing = [one.name for one in told.parameters if not one.description]
        assert not missing, f"{kind} {name}: give these fields a description: {missing}"


def test_every_option_of_every_verb_is_told_of():
    found = dict(command_line.verbs())
    assert {"fold", "evaluate", "check", "new-plugin", "collect", "train"} <= set(found)
    missing = [
        (verb, flags) for verb, parser in found.items() for flags, says in command_line.options(parser) if not says
    ]
    assert not missing
    assert all(parser.description for parser in found.values())


def test_every_hook_is_told_of():
    hooks = [name for name in vars(hookspecs) if name.startswith(("register_", "on_"))]
    assert len(hooks) > len(KINDS)
    assert not [name for name in hooks if not getattr(hookspecs, name).__doc__]
    page = modules.page("polyfold.plugins.hookspecs")
    assert not [name for name in hooks if f"hookspecs.{name}\n" not in page]


def test_every_public_module_has_a_page_and_every_name_is_on_it():
    listed = {file for file in ROOT.glob("polyfold/**/*.py") if "__all__" in file.read_text("utf-8")}
    public = {".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__") for file in listed}
    public = {name for name in public if not any(part.startswith("_") for part in name.split("."))}
    assert public - {"polyfold", "polyfold.cli"} == set(modules.names())
    for module in modules.names():
        page = modules.page(module)
        if module != "polyfold.plugins.hookspecs":
            assert not [name for name in import_module(module).__all__ if f"{module}.{name}\n" not in page]


def test_every_setting_of_a_study_is_told_of():
    assert set(studies.descriptions()) == set(Study.model_fields)
    words = set(re.findall(r"\w+", dict(command_line.verbs())["evaluate"].epilog))
    assert set(Study.model_fields) <= words


def test_every_kind_has_its_page_with_what_it_is_held_to():
    for kind in kinds.KINDS:
        page = kinds.page(kind)
        assert "hooks.py`" in page
        assert "test_conformance" in page
        assert page.count("\n- ") >= 3 + len(bundled(plural(kind))), kind


def test_every_recorded_table_is_a_page():
    assert {"main", "policies", "robot_cell"} <= set(results.names())
    assert results.page("main").startswith("# main\n")


@pytest.mark.parametrize("page", PAGES, ids=id_of)
def test_examples_run(page, monkeypatch):
    monkeypatch.chdir(ROOT)  # where the sample outlines are
    names: dict = {}
    before = plugins.by_hand()
    try:
        for block in re.findall(r"^( *)```python\n(.*?)^ *```", page.read_text("utf-8"), re.M | re.S):
            indent, source = block
            source = re.sub(rf"^{indent}", "", source, flags=re.M)
            exec(compile(source, page.name, "exec"), names)
    finally:
        if "playground" in names:
            names["playground"].close()
        for kind, name in plugins.by_hand():
            if (kind, name) not in before:
                plugins.unregister(kind, name)


@pytest.mark.parametrize("page", TOLD, ids=id_of)
def test_examples_that_take_long_are_python(page):
    for source in re.findall(r"^```\{code-block\} python\n(.*?)^```", page.read_text("utf-8"), re.M | re.S):
        compile(source, page.name, "exec")


@pytest.mark.parametrize("page", TOLD, ids=id_of)
def test_commands_exist(page, capsys):
    for line in re.findall(r"^    (?:[A-Z_]+=\S+ )?(?:\.venv/bin/)?polyfold (.+)$", page.read_text("utf-8"), re.M):
        words = shlex.split(line, comments=True)
        try:
            _parser(words).parse_args(words)
        except (SystemExit, Exception) as error:  # a wrong option ends the program
            told = answer(error) if isinstance(error, Exception) else capsys.readouterr().err
            pytest.fail(f"{page.name}: polyfold {line}: {told}")
