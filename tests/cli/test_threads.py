"""The command line leaves the cores to others."""

import os
import subprocess
import sys

import pytest

ASK = """
import os
from polyfold.cli import main

main(["tasks"])
print(os.environ.get("OPENBLAS_NUM_THREADS"))
"""


@pytest.mark.parametrize(
    ("before", "given", "threads"),
    [("", {}, "1"), ("", {"OPENBLAS_NUM_THREADS": "2"}, "2"), ("import numpy", {}, "None")],
)
def test_numpy_keeps_to_one_thread_unless_told_otherwise(before, given, threads):
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"} | given
    asked = subprocess.run(
        [sys.executable, "-c", before + ASK], env=environment, capture_output=True, text=True, check=True
    )
    assert asked.stdout.split()[-1] == threads
