import subprocess
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


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs_from_top_to_bottom(path):
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(path.parent)}}).execute()
    pictures = [
        output
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if {"image/png", "image/gif", "text/html"} & set(output.get("data", {}))
    ]
    assert pictures, "a notebook shows something"


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
