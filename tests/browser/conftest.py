"""A real JupyterLab in a real browser, where both are installed: Debian's chromium, driven by playwright."""

import os
import re
import secrets
import shutil
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


@contextmanager
def _server(folder):
    """JupyterLab over a folder; its address."""
    token = secrets.token_hex(8)
    command = [
        sys.executable, "-m", "jupyterlab", "--no-browser", "--port=0", "--ip=127.0.0.1", "--allow-root",
        f"--ServerApp.root_dir={folder}", f"--IdentityProvider.token={token}", "--LabApp.extension_manager=readonly",
        "--LabApp.news_url=None", "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
    ]  # fmt: skip
    home = {"JUPYTER_CONFIG_DIR": str(folder / ".jupyter"), "JUPYTER_DATA_DIR": str(folder / ".data")}
    process = subprocess.Popen(command, env={**os.environ, **home}, stderr=subprocess.PIPE, text=True)
    try:
        for line in process.stderr:
            found = re.search(r"http://127\.0\.0\.1:(\d+)/lab\?token=", line)
            if found:
                yield f"http://127.0.0.1:{found[1]}/lab/tree/{{}}?token={token}"
                return
        raise AssertionError("JupyterLab did not start")
    finally:
        process.terminate()
        process.stderr.close()
        process.wait(timeout=30)


@pytest.fixture
def lab(tmp_path):
    """A function that opens a notebook of one cell with this source in JupyterLab, and runs it; the browser's page."""
    engine = pytest.importorskip("playwright.sync_api", reason="drives the browser")
    pytest.importorskip("jupyterlab")
    if CHROMIUM is None:
        pytest.skip("there is no chromium here")
    with _server(tmp_path) as address, engine.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.set_default_timeout(60_000)
        # JupyterLab asks for a kernel where it opens a notebook before it knows which there are.
        asked = page.locator("dialog.jp-Dialog")
        page.add_locator_handler(asked, lambda: asked.get_by_role("button", name="Select", exact=True).last.click())

        def opened(source):
            _write(tmp_path / "mine.ipynb", source)
            page.goto(address.format("mine.ipynb"))
            page.wait_for_selector('.jp-Notebook-ExecutionIndicator[data-status="idle"]')
            _run_first_cell(page)
            return page

        yield opened
        browser.close()


def _run_first_cell(page):
    """Press Shift+Enter until the cell has run or is running: JupyterLab may still lay the notebook out."""
    for _ in range(20):
        page.click(".jp-Notebook .jp-Cell .cm-content")
        page.keyboard.press("Shift+Enter")
        page.wait_for_timeout(1_000)
        if page.locator(".jp-InputPrompt").first.text_content().strip() != "[ ]:":
            return
    raise AssertionError("the cell did not start")


def _write(path, source):
    import nbformat

    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    nbformat.write(notebook, path)


@pytest.fixture
def keep_screenshot(request):
    """A function that keeps what a page shows in the folder that ``POLYFOLD_SCREENSHOTS`` names, if it does."""
    folder = os.environ.get("POLYFOLD_SCREENSHOTS")

    def keep(page, name):
        if folder:
            page.screenshot(path=Path(folder) / f"{name}.png")

    return keep
