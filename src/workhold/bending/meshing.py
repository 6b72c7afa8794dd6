"""Meshes of second-order tetrahedra, coarse enough for a list of fixtures, and refined once to judge them by."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.bending.library import load_elements
from workhold.bending.shape import PartToBend
from workhold.errors import InputError

__all__ = ["Surface", "make_mesh", "refine_mesh"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Tetrahedra that a part is filled with, about, where its own shape does not ask for more. With the mesh refined, each
# of them becomes eight.
TETRAHEDRA = 1000
# The volume of a tetrahedron over the cube of the size that the mesher is given, as it fills a plate.
SHARE = 0.17
# Beyond this the refined mesh would take minutes.
MOST_TETRAHEDRA = 6_000
# How fast elements grow away from small ones, and how many fit on the radius of a round face: elements are curved, so that
# one for each radian follows it well.
GRADING, ROUND = 0.8, 1.0
# Sizes of elements are no larger than this many times a part's least extent: a plate then bends by its true
# stiffness with one second-order element over its thickness.
OF_LEAST_EXTENT = 2.0


@frozen(eq=False)
class Surface:
    """The surface of a mesh: triangles of six nodes.

    Parameters
    ----------
    nodes : (N, 3) where corners and middles of edges lie, in mm.
    triangles : (T, 6) numbers of nodes: three corners, counter-clockwise from outside, then the middles of the edges
        between the first two, the last two, and the last and the first.
    normals : (T, 3) unit vectors outward.
    """

    nodes: Array
    triangles: IntArray
    normals: Array


def make_mesh(part: PartToBend) -> Any:
    """Mesh a part.

    Raises
    ------
    InputError
        For a shape that cannot be meshed, and one that takes too many elements.
    """
    shape = part.build()
    try:
        low, high = (np.array([corner[k] for k in range(3)]) for corner in shape.bounding_box)
        size = min(
            (shape.mass / (SHARE * TETRAHEDRA)) ** (1 / 3), OF_LEAST_EXTENT * float((high - low).min())
        )
        mesh = (
            load_elements()
            .shapes.OCCGeometry(shape)
            .GenerateMesh(maxh=size, optsteps3d=2, grading=GRADING, curvaturesafety=ROUND)
        )
    except RuntimeError as error:
        raise InputError(
            "the part cannot be meshed, so it is not known how far it bends: repair its solid in the CAD program."
        ) from error
    if not mesh.ne:
        raise InputError("the part has no volume to mesh: repair its solid in the CAD program.")
    if mesh.ne > MOST_TETRAHEDRA:
        raise InputError(
            f"the part takes {mesh.ne:,} elements, and {MOST_TETRAHEDRA:,} are reckoned with at most: leave small fillets "
            "and holes out of the model."
        )
    return curve(mesh)


def refine_mesh(mesh: Any) -> Any:
    """Cut each element of a mesh into eight."""
    fine = mesh.ngmesh.Copy()
    fine.Refine()
    return curve(fine)


def curve(mesh: Any) -> Any:
    """A mesh for the solver, whose elements follow round faces."""
    made = load_elements().solving.Mesh(mesh)
    made.Curve(2)
    return made
