"""Records in an object store or on another machine, wherever fsspec can write: ``s3://bucket/folder``, ``sftp://host/folder``.

Workers of a cluster write there themselves, so that no record passes through the machine that asks.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from attrs import frozen

from workhold.batch.records import is_whole
from workhold.batch.store import FOLDER_LETTERS, FolderStore, Store
from workhold.errors import InputError

__all__ = ["UrlStore", "store_at"]


@frozen
class UrlStore:
    """Records below a URL.

    Parameters
    ----------
    url : without a slash at its end.
    """

    url: str

    def place(self, name: str) -> str:
        """The URL of a record."""
        return f"{self.url}/{name[:FOLDER_LETTERS]}/{name}.json"

    def at(self, name: str) -> tuple[Any, str]:
        """The file system of a record, and its path there."""
        from fsspec.core import url_to_fs

        system, path = url_to_fs(self.place(name))
        return system, path

    def has(self, name: str) -> bool:
        """Whether there is such a record."""
        return self.read(name) is not None

    def read(self, name: str) -> bytes | None:
        """A record, if it is whole."""
        system, path = self.at(name)
        try:
            content: bytes = system.cat_file(path)
        except OSError:
            return None
        return content if is_whole(content) else None

    def write(self, name: str, record: bytes) -> None:
        """Keep a record; see :meth:`workhold.batch.store.Store.write`. One that is cut short is none."""
        system, path = self.at(name)
        try:
            system.makedirs(path.rpartition("/")[0], exist_ok=True)
            system.pipe_file(path, record)
        except OSError as error:
            raise InputError(f"{self.place(name)} cannot be written: {error.strerror or error}.") from error

    @contextmanager
    def file(self, name: str) -> Iterator[Path]:
        """A copy of a record as a file."""
        with tempfile.TemporaryDirectory(prefix="workhold-") as folder:
            path = Path(folder) / f"{name}.json"
            path.write_bytes(self.read(name) or b"")
            yield path


def store_at(url: str) -> Store:
    """The store at a URL, or in a folder of this machine's disks, which all workers see.

    Raises
    ------
    InputError
        For a URL of a kind that cannot be used here, or where nothing can be kept.
    """
    if "://" not in url:
        return FolderStore(Path(url).absolute())
    if find_spec("fsspec") is None:
        raise InputError(f"{url} takes fsspec, which is not installed: install fsspec>=2024.6.")
    from fsspec.core import url_to_fs

    try:
        system, path = url_to_fs(url.rstrip("/"))
    except (ImportError, ValueError, OSError) as error:
        raise InputError(f"{url} cannot be used: {' '.join(str(error).split())}.") from error
    local = "file" in ((system.protocol,) if isinstance(system.protocol, str) else system.protocol)
    return FolderStore(Path(path)) if local else UrlStore(url.rstrip("/"))
