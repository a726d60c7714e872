"""The same folds on every processor, in the process that compiled the solver and in those that load it."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import polyfold
from polyfold import plugins
from polyfold.types import Action

OLDER = {
    # What another processor would run: numba's machine code, numpy's loops, BLAS and the C library's functions.
    "NUMBA_CPU_NAME": "generic",
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX2 FMA3 AVX512F AVX512_SKX",
    "OPENBLAS_CORETYPE": "NEHALEM",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F",
}
HASH_IN_ANOTHER_PROCESS = "from test_processors import folded; print(folded())"


def folded():
    """A hash of where three folds leave a t-shirt, and of its pictures."""
    simulator = plugins.create("simulators", "xpbd")
    simulator.reset(polyfold.garment("tshirt", seed=2000, edge_length=0.025), 0)
    digest = hashlib.sha256()
    for picks, places in [
        (("hem_left", "hem_right"), ("shoulder_left", "shoulder_right")),
        (("sleeve_top_left",), ("sleeve_top_right",)),
        (("sleeve_top_right", "armpit_right"), ("sleeve_bottom_left", "hem_left")),
    ]:
        at = simulator.state().keypoint_pixels()
        seen = simulator.execute(Action(*([at[name] for name in names] for names in (picks, places))))
        digest.update(simulator.state().positions.tobytes() + seen.rgb.tobytes() + seen.depth.tobytes())
    return digest.hexdigest()


def in_another_process(**variables):
    shown = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", HASH_IN_ANOTHER_PROCESS],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])} | variables,
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    return shown.stdout.strip()


def test_a_fold_ends_where_it_does_on_another_processor_and_where_the_solver_is_being_compiled(tmp_path):
    compiling, loading = (in_another_process(**OLDER, NUMBA_CACHE_DIR=str(tmp_path)) for _ in range(2))
    assert compiling == loading == folded()
