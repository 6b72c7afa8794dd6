"""The solids of a STEP file as a list: which there are, whether or not an outline can be made of them."""

from __future__ import annotations

from typing import Any

from attrs import astuple

from workhold.files.apart import run_apart
from workhold.files.step.library import load_step_library
from workhold.files.step.reader import guarded
from workhold.files.step.solids import read_solids
from workhold.model.solid import FileSolid

__all__ = ["listed_solids", "plain", "prepare"]


def listed_solids(content: bytes) -> tuple[FileSolid, ...]:
    """The solids of the bytes of a STEP file, read in a process of its own.

    Raises
    ------
    InputError
        As :func:`workhold.files.step.solids.read_solids`, and for a file that the process does not survive.
    """
    return tuple(FileSolid(*one) for one in run_apart(__name__, content, {}, "the STEP file"))


def prepare() -> None:
    """Loads the library, see :func:`workhold.files.apart.run_apart`."""
    load_step_library()


def plain(content: bytes) -> Any:
    """The solids as plain data.

    Raises
    ------
    InputError
        As :func:`listed_solids`.
    """
    return guarded(lambda: [astuple(solid.listed) for solid in read_solids(content)], ValueError)
