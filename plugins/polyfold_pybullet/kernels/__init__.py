"""Compiled kinematics. All kernels stand in one module: numba recompiles a module's functions when its file changes."""
