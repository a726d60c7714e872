"""The notebooks as somebody runs them who has installed the package and copied the notebook somewhere."""

import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

ROOT = Path(__file__).parents[2]


def git(*arguments):
    """What git prints; None where it is not installed, or this is no checkout."""
    try:
        return subprocess.run(
            ["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=True, encoding="utf-8"
        ).stdout
    except (OSError, subprocess.CalledProcessError):
        return None


def notebooks():
    """Those of the project: what else somebody keeps in the folder is their own."""
    tracked = git("ls-files", "--", "notebooks/*.ipynb")
    return [ROOT / name for name in tracked.splitlines()] if tracked else sorted((ROOT / "notebooks").glob("*.ipynb"))


NOTEBOOKS = notebooks()


@pytest.fixture(scope="session")
def installed(tmp_path_factory):
    """The folder that the built wheel is installed into."""
    target = tmp_path_factory.mktemp("installed")
    install = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*install, "--target", str(target), str(ROOT)], check=True)
    # The simulator's kernels would take minutes to compile again: those of the checkout, whose code is kept.
    shutil.rmtree(target / "polyfold_xpbd")
    (target / "polyfold_xpbd").symlink_to(ROOT / "plugins" / "polyfold_xpbd", target_is_directory=True)
    return target


WHERE_FROM = """
import sys

ours = (name for name in sys.modules if name.startswith(("polyfold", "experiments")))
[name for name in ours if not str(sys.modules[name].__spec__.origin).startswith({target!r})]
"""


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs_from_an_empty_folder_with_what_is_installed(path, installed, tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(installed))
    notebook = nbformat.read(path, as_version=4)
    notebook.cells.append(nbformat.v4.new_code_cell(WHERE_FROM.format(target=str(installed))))
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    (told,) = notebook.cells.pop().outputs
    assert told["data"]["text/plain"] == "[]", "modules of the checkout"
    assert not list(tmp_path.iterdir()), "a notebook leaves what it makes in a temporary folder"
    shown = [output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any({"image/png", "image/gif", "text/html"} & set(data) for data in shown), "a notebook shows something"
    assert not [data for data in shown if set(data) == {"text/plain"} and data["text/plain"].startswith("<")]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_is_committed_without_outputs(path):
    # Not the file itself: an editor that saves by itself leaves outputs there, and may.
    committed = git("show", f":./{path.relative_to(ROOT).as_posix()}")
    if committed is None:
        pytest.skip("not a checkout, so nothing is committed")
    notebook = nbformat.reads(committed, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "clear the outputs before adding it to git"


def test_no_checkpoints_of_an_editor_are_committed():
    assert ".ipynb_checkpoints" not in (git("ls-files") or "")
