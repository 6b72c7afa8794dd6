"""Flat faces that upright lines meet: all faces whose border, seen from above, goes around the line's point.

A point is in a face when a ray from it crosses the face's border an odd number of times (M. Shimrat,
*Algorithm 112: position of point relative to polygon*, Communications of the ACM 5 (1962)). All faces are
asked at once, which is much faster than the library for faces with many holes.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, tau
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.files.step.edge_curves import EdgeCurve
from workhold.files.step.faces import SolidFace, surface_of
from workhold.geometry.segment import Arc, Line, Point

__all__ = ["PlaneFaces"]

Array = NDArray[np.float64]
# The direction of rays: one in which no line of a drawing is likely to run, nor two of its points to lie.
RAY = (0.7548776662, 0.6558656181)


@frozen(eq=False)
class PlaneFaces:
    """Flat faces that are not upright, bordered by lines and arcs as seen from above.

    Parameters
    ----------
    planes : (F, 3) of each face: z in mm at the origin, and how much it rises along x and y.
    lines : (L, 4) start and step of the straight edges, in mm.
    line_face : (L,) the face of each.
    arcs : (A, 5) centre, radius, middle angle and half the sweep of the round edges.
    arc_face : (A,) the face of each.
    """

    planes: Array
    lines: Array
    line_face: NDArray[np.int64]
    arcs: Array
    arc_face: NDArray[np.int64]

    @classmethod
    def of(cls, faces: Sequence[SolidFace], edges: Sequence[EdgeCurve]) -> tuple[PlaneFaces, list[int]]:
        """The flat ones of some faces, and the indices of the others, upright ones left out.

        Parameters
        ----------
        edges : of all faces.
        """
        planes = {k: plane for k, face in enumerate(faces) if (plane := plane_of(face)) is not None}
        for edge in edges:
            if edge.is_other:
                planes.pop(edge.face, None)
        number = {face: k for k, face in enumerate(planes)}
        lines, line_face, arcs, arc_face = [], [], [], []
        for edge in edges:
            if edge.face not in number:
                continue
            if isinstance(edge.segment, Line):
                (x0, y0), (x1, y1) = edge.segment.start, edge.segment.end
                lines.append((x0, y0, x1 - x0, y1 - y0))
                line_face.append(number[edge.face])
            elif isinstance(edge.segment, Arc):
                one = edge.segment
                arcs.append((*one.center, one.radius, one.mid_angle, one.half_sweep))
                arc_face.append(number[edge.face])
        others = [k for k, face in enumerate(faces) if face.lie != "upright" and k not in number]
        made = cls(
            np.array(list(planes.values())).reshape(-1, 3),
            np.array(lines).reshape(-1, 4),
            np.array(line_face, np.int64),
            np.array(arcs).reshape(-1, 5),
            np.array(arc_face, np.int64),
        )
        return made, others

    def heights(self, point: Point) -> list[float]:
        """The z in mm at which the upright line through a point meets the faces, in any order."""
        (x, y), (dx, dy) = point, RAY
        px, py, sx, sy = self.lines.T
        across = dx * sy - dy * sx
        with np.errstate(divide="ignore", invalid="ignore"):
            along = ((px - x) * sy - (py - y) * sx) / across
            share = ((px - x) * dy - (py - y) * dx) / across
        met = [self.line_face[(along > 0) & (share >= 0) & (share < 1)]]
        cx, cy, radius, middle, half = self.arcs.T
        ahead = (cx - x) * dx + (cy - y) * dy
        aside = (cx - x) * dy - (cy - y) * dx
        square = radius * radius - aside * aside
        root = np.sqrt(np.maximum(square, 0.0))
        for away in (ahead - root, ahead + root):
            angle = np.arctan2(y + away * dy - cy, x + away * dx - cx)
            apart = np.abs((angle - middle + pi) % tau - pi)
            met.append(self.arc_face[(square > 0) & (away > 0) & (apart <= half)])
        inside = np.bincount(np.concatenate(met), minlength=len(self.planes)) % 2 == 1
        return [float(z + a * x + b * y) for z, a, b in self.planes[inside]]


def plane_of(face: SolidFace) -> tuple[float, float, float] | None:
    """The z of a face's plane at the origin in mm, and how much it rises along x and y.

    None for an upright face and for one that is not flat.
    """
    from OCP.GeomAbs import GeomAbs_SurfaceType as Type

    surface: Any = surface_of(face.shape)
    if face.lie == "upright" or surface.GetType() != Type.GeomAbs_Plane:
        return None
    if face.lie == "level":
        return face.low, 0.0, 0.0
    normal, place = surface.Plane().Axis().Direction(), surface.Plane().Location()
    rise_x, rise_y = -normal.X() / normal.Z(), -normal.Y() / normal.Z()
    return place.Z() - rise_x * place.X() - rise_y * place.Y(), rise_x, rise_y
