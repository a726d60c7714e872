"""Calling kernels that were compiled ahead of time."""

from __future__ import annotations

import ctypes
import hashlib
import json
import platform
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import cache, update_wrapper
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple

import numpy as np

FOLDER = Path(__file__).parent
INDEX = FOLDER / "kernels.json"
"""What there is: files of LLVM's intermediate code, the kernels in each, and the sources that they were made from."""
KERNELS = FOLDER.parent / "kernels"
PLACES = ("x86_64", "aarch64")
"""Machines, running Linux, whose code is made here: others have not been tried."""
RESULT, ERROR, STATUS, ARGUMENTS = 0, 4, 5, 6
"""Where, of 64 bits each, a kernel's results stand, what it raises, how it ended, and its arguments."""
ENDED_WELL = (0, -2)
"""numba's codes for a kernel that returned something, and for one that returned None."""
NEEDED = ("malloc", "free", "memset", "memcpy", "memmove")
"""What the code calls, or LLVM may write calls of."""


class Variant(NamedTuple):
    """A kernel for arguments of certain types.

    Attributes:
        code: the file of it.
        kernel: its name there.
        results: how many numbers it returns.
        slots: how many numbers its arguments are.
    """

    code: str
    kernel: str
    results: int
    slots: int


class Ahead:
    """A kernel: compiled ahead of time where that suits the arguments and the machine, else by numba.

    Attributes:
        otherwise: the kernel as numba compiles it.
    """

    def __init__(self, otherwise: Callable[..., Any], name: str) -> None:
        self.otherwise = otherwise
        self._name = name
        update_wrapper(self, otherwise)

    def __call__(self, *arguments: Any) -> Any:
        """Call it; what is compiled ahead of time lets other threads run meanwhile."""
        variant = _variants().get((self._name, tuple(map(type_of, arguments))))
        function = None if variant is None else _machine_code(variant)
        if variant is None or function is None:
            return self.otherwise(*arguments)
        slots = np.zeros(ARGUMENTS + variant.slots, np.int64)
        for place, value in enumerate(_flat(arguments), ARGUMENTS):
            slots[place] = value
        function(slots.ctypes.data)
        if slots[STATUS] not in ENDED_WELL:
            raise MemoryError(f"the kernel {self._name} failed, probably for want of memory")
        return tuple(slots[: variant.results].tolist()) if variant.results else None


def ahead(name: str, compiled: Callable[..., Any]) -> Any:
    """A function that numba compiles, called as it was compiled ahead of time under this name where it was."""
    from numba import config

    return compiled if getattr(config, "DISABLE_JIT", 0) else Ahead(compiled, name)


def type_of(argument: Any) -> str:
    """What a kernel's code depends on: a number's type, an array's, its dimensions and whether it may be written to."""
    if isinstance(argument, np.ndarray):
        order = "" if argument.flags.c_contiguous and argument.flags.aligned else " apart"
        return f"{argument.dtype.str[1:]}:{argument.ndim}{order}{'' if argument.flags.writeable else ' fixed'}"
    if isinstance(argument, tuple):
        return f"({', '.join(map(type_of, argument))})"
    if argument is None:
        return "none"
    return "i8" if type(argument) is int else np.dtype(type(argument)).str[1:]


def digest() -> str:
    """SHA-256 of the kernels' sources."""
    sources = sorted(KERNELS.rglob("*.py"))
    return hashlib.sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()


def _flat(arguments: Iterable[Any]) -> Iterator[int]:
    """Arguments as numba hands them on, 64 bits each: arrays by owner, parent, sizes, address, shape and strides."""
    for argument in arguments:
        if isinstance(argument, np.ndarray):
            yield from (0, 0, argument.size, argument.itemsize, argument.__array_interface__["data"][0])
            yield from argument.shape
            yield from argument.strides
        elif isinstance(argument, tuple):
            yield from _flat(argument)
        elif argument is None:
            yield 0
        elif isinstance(argument, np.floating):
            yield int.from_bytes(argument.tobytes(), "little")
        else:
            yield int(argument)


@cache
def _variants() -> dict[tuple[str, tuple[str, ...]], Variant]:
    """What there is by kernel and types; nothing where it was made from other sources, or for no machine like this."""
    if platform.system() != "Linux" or platform.machine() not in PLACES or not INDEX.is_file():
        return {}
    index = json.loads(INDEX.read_text(encoding="utf-8"))
    if index["digest"] != digest():
        return {}
    return {
        (one["kernel"], tuple(one["types"])): Variant(one["code"], one["kernel"], one["results"], one["slots"])
        for one in index["variants"]
    }


_lock = Lock()


def _machine_code(variant: Variant) -> Callable[[int], None] | None:
    """A variant in this processor's code; None where LLVM could not make it."""
    with _lock:  # two threads may want it at once
        return _made(variant)


@cache
def _made(variant: Variant) -> Callable[[int], None] | None:
    engine = _engine(variant.code)
    return engine and ctypes.CFUNCTYPE(None, ctypes.c_void_p)(engine.get_function_address(variant.kernel))


@cache
def _engine(code: str) -> Any:
    """The machine code of one file; None where LLVM is too old to read it, or something that it calls is missing."""
    import llvmlite.binding as llvm

    for prepare in (llvm.initialize, llvm.initialize_native_target, llvm.initialize_native_asmprinter):
        with suppress(RuntimeError):  # newer versions prepare themselves, and say so
            prepare()
    try:
        module = llvm.parse_bitcode((FOLDER / code).read_bytes())
    except RuntimeError:
        return None
    called = {function.name for function in module.functions if function.is_declaration}
    called = {name for name in called if not name.startswith("llvm.")} | set(NEEDED)
    if any(llvm.address_of_symbol(name) is None for name in called):
        return None
    machine = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=3, jit=True
    )
    module.triple, module.data_layout = machine.triple, str(machine.target_data)
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    return engine
