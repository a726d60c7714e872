"""Compiled kernels are never older than their sources, whichever file of theirs was changed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import polyfold_xpbd

PROGRAM = """
from polyfold.types import Action
from polyfold_standard.garments.square import Square
from polyfold_xpbd.simulator import XpbdSimulator
from polyfold_xpbd.kernels.loop import advance
simulator = XpbdSimulator()
simulator.reset(Square().generate(2000, 0.04), 0)
corners = simulator.state().keypoint_pixels()
simulator.execute(Action([corners["bottom_left"]], [corners["top_right"]]))
print(sum(advance.stats.cache_hits.values()), simulator.state().positions.sum().hex())
"""


def test_a_change_to_any_kernel_compiles_the_loop_anew(tmp_path):
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
        hits, positions = done.stdout.split()
        return int(hits), positions

    compiled, cached = run(), run()
    assert compiled[0] == 0
    assert cached == (1, compiled[1])
    motion = tmp_path / "polyfold_xpbd" / "kernels" / "motion.py"
    text = motion.read_text()
    assert "9.81" in text, "gravity"
    motion.write_text(text.replace("9.81", "1.62"))
    hits, positions = run()
    assert hits == 0
    assert positions != compiled[1]
