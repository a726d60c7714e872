import contextlib
import io
from types import SimpleNamespace

import pytest

from polyfold.cli import main


@pytest.fixture
def polyfold():
    """Run the command line in this process (the child processes of tests/plugins cover the real entry point)."""

    def run(*arguments):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                status = main([str(argument) for argument in arguments])
            except SystemExit as stop:
                status = stop.code
        return SimpleNamespace(status=status, out=out.getvalue(), err=err.getvalue())

    return run
