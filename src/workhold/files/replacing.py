"""Rules for replacing files: workhold's own earlier outputs may be replaced, inputs never.

The rules are the same for the command, for Python and for programs that call either. A file that workhold has
written is recognized by a mark in it and may be replaced; any other file only if the caller asks for it. An
output never replaces one of its own inputs, under its name or through links.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

from workhold.errors import InputError

__all__ = ["IN_PYTHON", "is_own", "refuse_other_ending", "refuse_output", "refuse_output_folder"]

# What the permission to replace a file is called in Python.
IN_PYTHON = "overwrite=True"
# What stands within the first or the last so many bytes of everything that workhold writes, and of nothing
# else.
ENDS = 4096
MARKS = (
    b'{"format": "workhold-result/',
    b'{"format": "workhold-family/',
    b'{"format": "workhold-supports/',
    b'{"format": "workhold-benchmark',
    b"format workhold-benchmark/1",
    b"\0workhold-result/",
    b"number,type,theta_deg,x,y,jaw_separation,",
    b"toolkit,fixtures,type_",
    b"hole,carrier,column,row,x,y,diameter,length,unit,dowel,face\n",
    b"part,file,toolkit,",
    b"workhold-table/1",
    b"<!-- workhold -->",
    b"tEXtSoftware\0workhold",
    b"/Producer (workhold)",
    b"$LASTSAVEDBY\n  1\nworkhold\n",
    b"'workhold','",
    b'"generator":"workhold"',
)
# Endings by which people and programs take a file for one of a certain kind.
ENDINGS = (
    *(".json", ".csv", ".npz", ".parquet", ".toml", ".tbl", ".nc", ".ngc", ".tap", ".gcode", ".html", ".zip"),
    *(".svg", ".png", ".jpg", ".jpeg", ".pdf", ".dxf", ".dwg", ".step", ".stp", ".igs", ".iges"),
    *(".glb", ".gltf", ".stl", ".obj", ".3mf"),
)


def refuse_output(
    path: str | Path,
    inputs: Iterable[str | Path | None] = (),
    force: bool = False,
    called: str = IN_PYTHON,
) -> None:
    """Raise InputError for an output file that must not or cannot be written, before any work is done for it.

    Parameters
    ----------
    inputs : the inputs that must not be replaced; names that are not files, and None, are ignored.
    force : whether a file that workhold has not written may be replaced.
    called : name of ``force`` at the caller, for the message.

    Raises
    ------
    InputError
        When it cannot be written, is one of the inputs (also through links), or is a foreign file.
    """
    from workhold.files.atomic import refuse_unwritable

    refuse_unwritable(path)
    refuse_replacing(Path(path), inputs, force, called)


def refuse_output_folder(
    folder: Path,
    names: Iterable[str],
    inputs: Iterable[str | Path | None],
    force: bool,
    called: str = IN_PYTHON,
) -> None:
    """Raise InputError for an output folder, or files with
    these names in it, that must not or cannot be written.

    The other parameters are those of :func:`refuse_output`.
    """
    from workhold.files.atomic import refuse_unwritable_folder

    refuse_unwritable_folder(folder)
    inputs = list(inputs)
    for name in names:
        refuse_replacing(folder / name, inputs, force, called)


def refuse_replacing(path: Path, inputs: Iterable[str | Path | None], force: bool, called: str) -> None:
    """Raise InputError if a path is one of the inputs, or if it is a file that workhold has not written and
    ``force`` is False.

    A path at which there is no file passes. ``called`` is the name of ``force`` in the message.
    """
    if not path.is_file():
        return
    if any(is_same(path, given) for given in inputs if given is not None):
        raise InputError(f"{path} is also an input: give the output another name.")
    if not force and not is_own(path):
        raise InputError(f"{path} was not written by workhold: give another name, or {called} to replace it.")


def refuse_other_ending(path: str | Path, own: Sequence[str], what: str) -> None:
    """Raise InputError for an output whose name has the ending of another kind of file that workhold writes.

    Parameters
    ----------
    own : endings that the output may have, in small letters with the point.
    what : words for the output in the message.
    """
    ending = Path(path).suffix.lower()
    if ending in ENDINGS and ending not in own:
        raise InputError(f"{path} is not the name of {what}: let the name end in {' or '.join(own)}.")


def is_same(path: Path, given: str | Path) -> bool:
    """Return whether two paths are the same existing file; False where one cannot be read."""
    try:
        return path.samefile(given)
    except (OSError, ValueError):
        return False


def is_own(path: Path) -> bool:
    """Return whether workhold has written a file, or the file is empty; False where it cannot be read."""
    with suppress(OSError), path.open("rb") as stream:
        first = stream.read(ENDS)
        stream.seek(-min(ENDS, os.fstat(stream.fileno()).st_size), os.SEEK_END)
        ends = first + stream.read(ENDS)
        return not ends or any(mark in ends for mark in MARKS)
    return False
