"""How kernels are compiled, and where the compiled code is kept.

Numba's disk cache looks only at the file of the function it keeps, so a kernel that calls a changed kernel of another
file would be served stale. The cache therefore lives in a folder named by a hash of all the package's sources: any
change of any source starts a new folder. Where no folder can be written, kernels are compiled anew in every process.
"""

from __future__ import annotations

import os
import pickle
import shutil
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache, cached_property
from hashlib import sha256
from pathlib import Path
from threading import Lock
from typing import Any, TypeVar, cast

import numba
from numba.core import config as numba_config
from numba.core.caching import FunctionCache, IndexDataCacheFile, NullCache
from numba.core.runtime.nrt import rtsys

__all__ = ["cache_folder", "compiled", "inner", "is_first_run"]

Function = TypeVar("Function", bound=Callable[..., Any])

FOLDERS_KEPT = 3
# Bytes of the hash in front of machine code.
SEAL = 32
# Whether kernels that only kernels call are made callable from Python too, for tests; it takes longer to compile.
ALL_CALLABLE = os.environ.get("WORKHOLD_KERNELS") == "callable"
# The module and the kernel that every search compiles, and that takes longest.
LONGEST_KERNEL = ("two_and_two", "two_and_two_cells")


def source_hash() -> str:
    """Hash of the sources of all rooms of the package, of where they are, and of the versions that compile them."""
    package = Path(__file__).resolve().parents[1]
    digest = sha256(f"{sys.version} numba {numba.__version__} {package} {ALL_CALLABLE}".encode())
    for path in (package.parent / "conventions.py", *sorted(package.rglob("*.py"))):
        digest.update(path.relative_to(package.parent).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:20]


def user_cache() -> Path:
    """The folder for all of workhold's compiled code: ``$WORKHOLD_CACHE_DIR`` or ``workhold`` in the user's cache."""
    named = os.environ.get("WORKHOLD_CACHE_DIR")
    if named:
        return Path(named)
    base = os.environ.get("XDG_CACHE_HOME")
    return Path(base or Path("~/.cache").expanduser()) / "workhold"


@cache
def cache_folder() -> Path | None:
    """The folder for the compiled code of exactly these sources, or None where nothing can be written."""
    try:
        folder = user_cache() / f"kernels-{source_hash()}"
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except (OSError, RuntimeError):
        return None
    drop_old_folders(folder)
    return folder


def drop_old_folders(current: Path) -> None:
    """Remove the compiled code of sources long replaced, keeping the newest few folders."""
    try:
        others = [p for p in current.parent.glob("kernels-*") if p != current]
        others.sort(key=lambda p: p.stat().st_mtime, reverse=True)
    except OSError:
        return
    for folder in others[FOLDERS_KEPT:]:
        shutil.rmtree(folder, ignore_errors=True)


def is_first_run() -> bool:
    """Whether the search's kernels of these sources still have to be compiled (a matter of twenty seconds or so).

    Reading a part compiles a few small ones, which do not count.
    """
    folder = cache_folder()
    return folder is None or next(folder.rglob(f"{'.'.join(LONGEST_KERNEL)}-*.nbi"), None) is None


class SealedFile(IndexDataCacheFile):
    """Numba's files of one function's cache, where a damaged one (a loss of power leaves empty and halved files) is as none.

    Machine code stands behind its hash, because running damaged code would end the process.
    """

    def _load_index(self) -> Any:
        """The index; empty where it is missing or damaged, so that it is made anew."""
        try:
            return super()._load_index()  # type: ignore[no-untyped-call]
        except Exception:
            return {}

    def _save_data(self, name: str, data: Any) -> None:
        """Write machine code behind its hash."""
        content = self._dump(data)  # type: ignore[no-untyped-call]
        with self._open_for_write(self._data_path(name)) as stream:  # type: ignore[no-untyped-call]
            stream.write(sha256(content).digest() + content)

    def _load_data(self, name: str) -> Any:
        """Machine code; what numba takes for a missing file where it is not what was written."""
        content = Path(self._data_path(name)).read_bytes()  # type: ignore[no-untyped-call]
        seal, content = content[:SEAL], content[SEAL:]
        if sha256(content).digest() != seal:
            raise FileNotFoundError(name)
        return pickle.loads(content)


class StoredCode(FunctionCache):
    """Numba's cache of one function, whose files are sealed, without the wait before machine code is read.

    Numba would first set up all it needs to compile, a fifth of a second. Code that is there needs only the allocator of
    arrays; where it is not there, the compiler sets up the rest itself.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        self._cache_file.__class__ = SealedFile

    def save_overload(self, sig: Any, data: Any) -> None:
        """Store machine code, unless the disk is full or does not let it."""
        with suppress(OSError):
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The machine code stored for a signature, or None."""
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)  # type: ignore[no-untyped-call]


class LateCache:
    """The cache of a kernel, opened when the kernel is first called or compiled into another.

    Most kernels are never looked up once those that call them are stored, and opening a cache touches the disk.
    """

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self.function = function
        self.folder = folder

    @cached_property
    def opened(self) -> Any:
        """Numba's cache; it reads the folder from a setting of the whole process, which is put back."""
        config: Any = numba_config
        with OPENING:
            before = config.CACHE_DIR
            config.CACHE_DIR = str(self.folder)
            try:
                return StoredCode(self.function)
            except RuntimeError:
                return NullCache()
            finally:
                config.CACHE_DIR = before

    def __getattr__(self, name: str) -> Any:
        return getattr(self.opened, name)


OPENING = Lock()


def compiled(function: Function) -> Function:
    """Compile a kernel that Python calls on first use, without the interpreter lock, and keep the machine code on disk if
    possible.

    Division by zero gives an infinity or NaN, as in NumPy. Kernels avoid what is slow to compile: assignments of slices,
    and long kernels that call other long kernels (every caller is optimized together with all it calls).
    """
    kernel: Any = numba.njit(nogil=True, error_model="numpy")(function)
    folder = cache_folder()
    if folder is not None:
        kernel._cache = LateCache(function, folder)
    return cast(Function, kernel)


def inner(function: Function) -> Function:
    """Compile a kernel that only kernels call: its code becomes part of theirs, and is not kept or made callable itself."""
    if ALL_CALLABLE:
        return compiled(function)
    options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return cast(Function, numba.njit(nogil=True, error_model="numpy", **options)(function))
