"""Output files that appear whole or not at all.

Content is written under a temporary name in the same folder and renamed at the end. So an error, a full
disk or an interruption leaves an earlier file as it was. Devices and pipes have nothing to protect and are
written directly.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex
from typing import IO, BinaryIO

from workhold.errors import InputError

__all__ = [
    "binary_file",
    "plain_errors",
    "refuse_unwritable",
    "refuse_unwritable_folder",
    "remove_unfinished",
    "text_file",
    "unfinished",
    "write_bytes",
]

NEW_FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL
# What stands on the disk and is not to stay if the process ends now.
unfinished: set[Path] = set()


def refuse_unwritable(path: str | Path) -> None:
    """Refuses an output file that could not be written in the end, before any work is done for it."""
    path = Path(path)
    target = resolved_file(path)
    with plain_errors(path):
        if is_special(target):
            return
        if target.exists() and not os.access(target, os.W_OK):
            raise InputError(f"{path} cannot be written: it is write-protected.")
        probe(target.parent)


def refuse_unwritable_folder(path: str | Path) -> None:
    """Refuses an output folder that could not be created or written in the end; creates nothing."""
    path = Path(path)
    with plain_errors(path):
        existing = resolved(path)
        while not existing.exists():
            existing = existing.parent
        if not existing.is_dir():
            raise InputError(f"{path} cannot be a folder: {existing} is a file.")
        probe(existing)


@contextmanager
def text_file(path: str | Path) -> Iterator[IO[str]]:
    """A text file (UTF-8, ``\\n`` line ends) that takes its name only when the block ends without an error."""
    with (
        replacement(Path(path)) as descriptor,
        os.fdopen(descriptor, "w", encoding="utf-8", newline="\n") as stream,
    ):
        yield stream


@contextmanager
def binary_file(path: str | Path) -> Iterator[BinaryIO]:
    """A file of bytes, written in any order, that takes its name only when the block ends without an error.

    Raises
    ------
    InputError
        When the file cannot be written, or is a pipe, in which nobody can go back.
    """
    with replacement(Path(path)) as descriptor, os.fdopen(descriptor, "wb") as stream:
        if not stream.seekable():
            raise InputError(f"{path} is a pipe: write a file in columns to a disk.")
        yield stream


def write_bytes(path: str | Path, content: bytes) -> None:
    """Writes a whole file of bytes, or leave an earlier one as it was."""
    with replacement(Path(path)) as descriptor, os.fdopen(descriptor, "wb") as stream:
        stream.write(content)


@contextmanager
def replacement(path: Path) -> Iterator[int]:
    """A file descriptor whose content replaces the path when the block ends without an error."""
    target = resolved_file(path)
    with plain_errors(path):
        if is_special(target):
            yield os.open(target, os.O_WRONLY)
            return
        temporary = temporary_name(target)
        unfinished.add(temporary)
        descriptor = os.open(temporary, NEW_FILE, 0o666)
        try:
            yield descriptor
            if target.exists():
                temporary.chmod(stat.S_IMODE(target.stat().st_mode))
            temporary.replace(target)
        except BaseException:
            with suppress(OSError):
                temporary.unlink()
            raise
        finally:
            unfinished.discard(temporary)


def remove_unfinished() -> None:
    """Removes what is not to stay, when the process ends out of turn; callable from any thread."""
    for path in tuple(unfinished):
        with suppress(OSError):
            path.unlink()


def resolved(path: Path) -> Path:
    """The path without symbolic links; refuses names that no file can have, and links in a circle."""
    try:
        return path.resolve()
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{str(path)!r} cannot be a file's name: {error}.") from error


def resolved_file(path: Path) -> Path:
    """The path without symbolic links, after checking that a file can be there."""
    target = resolved(path)
    with plain_errors(path):
        if target.is_dir():
            raise InputError(f"{path} is a folder: name a file in it.")
        if not target.parent.is_dir():
            folder = target.parent if path.is_symlink() else path.parent
            raise InputError(f"{path} cannot be written, there is no folder {folder}: create it first.")
    return target


@contextmanager
def plain_errors(path: Path) -> Iterator[None]:
    """Turns the operating system's refusals into a sentence that names the file."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror or error}.") from error


def probe(folder: Path) -> None:
    """Creates a file in a folder and remove it, the only sure way to know whether that is allowed."""
    temporary = temporary_name(folder / "probe")
    os.close(os.open(temporary, NEW_FILE, 0o666))
    temporary.unlink()


def is_special(target: Path) -> bool:
    """Whether a path is a device, a pipe or a socket: something to write to, not to replace."""
    return target.exists() and not target.is_file() and not target.is_dir()


def temporary_name(target: Path) -> Path:
    """A name beside the target that no other file has; cut short so that the file system accepts it."""
    return target.with_name(f".{target.name[:40]}.{token_hex(6)}.part")
