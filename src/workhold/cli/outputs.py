"""What a command may write over: its own earlier outputs, and nothing that it reads."""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from workhold.errors import InputError

__all__ = ["ForceOption", "refuse_output", "refuse_output_folder"]

ForceOption = Annotated[
    bool, typer.Option("--force", help="Replace files of these names that workhold has not written.")
]

# What stands within the first or the last so many bytes of everything that workhold writes, and of nothing else.
ENDS = 4096
MARKS = (
    b'{"format": "workhold-result/',
    b'{"format": "workhold-family/',
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
)


def refuse_output(path: str | Path, inputs: Iterable[str | Path | None], force: bool, called: str = "--force") -> None:
    """Refuse an output file before any work is done for it.

    Parameters
    ----------
    inputs : what the command reads: files, names of other things, and None for what is not given.
    force : whether a file that workhold has not written may be replaced.
    called : what that is called where it is asked for.

    Raises
    ------
    InputError
        When it cannot be written, is one of the inputs (also through links), or is a foreign file.
    """
    from workhold.files.atomic import refuse_unwritable

    refuse_unwritable(path)
    refuse_replacing(Path(path), inputs, force, called)


def refuse_output_folder(folder: Path, names: Iterable[str], inputs: Iterable[str | Path | None], force: bool) -> None:
    """Refuse an output folder, or the files of some names that a command would write into it.

    Raises
    ------
    InputError
        See :func:`refuse_output`.
    """
    from workhold.files.atomic import refuse_unwritable_folder

    refuse_unwritable_folder(folder)
    inputs = list(inputs)
    for name in names:
        refuse_replacing(folder / name, inputs, force)


def refuse_replacing(path: Path, inputs: Iterable[str | Path | None], force: bool, called: str = "--force") -> None:
    """Refuse to write over an input, and over a foreign file unless that is asked for.

    Raises
    ------
    InputError
        Naming the file.
    """
    if not path.is_file():
        return
    if any(is_same(path, given) for given in inputs if given is not None):
        raise InputError(f"{path} is also what is read: give the output another name.")
    if not force and not is_own(path):
        raise InputError(f"{path} was not written by workhold: give another name, or {called} to replace it.")


def is_same(path: Path, given: str | Path) -> bool:
    """Whether a file is what another name, which may be that of no file, leads to."""
    try:
        return path.samefile(given)
    except (OSError, ValueError):
        return False


def is_own(path: Path) -> bool:
    """Whether workhold has written a file, or nobody has written anything into it."""
    with suppress(OSError), path.open("rb") as stream:
        first = stream.read(ENDS)
        stream.seek(-min(ENDS, os.fstat(stream.fileno()).st_size), os.SEEK_END)
        ends = first + stream.read(ENDS)
        return not ends or any(mark in ends for mark in MARKS)
    return False
