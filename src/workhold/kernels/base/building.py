"""Compile the kernels of a room into one library: ``python -m workhold.kernels.base.building ROOM FOLDER``.

Numba compiles each kernel together with an entry that reads its arguments from words. LLVM makes an object
of each, in which nothing but the entry can be called, and a linker makes a shared library of them.
Arrays in kernels look at memory of the caller and own none, so that no references are counted; the library
calls functions of the C library's mathematics alone, and has neither Python nor numba in it.
"""

from __future__ import annotations

import gc
import os
import pkgutil
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Collection, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from threading import Event, Thread
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np
from numba import types

from workhold.kernels.base.compiling import (
    INNER,
    LETTERS,
    OPTIONS,
    Kernel,
    count_dimensions,
    get_element_type,
    list_fields,
)
from workhold.kernels.base.libraries import ENDINGS, KERNELS, make_library_name
from workhold.kernels.base.views import make_view_at

# What a library may call: functions of the C library's mathematics, and those that move memory.
OUTSIDE = {
    *("acos", "asin", "atan", "atan2", "ceil", "cos", "exp", "floor", "fmod", "hypot", "log", "pow", "sin"),
    *("sqrt", "tan", "memcpy", "memmove", "memset"),
}
# Seconds between reports of how much is compiled.
INTERVAL = 0.2


class EntrySource:
    """Python source of an entry: it reads a kernel's arguments from
    words and writes its result to the first words.
    """

    def __init__(self, kernel: Kernel) -> None:
        self.word = len(kernel.results)
        self.names: dict[str, Any] = {
            "make_view_at": make_view_at,
            "kernel": numba.njit(**OPTIONS)(kernel.function),
            "int64": np.int64,
            "float64": np.float64,
        }
        arguments = ", ".join([self.read(kind) for kind in kernel.arguments.values()])
        self.lines = [
            "def entry(address):",
            f"    words = make_view_at(address, ({self.word},), int64)",
            f"    reals = make_view_at(address, ({self.word},), float64)",
            f"    {'found = ' if kernel.results else ''}kernel({arguments})",
        ]
        for number, kind in enumerate(kernel.results):
            found = f"found[{number}]" if len(kernel.results) > 1 else "found"
            self.lines.append(f"    {'reals' if kind is float else 'words'}[{number}] = {found}")

    def read(self, kind: Any) -> str:
        """Return the expression that reads an argument of this type from
        the next words; advance ``self.word`` past them.
        """
        if (parts := list_fields(kind)) is not None:
            values = ", ".join([self.read(part) for _, part in parts])
            return f"{self.name(kind)}({values})" if hasattr(kind, "_fields") else f"({values},)"
        word = self.word
        if kind in LETTERS:
            self.word += 1
            return {int: f"words[{word}]", float: f"reals[{word}]", bool: f"words[{word}] != 0"}[kind]
        count = count_dimensions(kind)
        self.word += 1 + count
        shape = ", ".join(f"words[{word + 1 + axis}]" for axis in range(count))
        return f"make_view_at(words[{word}], ({shape},), {self.name(get_element_type(kind).type)})"

    def name(self, thing: type[Any]) -> str:
        """Return the name of a class in the source, and add the class to the names that the source
        can use.
        """
        self.names[thing.__name__] = thing
        return thing.__name__

    def compile(self) -> Any:
        """Return numba's C function of the entry: void (int64 address of the words)."""
        exec("\n".join(self.lines), self.names)
        return numba.cfunc(types.void(types.int64), error_model="numpy")(self.names["entry"])


def compile_kernels(room: str) -> Iterator[tuple[str, Any]]:
    """Yield (name, LLVM module) of each kernel of a room by name; the module's entry function has
    that name.
    """
    for _, kernel in sorted(Kernel.all[room].items()):
        entry = EntrySource(kernel).compile()
        module = llvm.parse_assembly(entry.inspect_llvm())
        module.get_function(entry.native_name).name = kernel.name
        yield kernel.name, module


