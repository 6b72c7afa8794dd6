"""Where a solid has material: on upright lines, and over points of the plane.

Glossary
--------
interval : a range of z in mm in which an upright line runs inside the solid.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from attrs import define, field

from workhold.conventions import SAME_HEIGHT
from workhold.files.step.faces import SolidFace
from workhold.geometry.segment import Point

__all__ = ["Material"]


@define
class Material:
    """Answers where a solid's upright lines run inside it. Upright faces are not met by such lines.

    Parameters
    ----------
    shape : Open CASCADE's solid, turned so that the axis points up.
    faces : all faces of the solid.
    """

    shape: Any
    faces: Sequence[SolidFace]
    meeting: Any = field(init=False)
    below: float = field(init=False)
    known: dict[Point, list[tuple[float, float]]] = field(init=False, factory=dict)

    def __attrs_post_init__(self) -> None:
        from OCP.BRep import BRep_Builder
        from OCP.IntCurvesFace import IntCurvesFace_ShapeIntersector
        from OCP.TopoDS import TopoDS_Compound

        together, builder = TopoDS_Compound(), BRep_Builder()
        builder.MakeCompound(together)
        for face in self.faces:
            if face.lie != "upright":
                builder.Add(together, face.shape)
        self.meeting = IntCurvesFace_ShapeIntersector()
        self.meeting.Load(together, 1e-7)
        self.below = min(face.low for face in self.faces) - 1.0

    def intervals(self, point: Point) -> list[tuple[float, float]]:
        """The intervals of the upright line through a point (x, y), from the lowest up."""
        if point not in self.known:
            heights = self.heights(point)
            if len(heights) % 2 == 0:
                self.known[point] = list(zip(heights[0::2], heights[1::2], strict=True))
            else:
                # Near an edge the line may meet one face too few; then each range is asked for by itself.
                self.known[point] = [
                    (low, high) for low, high in pairwise(heights) if self.is_inside(point, (low + high) / 2)
                ]
        return self.known[point]

    def is_inside(self, point: Point, z: float) -> bool:
        """Whether the solid has material at a point of the plane and a height."""
        from OCP.BRepClass3d import BRepClass3d_SolidClassifier
        from OCP.gp import gp_Pnt
        from OCP.TopAbs import TopAbs_State

        classifier = BRepClass3d_SolidClassifier(self.shape, gp_Pnt(*point, z), 1e-7)
        return bool(classifier.State() == TopAbs_State.TopAbs_IN)

    def heights(self, point: Point) -> list[float]:
        """Sorted z in mm at which the upright line through a point passes a face."""
        from OCP.gp import gp_Dir, gp_Lin, gp_Pnt

        line = gp_Lin(gp_Pnt(point[0], point[1], self.below), gp_Dir(0.0, 0.0, 1.0))
        self.meeting.Perform(line, -1.0, 1e7)
        if not self.meeting.IsDone():
            return []
        found = sorted(self.meeting.WParameter(k) for k in range(1, self.meeting.NbPnt() + 1))
        return [self.below + value for value in found]

    def reaches_into(self, point: Point, low: float, high: float) -> bool:
        """Whether some material over a point lies strictly between two z in mm."""
        return any(min(end, high) - max(start, low) > SAME_HEIGHT for start, end in self.intervals(point))
