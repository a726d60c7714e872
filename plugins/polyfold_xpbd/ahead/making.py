"""Compile the kernels ahead of time: ``python -m polyfold_xpbd.ahead.making``, after a change to one of them.

numba compiles each for the types that folding calls it with, to LLVM code that suits every processor. Of that are kept
the kernels, what they call, and for each a function that takes its arguments from a row of 64-bit numbers. What numba
would have called of its own runtime, memory alone, is written here in a few lines, so the code needs no numba.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from typing import Any

import numpy as np

from polyfold_xpbd.ahead import calling
from polyfold_xpbd.ahead.calling import ARGUMENTS, ERROR, FOLDER, INDEX, RESULT, STATUS, digest, type_of

ANY_PROCESSOR = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
MEMORY = """
declare ptr @malloc(i64)
declare void @free(ptr)

define ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align) {
  %step = zext i32 %align to i64
  %head = add i64 %step, 48
  %total = add i64 %size, %head
  %info = call ptr @malloc(i64 %total)
  %none = icmp eq ptr %info, null
  br i1 %none, label %done, label %fill
fill:
  %first = ptrtoint ptr %info to i64
  %last = add i64 %first, %head
  %past = urem i64 %last, %step
  %begin = sub i64 %last, %past
  %data = inttoptr i64 %begin to ptr
  %dtor = getelementptr i8, ptr %info, i64 8
  %dtor.info = getelementptr i8, ptr %info, i64 16
  %at = getelementptr i8, ptr %info, i64 24
  %bytes = getelementptr i8, ptr %info, i64 32
  %allocator = getelementptr i8, ptr %info, i64 40
  store i64 1, ptr %info
  store ptr null, ptr %dtor
  store ptr null, ptr %dtor.info
  store ptr %data, ptr %at
  store i64 %size, ptr %bytes
  store ptr null, ptr %allocator
  br label %done
done:
  ret ptr %info
}

define void @NRT_incref(ptr %info) {
  %none = icmp eq ptr %info, null
  br i1 %none, label %done, label %add
add:
  %old = load i64, ptr %info
  %new = add i64 %old, 1
  store i64 %new, ptr %info
  br label %done
done:
  ret void
}

define void @NRT_decref(ptr %info) {
  %none = icmp eq ptr %info, null
  br i1 %none, label %done, label %take
take:
  %old = load i64, ptr %info
  %new = sub i64 %old, 1
  store i64 %new, ptr %info
  %last = icmp eq i64 %new, 0
  br i1 %last, label %end, label %done
end:
  call void @free(ptr %info)
  br label %done
done:
  ret void
}
"""
"""numba's counted memory: references, what destroys it, that one's argument, the data, their size, who allocated."""


def main() -> None:
    """Compile in a process that numba has not been loaded into, whose settings it reads when it is."""
    if "--here" in sys.argv[1:]:
        _make()
        return
    with tempfile.TemporaryDirectory() as empty:
        settings = {**os.environ, **ANY_PROCESSOR, "NUMBA_CACHE_DIR": empty}
        subprocess.run([sys.executable, "-m", __spec__.name, "--here"], env=settings, check=True)  # pyright: ignore


def _make() -> None:
    import llvmlite.binding as llvm

    calling.PLACES = ()  # nothing that was made before
    _keep_portable_code()
    index, known = [], set()
    for code, guaranteed in (("kernels.bc", False), ("guaranteed.bc", True)):
        whole, entries = llvm.parse_assembly(MEMORY), []
        for name, kernel in _compiled_by_folding(guaranteed).items():
            for made in kernel.otherwise.overloads.values():
                if made.fndesc.llvm_func_name not in known:
                    known.add(made.fndesc.llvm_func_name)
                    entries.append(_add(whole, name, made))
        kernels = [entry["kernel"] for entry in entries]
        _finish(whole, kernels)
        (FOLDER / code).write_bytes(whole.as_bitcode())
        index += [{"code": code, **entry} for entry in entries]
        print(f"{code}: {(FOLDER / code).stat().st_size} bytes, {', '.join(kernels)}")
    about = {"digest": digest(), "llvm": ".".join(map(str, llvm.llvm_version_info)), "variants": index}
    INDEX.write_text(json.dumps(about, indent=1) + "\n", encoding="utf-8")


def _keep_portable_code() -> None:
    """Have numba keep each library's code as it is before machine code is made of it, which changes it."""
    from numba.core.codegen import CPUCodeLibrary

    optimise = CPUCodeLibrary._optimize_final_module

    def optimised(library: Any) -> None:
        optimise(library)
        library.portable = library._final_module.as_bitcode()

    setattr(CPUCodeLibrary, optimise.__name__, optimised)


