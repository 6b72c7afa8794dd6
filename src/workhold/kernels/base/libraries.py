"""Find, load and build the shared libraries of the kernels, one for each room.

A library's name holds a hash of the kernels' sources, so that code of other sources is never run. It lies in
the package where a wheel was built, else in the user's cache, where it is built when a kernel of its room is
first called.
"""

from __future__ import annotations

import atexit
import ctypes
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from sysconfig import get_platform
from threading import Event, Lock
from typing import IO, Any

from workhold.errors import InputError
from workhold.limits import refuse_little_space

KERNELS = Path(__file__).resolve().parents[1]
# The rooms that every search needs, and that of seating; those that take longest come first.
SEARCH_ROOMS = ("curves", "proof", "contact", "base")
SEATING_ROOMS = ("seating",)
ROOMS = (*SEATING_ROOMS, *SEARCH_ROOMS)
FOLDERS_KEPT = 3
# Bytes of address space: with less, numba and its compiler end the process by a signal.
COMPILER_SPACE = 1_000_000_000
LOADING = Lock()
# A shared library, or an object file where there was no linker.
ENDINGS = ("so", "o")
# The plain processor that is compiled for; of others whatever LLVM takes for the oldest.
PLAIN_PROCESSORS = {"x86_64": "x86-64", "AMD64": "x86-64"}


@cache
def compute_source_hash() -> str:
    """Return a hash (20 hex digits) of the sources of all kernels and
    of ``conventions.py``, whose numbers they use.
    """
    digest, package = sha256(), KERNELS.parent
    for path in (package / "conventions.py", *sorted(KERNELS.rglob("*.py"))):
        # Where libraries lie makes no difference to what is in them.
        if path == Path(__file__):
            continue
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:20]


def make_library_name(room: str, ending: str) -> str:
    """Return the file name of a room's library for these sources and
    this platform, with this ending (no dot).
    """
    return f"kernels-{room}-{compute_source_hash()}.{get_platform().replace('.', '_')}.{ending}"


def find_user_cache() -> Path:
    """Return the folder of workhold's cached files:
    ``$WORKHOLD_CACHE_DIR``, or ``workhold`` in the user's cache.
    """
    named = os.environ.get("WORKHOLD_CACHE_DIR")
    if named:
        return Path(named)
    base = os.environ.get("XDG_CACHE_HOME")
    return Path(base or Path("~/.cache").expanduser()) / "workhold"


@cache
def make_cache_folder() -> Path | None:
    """Return the cache folder for the libraries of these sources, or None where it cannot be written.

    Create it where it does not exist, and remove older ones, see :func:`drop_old_folders`.
    """
    try:
        folder = find_user_cache() / f"kernels-{compute_source_hash()}"
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except (OSError, RuntimeError):
        return None
    drop_old_folders(folder)
    return folder


@cache
def make_temporary_folder() -> Path:
    """Return a folder for the libraries of this process alone, removed when the process ends."""
    folder = tempfile.TemporaryDirectory(prefix="workhold-kernels-")
    atexit.register(folder.cleanup)
    return Path(folder.name)


def drop_old_folders(current: Path) -> None:
    """Remove the library folders of other sources beside ``current``, except the newest ``FOLDERS_KEPT``."""
    try:
        others = [path for path in current.parent.glob("kernels-*") if path != current]
        others.sort(key=lambda path: path.stat().st_mtime, reverse=True)
    except OSError:
        return
    for folder in others[FOLDERS_KEPT:]:
        shutil.rmtree(folder, ignore_errors=True)


def find_library_folder() -> Path:
    """Return the folder that libraries are built into: the cache
    folder, or a temporary one where that is not writable.
    """
    return make_cache_folder() or make_temporary_folder()


def find_library(room: str) -> Path | None:
    """Return the file of a room's library, in the package or in the cache; None where it is not built yet."""
    # Benchmarks and tests ask for what is compiled on first use, though the package has libraries.
    in_package = None if os.environ.get("WORKHOLD_KERNELS") == "cache" else find_in(KERNELS, room)
    return in_package or find_in(find_library_folder(), room)


def find_in(folder: Path, room: str) -> Path | None:
    """Return the file of a room's library in ``folder``, or None where the folder has none."""
    paths = (folder / make_library_name(room, ending) for ending in ENDINGS)
    return next((path for path in paths if path.exists()), None)


def is_built(rooms: Sequence[str] = SEARCH_ROOMS) -> bool:
    """Return whether the libraries of all these rooms exist."""
    return all(find_library(room) is not None for room in rooms)


