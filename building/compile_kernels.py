"""Compile all kernels ahead of time into one shared library that ``workhold.kernels.base.built`` loads.

Numba compiles each kernel for a plain processor of this kind (x86-64 without extensions, say), just as it would on first
use. Of its optimized code everything but the kernel itself is made private or thrown away, LLVM writes an object file,
and the linker joins them. Kernels keep numba's calling convention, so the library needs nothing of Python; what they need of
numba's runtime, making and giving back arrays, is a few lines of LLVM's language below.

The parts of ``workhold.kernels.preparing`` are compiled in processes of their own at the same time. Run as a script with the
folder for the library, and the parts, if not all.
"""

from __future__ import annotations

import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

SOURCES = Path(__file__).resolve().parents[1] / "src"
# The first word to a process that compiles a part.
EMIT = "emit"
# What a kernel is called beside the function that takes its words.
OWN = "kernel_itself"
# The plain processor that is compiled for; of others whatever LLVM takes for the oldest.
PLAIN = {"x86_64": "x86-64", "AMD64": "x86-64"}
# numba's record of an array in memory: references, two for a destructor, address, bytes, allocator.
RUNTIME = """
declare ptr @malloc(i64)
declare void @free(ptr)

define ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align) {
  %wide = zext i32 %align to i64
  %room = add i64 %wide, 48
  %total = add i64 %size, %room
  %made = call ptr @malloc(i64 %total)
  %none = icmp eq ptr %made, null
  br i1 %none, label %failed, label %filled
failed:
  ret ptr null
filled:
  %address = ptrtoint ptr %made to i64
  %behind = add i64 %address, %room
  %over = urem i64 %behind, %wide
  %start = sub i64 %behind, %over
  %data = inttoptr i64 %start to ptr
  store i64 1, ptr %made
  %data_at = getelementptr i64, ptr %made, i64 3
  store ptr %data, ptr %data_at
  %size_at = getelementptr i64, ptr %made, i64 4
  store i64 %size, ptr %size_at
  ret ptr %made
}

define void @NRT_MemInfo_call_dtor(ptr %made) {
  call void @free(ptr %made)
  ret void
}
"""
# Whether an object is an array of some elements, in order and aligned, of so many dimensions, by its header.
IS_ARRAY = """
@{known} = external global [{count} x ptr]

define internal i1 @is_array(ptr %object, i64 %element, i32 %dimensions) {{
  %type_at = getelementptr i8, ptr %object, i64 {type}
  %type = load ptr, ptr %type_at
  %wanted_type = load ptr, ptr @{known}
  %same_type = icmp eq ptr %type, %wanted_type
  br i1 %same_type, label %array, label %none
none:
  ret i1 false
array:
  %element_at = getelementptr i8, ptr %object, i64 {element}
  %own_element = load ptr, ptr %element_at
  %wanted_at = getelementptr ptr, ptr @{known}, i64 %element
  %wanted = load ptr, ptr %wanted_at
  %same_element = icmp eq ptr %own_element, %wanted
  %dimensions_at = getelementptr i8, ptr %object, i64 {dimensions}
  %own_dimensions = load i32, ptr %dimensions_at
  %same_dimensions = icmp eq i32 %own_dimensions, %dimensions
  %flags_at = getelementptr i8, ptr %object, i64 {flags}
  %flags = load i32, ptr %flags_at
  %own_order = and i32 %flags, {ordered}
  %same_order = icmp eq i32 %own_order, {ordered}
  %same = and i1 %same_element, %same_dimensions
  %all = and i1 %same, %same_order
  ret i1 %all
}}
"""
EXPORTS = """
declare void @free(ptr)
@{description} = constant [{length} x i8] c"{text}"
@{known} = global [{count} x ptr] zeroinitializer

define void @{release}(ptr %made) {{
  %before = atomicrmw sub ptr %made, i64 1 seq_cst
  %last = icmp eq i64 %before, 1
  br i1 %last, label %unused, label %used
unused:
  call void @free(ptr %made)
  ret void
used:
  ret void
}}
"""


def described(kind: Any) -> Any:
    """A type of numba as ``workhold.kernels.base.built`` tells it."""
    from numba.core import types

    if isinstance(kind, types.Array):
        assert kind.layout == "C", kind
        element = "i8" if kind.dtype == types.int64 else "f8" if kind.dtype == types.float64 else "i1"
        assert element != "i1" or kind.dtype == types.int8, kind
        return {"array": element, "dimensions": kind.ndim}
    if isinstance(kind, types.BaseTuple):
        return [described(part) for part in kind.types]
    if kind == types.none:
        return None
    assert kind in (types.int64, types.float64, types.boolean), kind
    return "bool" if kind == types.boolean else str(kind)


