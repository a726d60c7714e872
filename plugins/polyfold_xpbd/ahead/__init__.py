"""Kernels compiled ahead of time, so that the first fold after an install need not wait for numba.

numba turns Python into LLVM's intermediate code in half a minute, and LLVM that into machine code in half a second. The
first step is done once, by :mod:`polyfold_xpbd.ahead.making`, and its result, which is no processor's own, is shipped;
the second is done here by :mod:`polyfold_xpbd.ahead.calling`, for the processor at hand. Where that can't be, after a
change to a kernel for example, numba compiles as it always did, to the same numbers.
"""