def load_entry(room: str, name: str) -> Callable[[int], None]:
    """Return the compiled entry of a kernel, which takes the address
    of its words; build the room's library if needed.

    Raises
    ------
    InputError
        When there is no library and it cannot be built, or a library in the package is damaged.
    """
    with LOADING:
        path = find_library(room) or build_library(room)
        try:
            entry = find_entry(str(path), name)
        except OSError as error:
            if path.parent == KERNELS:
                raise InputError(
                    f"A library of compiled kernels is damaged; install again. {error}"
                ) from None
            path.unlink()
            entry = find_entry(str(build_library(room)), name)
    entry.argtypes, entry.restype = (ctypes.c_void_p,), None
    return entry


def find_entry(path: str, name: str) -> Any:
    """Return a function of a library file: of a shared library, or of
    an object file where there was no linker.
    """
    if path.endswith(ENDINGS[0]):
        return getattr(ctypes.CDLL(path), name)
    return ctypes.CFUNCTYPE(None, ctypes.c_void_p)(load_object(path).get_function_address(name))


def build_library(room: str) -> Path:
    """Build the library of a room into the cache folder, and return its file."""
    build_libraries((room,))
    path = find_library(room)
    assert path is not None
    return path


@cache
def load_object(path: str) -> Any:
    """Load an object file without a linker, and return LLVM's
    execution engine, which knows the addresses of its functions.
    """
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine()
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.object_file.ObjectFileRef.from_path(path))
    engine.finalize_object()
    return engine


def build_libraries(
    rooms: Sequence[str],
    folder: Path | None = None,
    report: Callable[[float], None] = lambda done: None,
    cancel: Event | None = None,
) -> None:
    """Build the libraries of those rooms that have none, each in its own process.

    Numba's settings in these processes are not those of this process.

    Parameters
    ----------
    folder : receives the libraries; None for :func:`find_library_folder`.
    report : is called with the share of the work that is done, from 0 to 1.
    cancel : ends all processes when it is set; libraries are then missing.

    Raises
    ------
    InputError
        When there is no numba to compile with, no memory for it, or a kernel cannot be compiled.
    """
    folder = folder or find_library_folder()
    wanted = [room for room in ROOMS if room in rooms and find_in(folder, room) is None]
    if not wanted:
        return
    if find_spec("numba") is None:
        raise InputError(
            "This installation has no compiled kernels for this kind of machine, and no numba to compile "
            "them with; install workhold[numba]."
        )
    refuse_little_space(
        COMPILER_SPACE, "compiling the kernels", "raise the limit, or install a wheel with compiled kernels"
    )
    done = dict.fromkeys(wanted, 0.0)
    faults: list[str] = []

    def build(room: str) -> None:
        """Build one room's library in a process of its own, reporting its
        progress; add its error to ``faults``.
        """
        with tempfile.TemporaryFile("w+") as said, start_compiling(room, folder, said) as process:
            assert process.stdout is not None
            for line in process.stdout:
                if cancel is not None and cancel.is_set():
                    process.terminate()
                    return
                done[room] = float(line)
                report(sum(done.values()) / len(done))
            if process.wait():
                said.seek(0)
                faults.extend(
                    said.read().strip().splitlines()[-1:] or [f"it ended with {process.returncode}"]
                )
            elif (made := find_in(folder, room)) is not None:
                # Whole after a loss of power, too.
                with made.open("rb") as file:
                    os.fsync(file.fileno())

    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        list(pool.map(build, wanted))
    if faults:
        raise InputError(f"The kernels could not be compiled: {faults[0]}")


def start_compiling(room: str, folder: Path, said: IO[str]) -> subprocess.Popen[str]:
    """Start and return the process that builds the library of a room into ``folder``.

    Its standard output has a line with the progress, from 0 to 1, every few seconds; ``said`` receives its
    standard error. The process ends when this process ends, in whatever way.
    """
    processor = PLAIN_PROCESSORS.get(platform.machine(), "generic")
    settings = {
        "WORKHOLD_KERNELS": "building",
        "NUMBA_CPU_NAME": processor,
        "NUMBA_CPU_FEATURES": "",
        # Numba would optimize each function by itself; a kernel is optimized as a whole.
        "NUMBA_OPT": "0",
        "PYTHONPATH": os.pathsep.join(entry for entry in sys.path if entry),
    }
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "workhold.kernels.base.building", room, str(folder)],
        env={**os.environ, **settings},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=said,
        text=True,
    )
