import os

# Tests run in as many processes as there are cores: threads of numerical libraries would fight over them, and those of
# OpenBLAS slow each other down many times over. It reads this once, when numpy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from hypothesis import settings

# The first call of a compiled or lazily imported function is slow; a deadline would judge that, not the property.
settings.register_profile("project", deadline=None, derandomize=True)
settings.load_profile("project")
