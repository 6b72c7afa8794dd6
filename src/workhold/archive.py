"""An archive of columns: an uncompressed ZIP of NumPy arrays (.npy) and one text.

``numpy.load`` opens such an archive too. The arrays all have the same number of rows and begin at multiples
of 64 bytes, so that they can be mapped into memory. Opening reads only the directory and the text. No times
are written, so the same content gives the same bytes.

The formats are those of two documents. PKWARE, "APPNOTE.TXT - .ZIP File Format Specification", version
6.3.10, has them in sections 4.3.7 to 4.3.16 and 4.5.3 (sizes of 64 bits). NumPy's is "NEP 1 - A simple file
format for NumPy arrays".

Glossary
--------
column : an array of one row for each thing that is listed.
member : a column or the text, with its local header in front.
mark : a few letters at the very end of the file, by which its writer is known.
"""

from __future__ import annotations

import io
import mmap
import struct
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, BinaryIO
from zipfile import ZIP_STORED, BadZipFile, ZipFile, ZipInfo
from zlib import crc32

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.errors import InputError

__all__ = [
    "ArchiveWriter",
    "ColumnFormat",
    "Columns",
    "DirectoryCheckedFile",
    "is_archive",
    "map_archive",
    "release_mapped_pages",
]

FIRST_BYTES = b"PK\x03\x04"
ALIGNMENT = 64
# Version 4.5 of the format knows sizes of 64 bits; 1 January 1980 is its first day.
VERSION, FIRST_DAY = 45, 0x21
LOCAL, CENTRAL = struct.Struct("<4s5H3L2H"), struct.Struct("<4s6H3L5H2L")
END_64, LOCATOR, END = struct.Struct("<4sQ2H2L4Q"), struct.Struct("<4sLQL"), struct.Struct("<4s4H2LH")
# An extra field of large sizes, and one that only takes up room.
SIZES, ROOM = 0x0001, 0xD935
IN_EXTRA = 0xFFFFFFFF
# The polynomial of the checksum: bits from x^0, which is the highest, to x^31.
POLYNOMIAL, TOP = 0xEDB88320, 31
# Bytes of a directory, and of the text of an archive to be read.
MOST_DIRECTORY, MOST_TEXT = 1 << 20, 50_000_000


@frozen
class ColumnFormat:
    """The contents of a column: NumPy's name of their type, such as ``<f8``, and the shape of a row."""

    kind: str
    shape: tuple[int, ...] = ()

    def make_header(self, rows: int) -> bytes:
        """Return the header of a ``.npy`` file, version 1.0, for an array of this many rows.

        Its length in bytes does not depend on the number of rows.
        """
        stream = io.BytesIO()
        about = {"descr": self.kind, "fortran_order": False, "shape": (rows, *self.shape)}
        np.lib.format.write_array_header_1_0(stream, about)
        return stream.getvalue()

    @property
    def row_bytes(self) -> int:
        """Number of bytes of one row."""
        return int(np.dtype(self.kind).itemsize * np.prod(self.shape, dtype=np.int64))


Columns = Mapping[str, ColumnFormat]


@define(eq=False)
class ArchiveMember:
    """A member of the archive that is being written.

    Parameters
    ----------
    name : name of the member.
    start : byte of the file at which its local header begins.
    size : bytes of its content.
    checksum : CRC-32 of the content written so far.
    """

    name: bytes
    start: int
    size: int
    checksum: int = 0

    @property
    def room(self) -> int:
        """Number of padding bytes in the local header that
        make the content begin at a multiple of 64 bytes.
        """
        return -(self.start + LOCAL.size + len(self.name) + 24) % ALIGNMENT

    @property
    def content(self) -> int:
        """Byte of the file at which the content begins."""
        return self.start + LOCAL.size + len(self.name) + 24 + self.room

    def make_local_header(self) -> bytes:
        """Return the ZIP local file header, with the name and the extra fields (64-bit sizes and padding)."""
        sizes = struct.pack("<2H2Q", SIZES, 16, self.size, self.size)
        extra = sizes + struct.pack("<2H", ROOM, self.room) + bytes(self.room)
        lengths = IN_EXTRA, IN_EXTRA, len(self.name), len(extra)
        return (
            LOCAL.pack(FIRST_BYTES, VERSION, 0, 0, 0, FIRST_DAY, self.checksum, *lengths) + self.name + extra
        )

    def make_central_header(self) -> bytes:
        """Return the member's entry in the ZIP central directory."""
        extra = struct.pack("<2H3Q", SIZES, 24, self.size, self.size, self.start)
        lengths = IN_EXTRA, IN_EXTRA, len(self.name), len(extra)
        fixed = CENTRAL.pack(
            b"PK\x01\x02", VERSION, VERSION, 0, 0, 0, FIRST_DAY, self.checksum, *lengths, 0, 0, 0, 0, IN_EXTRA
        )
        return fixed + self.name + extra


