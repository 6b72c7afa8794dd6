"""Which solids a STEP file has."""

from __future__ import annotations

from os import PathLike

from workhold.errors import InputError
from workhold.files.part.finding import found, kind_of, read_bytes
from workhold.model.solid import FileSolid

__all__ = ["solids_in"]


def solids_in(path: str | PathLike[str]) -> tuple[FileSolid, ...]:
    """Lists the solids of a STEP file by decreasing volume, with their names where the file has them.

    ``load`` takes one of them by its number or its name.

    Parameters
    ----------
    path : of the file.

    Returns
    -------
    Number, name, size along x, y and z, and lowest corner of each; lengths in mm, in the file's own axes. A
    name is empty where the file has none.

    Raises
    ------
    InputError
        For a file that cannot be read, is of another kind, or has no solid; naming the file.
    """
    file = found(path)
    try:
        content = read_bytes(file)
        if kind_of(file, content) != "step":
            raise InputError("only STEP files have solids.")
        from workhold.files.step.solid_list import listed_solids

        return listed_solids(content)
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from error