def taking_words(name: str, arguments: Sequence[Any], kinds: Sequence[str], results: int) -> str:
    """A function, in LLVM's language, that calls a kernel with what words of eight bytes say: as many as it returns are left
    free before one for its failure, then come those of its arguments, of arrays where their headers are. The kernel takes
    values of some kinds, arrays taken apart; the function returns ``REFUSED`` for an array that is none of its own.
    """
    from workhold.kernels.base.built import ELEMENTS, HEADER, KNOWN, ORDERED, REFUSED

    lines = [IS_ARRAY.format(known=KNOWN, count=1 + len(ELEMENTS), ordered=ORDERED, **HEADER)]
    lines += [f"declare i32 @{OWN}({', '.join(kinds)})", f"define i32 @{name}(ptr %words) {{"]
    values = ["ptr %words", f"ptr %at{results}"]
    lines.append(f"  %at{results} = getelementptr i64, ptr %words, i64 {results}")
    for number, argument in enumerate(flat(arguments), results + 1):
        lines.append(f"  %at{number} = getelementptr i64, ptr %words, i64 {number}")
        if isinstance(argument, str):
            kind = kinds[len(values)]
            # Truths are words, too.
            whole = kind in ("double", "i64")
            lines.append(
                f"  %{'value' if whole else 'word'}{number} = load {kind if whole else 'i64'}, ptr %at{number}"
            )
            if not whole:
                lines.append(f"  %value{number} = trunc i64 %word{number} to {kind}")
            values.append(f"{kind} %value{number}")
            continue
        array, dimensions, element = f"%array{number}", argument["dimensions"], argument["array"]
        lines += [
            f"  {array} = load ptr, ptr %at{number}",
            f"  {array}.is = call i1 @is_array(ptr {array}, i64 {1 + ELEMENTS.index(element)}, i32 {dimensions})",
            f"  br i1 {array}.is, label %taken{number}, label %refused",
            f"taken{number}:",
        ]
        for part in ("data", "shape", "strides"):
            lines.append(f"  {array}.{part}_at = getelementptr i8, ptr {array}, i64 {HEADER[part]}")
            lines.append(f"  {array}.{part} = load ptr, ptr {array}.{part}_at")
        sizes = list[str]()
        for part, axis in product(("shape", "strides"), range(dimensions)):
            lines.append(f"  {array}.{part}{axis}_at = getelementptr i64, ptr {array}.{part}, i64 {axis}")
            lines.append(f"  {array}.{part}{axis} = load i64, ptr {array}.{part}{axis}_at")
            sizes.append(f"i64 {array}.{part}{axis}")
        count = "1"
        for axis in range(dimensions):
            lines.append(f"  {array}.count{axis} = mul i64 {count}, {array}.shape{axis}")
            count = f"{array}.count{axis}"
        values += ["ptr null", "ptr null", f"i64 {count}", f"i64 {element[1:]}", f"ptr {array}.data", *sizes]
    lines += [f"  %done = call i32 @{OWN}({', '.join(values)})", "  ret i32 %done"]
    lines += ["refused:", f"  ret i32 {REFUSED}", "}"]
    return "\n".join(lines)


def flat(arguments: Sequence[Any]) -> list[Any]:
    """Arguments with records taken apart."""
    return [part for one in arguments for part in (flat(one) if isinstance(one, list) else [one])]