@define(eq=False)
class ArchiveWriter:
    """Write an archive block by block: call :meth:`append_rows` for each block, then :meth:`close` once.

    Parameters
    ----------
    stream : an empty file opened for writing that can seek.
    columns : formats of the columns by name, in the order in which :meth:`append_rows` takes them.
    rows : upper limit of the number of rows that will be added. Space for all of them is reserved in the
        file; unused space stays empty.
    """

    stream: BinaryIO
    columns: Mapping[str, ColumnFormat]
    rows: int
    members: list[ArchiveMember] = field(factory=list, init=False)
    done: int = field(default=0, init=False)

    def __attrs_post_init__(self) -> None:
        start = 0
        for name, column in self.columns.items():
            header = column.make_header(self.rows)
            size = len(header) + self.rows * column.row_bytes
            member = ArchiveMember(f"{name}.npy".encode(), start, size, crc32(header))
            self.write_bytes_at(member.content, header)
            self.members.append(member)
            start = member.content + size

    def write_bytes_at(self, place: int, content: Any) -> None:
        """Write bytes at a byte position of the file."""
        self.stream.seek(place)
        self.stream.write(content)

    def append_rows(self, block: Sequence[NDArray[Any]]) -> None:
        """Append rows.

        Parameters
        ----------
        block : one array for each column, in the order of ``columns``, all with the same number of rows.
        """
        for member, column, values in zip(self.members, self.columns.values(), block, strict=True):
            content = np.ascontiguousarray(values, column.kind).reshape(-1).view(np.uint8).data
            self.write_bytes_at(
                member.content + member.size - (self.rows - self.done) * column.row_bytes, content
            )
            member.checksum = crc32(content, member.checksum)
        self.done += len(block[0])

    def set_row_counts(self) -> None:
        """Set the row count of every column to the number of rows that were added, in the columns' headers
        and in the writer's own state.

        The column's data stay in place: the header's length does not depend on the row count.
        """
        for member, column in zip(self.members, self.columns.values(), strict=True):
            said, header = column.make_header(self.rows), column.make_header(self.done)
            size = self.done * column.row_bytes
            self.write_bytes_at(member.content, header)
            member.size = len(header) + size
            member.checksum ^= extend_checksum_difference(crc32(said) ^ crc32(header), size)
        self.rows = self.done

    def close(self, name: str, text: str, mark: str) -> None:
        r"""Write the text as the last member, all local headers,
        the directory and the mark; the stream stays open.

        Parameters
        ----------
        name : name of the member that is the text.
        text : written as UTF-8; lone surrogates become ``\udXXX`` escapes.
        mark : written as the comment of the ZIP file, which are its last bytes.
        """
        # Half a letter in a string of JSON becomes its escape.
        content = text.encode("utf-8", "backslashreplace")
        last = self.members[-1]
        member = ArchiveMember(name.encode(), last.content + last.size, len(content), crc32(content))
        if self.done < self.rows:
            self.set_row_counts()
        self.write_bytes_at(member.content, content)
        self.members.append(member)
        for one in self.members:
            self.write_bytes_at(one.start, one.make_local_header())
        place, count = member.content + member.size, len(self.members)
        directory = b"".join(one.make_central_header() for one in self.members)
        end = END_64.pack(
            b"PK\x06\x06", END_64.size - 12, VERSION, VERSION, 0, 0, count, count, len(directory), place
        )
        locator = LOCATOR.pack(b"PK\x06\x07", 0, place + len(directory), 1)
        last_words = END.pack(
            b"PK\x05\x06", 0, 0, count, count, len(directory), min(place, IN_EXTRA), len(mark.encode())
        )
        self.write_bytes_at(place, directory + end + locator + last_words + mark.encode())


