"""From ``polyfold new-plugin`` to a green conformance run, for every kind of component."""

import os
import re
import subprocess
import sys

import pytest

from polyfold.cli import main
from polyfold.plugins.hookspecs import KINDS, singular

METADATA = "Metadata-Version: 2.1\nName: {name}\nVersion: 0.1.0\n"


def installed(folder, name):
    """Make a plugin's folder visible as pip's editable install does; the environment of a process that sees it."""
    source = folder / "src"
    entry = re.search(r"\[project.entry-points.polyfold\]\n(.*)\n", (folder / "pyproject.toml").read_text())[1]
    about = source / f"{name.replace('-', '_')}-0.1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(METADATA.format(name=name))
    (about / "entry_points.txt").write_text("[polyfold]\n" + entry.replace('"', "") + "\n")
    return {**os.environ, "PYTHONPATH": os.pathsep.join([str(source), *sys.path])}


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_written_passes_its_own_tests(kind, tmp_path):
    name = f"polyfold-my-{singular(kind)}"
    assert main(["new-plugin", name, "--kind", singular(kind), "--out", str(tmp_path)]) == 0
    folder = tmp_path / name
    seen = installed(folder, name)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(folder)]
    tests = subprocess.run(command, env=seen, cwd=folder, capture_output=True, text=True, check=False)
    assert tests.returncode == 0, tests.stdout[-3000:]
    assert "skipped" not in tests.stdout
    listed = subprocess.run([sys.executable, "-m", "polyfold", "plugins"], env=seen, capture_output=True, text=True)
    assert f"my-{singular(kind)}" in listed.stdout.replace("_", "-")
    assert name in listed.stdout


def test_its_source_is_as_tidy_as_ours(tmp_path):
    for kind in KINDS:
        main(["new-plugin", f"my-{singular(kind)}", "--kind", kind, "--out", str(tmp_path)])
    command = [
        sys.executable,
        "-m",
        "ruff",
        "check",
        "--isolated",
        "--select",
        "E,F,W,I,UP,B,D1,SIM",
        "--ignore",
        "D107",
    ]
    checked = subprocess.run(
        [*command, "--line-length", "140", str(tmp_path)], capture_output=True, text=True, check=False
    )
    if "No module named ruff" in checked.stderr:
        pytest.skip("ruff is not installed")
    assert checked.returncode == 0, checked.stdout


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["Widest", "--kind", "policy"], "'Widest' is no name for a plugin; take lower-case letters"),
        (["../up", "--kind", "policy"], "is no name for a plugin"),
        (["widest", "--kind", "polcy"], "there is no kind 'polcy' of component; did you mean 'policy'?"),
        (["polyfold", "--kind", "policy"], "would hide Python's own or PolyFold"),
        (["class", "--kind", "policy"], "would hide Python's own or PolyFold; call it polyfold-class-mine"),
        (["json", "--kind", "metric"], "would hide Python's own or PolyFold"),
        (["polyfold-polygon", "--kind", "grounding"], "a grounding is called 'polygon' already; choose another name"),
        (["there", "--kind", "policy"], "is there already; choose another name, or remove it"),
    ],
)
def test_what_can_t_be_written_is_refused(arguments, says, tmp_path, capsys):
    (tmp_path / "there").mkdir()
    assert main(["new-plugin", *arguments, "--out", str(tmp_path)]) == 1
    assert says in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["there"]
    assert not list((tmp_path / "there").iterdir())