def emit(part: str, folder: Path) -> None:
    """Compile the kernels of a part and write an object file for each, and what it is called with."""
    # Before numba is imported.
    os.environ["NUMBA_CPU_NAME"], os.environ["NUMBA_CPU_FEATURES"] = (
        PLAIN.get(platform.machine(), "generic"),
        "",
    )
    os.environ["WORKHOLD_KERNELS"] = "building"
    sys.path.insert(0, str(SOURCES))
    import llvmlite.binding as llvm

    from workhold.kernels import preparing
    from workhold.kernels.base.built import words_of

    machine = llvm.Target.from_default_triple().create_target_machine(
        cpu=os.environ["NUMBA_CPU_NAME"], features="", opt=3, reloc="pic", codemodel="default"
    )
    for kernel in preparing.prepared(part):
        (signature,) = kernel.signatures
        compiled = kernel.overloads[signature]
        module = llvm.parse_assembly(compiled.library.get_llvm_str())
        module.link_in(llvm.parse_assembly(RUNTIME))
        for thing in (*module.functions, *module.global_variables):
            if not thing.is_declaration:
                thing.linkage = "internal"
        own = module.get_function(compiled.fndesc.llvm_func_name)
        own.linkage, own.name = "external", OWN
        results = words_of(described(compiled.signature.return_type))
        kinds, arguments = (
            [str(argument.type) for argument in own.arguments],
            [described(kind) for kind in signature],
        )
        module.link_in(llvm.parse_assembly(taking_words(kernel.__name__, arguments, kinds, results)))
        own.linkage = "internal"
        # Once more, now that nothing but the kernel calls what it calls: records that are handed on were copied whole,
        # and only what is needed of them is now.
        builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
        builder.getModulePassManager().run(module, builder)
        (folder / f"{kernel.__name__}.o").write_bytes(machine.emit_object(module))
        told = {"arguments": arguments, "result": described(compiled.signature.return_type)}
        (folder / f"{kernel.__name__}.json").write_text(json.dumps(told))


def is_built(folder: Path) -> bool:
    """Whether the library in a folder is that of these sources, for machines of this kind."""
    os.environ["WORKHOLD_KERNELS"] = "building"
    sys.path.insert(0, str(SOURCES))
    from workhold.kernels.base.built import Library, library_name, source_hash

    try:
        return bool(Library(folder / library_name()).source_hash == source_hash())
    except (OSError, AttributeError, ValueError):
        return False


def build(folder: Path, parts: Sequence[str] = ()) -> Path:
    """Build the library of these sources, or of some parts of them, into a folder, unless it is there; return its path.

    Raises
    ------
    SystemExit
        In one sentence, where there is no linker, or a kernel cannot be compiled.
    """
    fits = is_built(folder)
    from workhold.kernels.base.built import library_name, source_hash

    path, wanted = folder / library_name(), source_hash()
    if fits:
        return path
    linker = shutil.which("cc") or shutil.which("ld")
    if linker is None:
        sys.exit("Building the kernels needs a linker: install gcc or binutils.")
    with tempfile.TemporaryDirectory() as name:
        objects = Path(name)
        from workhold.kernels.preparing import PARTS

        compilers = [
            subprocess.Popen([sys.executable, __file__, EMIT, part, name]) for part in parts or PARTS
        ]
        codes = [process.wait() for process in compilers]
        if any(codes):
            sys.exit("The kernels could not be compiled.")
        kernels = {told.stem: json.loads(told.read_text()) for told in sorted(objects.glob("*.json"))}
        write_exports(objects / "exports.o", {"source_hash": wanted, "kernels": kernels})
        if sys.platform == "darwin":
            options = ["-dynamiclib", "-undefined", "dynamic_lookup"]
        elif sys.platform == "win32":
            # Of MinGW, whose C library is linked to; untested.
            options = ["-shared", "-s"]
        else:
            # What is left open, the functions of libm and malloc, is found in the process that loads the library.
            options = ["-shared", "-s"] + (["-nostdlib"] if linker.endswith("cc") else [])
        unfinished = objects / path.name
        subprocess.run([linker, *options, "-o", unfinished, *sorted(objects.glob("*.o"))], check=True)
        shutil.copy(unfinished, path.with_suffix(".new"))
        path.with_suffix(".new").replace(path)
    return path


def write_exports(path: Path, description: Any) -> None:
    """Write the object file of what the library exports besides its kernels."""
    import llvmlite.binding as llvm

    from workhold.kernels.base.built import DESCRIPTION, ELEMENTS, KNOWN, RELEASE

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    content = json.dumps(description).encode() + b"\0"
    text = "".join(
        chr(byte) if 32 <= byte < 127 and byte not in b'"\\' else f"\\{byte:02X}" for byte in content
    )
    names = {"description": DESCRIPTION, "release": RELEASE, "known": KNOWN, "count": 1 + len(ELEMENTS)}
    module = llvm.parse_assembly(EXPORTS.format(length=len(content), text=text, **names))
    machine = llvm.Target.from_default_triple().create_target_machine(reloc="pic", codemodel="default")
    path.write_bytes(machine.emit_object(module))


if __name__ == "__main__":
    if sys.argv[1] == EMIT:
        emit(sys.argv[2], Path(sys.argv[3]))
    else:
        sys.stdout.write(f"{build(Path(sys.argv[1]), sys.argv[2:])}\n")