def extend_checksum_difference(difference: int, size: int) -> int:
    """Return the XOR of the CRC-32s of two byte strings
    after both have been extended by ``size`` equal bytes.

    ``difference`` is the XOR of the CRC-32s before that. Each bit that is appended multiplies the difference
    by x, modulo the polynomial of CRC-32.

    Reference: M. Adler, zlib, ``crc32_combine``.
    """
    power = 1 << TOP - 8
    while size:
        if size & 1:
            difference = multiply_polynomials(difference, power)
        power = multiply_polynomials(power, power)
        size >>= 1
    return difference


def multiply_polynomials(a: int, b: int) -> int:
    """Return the product of two polynomials over GF(2), modulo the polynomial of CRC-32.

    Bit 31 of an operand is the coefficient of x^0, bit 0 that of x^31.
    """
    product = 0
    for place in range(TOP, -1, -1):
        if a >> place & 1:
            product ^= b
        b = b >> 1 ^ (POLYNOMIAL if b & 1 else 0)
    return product


def is_archive(path: Path) -> bool:
    """Return whether a path is a file that begins with the
    signature of a ZIP member; False where there is no file.

    Raises
    ------
    OSError
        When it cannot be read.
    """
    if not path.is_file():
        return False
    with path.open("rb") as stream:
        return stream.read(len(FIRST_BYTES)) == FIRST_BYTES


class DirectoryCheckedFile(io.FileIO):
    """A file for ``zipfile`` whose reads are limited to ``MOST_DIRECTORY`` bytes."""

    def read(self, size: int | None = -1, /) -> bytes:
        """Return up to ``size`` bytes; for None or a negative size the bytes up to the
        end of the file, but at most ``MOST_DIRECTORY``.

        Raises
        ------
        BadZipFile
            For a ``size`` above ``MOST_DIRECTORY``.
        """
        if size is not None and size > MOST_DIRECTORY:
            raise BadZipFile("its directory is too large")
        return super().read(MOST_DIRECTORY if size is None or size < 0 else size) or b""


def map_archive(
    path: Path, columns: Columns | Callable[[str], Columns], name: str, whole: bool = False
) -> tuple[str, dict[str, NDArray[Any]]]:
    """Return the text of an archive and its columns by name, read-only arrays that are mapped into memory.

    Bytes of a column are read from the disk when they are accessed. Nothing in the file is trusted: members
    must be stored uncompressed, inside the file and without overlap, and the number of rows in an array's
    header must agree with the number of its bytes.

    Parameters
    ----------
    columns : formats by name of the columns to return, or a function that derives these formats from the
        text; other members are ignored.
    name : name of the member that is the text.
    whole : read the columns once and compare their checksums; the text's is always compared.

    Raises
    ------
    InputError
        When the file is no such archive, is damaged, or its columns differ in their number of rows. The
        numbers in the columns are not checked.
    OSError
        When it cannot be read.
    """
    try:
        with DirectoryCheckedFile(path) as stream:
            with ZipFile(stream) as archive:
                everything = archive.infolist()
            content = mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)
        texts = [info for info in everything if info.filename == name]
        refuse_inconsistent_members({name}, texts, [])
        first, end = find_member_span(texts[0], content)
        if end - first > MOST_TEXT:
            raise BadZipFile(f"its {name} is too large")
        text = content[first:end].decode()
        columns = columns if isinstance(columns, Mapping) else columns(text)
        names = {f"{one}.npy" for one in columns} | {name}
        members = [info for info in everything if info.filename in names]
        spans = {info.filename: find_member_span(info, content) for info in members}
        refuse_inconsistent_members(names, members, list(spans.values()))
        for info in members:
            if (whole or info.filename == name) and compute_checksum(
                content, *spans[info.filename]
            ) != info.CRC:
                raise BadZipFile(f"{info.filename} has been changed since it was written")
        arrays = {
            one: map_column(content, *spans[f"{one}.npy"], one, column) for one, column in columns.items()
        }
    except (BadZipFile, struct.error, ValueError, NotImplementedError, OverflowError) as error:
        reason = str(error) if isinstance(error, BadZipFile) else "it is damaged"
        raise InputError(f"{path} is not a result file: {reason[:1].lower()}{reason[1:]}.") from error
    if len({len(array) for array in arrays.values()}) > 1:
        raise InputError(f"{path} is not a result file: its columns do not have the same number of rows.")
    return text, arrays


