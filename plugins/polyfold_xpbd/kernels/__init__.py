"""The compiled loop over substeps: gravity, bending, tethers, stretch, self-contact, table.

Only :func:`polyfold_xpbd.kernels.loop.advance` and :func:`polyfold_xpbd.kernels.vectors.vertex_normals` keep their
machine code on disk. Numba renews it when the file of that very function changes, so the loop's is also kept under a
digest of all files here: a change to any kernel compiles the loop anew.
"""
