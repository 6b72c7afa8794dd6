"""How kernels are compiled, and where the compiled code is kept.

Where the package was built with a library of all kernels, of exactly these sources, they come from there
(``built``) and numba is not needed. Elsewhere numba compiles them on first use.

Numba's disk cache looks only at the file of the function it keeps, so a kernel that calls a changed kernel of
another file would be served stale. The cache therefore lives in a folder named by a hash of all the package's
sources: any change of any source starts a new folder. Where no folder can be written, kernels are compiled
anew in every process.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from workhold.errors import InputError
from workhold.kernels.base.built import KERNELS, Library, library_name, source_hash
from workhold.limits import refuse_little_space

Function = TypeVar("Function", bound=Callable[..., Any])
# What kernels take: reals, whole numbers, and verdicts or flags.
Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
ByteArray = NDArray[np.int8]

FOLDERS_KEPT = 3
# Bytes of address space: with less, numba and its compiler end the process by a signal or an own error.
COMPILER_SPACE = 1_000_000_000
# "numba" compiles on first use whatever was built; "building" besides neither reads nor keeps machine code;
# "callable" makes kernels that only kernels call callable from Python as well, for tests, and takes longer.
MODE = os.environ.get("WORKHOLD_KERNELS", "")
ALL_CALLABLE = MODE == "callable"
# Options of numba for kernels that make arrays, for those that make none, and besides for all of them, which
# no C calls, and for those that only kernels call.
MAKING_ARRAYS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
WITHOUT_COUNTS: dict[str, Any] = {**MAKING_ARRAYS, "_nrt": False}
NO_CALLBACK: dict[str, Any] = {"no_cfunc_wrapper": True}
ONLY_INNER: dict[str, Any] = {"no_cpython_wrapper": True, **NO_CALLBACK}
# The numba whose inner parts ``lean`` builds on. Any other compiles in its own way, in twice the time.
LEAN_NUMBA = "0.68."
# The modules and kernels that two processes compile last for a search: where both are stored, all are.
LAST_OF_SEARCH = ("canonical_form.contacts_of", "quality.figures")


def built_library() -> Library | None:
    """The library of kernels built from exactly these sources for this kind of machine, if there is one.

    Raises
    ------
    InputError
        When there is none, nor numba to compile them with, nor memory for it.
    """
    if MODE not in ("numba", "building", "callable"):
        try:
            library = Library(KERNELS / library_name())
        except OSError:
            pass
        else:
            if library.source_hash == source_hash():
                return library
    if find_spec("numba") is None:
        raise InputError(
            "This installation has no compiled kernels for this kind of machine, and no numba to compile "
            "them with; "
            "install workhold[numba]."
        )
    refuse_little_space(
        COMPILER_SPACE, "compiling the kernels", "raise the limit, or install a wheel with compiled kernels"
    )
    return None


LIBRARY = built_library()


def cache_key() -> str:
    """Hash of the sources, of where they are, and of the versions that compile them: the same code has the
    same key."""
    import numba

    known = f"{sys.version} numba {numba.__version__} {KERNELS} {ALL_CALLABLE} {source_hash()}"
    return sha256(known.encode()).hexdigest()[:20]


def user_cache() -> Path:
    """The folder for all of workhold's compiled code: ``$WORKHOLD_CACHE_DIR`` or ``workhold`` in the user's
    cache."""
    named = os.environ.get("WORKHOLD_CACHE_DIR")
    if named:
        return Path(named)
    base = os.environ.get("XDG_CACHE_HOME")
    return Path(base or Path("~/.cache").expanduser()) / "workhold"


@cache
def cache_folder() -> Path | None:
    """The folder for the compiled code of exactly these sources, or None where nothing can be written or is
    to be."""
    if MODE == "building":
        return None
    try:
        folder = user_cache() / f"kernels-{cache_key()}"
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except (OSError, RuntimeError):
        return None
    drop_old_folders(folder)
    return folder


def drop_old_folders(current: Path) -> None:
    """Removes the compiled code of sources long replaced, keeping the newest few folders."""
    try:
        others = [p for p in current.parent.glob("kernels-*") if p != current]
        others.sort(key=lambda p: p.stat().st_mtime, reverse=True)
    except OSError:
        return
    for folder in others[FOLDERS_KEPT:]:
        shutil.rmtree(folder, ignore_errors=True)


def is_first_run() -> bool:
    """Whether the search's kernels of these sources still have to be compiled (a matter of a quarter of a
    minute or so)."""
    return not are_stored(LAST_OF_SEARCH)


def are_stored(kernels: Sequence[str]) -> bool:
    """Whether kernels, named as "module.kernel", need not be compiled any more."""
    if LIBRARY is not None:
        return True
    folder = cache_folder()
    return folder is not None and set(kernels) <= {
        path.name.partition("-")[0] for path in folder.rglob("*.nbi")
    }


def compiled(function: Function) -> Function:
    """Compiles a kernel that Python calls on first use, without the interpreter lock, and keeps the machine
    code on disk if possible; it makes and returns no array.

    Division by zero gives an infinity or NaN, as in NumPy. Kernels avoid what is slow to compile: assignments
    of slices, and long kernels that call other long kernels (every caller is optimized together with all it
    calls).

    A kernel counts no references to arrays, for its caller holds all it looks at. A count is an atomic
    addition and every view of a row would take two: they were half of a search's time.
    """
    return called_by_python(function, WITHOUT_COUNTS)


def compiled_making_arrays(function: Function) -> Function:
    """Compiles a kernel like :func:`compiled`, but one that makes or returns arrays, and so counts references
    to arrays: it makes room, and leaves loops to kernels that do not."""
    return called_by_python(function, MAKING_ARRAYS)


def inner(function: Function) -> Function:
    """Compiles a kernel like :func:`compiled` that only kernels call: its code becomes part of theirs, and is
    not kept or made callable itself."""
    return called_by_kernels(function, WITHOUT_COUNTS)


def inner_making_arrays(function: Function) -> Function:
    """Compiles a kernel like :func:`compiled_making_arrays` that only kernels call."""
    return called_by_kernels(function, MAKING_ARRAYS)


def called_by_python(function: Function, options: dict[str, Any]) -> Function:
    """The kernel of the library, or one of numba whose machine code is kept on disk if possible."""
    if LIBRARY is not None:
        return cast(Function, LIBRARY.checked(function))
    import numba

    kernel: Any = numba.njit(**options, **NO_CALLBACK, **lean_compiler("OuterCompiler"))(function)
    folder = cache_folder()
    if folder is not None:
        from workhold.kernels.base.storing import LateCache

        kernel._cache = LateCache(function, folder)
    return cast(Function, kernel)


def called_by_kernels(function: Function, options: dict[str, Any]) -> Function:
    """A kernel of numba that only kernels call; the function itself where they are in the library."""
    if LIBRARY is not None:
        return function
    if ALL_CALLABLE:
        return called_by_python(function, options)
    import numba

    return cast(Function, numba.njit(**options, **ONLY_INNER, **lean_compiler("InnerCompiler"))(function))


def lean_compiler(name: str) -> dict[str, Any]:
    """The option of numba that names one of the compilers of ``lean``, for the numba they were written for.

    None for a wheel, which is built once: numba's own way gives code that is up to some per cent faster.
    """
    import numba

    if MODE == "building" or not numba.__version__.startswith(LEAN_NUMBA):
        return {}
    from workhold.kernels.base import lean

    return {"pipeline_class": getattr(lean, name)}
