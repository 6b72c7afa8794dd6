"""Records of the outcomes of tasks, as bytes, and the stores that keep them.

The record of an answer is a result file (``files.result.writer``) of the best fixtures, which every command
for result files can open. The record of a drawing has the part, in the form that ``files.part.data`` reads,
and remarks on it. A refusal of a part or query is a record too, since it would be refused again.

A folder keeps each record in a file under its task's name, written whole or not at all. A second file has the
checksum of its name and its bytes and is written first: a record that was changed, cut short or swapped
afterwards does not count. Two runs may use one folder at the same time: a record that both write has the same
bytes, and gets its name in one step. Records may also be kept on an object store or another machine, wherever
fsspec can write: ``s3://bucket/folder``, ``sftp://host/folder``. Workers of a cluster write there directly,
so that records do not pass through the user's machine.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Protocol

from attrs import frozen

from workhold.errors import InputError
from workhold.files.atomic import explain_system_errors, write_bytes
from workhold.files.budget import FileLimits
from workhold.files.result.writer import make_own_outlines_entry, make_solid_entry, make_workpiece_entry
from workhold.files.text import read_limited
from workhold.model.own_outlines import add_own_outlines
from workhold.model.solid import SolidOutline
from workhold.model.workpiece import Workpiece

__all__ = [
    "PART",
    "REFUSAL",
    "FolderStore",
    "RecordStore",
    "UrlStore",
    "is_whole",
    "make_part_record",
    "parse_record",
    "make_refusal_record",
    "open_store",
    "read_workpiece_record",
]

PART, REFUSAL = "workhold-part/1", "workhold-refusal/1"
# In records a part has this name, so that files of one content, whatever they are called, are one part.
PART_NAME = "part"
# A record is read whole, as it was written.
RECORD = FileLimits("a record", None)
FIRST, LAST = b'{"format": "workhold-', b"]}\n"


def make_part_record(workpiece: Workpiece, remarks: Sequence[str]) -> bytes:
    """Return the record of a drawing: the part, its number of faces and size, and remarks."""
    about = {
        "format": PART,
        **make_workpiece_entry(workpiece),
        **make_solid_entry(workpiece.solid),
        "name": PART_NAME,
    }
    heights = {
        role: (one.solid.low, one.solid.peg_height)
        for role, one in workpiece.outlines
        if one.solid is not None
    }
    if heights:
        about |= {**make_own_outlines_entry(workpiece), "heights": heights}
    x0, y0, x1, y1 = workpiece.bounds
    return encode_record(
        about | {"faces": len(workpiece.faces), "size": [x1 - x0, y1 - y0], "remarks": list(remarks)}
    )


def make_refusal_record(sentence: str) -> bytes:
    """Return the record of a part or query that was refused, with the sentence that says why."""
    return encode_record({"format": REFUSAL, "refusal": [sentence]})


def encode_record(content: dict[str, Any]) -> bytes:
    """Return a record as one line of JSON.

    The last entry of ``content`` must be a list, so that the line ends as every record does.
    """
    return json.dumps(content).encode() + b"\n"


def make_checksum_line(name: str, content: bytes) -> bytes:
    """Return the line of a record's checksum file: the SHA-256 of the task's name and the record's bytes."""
    return sha256(name.encode() + b"\n" + content).hexdigest().encode() + b"\n"


def is_whole(name: str, content: bytes, line: bytes) -> bool:
    """Return whether ``content`` is the complete record of the task ``name``.

    It must begin and end as a record does, and match its checksum ``line``.

    >>> record = make_refusal_record("no")
    >>> line = make_checksum_line("a", record)
    >>> [is_whole("a", *one) for one in ((record, line), (record[:-1], line), (b"", line), (record, b""))]
    [True, False, False, False]
    """
    return content.startswith(FIRST) and content.endswith(LAST) and line == make_checksum_line(name, content)


def parse_record(content: bytes) -> dict[str, Any]:
    """Return a record as plain data with the key "refusal":
    the sentence of a refusal, "" in any other record.
    """
    data: dict[str, Any] = json.loads(content)
    data["refusal"] = data["refusal"][0] if data["format"] == REFUSAL else ""
    return data


def read_workpiece_record(record: dict[str, Any]) -> Workpiece:
    """Return the part of a drawing's record."""
    solid = SolidOutline.from_entries(record["solid"], record) if record.get("solid") else None
    workpiece = Workpiece.from_loops(PART_NAME, record["loops"], None, record["departure"], solid)
    if "outlines" not in record:
        return workpiece
    return add_own_outlines(workpiece, record["outlines"], record["heights"])