def _compiled_by_folding(guaranteed: bool) -> dict[str, Any]:
    """The kernels, after they were called with all types that a simulator like this calls them with."""
    from polyfold import plugins
    from polyfold.types import Action
    from polyfold_xpbd import camera, solver

    simulator = plugins.create("simulators", "xpbd", {"guaranteed": guaranteed})
    simulator.reset(plugins.generate_garment("square", 0, 0.06), 0)
    corners = simulator.state().keypoint_pixels()
    simulator.execute(Action(np.array([corners["bottom_left"]]), np.array([corners["top_right"]])))
    return {
        "advance": solver.advance,
        "average_normals": solver.average_normals,
        "rasterise": camera.rasterise,
        "average": camera.average,
    }


def _add(whole: Any, kernel: str, made: Any) -> dict[str, Any]:
    """Link what numba ``made`` of a ``kernel``, and its entry, into the ``whole``; what the index says of it."""
    import llvmlite.binding as llvm

    whole.link_in(llvm.parse_bitcode(made.library.portable))
    name = made.fndesc.llvm_func_name
    types = [str(parameter.type) for parameter in whole.get_function(name).arguments]
    whole.link_in(llvm.parse_assembly(_entry(kernel, name, types)))
    return {
        "kernel": kernel,
        "types": [_named(one) for one in made.signature.args],
        "results": getattr(made.signature.return_type, "count", 0),
        "slots": len(types) - 2,
    }


def _entry(entry: str, name: str, types: list[str]) -> str:
    """A function of one pointer that calls ``name``, whose parameters have these types; two are for its results."""
    lines = [f'define void @"{entry}"(ptr %slots) {{']
    handed = []
    for number, kind in enumerate(types):
        slot = (RESULT, ERROR)[number] if number < 2 else ARGUMENTS + number - 2
        lines.append(f"  %p{number} = getelementptr i64, ptr %slots, i64 {slot}")
        if number >= 2:
            lines.append(f"  %v{number} = load {kind}, ptr %p{number}")
        handed.append(f"{kind} %{'v' if number >= 2 else 'p'}{number}")
    lines += [
        f'  %status = call i32 @"{name}"({", ".join(handed)})',
        "  %wide = sext i32 %status to i64",
        f"  %end = getelementptr i64, ptr %slots, i64 {STATUS}",
        "  store i64 %wide, ptr %end",
        "  ret void",
        "}",
        f'declare i32 @"{name}"({", ".join(types)})',
    ]
    return "\n".join(lines)


def _named(kind: Any) -> str:
    """A type of numba's as :func:`polyfold_xpbd.ahead.calling.type_of` names it."""
    from numba.core import types
    from numba.np.numpy_support import as_dtype

    if isinstance(kind, types.Array):
        example = np.zeros((1,) * kind.ndim, as_dtype(kind.dtype))
        example.flags.writeable = kind.mutable
        return type_of(example)
    if isinstance(kind, (types.Tuple, types.UniTuple)):
        return f"({', '.join(map(_named, kind))})"
    return "none" if isinstance(kind, types.NoneType) else as_dtype(kind).str[1:]


def _finish(whole: Any, entries: Iterable[str]) -> None:
    """Leave what the entries call, without names, and let LLVM see it as one."""
    import llvmlite.binding as llvm

    for part in (*whole.functions, *whole.global_variables):
        if not part.is_declaration and part.name not in entries:
            part.linkage = "internal"
    machine = llvm.Target.from_default_triple().create_target_machine(cpu="generic", features="", opt=3, jit=True)
    tuning = llvm.create_pipeline_tuning_options(speed_level=2)
    tuning.loop_vectorization = tuning.slp_vectorization = True
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(whole, builder)
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_strip_dead_prototype_pass()
    passes.add_strip_symbols_pass()
    passes.run(whole, builder)
    whole.verify()


if __name__ == "__main__":
    main()
