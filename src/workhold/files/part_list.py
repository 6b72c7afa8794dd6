"""Many parts at once: files, folders with drawings, and built-in names become a list in a fixed order.

Glossary
--------
listed part : a file with a drawing, and its name in the list.
drawing : a file with the ending of a part file; JSON that workhold wrote itself does not count.
"""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from attrs import frozen

from workhold.errors import InputError, lacks_memory, make_encodable
from workhold.files.part.finding import find_part_file
from workhold.files.part.load import LoadedPart, read_workpiece

__all__ = ["ListedPart", "ReadPart", "list_parts", "read_listed"]

ENDINGS = (".dxf", ".svg", ".json", ".step", ".stp")
# How a file of results, or of jobs that are done, begins; a part's never does.
OWN = b'{"format": "workhold-'
# More drawings than this in one folder are more likely a slip, such as a whole disk, than a wish.
MOST_PARTS = 1_000_000


@frozen
class ListedPart:
    """A part that is still to be read.

    Parameters
    ----------
    name : its name in the list: a built-in name, the file as it was typed, or its path within the folder that
        was typed. Names in a list differ.
    path : its file.
    """

    name: str
    path: Path


@frozen
class ReadPart:
    """A part of a list after reading: loaded, or refused.

    Parameters
    ----------
    listed : the entry of the list.
    loaded : the part; None where it was refused.
    refusal : the error message; empty where it was not refused.
    """

    listed: ListedPart
    loaded: LoadedPart | None
    refusal: str = ""


def list_parts(given: Iterable[str | Path], leave_out: Iterable[str | Path] = ()) -> tuple[ListedPart, ...]:
    """Return the parts that files, folders and built-in names stand for, each file once, in the order given.

    Of a folder these are all drawings in it and below it, whether or not they can be read. Numbers in names
    sort as numbers: ``plate2.dxf`` comes before ``plate10.dxf``. Hidden files and
    folders, links to folders, and what workhold wrote are passed over.

    Parameters
    ----------
    given : files, folders and built-in names; a file or folder is preferred to a built-in part of the same
        name.
    leave_out : folders whose drawings are not parts, such as one for results.

    Raises
    ------
    InputError
        For what does not exist, a folder without a drawing, and more than a million parts.

    Examples
    --------
    >>> [part.name for part in list_parts(["widget", "Flange", "widget"])]
    ['widget', 'Flange']
    """
    apart = {os.path.realpath(folder) for folder in leave_out}
    parts: dict[tuple[str, str], tuple[str, Path, Path]] = {}
    for one in given:
        path = Path(one)
        if is_folder(path):
            drawings = list(list_drawings_in_folder(path, apart))
            if not drawings:
                raise InputError(
                    f"{path} has no drawing in it: give a folder with {', '.join(ENDINGS[:-1])} or "
                    f"{ENDINGS[-1]} files."
                )
            entries = [(drawing.relative_to(path).as_posix(), drawing, drawing) for drawing in drawings]
        else:
            entries = [(str(one), Path(one), find_part_file(one))]
        for entry in entries:
            # The ending is what a file is read by: under another one a link is another part.
            parts.setdefault((os.path.realpath(entry[2]), entry[2].suffix.lower()), entry)
        if len(parts) > MOST_PARTS:
            raise InputError(
                f"{path} brings more than {MOST_PARTS:,} parts: give fewer folders, or name the files."
            )
    times = Counter(name for name, _, _ in parts.values())
    return tuple(
        ListedPart(make_encodable(name if times[name] == 1 else str(typed)), file)
        for name, typed, file in parts.values()
    )


def is_folder(path: Path) -> bool:
    """Return whether a path is a folder; False also for a name that no file can have."""
    try:
        return path.is_dir()
    except OSError:
        return False


def list_drawings_in_folder(folder: Path, apart: set[str]) -> Iterator[Path]:
    """Yield the paths of the drawings in a folder, and then those in each folder inside it, both in natural
    order of names.

    Dead links, pipes and inner folders that cannot be read are yielded, too, so that reading them gives the
    error. Raises InputError when the folder itself cannot be read.

    Parameters
    ----------
    apart : real paths of inner folders to leave out.
    """
    # Each with where it really lies: asking for that anew would look at all folders above it every time.
    waiting = [(folder, Path(os.path.realpath(folder)))]
    while waiting:
        inside, place = waiting.pop()
        try:
            entries = sorted(os.scandir(inside), key=lambda entry: make_natural_sort_key(entry.name))
        except OSError as error:
            if inside != folder:
                yield inside
                continue
            why = (error.strerror or str(error)).lower()
            raise InputError(f"{folder} cannot be read ({why}).") from error
        entries = [entry for entry in entries if not entry.name.startswith(".")]
        for path in (inside / entry.name for entry in entries):
            if path.suffix.lower() in ENDINGS and not path.is_dir() and not is_own(path):
                yield path
        inner = [entry.name for entry in entries if entry.is_dir(follow_symlinks=False)]
        places = [(inside / name, place / name) for name in reversed(inner)]
        waiting += [one for one in places if str(one[1]) not in apart]


def make_natural_sort_key(name: str) -> tuple[list[tuple[bool, int, str]], str]:
    """Return a sort key for a name, in which runs of digits count as
    numbers and capitals as small letters.
    """
    pieces = re.findall(r"[0-9]{1,18}|[^0-9]+", name)
    return [
        (piece[0] > "9", int(piece) if "0" <= piece[0] <= "9" else 0, piece.lower()) for piece in pieces
    ], name


def is_own(path: Path) -> bool:
    """Return whether a file is JSON that workhold wrote, such as results; False where it cannot be opened."""
    if path.suffix.lower() != ".json" or not path.is_file():
        return False
    try:
        with path.open("rb") as stream:
            return stream.read(len(OWN)) == OWN
    except OSError:
        return False


def read_listed(part: ListedPart, **options: Any) -> ReadPart:
    """Return a part of a list after reading it; an error becomes its
    refusal, so that other parts can be read.

    Parameters
    ----------
    options : see :func:`workhold.files.part.load.read_workpiece`.

    Examples
    --------
    >>> read = read_listed(list_parts(["widget"])[0])
    >>> read.loaded.workpiece.name, read.refusal
    ('widget', '')
    """
    try:
        return ReadPart(part, read_workpiece(part.path, **options))
    except InputError as error:
        return ReadPart(part, None, str(error))
    except Exception as error:
        # Whatever it is, it must not cost the other parts.
        why = (
            "reading it takes more memory than there is: save less in it"
            if lacks_memory(error)
            else "the file is damaged, or holds what this program cannot read: save it anew"
        )
        return ReadPart(part, None, f"{part.path.name}: {why}.")
