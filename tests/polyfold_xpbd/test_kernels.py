"""Compiled kernels are never older than their sources, whichever file of theirs was changed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import polyfold_xpbd
import pytest

PROGRAM = """
import sys
from polyfold.types import Action
from polyfold_standard.garments.square import Square
from polyfold_xpbd.simulator import XpbdSimulator
from polyfold_xpbd.kernels.loop import advance
numba = advance.otherwise
for guaranteed in (False, True):
    simulator = XpbdSimulator(XpbdSimulator.Config(guaranteed=guaranteed))
    simulator.reset(Square().generate(2000, 0.04), 0)
    corners = simulator.state().keypoint_pixels()
    simulator.execute(Action([corners["bottom_left"]], [corners["top_right"]]))
    seen = simulator.observe()
    print(simulator.state().positions.sum().hex(), seen.rgb.sum(), float(seen.depth.sum()))
kept = sum(numba.stats.cache_hits.values())
print("compiled", len(numba.signatures) - kept, "kept", kept)
print("Watch" in " ".join(map(repr, numba.nopython_signatures)))
"""


@pytest.fixture
def run(tmp_path):
    """Fold as the simulator in ``tmp_path`` does: how it came out, what numba did, whether it knows a class of ours."""
    there = Path(polyfold_xpbd.__file__).parent
    shutil.copytree(there, tmp_path / "polyfold_xpbd", ignore=shutil.ignore_patterns("__pycache__"))
    settings = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path]),
        "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
    }

    def run():
        done = subprocess.run([sys.executable, "-c", PROGRAM], env=settings, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        *folded, compiling, ours = done.stdout.splitlines()
        return folded, compiling, ours

    return run


def test_a_change_to_any_kernel_compiles_the_loop_anew(run, tmp_path):
    shipped, compiling, _ = run()
    assert compiling == "compiled 0 kept 0", "the first fold after an install waits for nothing"
    motion = tmp_path / "polyfold_xpbd" / "kernels" / "motion.py"
    text = motion.read_text()
    motion.write_text(text + "\n# changed\n")
    anew, compiling, ours = run()
    assert compiling == "compiled 2 kept 0"
    assert anew == shipped, "to the last bit"
    assert ours == "False", "a class of ours in numba's cache could not be imported once it was renamed"
    assert run() == (shipped, "compiled 0 kept 2", "False")
    assert "9.81" in text, "gravity"
    motion.write_text(text.replace("9.81", "1.62"))
    lighter, compiling, _ = run()
    assert compiling == "compiled 2 kept 0"
    assert not set(lighter) & set(shipped)
