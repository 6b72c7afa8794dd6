"""Where a solid has material: on upright lines, and over points of the plane.

Glossary
--------
interval : a range of z in mm in which an upright line runs inside the solid.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from math import cos, pi, sin, tau
from typing import Any

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.files.step.edge_curves import EdgeCurve
from workhold.files.step.faces import SolidFace
from workhold.geometry.segment import Arc, Point, Segment

__all__ = ["Material"]

# How far beside a face's box its points are looked for, in mm.
BESIDE_BOX = 1e-3
# Borders are turned by this angle in radians before they are crossed, so that no line that a drawing has runs
# along the crossing line.
TURN = 0.7123


@frozen
class LevelBorder:
    """The border of a level face; inside, a line from a point to +x crosses it an odd number of times.

    Parameters
    ----------
    ends : (N, 2) y in mm, turned by ``TURN``, between which each piece of the border rises or falls only.
    lines : (N, 2) of a straight piece x at the first end, and by how much it changes with y.
    circles : (N, 4) of an arc its centre, radius, and 1 for its right half, -1 for its left; else zeros.
    """

    ends: NDArray[np.float64]
    lines: NDArray[np.float64]
    circles: NDArray[np.float64]

    @classmethod
    def of(cls, segments: Sequence[Segment]) -> LevelBorder:
        """The border that segments make, run either way."""
        pieces = [piece for segment in segments for piece in rising_pieces(segment)]
        table = np.array(pieces, np.float64).reshape(-1, 8)
        return cls(table[:, :2], table[:, 2:4], table[:, 4:])

    def has(self, point: Point) -> bool:
        """Whether a point that is not on the border lies inside."""
        x, y = turned(point)
        crossed = np.flatnonzero((self.ends[:, 0] > y) != (self.ends[:, 1] > y))
        center_x, center_y, radius, side = self.circles[crossed].T
        away = np.sqrt(np.maximum(radius**2 - (y - center_y) ** 2, 0.0))
        straight = self.lines[crossed, 0] + self.lines[crossed, 1] * (y - self.ends[crossed, 0])
        at = np.where(radius > 0.0, center_x + side * away, straight)
        return bool(np.count_nonzero(at > x) % 2)


def turned(point: Point) -> Point:
    """A point turned by ``TURN`` about the origin."""
    x, y = point
    return x * cos(TURN) - y * sin(TURN), x * sin(TURN) + y * cos(TURN)


def rising_pieces(segment: Segment) -> list[tuple[float, ...]]:
    """The pieces of a segment over which y, turned, rises or falls only; see :class:`LevelBorder`."""
    if not isinstance(segment, Arc):
        (x0, y0), (x1, y1) = turned(segment.start), turned(segment.end)
        return [(y0, y1, x0, (x1 - x0) / (y1 - y0), 0.0, 0.0, 0.0, 0.0)] if y0 != y1 else []
    x, y = turned(segment.center)
    low = segment.mid_angle - segment.half_sweep + TURN
    high = low + 2 * segment.half_sweep
    first = np.ceil((low - pi / 2) / pi) * pi + pi / 2
    angles = [low, *(angle for angle in np.arange(first, high, pi) if low < angle < high), high]
    pieces = list[tuple[float, ...]]()
    for a, b in pairwise(angles):
        ends = y + segment.radius * sin(a), y + segment.radius * sin(b)
        side = 1.0 if cos((a + b) / 2 % tau) > 0 else -1.0
        pieces.append((*ends, 0.0, 0.0, x, y, segment.radius, side))
    return pieces


@define
class Material:
    """Answers where a solid's upright lines run inside it. Upright faces are not met by such lines.

    Parameters
    ----------
    shape : Open CASCADE's solid, turned so that the axis points up.
    faces, edges : all faces of the solid, and their edges.
    """

    shape: Any
    faces: Sequence[SolidFace]
    edges: Sequence[EdgeCurve]
    level: dict[int, LevelBorder] = field(init=False, factory=dict)
    meeting: dict[int, Any] = field(init=False, factory=dict)
    boxes: NDArray[np.float64] = field(init=False)
    below: float = field(init=False)
    known: dict[Point, list[tuple[float, float]]] = field(init=False, factory=dict)

    def __attrs_post_init__(self) -> None:
        borders = defaultdict[int, list[EdgeCurve]](list)
        for edge in self.edges:
            borders[edge.face].append(edge)
        for index, edges in borders.items():
            segments = [edge.segment for edge in edges if edge.segment is not None]
            if self.faces[index].lie == "level" and len(segments) == len(edges):
                self.level[index] = LevelBorder.of(segments)
        nowhere = (np.inf, np.inf, -np.inf, -np.inf)
        boxes = [face.box if face.lie != "upright" else nowhere for face in self.faces]
        self.boxes = np.array(boxes) + np.array([-BESIDE_BOX, -BESIDE_BOX, BESIDE_BOX, BESIDE_BOX])
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
        x, y = point
        left, lower, right, upper = self.boxes.T
        near = np.flatnonzero((left <= x) & (x <= right) & (lower <= y) & (y <= upper))
        found = []
        for index in near.tolist():
            border = self.level.get(index)
            if border is None:
                found += self.met(index, point)
            elif border.has(point):
                found.append(self.faces[index].low)
        return sorted(found)

    def met(self, index: int, point: Point) -> list[float]:
        """The z in mm at which the upright line through a point meets a face, as the library finds them."""
        from OCP.gp import gp_Dir, gp_Lin, gp_Pnt
        from OCP.IntCurvesFace import IntCurvesFace_Intersector

        if index not in self.meeting:
            self.meeting[index] = IntCurvesFace_Intersector(self.faces[index].shape, 1e-7)
        meeting = self.meeting[index]
        meeting.Perform(gp_Lin(gp_Pnt(point[0], point[1], self.below), gp_Dir(0.0, 0.0, 1.0)), -1.0, 1e7)
        if not meeting.IsDone():
            return []
        return [self.below + meeting.WParameter(k) for k in range(1, meeting.NbPnt() + 1)]

    def reaches_into(self, point: Point, low: float, high: float) -> bool:
        """Whether some material over a point lies strictly between two z in mm."""
        return any(min(end, high) - max(start, low) > SAME_HEIGHT for start, end in self.intervals(point))
