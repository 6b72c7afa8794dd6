"""The material of a solid along upright lines: where a line through a point of the plane runs inside it.

Most faces are met once: flat ones, and cones about an upright axis on one side of their tip. A line meets
such a face where its border, seen from above, goes around the line's point. That is so when a ray from the
point crosses the border an odd number of times (M. Shimrat, *Algorithm 112: position of point relative to
polygon*, Communications of the ACM 5 (1962)). All these faces are asked at once, which is much faster than
the library for faces with many edges.

Glossary
--------
interval : a range of z in mm in which an upright line runs inside the solid.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf, pi, sin, tan, tau
from typing import Any

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT, SHORTEST
from workhold.files.step.edge_curves import EdgeCurve
from workhold.files.step.faces import SolidFace, is_upright, surface_of
from workhold.files.step.library import occ
from workhold.geometry.segment import Arc, Line, Point

__all__ = ["Material", "PlaneFaces"]

Array = NDArray[np.float64]
# A plane or a cone as PlaneFaces holds it.
Sheet = tuple[float, float, float, float, float, float]
# How far in mm a line may miss a face's border and still meet the face.
ON_FACE = 1e-7
# How much wider than the library says, in mm, the boxes of faces are taken.
ROUND = 1e-6
# The direction of rays, and another: ones in which no line of a drawing is likely to run, nor two of its
# points to lie.
RAY, OTHER_RAY = (0.7548776662, 0.6558656181), (-0.5698402910, 0.8217609881)


@frozen(eq=False)
class PlaneFaces:
    """Flat faces and upright cones, bordered by lines and arcs as seen from above.

    Parameters
    ----------
    planes : (F, 6) of each face: z in mm at the origin, and how much it rises along x and y. Of cones how
        much they rise away from the axis, and x and y of the axis in mm.
    lines : (L, 4) start and step of the straight edges, in mm.
    line_ends : (F + 1,) where the edges of each face begin, and those of the last end.
    arcs : (A, 5) centre, radius, middle angle and half the sweep of the round edges.
    arc_ends : (F + 1,) where the round edges of each face begin, and those of the last end.
    boxes : (F, 4) least x and y, greatest x and y of each face, in mm.
    known : whether faces hold points by both rays, once that was asked: all heights ask for the same points.
    """

    planes: Array
    lines: Array
    line_ends: NDArray[np.int64]
    arcs: Array
    arc_ends: NDArray[np.int64]
    boxes: Array
    known: dict[tuple[int, Point], bool] = field(init=False, factory=dict)

    @classmethod
    def of(cls, faces: Sequence[SolidFace], edges: Sequence[EdgeCurve]) -> tuple[PlaneFaces, list[int]]:
        """The flat ones and the cones of some faces, and the indices of others that are not upright.

        Parameters
        ----------
        edges : of all faces.
        """
        planes = {
            k: plane for k, face in enumerate(faces) if (plane := plane_of(face) or cone_of(face)) is not None
        }
        for edge in edges:
            if edge.is_other:
                planes.pop(edge.face, None)
        number = {face: k for k, face in enumerate(planes)}
        lines: list[list[tuple[float, ...]]] = [[] for _ in number]
        arcs: list[list[tuple[float, ...]]] = [[] for _ in number]
        for edge in edges:
            if edge.face not in number:
                continue
            if isinstance(edge.segment, Line):
                (x0, y0), (x1, y1) = edge.segment.start, edge.segment.end
                lines[number[edge.face]].append((x0, y0, x1 - x0, y1 - y0))
            elif isinstance(edge.segment, Arc):
                one = edge.segment
                arcs[number[edge.face]].append((*one.center, one.radius, one.mid_angle, one.half_sweep))
        others = [k for k, face in enumerate(faces) if face.lie != "upright" and k not in number]
        made = cls(
            np.array(list(planes.values())).reshape(-1, 6),
            np.array([row for own in lines for row in own]).reshape(-1, 4),
            np.cumsum([0, *map(len, lines)]),
            np.array([row for own in arcs for row in own]).reshape(-1, 5),
            np.cumsum([0, *map(len, arcs)]),
            np.array([faces[k].box for k in number]).reshape(-1, 4) + ROUND * np.array([-1, -1, 1, 1]),
        )
        return made, others

    def heights(self, point: Point) -> list[float]:
        """The z in mm at which the upright line through a point meets the faces, in any order."""
        levels = self.levels(point)
        return [float(levels[k]) for k in np.flatnonzero(self.near(point)).tolist() if self.holds(k, point)]

    def meets(self, point: Point, low: float, high: float) -> bool:
        """Whether the upright line through a point meets a face between two z in mm; two rays must agree."""
        levels = self.levels(point)
        near = self.near(point) & (low < levels) & (levels < high)
        return any(self.surely_holds(k, point) for k in np.flatnonzero(near).tolist())

    def surely_holds(self, face: int, point: Point) -> bool:
        """Whether both rays find a point in a face of a number."""
        key = face, point
        if key not in self.known:
            self.known[key] = self.holds(face, point) and self.holds(face, point, OTHER_RAY)
        return self.known[key]

    def levels(self, point: Point) -> Array:
        """The z (F,) in mm of each face's plane or cone at a point."""
        origin, rise_x, rise_y, outward, axis_x, axis_y = self.planes.T
        away = np.hypot(point[0] - axis_x, point[1] - axis_y)
        levels: Array = origin + rise_x * point[0] + rise_y * point[1] + outward * away
        return levels

    def near(self, point: Point) -> NDArray[np.bool_]:
        """Which faces (F,) have a point in their box."""
        (x, y), boxes = point, self.boxes
        return (boxes[:, 0] <= x) & (x <= boxes[:, 2]) & (boxes[:, 1] <= y) & (y <= boxes[:, 3])

    def holds(self, face: int, point: Point, ray: Point = RAY) -> bool:
        """Whether a face of a number holds a point, seen from above.

        Parameters
        ----------
        ray : unit vector, see the head of the file.
        """
        (x, y), (dx, dy) = point, ray
        px, py, sx, sy = self.lines[self.line_ends[face] : self.line_ends[face + 1]].T
        across = dx * sy - dy * sx
        with np.errstate(divide="ignore", invalid="ignore"):
            along = ((px - x) * sy - (py - y) * sx) / across
            share = ((px - x) * dy - (py - y) * dx) / across
        met = int(np.count_nonzero((along > 0) & (share >= 0) & (share < 1)))
        cx, cy, radius, middle, half = self.arcs[self.arc_ends[face] : self.arc_ends[face + 1]].T
        if len(cx):
            ahead = (cx - x) * dx + (cy - y) * dy
            aside = (cx - x) * dy - (cy - y) * dx
            square = radius * radius - aside * aside
            root = np.sqrt(np.maximum(square, 0.0))
            for away in (ahead - root, ahead + root):
                angle = np.arctan2(y + away * dy - cy, x + away * dx - cx)
                apart = np.abs((angle - middle + pi) % tau - pi)
                met += int(np.count_nonzero((square > 0) & (away > 0) & (apart <= half)))
        return met % 2 == 1


