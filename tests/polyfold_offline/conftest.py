"""What tests of the offline reader share."""

import contextlib
import io

import pytest

from polyfold.cli import main


@pytest.fixture
def cli():
    """Run a command line; gives its exit status and all that it printed."""

    def run(*arguments):
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            status = main([str(argument) for argument in arguments])
        return status, out.getvalue()

    return run
