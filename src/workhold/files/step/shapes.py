"""Shapes of Open CASCADE that another library has made: solids seen along an axis, or flat faces as they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from workhold.conventions import ALIGNED, SAME_HEIGHT
from workhold.errors import InputError
from workhold.files.outline.chain import Drawing
from workhold.files.questions import AXIS
from workhold.files.step.library import load_step_library
from workhold.files.step.reader import border_remarks, read_solid
from workhold.files.step.regions import borders, level_region, union
from workhold.files.step.solids import AXES, along, bounding_box, numbered, sub_shapes

__all__ = ["read_shapes"]


def read_shapes(
    shapes: Sequence[Any],
    *,
    axis: str | None = None,
    section_height: float | None = None,
    part_number: int | None = None,
    fit: float | None = None,
) -> tuple[Drawing, int | None]:
    """The drawing of some shapes, and the number of the part that is still to be taken of it.

    Parameters
    ----------
    shapes : of Open CASCADE, in mm.
    axis, section_height, part_number, fit : see :func:`workhold.files.step.reader.read_step`. Faces that lie level
        to an axis need not be told which.

    Raises
    ------
    InputError
        For shapes with neither a solid nor a face, solids as in :func:`workhold.files.step.reader.read_step`, and faces that
        are not flat, or do not lie level to an axis at one height.
    """
    load_step_library()
    solids = [solid for shape in shapes for solid in sub_shapes(shape, "SOLID")]
    if solids:
        return read_solid(numbered(solids), axis, section_height, part_number, fit), None
    faces = [face for shape in shapes for face in sub_shapes(shape, "FACE")]
    if not faces:
        raise InputError("the shape has neither a face nor a solid: make a face of its outline first.")
    if section_height is not None:
        raise InputError("a section is taken of solids, and this is a face: leave the section out.")
    axes = [axis.strip().lower()] if axis else [*AXES]
    views = [[one for face in faces for one in sub_shapes(along(face, name), "FACE")] for name in axes if name in AXES]
    level = [view for view in views if lie_level(view)]
    if not level:
        raise InputError(
            f"the faces are not flat, level to an axis and at one height: move them there, or give {AXIS}."
        )
    edges = borders(union([level_region(face, bounding_box(face)[0][2], True) for face in level[0]]), fit)
    return Drawing(edges.chains, tuple(border_remarks(edges)), edges.curves), part_number


def lie_level(faces: Sequence[Any]) -> bool:
    """Whether faces are flat and level, all at one height."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType

    heights = []
    for face in faces:
        surface = BRepAdaptor_Surface(face)
        if surface.GetType() != GeomAbs_SurfaceType.GeomAbs_Plane:
            return False
        normal = surface.Plane().Axis().Direction()
        if max(abs(normal.X()), abs(normal.Y())) > ALIGNED:
            return False
        heights.append(surface.Plane().Location().Z())
    return bool(max(heights) - min(heights) <= SAME_HEIGHT)
