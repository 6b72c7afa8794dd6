"""NGSolve with Netgen, the library that meshes and solves: loaded only when a part is bent."""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from typing import Any

from attrs import frozen

from workhold.errors import InputError

__all__ = ["REQUIREMENT", "Elements", "load_elements"]

# What the extra asks for; nobody else's distribution can be had by its name.
REQUIREMENT = "ngsolve>=6.2.2608"


@frozen
class Elements:
    """Modules of the library: elements and solvers, shapes, and meshes."""

    solving: Any
    shapes: Any
    meshing: Any


@cache
def load_elements() -> Elements:
    """Return the library's modules; the first call loads them, which takes about a second, and limits them to
    one thread.

    Raises
    ------
    InputError
        When the extra is not installed, with the remedy.
    """
    # Both this library and the reader of STEP files bring an Open CASCADE of their own. A process that loads this
    # one first ends with a crash once the other is loaded, too; the other way round it does not.
    with suppress(ImportError):
        import OCP  # noqa: F401
    try:
        import netgen.meshing
        import netgen.occ
        import ngsolve
    except ImportError as error:
        raise InputError(
            f"how far a part bends needs a library that is not installed: pip install '{REQUIREMENT}'."
        ) from error
    ngsolve.SetNumThreads(1)
    netgen.meshing.SetMessageImportance(0)
    return Elements(ngsolve, netgen.occ, netgen.meshing)