def make_object(module: Any, entries: Collection[str]) -> bytes:
    """Return the object file of a module that exports only the functions named in ``entries``.

    Raises
    ------
    SystemExit
        When the module calls a function outside ``OUTSIDE``, as a kernel does that makes an array or raises
        an error.
    """
    machine = llvm.Target.from_default_triple().create_target_machine(
        cpu=os.environ["NUMBA_CPU_NAME"], features="", opt=3, reloc="pic", codemodel="default"
    )
    for thing in (*module.functions, *module.global_variables):
        if not thing.is_declaration and thing.name not in entries:
            thing.linkage = "internal"
    # The second time what can never happen is gone, such as errors of functions that raise none.
    for _ in range(2):
        builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
        builder.getModulePassManager().run(module, builder)
    for function in module.functions:
        if function.is_declaration and not function.name.startswith("llvm.") and function.name not in OUTSIDE:
            sys.exit(f"One of the kernels {', '.join(entries)} calls {function.name}, which no library has.")
    return bytes(machine.emit_object(module))


def link(linker: str, sources: Sequence[Path], target: Path) -> None:
    """Link object files (``sources``) into the shared library ``target``, with the program ``linker``."""
    if sys.platform == "darwin":
        options = ["-dynamiclib", "-undefined", "dynamic_lookup"]
    elif sys.platform == "win32":
        # Of MinGW, whose C library is linked to; untested.
        options = ["-shared", "-s"]
    else:
        # What is left open, the functions of libm, is found in the process that loads the library.
        options = ["-shared", "-s"] + (["-nostdlib"] if linker.endswith("cc") else [])
    subprocess.run([linker, *options, "-o", target, *sources], check=True)


def build(room: str, folder: Path) -> Path:
    """Build the library of a room into ``folder``, and return its path.

    Each kernel is optimized with its own copies of the functions that it calls, which makes it faster. Where
    no linker is installed, the library is one object file with all kernels.
    """
    package = f"workhold.kernels.{room}"
    for module in pkgutil.iter_modules([str(KERNELS / room)]):
        if module.name not in ("building", "libraries", "views"):
            import_module(f"{package}.{module.name}")
    linker = shutil.which("cc") or shutil.which("ld")
    with tempfile.TemporaryDirectory(dir=folder) as name:
        made, whole = Path(name) / "kernels", None
        entries, objects = list[str](), list[Path]()
        for entry, module in compile_kernels(room):
            entries.append(entry)
            if linker is not None:
                objects.append(made.with_name(f"{entry}.o"))
                objects[-1].write_bytes(make_object(module, (entry,)))
            elif whole is None:
                whole = module
            else:
                whole.link_in(module)
        if linker is not None:
            link(linker, objects, made)
        else:
            made.write_bytes(make_object(whole, entries))
        path = folder / make_library_name(room, ENDINGS[linker is None])
        made.replace(path)
    return path


def report_progress(stop: Event) -> None:
    """Print the compiled share of the inner functions (0 to 1), a
    line every ``INTERVAL`` seconds, until ``stop`` is set.
    """
    while not stop.wait(INTERVAL):
        done = sum(bool(function.signatures) for function in INNER)
        sys.stdout.write(f"{done / max(len(INNER), 1):.3f}\n")
        sys.stdout.flush()


def end_with_starter() -> None:
    """Wait until standard input is closed, which means that the
    starting process has ended; then exit with status 1.
    """
    sys.stdin.read()
    os._exit(1)


def main(room: str, folder: str) -> None:
    """Build the library of a room into a folder; print the progress from 0 to 1, a line each."""
    # The collector would look through all that is compiled again and again.
    gc.disable()
    stop = Event()
    Thread(target=end_with_starter, daemon=True).start()
    reporting = Thread(target=report_progress, args=(stop,))
    reporting.start()
    try:
        build(room, Path(folder))
    finally:
        stop.set()
        reporting.join()
    sys.stdout.write("1.0\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
