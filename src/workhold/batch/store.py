"""Where records are kept: a folder of files, each under its task's name, written whole or not at all.

Two runs may use one folder at a time: a record that both write has the same bytes, and takes its name at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Protocol

from attrs import frozen

from workhold.batch.records import is_whole
from workhold.files.atomic import plain_errors, write_bytes

__all__ = ["FolderStore", "Store"]

# Letters of a name that its folder has: so no folder has too many files.
FOLDER_LETTERS = 2


class Store(Protocol):
    """What keeps records."""

    def has(self, name: str) -> bool:
        """Whether a task is done: its record is there, and whole."""

    def read(self, name: str) -> bytes | None:
        """The record of a task; None where there is none."""

    def write(self, name: str, record: bytes) -> None:
        """Keep a record.

        Raises
        ------
        InputError
            When it cannot be kept.
        """

    def place(self, name: str) -> str:
        """Where the record of a task is, or would be."""

    def file(self, name: str) -> AbstractContextManager[Path]:
        """The record of a task that is done, as a file as long as the block runs."""


@frozen
class FolderStore:
    """A folder of records.

    Parameters
    ----------
    folder : is made with the first record.
    """

    folder: Path

    def place(self, name: str) -> str:
        """The path of a record."""
        return str(self.path(name))

    def path(self, name: str) -> Path:
        """The path of a record."""
        return self.folder / name[:FOLDER_LETTERS] / f"{name}.json"

    def has(self, name: str) -> bool:
        """Whether there is such a record."""
        return self.read(name) is not None

    def read(self, name: str) -> bytes | None:
        """A record, if it is whole."""
        try:
            content = self.path(name).read_bytes()
        except OSError:
            return None
        return content if is_whole(content) else None

    @contextmanager
    def file(self, name: str) -> Iterator[Path]:
        """The file of a record; see :meth:`Store.file`."""
        yield self.path(name)

    def write(self, name: str, record: bytes) -> None:
        """Keep a record; see :meth:`Store.write`."""
        path = self.path(name)
        with plain_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(path, record)
