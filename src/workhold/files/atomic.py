"""Output files that appear whole or not at all.

Content is written under a temporary name in the same folder and renamed at the end. So an error, a full disk
or an interruption leaves an earlier file as it was. Devices and pipes hold no earlier content and are written
directly.
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
    "write_binary_file",
    "explain_system_errors",
    "refuse_unwritable",
    "refuse_unwritable_folder",
    "remove_unfinished",
    "write_text_file",
    "unfinished",
    "write_bytes",
]

NEW_FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL
# What stands on the disk and is not to stay if the process ends now.
unfinished: set[Path] = set()


def refuse_unwritable(path: str | Path) -> None:
    """Raise InputError if an output file could not be written; to be called before the work that makes its
    content.
    """
    path = Path(path)
    target = resolve_file_path(path)
    with explain_system_errors(path):
        if is_special(target):
            return
        if target.exists() and not os.access(target, os.W_OK):
            raise InputError(f"{path} cannot be written: it is write-protected.")
        probe_folder(target.parent)


def refuse_unwritable_folder(path: str | Path) -> None:
    """Raise InputError if an output folder could not be created or written in; nothing is created."""
    path = Path(path)
    with explain_system_errors(path):
        existing = resolve_path(path)
        while not existing.exists():
            existing = existing.parent
        if not existing.is_dir():
            raise InputError(f"{path} cannot be a folder: {existing} is a file.")
        probe_folder(existing)


@contextmanager
def write_text_file(path: str | Path) -> Iterator[IO[str]]:
    """Yield a text file (UTF-8, ``\\n`` line ends) that
    takes its name only when the block ends without an error.

    Raises InputError when the file cannot be written.
    """
    with (
        replace_file(Path(path)) as descriptor,
        os.fdopen(descriptor, "w", encoding="utf-8", newline="\n") as stream,
    ):
        yield stream


@contextmanager
def write_binary_file(path: str | Path) -> Iterator[BinaryIO]:
    """Yield a binary file, opened for writing with seek, that
    takes its name only when the block ends without an error.

    Raises
    ------
    InputError
        When the file cannot be written, or is a pipe, which cannot seek.
    """
    with replace_file(Path(path)) as descriptor, os.fdopen(descriptor, "wb") as stream:
        if not stream.seekable():
            raise InputError(f"{path} is a pipe: write a file in columns to a disk.")
        yield stream


def write_bytes(path: str | Path, content: bytes) -> None:
    """Write a whole binary file; raise InputError, and leave an earlier file as it was, when that fails."""
    with replace_file(Path(path)) as descriptor, os.fdopen(descriptor, "wb") as stream:
        stream.write(content)


@contextmanager
def replace_file(path: Path) -> Iterator[int]:
    """Yield a file descriptor whose content replaces the path when the block ends without an error.

    A device or a pipe is not replaced but written to directly. Raises InputError when the file cannot be
    written.
    """
    target = resolve_file_path(path)
    with explain_system_errors(path):
        if is_special(target):
            yield os.open(target, os.O_WRONLY)
            return
        temporary = make_temporary_name(target)
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
    """Remove all temporary files of this module, for when
    the process is ended early; callable from any thread.
    """
    for path in tuple(unfinished):
        with suppress(OSError):
            path.unlink()


def resolve_path(path: Path) -> Path:
    """Return the path without symbolic links; raise InputError
    for impossible names, and for links in a circle.
    """
    try:
        return path.resolve()
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(f"{str(path)!r} cannot be a file's name: {error}.") from error


def resolve_file_path(path: Path) -> Path:
    """Return the path without symbolic links; raise InputError
    if it is a folder, or there is no folder for it.
    """
    target = resolve_path(path)
    with explain_system_errors(path):
        if target.is_dir():
            raise InputError(f"{path} is a folder: name a file in it.")
        if not target.parent.is_dir():
            folder = target.parent if path.is_symlink() else path.parent
            raise InputError(f"{path} cannot be written, there is no folder {folder}: create it first.")
    return target


@contextmanager
def explain_system_errors(path: Path) -> Iterator[None]:
    """Turn an OSError in the block into an InputError
    that names the file; BrokenPipeError passes unchanged.
    """
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror or error}.") from error


def probe_folder(folder: Path) -> None:
    """Create a file in a folder and remove it; raise OSError if that is not allowed. No other test is as
    sure.
    """
    temporary = make_temporary_name(folder / "probe")
    os.close(os.open(temporary, NEW_FILE, 0o666))
    temporary.unlink()


def is_special(target: Path) -> bool:
    """Return whether a path is a device, a pipe or a socket, which is written to instead of replaced."""
    return target.exists() and not target.is_file() and not target.is_dir()


def make_temporary_name(target: Path) -> Path:
    """Return a random hidden name in the target's folder, short enough for the file system."""
    return target.with_name(f".{target.name[:40]}.{token_hex(6)}.part")