def release_mapped_pages(column: NDArray[Any]) -> None:
    """Give back the memory that holds parts of a mapped archive, given one of its columns.

    What is accessed next is read from the disk again. Where the system cannot do this, or the column is not
    mapped, nothing happens.
    """
    base: Any = column
    while isinstance(base, np.ndarray):
        base = base.base
    base = base.obj if isinstance(base, memoryview) else base
    if isinstance(base, mmap.mmap) and hasattr(mmap, "MADV_DONTNEED"):
        base.madvise(mmap.MADV_DONTNEED)


def refuse_inconsistent_members(
    names: set[str], members: Sequence[ZipInfo], spans: list[tuple[int, int]]
) -> None:
    """Raise BadZipFile unless each name stands for exactly one of the members and no two spans overlap.

    Parameters
    ----------
    members : members of the archive whose names are in ``names``.
    spans : byte ranges (first, end) of members in the file, in any order.
    """
    found = [info.filename for info in members]
    for one in sorted(names):
        if found.count(one) != 1:
            raise BadZipFile(f"{one} is {'missing' if one not in found else 'there twice'}")
    spans = sorted(spans)
    if any(end > first for (_, end), (first, _) in pairwise(spans)):
        raise BadZipFile("its members overlap")


def find_member_span(info: ZipInfo, content: mmap.mmap) -> tuple[int, int]:
    """Return the byte range (first, end) of a member's content in the file; ``end`` is excluded.

    Raises BadZipFile for a compressed or encrypted member, and for a member whose content reaches beyond the
    end of the file; struct.error when even its local header does.
    """
    if info.compress_type != ZIP_STORED or info.flag_bits & 1 or info.compress_size != info.file_size:
        raise BadZipFile(f"{info.filename} is packed, so it cannot be mapped into memory")
    if info.header_offset < 0:
        raise BadZipFile(f"{info.filename} lies outside of it")
    signature, *_, name, extra = LOCAL.unpack_from(content, info.header_offset)
    first = info.header_offset + LOCAL.size + name + extra
    if signature != FIRST_BYTES or first + info.file_size > len(content):
        raise BadZipFile(f"{info.filename} lies outside of it")
    return first, first + info.file_size


def compute_checksum(content: mmap.mmap, first: int, end: int) -> int:
    """Return the CRC-32 of the bytes ``first`` to ``end`` (excluded) of a mapped file."""
    value = 0
    with memoryview(content) as view:
        for k in range(first, end, MOST_DIRECTORY):
            value = crc32(view[k : min(k + MOST_DIRECTORY, end)], value)
    return value


def map_column(content: mmap.mmap, first: int, end: int, name: str, column: ColumnFormat) -> NDArray[Any]:
    """Return the column (N, ...) whose ``.npy`` file takes
    the bytes ``first`` to ``end``, as a read-only view.

    N follows from the number of bytes after the header. Raises BadZipFile when the header does not state the
    type and row shape of ``column`` and N rows, and struct.error when there are too few bytes for a header.
    """
    (length,) = struct.unpack_from("<H", content[first : min(first + 10, end)], 8)
    rows, rest = divmod(end - first - 10 - length, column.row_bytes)
    header, wanted = (
        b"".join(part.split()) for part in (content[first : first + 10 + length], column.make_header(rows))
    )
    if rows < 0 or rest or header[:8] + header[10:] != wanted[:8] + wanted[10:]:
        raise BadZipFile(f"{name}.npy is not an array of {column.kind} with rows of shape {column.shape}")
    if rows == 0:
        return np.zeros((0, *column.shape), column.kind)
    values = np.frombuffer(content, column.kind, rows * int(np.prod(column.shape)), first + 10 + length)
    return values.reshape(rows, *column.shape)