# What the file of a checksum ends in, in place of the record's own ending.
CHECKSUM = ".sha256"


def make_checksum_path(path: str) -> str:
    """Return the path of the checksum file for a record's path in an object store."""
    return path.removesuffix(".json") + CHECKSUM


# Letters of a name that its folder has: so no folder has too many files.
FOLDER_LETTERS = 2


class RecordStore(Protocol):
    """A store of records by the names of tasks."""

    __slots__ = ()

    def has(self, name: str) -> bool:
        """Return whether a complete record of a task exists: then the task is done."""
        return self.read(name) is not None

    def read(self, name: str) -> bytes | None:
        """Return the record of a task; None if there is no complete one."""

    def write(self, name: str, record: bytes) -> None:
        """Keep the record of a task.

        Raises
        ------
        InputError
            When it cannot be written.
        """

    def get_location(self, name: str) -> str:
        """Return the path or URL at which the record of a task is, or would be."""

    def open_record(self, name: str) -> AbstractContextManager[Path]:
        """Yield the path of a file with the record of a task that is done.

        The file may be gone after the block.
        """


@frozen
class FolderStore(RecordStore):
    """A folder of records.

    Parameters
    ----------
    folder : the folder, created with the first record.
    """

    folder: Path

    def get_location(self, name: str) -> str:
        """Return the path of a task's record."""
        return str(self.make_record_path(name))

    def make_record_path(self, name: str) -> Path:
        """Return the path of a task's record."""
        return self.folder / name[:FOLDER_LETTERS] / f"{name}.json"

    def read(self, name: str) -> bytes | None:
        """Return the record of a task; None if there is no complete one."""
        path = self.make_record_path(name)
        try:
            content, line = (read_limited(file, RECORD) for file in (path, path.with_suffix(CHECKSUM)))
        except InputError:
            return None
        return content if is_whole(name, content, line) else None

    @contextmanager
    def open_record(self, name: str) -> Iterator[Path]:
        """Yield the path of a task's record."""
        yield self.make_record_path(name)

    def write(self, name: str, record: bytes) -> None:
        """Write a record and its checksum; raise InputError where they cannot be written."""
        path = self.make_record_path(name)
        with explain_system_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(path.with_suffix(CHECKSUM), make_checksum_line(name, record))
        write_bytes(path, record)


@frozen
class UrlStore(RecordStore):
    """Records below a URL.

    Parameters
    ----------
    url : without a slash at its end.
    """

    url: str

    def get_location(self, name: str) -> str:
        """Return the URL of a task's record."""
        return f"{self.url}/{name[:FOLDER_LETTERS]}/{name}.json"

    def locate_record(self, name: str) -> tuple[Any, str]:
        """Return the fsspec file system of a task's record, and the record's path there."""
        from fsspec.core import url_to_fs

        system, path = url_to_fs(self.get_location(name))
        return system, path

    def read(self, name: str) -> bytes | None:
        """Return the record of a task; None if there is no complete one."""
        system, path = self.locate_record(name)
        try:
            content: bytes = system.cat_file(path)
            line: bytes = system.cat_file(make_checksum_path(path))
        except OSError:
            return None
        return content if is_whole(name, content, line) else None

    def write(self, name: str, record: bytes) -> None:
        """Write a record and its checksum; raise InputError where they cannot be written.

        A record that is cut short does not match its checksum, and so does not count.
        """
        system, path = self.locate_record(name)
        try:
            system.makedirs(path.rpartition("/")[0], exist_ok=True)
            system.pipe_file(make_checksum_path(path), make_checksum_line(name, record))
            system.pipe_file(path, record)
        except OSError as error:
            raise InputError(
                f"{self.get_location(name)} cannot be written: {error.strerror or error}."
            ) from error

    @contextmanager
    def open_record(self, name: str) -> Iterator[Path]:
        """Yield the path of a temporary file with the record of a task."""
        with tempfile.TemporaryDirectory(prefix="workhold-") as folder:
            path = Path(folder) / f"{name}.json"
            path.write_bytes(self.read(name) or b"")
            yield path


def open_store(url: str) -> RecordStore:
    """Return the store at a URL or in a folder; all workers must be able to reach it.

    Raises
    ------
    InputError
        For a URL that fsspec cannot use here.
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
