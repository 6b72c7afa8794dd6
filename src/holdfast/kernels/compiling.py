"""How kernels are compiled, and where the compiled code is kept.

Numba's disk cache looks only at the file of the function it keeps, so a kernel that calls a changed kernel of another
file would be served stale. The cache therefore lives in a folder named by a hash of all the package's sources: any
change of any source starts a new folder. Where no folder can be written, kernels are compiled anew in every process.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import config as numba_config

__all__ = ["cache_folder", "compiled", "is_first_run"]

Function = TypeVar("Function", bound=Callable[..., Any])

FOLDERS_KEPT = 3
# The module and the kernel that every search compiles, and that takes longest.
LONGEST_KERNEL = ("type_one", "type_one_cells")


def source_hash() -> str:
    """Hash of the package's sources, of where they are, and of the versions that compile them."""
    package = Path(__file__).resolve().parent
    digest = sha256(f"{sys.version} numba {numba.__version__} {package}".encode())
    for path in sorted(package.glob("*.py")):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:20]


def user_cache() -> Path:
    """The folder for all of holdfast's compiled code: ``$HOLDFAST_CACHE_DIR`` or ``holdfast`` in the user's cache."""
    named = os.environ.get("HOLDFAST_CACHE_DIR")
    if named:
        return Path(named)
    base = os.environ.get("XDG_CACHE_HOME")
    return Path(base or Path("~/.cache").expanduser()) / "holdfast"


@cache
def cache_folder() -> Path | None:
    """The folder for the compiled code of exactly these sources, or None where nothing can be written."""
    folder = user_cache() / f"kernels-{source_hash()}"
    try:
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


def compiled(function: Function) -> Function:
    """Compile a kernel on first use, without the interpreter lock, and keep the machine code on disk if possible.

    Division by zero gives an infinity or NaN, as in NumPy. Kernels avoid what is slow to compile: assignments of slices,
    and long kernels that call other long kernels (every caller is optimized together with all it calls).
    """
    folder = cache_folder()
    if folder is None:
        return cast(Function, numba.njit(nogil=True, error_model="numpy")(function))
    # Numba reads the folder when it decorates; the setting of the rest of the process is put back.
    config: Any = numba_config
    before = config.CACHE_DIR
    config.CACHE_DIR = str(folder)
    try:
        return cast(Function, numba.njit(nogil=True, error_model="numpy", cache=True)(function))
    except RuntimeError:
        return cast(Function, numba.njit(nogil=True, error_model="numpy")(function))
    finally:
        config.CACHE_DIR = before
