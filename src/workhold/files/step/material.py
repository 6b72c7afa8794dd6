"""Where a solid has material: on upright lines, and over points of the plane.

Glossary
--------
interval : a range of z in mm in which an upright line runs inside the solid.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.files.step.edge_curves import EdgeCurve
from workhold.files.step.faces import SolidFace
from workhold.files.step.plane_faces import PlaneFaces
from workhold.geometry.segment import Point

__all__ = ["Material"]

# How far in mm a line may miss a face's border and still meet the face.
ON_FACE = 1e-7


@define
class Material:
    """Answers where a solid's upright lines run inside it. Upright faces are not met by such lines.

    Parameters
    ----------
    shape : Open CASCADE's solid, turned so that the axis points up.
    faces, edges : all faces of the solid, and the edges of each.
    """

    shape: Any
    faces: Sequence[SolidFace]
    edges: Sequence[EdgeCurve]
    flat: PlaneFaces = field(init=False)
    meeting: list[Any] = field(init=False)
    # (F, 6) of each face met: its box seen from above, and its lowest and highest z, in mm.
    boxes: NDArray[np.float64] = field(init=False)
    below: float = field(init=False)
    known: dict[Point, list[tuple[float, float]]] = field(init=False, factory=dict)
    # Heights at which an upright line passes a face that is not flat, by the line's point and the face.
    hits: dict[tuple[Point, int], list[float]] = field(init=False, factory=dict)
    classifier: Any = field(init=False, default=None)

    def __attrs_post_init__(self) -> None:
        from OCP.IntCurvesFace import IntCurvesFace_Intersector

        self.flat, others = PlaneFaces.of(self.faces, self.edges)
        met = [self.faces[k] for k in others]
        self.meeting = [IntCurvesFace_Intersector(face.shape, ON_FACE) for face in met]
        self.boxes = np.array([(*face.box, face.low, face.high) for face in met]).reshape(-1, 6)
        self.below = min(face.low for face in self.faces) - 1.0

    def intervals(self, point: Point) -> list[tuple[float, float]]:
        """The intervals of the upright line through a point (x, y), from the lowest up."""
        if point not in self.known:
            heights = self.heights(point)
            is_clear = all(high - low > SAME_HEIGHT for low, high in pairwise(heights))
            if len(heights) % 2 == 0 and is_clear:
                self.known[point] = list(zip(heights[0::2], heights[1::2], strict=True))
            else:
                # On an edge the line may meet one face too few, or two neighbours at once; then each range is
                # asked for by itself.
                self.known[point] = [
                    (low, high)
                    for low, high in pairwise(heights)
                    if high - low > SAME_HEIGHT and self.is_inside(point, (low + high) / 2)
                ]
        return self.known[point]

    def is_inside(self, point: Point, z: float) -> bool:
        """Whether the solid has material at a point of the plane and a height."""
        from OCP.BRepClass3d import BRepClass3d_SolidClassifier
        from OCP.gp import gp_Pnt
        from OCP.TopAbs import TopAbs_State

        if self.classifier is None:
            # It looks at the whole solid first, which takes much longer than each of its answers.
            self.classifier = BRepClass3d_SolidClassifier(self.shape)
        self.classifier.Perform(gp_Pnt(*point, z), 1e-7)
        return bool(self.classifier.State() == TopAbs_State.TopAbs_IN)

    def heights(self, point: Point) -> list[float]:
        """Sorted z in mm at which the upright line through a point passes a face."""
        found = self.flat.heights(point)
        for index in np.flatnonzero(self.near(point)).tolist():
            found += self.hits_of(point, index)
        return sorted(found)

    def near(self, point: Point) -> NDArray[np.bool_]:
        """Which faces that are not flat may lie over a point, seen by their boxes."""
        (x, y), boxes = point, self.boxes
        near = (boxes[:, 0] - ON_FACE <= x) & (x <= boxes[:, 2] + ON_FACE)
        return near & (boxes[:, 1] - ON_FACE <= y) & (y <= boxes[:, 3] + ON_FACE)

    def hits_of(self, point: Point, index: int) -> list[float]:
        """The z in mm at which the upright line through a point passes a face that is not flat."""
        from OCP.gp import gp_Dir, gp_Lin, gp_Pnt

        key = point, index
        if key not in self.hits:
            face = self.meeting[index]
            face.Perform(gp_Lin(gp_Pnt(*point, self.below), gp_Dir(0.0, 0.0, 1.0)), -1.0, 1e7)
            met = range(1, face.NbPnt() + 1) if face.IsDone() else ()
            self.hits[key] = [self.below + face.WParameter(k) for k in met]
        return self.hits[key]

    def reaches_into(self, point: Point, low: float, high: float) -> bool:
        """Whether some material over a point lies strictly between two z in mm."""
        # A face has material on one of its sides, so one hit within is enough. Flat faces are asked first,
        # because they answer much faster.
        inner = low + 2 * SAME_HEIGHT, high - 2 * SAME_HEIGHT
        if self.flat.meets(point, *inner):
            return True
        near = self.near(point) & (self.boxes[:, 4] < inner[1]) & (self.boxes[:, 5] > inner[0])
        for index in np.flatnonzero(near).tolist():
            if any(inner[0] < z < inner[1] for z in self.hits_of(point, index)):
                return True
        return any(min(end, high) - max(start, low) > SAME_HEIGHT for start, end in self.intervals(point))
