"""The compiled loop over substeps: gravity, bending, tethers, stretch, self-contact, table.

They are compiled ahead of time (:mod:`polyfold_xpbd.ahead`), until a file here changes. Then numba compiles, and what
the simulator itself calls keeps its machine code on disk. Numba renews that when the file of that very function
changes, so the loop's is also kept under a digest of all files here: a change to any kernel compiles the loop anew.
"""
