"""Parts to bend, and the bodies that they are meshed as."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from workhold import InputError, Workpiece
from workhold.bending.elastic import ElasticBody, PointForces
from workhold.bending.library import load_elements
from workhold.bending.meshing import PartMesh, curve_mesh, make_mesh
from workhold.bending.shape import PrismShape
from workhold.model.elastic_material import ElasticMaterial

Array = NDArray[np.float64]
MODULUS, RATIO = 70_000.0, 0.33
METAL = ElasticMaterial("metal", MODULUS, RATIO, 2700.0)
UP = np.array([0.0, 0.0, 1.0])


def need_elements() -> None:
    """Skip a module where the library is not installed, and load it else as the program does.

    Loaded before the reader of STEP files, as ``importorskip`` would, it ends the process with a crash.
    """
    try:
        load_elements()
    except InputError:
        pytest.skip("the extra 'bending' is not installed", allow_module_level=True)


def block(length: float, width: float) -> Workpiece:
    return Workpiece.from_points("block", [(0, 0), (length, 0), (length, width), (0, width)])


def ring(radius: float, wall: float) -> Workpiece:
    outer, inner = radius + wall / 2, radius - wall / 2
    circles = [[[-far, 0, 1], [far, 0, 1]] for far in (outer, inner)]
    return Workpiece.from_loops("ring", circles)


@cache
def bodies(
    make: Callable[..., Workpiece], sizes: tuple[float, ...], thickness: float
) -> tuple[ElasticBody, ElasticBody]:
    """A part of metal, meshed, and refined once."""
    mesh = make_mesh(PrismShape(make(*sizes), thickness))
    return ElasticBody(mesh, METAL), ElasticBody(refine_mesh(mesh), METAL)


def refine_mesh(mesh: PartMesh) -> PartMesh:
    """A mesh with each element cut into eight."""
    fine = mesh.made.ngmesh.Copy()
    fine.Refine()
    return curve_mesh(fine)


def even(low: float, high: float, count: int = 24) -> Array:
    """The middles of equal pieces of an interval."""
    return low + (np.arange(count) + 0.5) / count * (high - low)


def over(x: Array | float, y: Array | float, z: Array | float) -> Array:
    """Points (M, 3), every x with every y and z."""
    return np.stack([one.ravel() for one in np.meshgrid(x, y, z, indexing="ij")], axis=1)


def shared(
    points: Array, force: tuple[float, float, float], outward: tuple[float, float, float]
) -> PointForces:
    """A force shared out evenly among points."""
    return PointForces(
        points, np.tile(np.array(force) / len(points), (len(points), 1)), np.array(outward, float)
    )


def moved(body: ElasticBody, loads: list[PointForces], reads: list[PointForces]) -> list[float]:
    """What is read of the movement under some loads together."""
    together = sum(load.wrench for load in loads)
    assert np.abs(together).max() < 1e-6
    surface = body.solve_loads([sum(body.compute_work(load) for load in loads)])[0]
    return [float((body.compute_work(read) * surface).sum()) for read in reads]
