"""The curves of a solid that can bound its projection along the axis, as lines and arcs in the plane.

A point on the border of a slab's projection lies on an edge, on a fold of a face, or on the cut at either end
of the slab. Further curves do no harm, because only pieces with material on one side are
taken. So curves are taken whole where that is simple.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.files.step.edge_curves import EdgeCurve, Found
from workhold.files.step.faces import SolidFace
from workhold.files.step.level_cuts import level_cuts
from workhold.geometry.segment import Arc, Line, Point, Segment

__all__ = ["ProjectedCurves", "projected_curves"]


@frozen
class ProjectedCurves:
    """All curves that can bound the projection of a slab.

    Parameters
    ----------
    segments : lines and arcs.
    cuts : segments with points at which they are to be cut besides.
    others : of curves that are neither, the face's index and (N, 2) points in mm.
    """

    segments: tuple[Segment, ...]
    cuts: tuple[tuple[Segment, Point], ...]
    others: tuple[tuple[int, NDArray[np.float64]], ...]


def projected_curves(
    faces: Sequence[SolidFace],
    edges: Sequence[EdgeCurve],
    low: float,
    high: float,
    folds_of: Callable[[int], Sequence[Found]],
) -> ProjectedCurves:
    """Every curve that can bound the projection of the slab between two z in mm.

    Parameters
    ----------
    folds_of : the folds of the face of a number, see ``files.step.folds``; they are the same for all slabs.
    """
    segments: list[Segment] = []
    cuts: list[tuple[Segment, Point]] = []
    others: list[tuple[int, NDArray[np.float64]]] = []
    for edge in edges:
        # A wall that reaches up into the slab stands on edges below it.
        reaches_up = faces[edge.face].lie == "upright" and faces[edge.face].high > low + SAME_HEIGHT
        if (edge.high < low - SAME_HEIGHT and not reaches_up) or edge.low > high + SAME_HEIGHT:
            continue
        if edge.segment is not None:
            segments.append(edge.segment)
            cuts += [(edge.segment, point) for z in (low, high) for point in edge.crossings(z)]
        elif edge.is_other:
            others.append((edge.face, edge.points[:, :2]))
    for index, face in enumerate(faces):
        if face.lie != "leaning" or face.high < low - SAME_HEIGHT or face.low > high + SAME_HEIGHT:
            continue
        levels = [z for z in (low, high) if face.low - SAME_HEIGHT <= z <= face.high + SAME_HEIGHT]
        for found in (*folds_of(index), *(one for z in levels for one in level_cuts(face, z))):
            if isinstance(found, Line | Arc):
                segments.append(found)
            else:
                others.append((index, found))
    return ProjectedCurves(tuple(segments), tuple(cuts), tuple(others))