def plane_of(face: SolidFace) -> Sheet | None:
    """A face's plane, see :class:`PlaneFaces`; None for an upright face and for one that is not flat."""
    surface: Any = surface_of(face.shape)
    if face.lie == "upright" or surface.GetType() != occ.GeomAbs_Plane:
        return None
    if face.lie == "level":
        return face.low, 0.0, 0.0, 0.0, 0.0, 0.0
    normal, place = surface.Plane().Axis().Direction(), surface.Plane().Location()
    rise_x, rise_y = -normal.X() / normal.Z(), -normal.Y() / normal.Z()
    return place.Z() - rise_x * place.X() - rise_y * place.Y(), rise_x, rise_y, 0.0, 0.0, 0.0


def cone_of(face: SolidFace) -> Sheet | None:
    """A face's cone, see :class:`PlaneFaces`; None for others and for both sides of a tip."""
    surface = occ.BRepAdaptor_Surface(face.shape)
    if surface.GetType() != occ.GeomAbs_Cone or not is_upright(surface.Cone().Axis()):
        return None
    cone = surface.Cone()
    ends = surface.FirstVParameter(), surface.LastVParameter()
    radii = [cone.RefRadius() + v * sin(cone.SemiAngle()) for v in ends]
    if min(radii) < -SHORTEST and max(radii) > SHORTEST:
        return None
    # Beyond the tip radii are below 0, and what rises outward falls.
    side = 1.0 if sum(radii) > 0.0 else -1.0
    rise = cone.Axis().Direction().Z() / tan(cone.SemiAngle())
    place = cone.Location()
    return place.Z() - rise * cone.RefRadius(), 0.0, 0.0, side * rise, place.X(), place.Y()


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
    # By point and lower height: the least upper height for which material was found, and the greatest for which
    # none was.
    reached: dict[tuple[Point, float], tuple[float, float]] = field(init=False, factory=dict)
    classifier: Any = field(init=False, default=None)

    def __attrs_post_init__(self) -> None:
        self.flat, others = PlaneFaces.of(self.faces, self.edges)
        met = [self.faces[k] for k in others]
        self.meeting = [occ.IntCurvesFace_Intersector(face.shape, ON_FACE) for face in met]
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
        if self.classifier is None:
            # It looks at the whole solid first, which takes much longer than each of its answers.
            self.classifier = occ.BRepClass3d_SolidClassifier(self.shape)
        self.classifier.Perform(occ.gp_Pnt(*point, z), 1e-7)
        return bool(self.classifier.State() == occ.TopAbs_IN)

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
        key = point, index
        if key not in self.hits:
            face = self.meeting[index]
            face.Perform(occ.gp_Lin(occ.gp_Pnt(*point, self.below), occ.gp_Dir(0.0, 0.0, 1.0)), -1.0, 1e7)
            met = range(1, face.NbPnt() + 1) if face.IsDone() else ()
            self.hits[key] = [self.below + face.WParameter(k) for k in met]
        return self.hits[key]

    def reaches_into(self, point: Point, low: float, high: float) -> bool:
        """Whether some material over a point lies strictly between two z in mm."""
        # Outlines of all heights ask for the same points, and what is reached stays so as the height grows.
        least, most = self.reached.get((point, low), (inf, -inf))
        if not most < high < least:
            return high >= least
        is_reached = self.finds_within(point, low, high)
        self.reached[point, low] = (high, most) if is_reached else (least, high)
        return is_reached

    def finds_within(self, point: Point, low: float, high: float) -> bool:
        """Finds what :meth:`reaches_into` returns."""
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
