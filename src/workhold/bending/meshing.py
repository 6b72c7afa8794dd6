"""Meshes of tetrahedra that follow round faces, coarse enough for a list of fixtures."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from ctypes import CDLL
from functools import cached_property
from math import sqrt
from typing import Any

import numpy as np
from attrs import define

from workhold.bending.library import load_elements
from workhold.bending.shape import PartToBend
from workhold.bending.surface import Surface, find_surface
from workhold.errors import InputError

__all__ = ["PartMesh", "curve_mesh", "make_mesh"]

# Tetrahedra that a part is filled with, about, where its own shape does not ask for more.
TETRAHEDRA = 1000
# The volume of a tetrahedron over the cube of the size that the mesher is given, as it fills a plate.
SHARE = 0.17
# The process's own numbers of its output and its error output.
OUTPUTS = (1, 2)
# Beyond this elements of the third order would take minutes.
MOST_TETRAHEDRA = 12_000
# How fast elements grow away from small ones, and how many fit on the radius of a round face: elements are curved, so that
# five round a bore follow it well. The further ones, of which the last are the mesher's own, are for parts that it fails
# on so.
FEW = {"grading": 0.8, "curvaturesafety": 0.8}
MORE = ({"grading": 0.8, "curvaturesafety": 1.0}, {"grading": 0.3, "curvaturesafety": 2.0})
# mm, in place of a thickness or a size of nothing.
TINY = 1e-9
# The mesher's rounds of making elements better; its threads wait for each other for longer than they work.
COMMON = {"optsteps3d": 2, "parallel_meshing": False}
# Sizes of elements are no larger than this many times a part's least extent: a plate then bends by its true
# stiffness with one second-order element over its thickness.
OF_LEAST_EXTENT = 2.0
# Of a sheet, which then takes too many, they are larger, up to so many times its thickness: measured on sheets of 3 and 6
# mm, figures then change by less than the error told. One layer of elements has about so many per square of their size.
OF_SHEET, PER_SQUARE = 8.0, 6.5
# Of the most tetrahedra, those for which such a size is chosen.
ROOM = 0.8


@define(eq=False)
class PartMesh:
    """A mesh of a part whose elements follow round faces.

    Parameters
    ----------
    made : the library's mesh object.
    """

    made: Any

    @cached_property
    def surface(self) -> Surface:
        """Surface of the mesh."""
        return find_surface(self.made)


def make_mesh(part: PartToBend) -> PartMesh:
    """Return a mesh of a part.

    Raises
    ------
    InputError
        For a shape that cannot be meshed or needs too many elements.
    """
    shape = part.build()
    try:
        low, high = (np.array([corner[k] for k in range(3)]) for corner in shape.bounding_box)
        mesh = mesh_shape(shape, choose_size(float(shape.mass), float((high - low).min())))
    except list_mesher_errors() as error:
        raise InputError(
            "the part cannot be meshed, so it is not known how far it bends: repair its solid in the CAD program."
        ) from error
    if not mesh.ne:
        raise InputError("the part has no volume to mesh: repair its solid in the CAD program.")
    if mesh.ne > MOST_TETRAHEDRA:
        raise InputError(
            f"the part needs {mesh.ne:,} elements, and the limit is {MOST_TETRAHEDRA:,}: leave small fillets "
            "and holes out of the model."
        )
    return curve_mesh(mesh)


def choose_size(volume: float, least: float) -> float:
    """Return the size of elements in mm for a part with this volume in mm³ and least extent in mm.

    Raises
    ------
    InputError
        For a sheet so wide that it would take too many.

    Examples
    --------
    A block, a plate, and a sheet of 600 by 400 by 3 mm:

    >>> [round(choose_size(*one), 1) for one in ((60 * 40 * 30, 30), (120 * 70 * 4, 4), (600 * 400 * 3, 3))]
    [7.5, 5.8, 12.7]
    """
    usual = float((volume / (SHARE * TETRAHEDRA)) ** (1 / 3))
    size = min(usual, OF_LEAST_EXTENT * least)
    area = volume / max(least, TINY)
    if PER_SQUARE * area > MOST_TETRAHEDRA * size**2:
        wanted = sqrt(PER_SQUARE * area / (ROOM * MOST_TETRAHEDRA))
        size = min(usual, max(size, wanted), OF_SHEET * least)
    needed = PER_SQUARE * area / max(size, TINY) ** 2
    if needed > MOST_TETRAHEDRA:
        raise InputError(
            f"the part is a sheet that needs about {needed:,.0f} elements, and the limit is {MOST_TETRAHEDRA:,}: bend a "
            "smaller piece of it, as wide as what is clamped and cut, or look at its thickness."
        )
    return size


def mesh_shape(shape: Any, size: float) -> Any:
    """Return a library mesh of a shape, with tetrahedra of at most ``size`` mm.

    A coarse mesh is tried first, then finer ones. Raises one of the errors of :func:`list_mesher_errors` if
    all fail.
    """
    whole = load_elements().shapes.OCCGeometry(shape)
    with silence_output():
        for settings in (FEW, *MORE[:-1]):
            try:
                return whole.GenerateMesh(maxh=size, **COMMON, **settings)
            except list_mesher_errors():
                continue
        return whole.GenerateMesh(maxh=size, **COMMON, **MORE[-1])


def list_mesher_errors() -> tuple[type[Exception], ...]:
    """Return the exception classes that the library raises when it cannot mesh a shape."""
    return (RuntimeError, load_elements().meshing.NgException)


@contextmanager
def silence_output() -> Iterator[None]:
    """Discard everything that the process writes to standard output and standard error while the context is
    open.

    A mesher that fails prints pages of messages.
    """
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    kept = [os.dup(number) for number in OUTPUTS]
    try:
        for number in OUTPUTS:
            os.dup2(nowhere, number)
        yield
    finally:
        # What the library has written and not yet handed on goes the same way.
        with suppress(OSError, AttributeError, TypeError):
            CDLL(None).fflush(None)
        for number, own in zip(OUTPUTS, kept, strict=True):
            os.dup2(own, number)
            os.close(own)
        os.close(nowhere)


def curve_mesh(mesh: Any) -> PartMesh:
    """Return a mesh for the solver whose elements are curved to follow round faces; ``mesh`` is one of the
    library.
    """
    made = load_elements().solving.Mesh(mesh)
    made.Curve(2)
    return PartMesh(made)
