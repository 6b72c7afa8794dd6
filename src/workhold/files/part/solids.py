"""Which solids a STEP file has, and what a part is called that is one of several."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike

from attrs import evolve

from workhold.errors import InputError
from workhold.files.part.finding import found, kind_of, read_bytes
from workhold.files.part.loaded import Loaded
from workhold.model.own_outlines import own_name
from workhold.model.solid import FileSolid
from workhold.model.workpiece import Workpiece

__all__ = ["solids_in", "with_solid_named"]


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


def with_solid_named(loaded: Loaded, file: str, chosen: int | str | None) -> Loaded:
    """A part named after its solid too, where the file holds several with names: ``lug of machine``.

    Parameters
    ----------
    file : name of the file.
    chosen : number or name of the solid that was read; None is the largest.
    """
    name = "" if len(loaded.solids) < 2 else name_of_chosen(loaded.solids, chosen)
    if not name or name == file:
        return loaded
    called = f"{name} of {file}"
    outlines = tuple((role, between(called, own)) for role, own in loaded.workpiece.outlines)
    return evolve(loaded, workpiece=evolve(loaded.workpiece, name=called, outlines=outlines))


def name_of_chosen(solids: Sequence[FileSolid], chosen: int | str | None) -> str:
    """What the file calls the solid of a number or a name; empty where it does not."""
    if not isinstance(chosen, str):
        return solids[(chosen or 1) - 1].name
    asked = " ".join(chosen.split())
    names = [solid.name for solid in solids]
    return asked if asked in names else next(one for one in names if one.casefold() == asked.casefold())


def between(called: str, own: Workpiece) -> Workpiece:
    """The outline of a carrier with heights of its own, named after the part and these heights."""
    assert own.solid is not None
    return evolve(own, name=own_name(called, (own.solid.low, own.solid.peg_height)))
