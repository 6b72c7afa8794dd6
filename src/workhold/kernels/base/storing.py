"""Where numba keeps machine code: its cache, made safe against damaged files and quick to open.

Only this module, and what compiles, needs numba.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from threading import Lock
from typing import Any

from numba.core import config as numba_config
from numba.core.caching import FunctionCache, IndexDataCacheFile, NullCache
from numba.core.runtime.nrt import rtsys

# Bytes of the hash in front of machine code.
SEAL = 32
# Only one cache is opened at a time.
OPENING = Lock()


class SealedFile(IndexDataCacheFile):
    """Numba's files of one function's cache, where a damaged one (a loss of power leaves empty and halved
    files) is as none.

    Machine code stands behind its hash, because running damaged code would end the process.
    """

    def _load_index(self) -> Any:
        """The index; empty where it is missing or damaged, so that it is made anew."""
        try:
            return super()._load_index()  # type: ignore[no-untyped-call]
        except Exception:
            return {}

    def _save_data(self, name: str, data: Any) -> None:
        """Writes machine code behind its hash."""
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

    Numba would first set up all it needs to compile, a fifth of a second. Code that is there needs only the
    allocator of arrays; where it is not there, the compiler sets up the rest itself.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        self._cache_file.__class__ = SealedFile

    def save_overload(self, sig: Any, data: Any) -> None:
        """Stores machine code, unless the disk is full or does not let it."""
        with suppress(OSError):
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The machine code stored for a signature, or None."""
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)  # type: ignore[no-untyped-call]


class LateCache:
    """The cache of a kernel, opened when the kernel is first called or compiled into another.

    Most kernels are never looked up once those that call them are stored, and opening a cache touches the
    disk.
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
