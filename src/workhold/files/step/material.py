"""The material of a solid along upright lines: the intervals of z in which the line through a point (x, y) is
inside.

An upright line meets most faces at most once: flat ones, and cones about an upright axis on one side of their
tip. It meets such a face where the face's border, seen from above, goes around the line's point: where a ray
from the point crosses the border an odd number of times (M. Shimrat, *Algorithm 112: position of point
relative to polygon*, Communications of the ACM 5 (1962)). All these faces are tested at once, which is much
faster than the library for faces with many edges.

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
from workhold.files.step.faces import SolidFace, find_surface, is_parallel_to_z
from workhold.files.step.library import occ
from workhold.geometry.segment import Arc, Line, Point

__all__ = ["Material", "PlaneFaces"]

Array = NDArray[np.float64]
# A plane or a cone as PlaneFaces holds it.
Sheet = tuple[float, float, float, float, float, float]
# How far in mm a line may miss a face's border and still meet the face.
ON_FACE = 1e-7
# Points times faces that are looked at together.
AT_ONCE = 1 << 18
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
    planes : (F, 6), a row for each of F faces: z in mm at the origin (of a cone, at its axis), slope along x,
        slope along y, and for cones the slope away from the axis and the axis's x and y in mm, otherwise 0.
    lines : (L, 4) start and step (x, y, dx, dy) of the straight edges, in mm, face by face.
    line_ends : (F + 1,) row in ``lines`` at which the edges of each face begin, and the number of rows.
    arcs : (A, 5) centre, radius, middle angle and half the sweep of the round edges, face by face.
    arc_ends : (F + 1,) row in ``arcs`` at which the edges of each face begin, and the number of rows.
    boxes : (F, 4) least x and y, greatest x and y of each face, in mm.
    known : cache of :meth:`surely_contains` by face and point, because all heights ask for the same points.
    """

    planes: Array
    lines: Array
    line_ends: NDArray[np.int64]
    arcs: Array
    arc_ends: NDArray[np.int64]
    boxes: Array
    known: dict[tuple[int, Point], bool] = field(init=False, factory=dict)

    @classmethod
    def from_faces(
        cls, faces: Sequence[SolidFace], edges: Sequence[EdgeCurve]
    ) -> tuple[PlaneFaces, list[int]]:
        """Return (1) the flat faces and cones among ``faces``, and (2) the
        indices of all other faces that are not upright.

        Faces with an edge that is neither line nor arc seen from above are in (2). ``edges`` are those of all
        faces.
        """
        planes = {
            k: plane
            for k, face in enumerate(faces)
            if (plane := find_plane(face) or find_cone(face)) is not None
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

    def find_crossing_heights(self, point: Point) -> list[float]:
        """Return the z in mm, unsorted, at which the upright line through a point meets the faces."""
        near = np.flatnonzero(find_boxes_holding([point], self.boxes)).tolist() if len(self.boxes) else []
        if not near:
            return []
        (levels,) = self.compute_heights_at([point])
        return [float(levels[k]) for k in near if self.contains(k, point)]

    def find_any_crossing_heights(self, points: Sequence[Point], low: float, high: float) -> list[float]:
        """Return for each of N points some z in mm, strictly between ``low`` and ``high``, at which the
        upright line through it meets a face; inf where there is none.

        A face counts only if both rays of :meth:`surely_contains` find the point in it.
        """
        if not len(self.planes):
            return [inf] * len(points)
        levels = self.compute_heights_at(points)
        near = find_boxes_holding(points, self.boxes) & (low < levels) & (levels < high)
        return [
            next(
                (float(own[k]) for k in np.flatnonzero(is_near).tolist() if self.surely_contains(k, point)),
                inf,
            )
            for point, own, is_near in zip(points, levels, near, strict=True)
        ]

    def surely_contains(self, face: int, point: Point) -> bool:
        """Return whether two rays in different directions both
        find a point in the face with this index, seen from above.
        """
        key = face, point
        if key not in self.known:
            self.known[key] = self.contains(face, point) and self.contains(face, point, OTHER_RAY)
        return self.known[key]

    def compute_heights_at(self, points: Sequence[Point]) -> Array:
        """Return (N, F), the z in mm over each of N points of each of F faces, as if its plane or cone had no
        border.
        """
        origin, rise_x, rise_y, outward, axis_x, axis_y = self.planes.T
        x, y = np.array(points)[:, :, None].transpose(1, 0, 2)
        away = np.hypot(x - axis_x, y - axis_y)
        levels: Array = origin + rise_x * x + rise_y * y + outward * away
        return levels

    def contains(self, face: int, point: Point, ray: Point = RAY) -> bool:
        """Return whether the face with this index contains a point, seen from above.

        Parameters
        ----------
        ray : unit vector of the ray from the point whose crossings with the border are counted.
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


def find_boxes_holding(points: Sequence[Point], boxes: Array, more: float = 0.0) -> NDArray[np.bool_]:
    """Return booleans (N, F): whether each of N points (x, y) lies in each of F boxes.

    The first four columns of ``boxes`` are x0, y0, x1, y1 in mm; each box is widened by ``more`` mm on all
    sides.
    """
    x, y = np.array(points)[:, :, None].transpose(1, 0, 2)
    near: NDArray[np.bool_] = (boxes[:, 0] - more <= x) & (x <= boxes[:, 2] + more)
    near &= (boxes[:, 1] - more <= y) & (y <= boxes[:, 3] + more)
    return near


def find_plane(face: SolidFace) -> Sheet | None:
    """Return a face's plane as a row of :class:`PlaneFaces`;
    None for an upright face and for one that is not flat.
    """
    surface: Any = find_surface(face.shape)
    if face.lie == "upright" or surface.GetType() != occ.GeomAbs_Plane:
        return None
    if face.lie == "level":
        return face.low, 0.0, 0.0, 0.0, 0.0, 0.0
    normal, place = surface.Plane().Axis().Direction(), surface.Plane().Location()
    rise_x, rise_y = -normal.X() / normal.Z(), -normal.Y() / normal.Z()
    return place.Z() - rise_x * place.X() - rise_y * place.Y(), rise_x, rise_y, 0.0, 0.0, 0.0


def find_cone(face: SolidFace) -> Sheet | None:
    """Return a face's upright cone as a row of :class:`PlaneFaces`; None for other faces and for a cone that
    reaches over both sides of its tip.
    """
    surface = occ.BRepAdaptor_Surface(face.shape)
    if surface.GetType() != occ.GeomAbs_Cone or not is_parallel_to_z(surface.Cone().Axis()):
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
    """The intervals in which upright lines run inside a solid, found on demand and cached.

    Such lines do not meet upright faces.

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
    # The library's upright line and a point of it, moved from place to place: making others takes as long as
    # asking a face.
    foot: Any = field(init=False)
    upward: Any = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.flat, others = PlaneFaces.from_faces(self.faces, self.edges)
        # The lowest first: what is met low is reached at more heights.
        met = sorted((self.faces[k] for k in others), key=lambda face: face.low)
        self.meeting = [occ.IntCurvesFace_Intersector(face.shape, ON_FACE) for face in met]
        self.boxes = np.array([(*face.box, face.low, face.high) for face in met]).reshape(-1, 6)
        self.below = min(face.low for face in self.faces) - 1.0
        self.foot = occ.gp_Pnt()
        self.upward = occ.gp_Lin(self.foot, occ.gp_Dir(0.0, 0.0, 1.0))

    def find_material_intervals(
        self, point: Point, near: Sequence[int] | None = None
    ) -> list[tuple[float, float]]:
        """Return the intervals (z0, z1) in mm of the upright line through a point (x, y), from the lowest up.

        ``near`` are indices in ``meeting`` of the faces that may lie over the point, where the caller knows
        them.
        """
        if point not in self.known:
            near = np.flatnonzero(self.find_faces_near([point])).tolist() if near is None else near
            heights = self.find_crossing_heights(point, near)
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
        """Return whether the point (x, y, z) is inside the solid."""
        if self.classifier is None:
            # It looks at the whole solid first, which takes much longer than each of its answers.
            self.classifier = occ.BRepClass3d_SolidClassifier(self.shape)
        self.classifier.Perform(occ.gp_Pnt(*point, z), 1e-7)
        return bool(self.classifier.State() == occ.TopAbs_IN)

    def find_crossing_heights(self, point: Point, near: Sequence[int]) -> list[float]:
        """Return the sorted z in mm at which the upright line through a point meets a face.

        ``near`` is as in :meth:`find_material_intervals`.
        """
        found = self.flat.find_crossing_heights(point)
        for index in near:
            found += self.find_crossings_with_face(point, index)
        return sorted(found)

    def find_faces_near(self, points: Sequence[Point]) -> NDArray[np.bool_]:
        """Return (N, F), whether the box of each of the F faces in ``meeting`` is over each of N points."""
        return find_boxes_holding(points, self.boxes, ON_FACE)

    def find_crossings_with_face(self, point: Point, index: int) -> list[float]:
        """Return the z in mm at which the upright line through a point meets the face ``meeting[index]``."""
        key = point, index
        if key not in self.hits:
            face = self.meeting[index]
            self.foot.SetCoord(*point, self.below)
            self.upward.SetLocation(self.foot)
            face.Perform(self.upward, -1.0, 1e7)
            met = range(1, face.NbPnt() + 1) if face.IsDone() else ()
            self.hits[key] = [self.below + face.WParameter(k) for k in met]
        return self.hits[key]

    def lies_between(self, points: Sequence[Point], low: float, high: float) -> list[bool]:
        """Return for each point whether the upright line
        through it has material strictly between two z in mm.
        """
        # Outlines of all heights ask for the same points, and what is reached stays so as the height grows.
        bounds = [self.reached.get((point, low), (inf, -inf)) for point in points]
        fresh = [point for point, (least, most) in zip(points, bounds, strict=True) if most < high < least]
        if not fresh:
            return [high >= least for least, _ in bounds]
        fresh = list(dict.fromkeys(fresh))
        step = max(1, AT_ONCE // len(self.faces))
        for first in range(0, len(fresh), step):
            some = fresh[first : first + step]
            for point, reached in zip(some, self.find_within(some, low, high), strict=True):
                least, most = self.reached.get((point, low), (inf, -inf))
                self.reached[point, low] = (reached, most) if reached <= high else (least, high)
        return [high >= self.reached[point, low][0] for point in points]

    def find_within(self, points: Sequence[Point], low: float, high: float) -> list[float]:
        """Return for each point an upper z in mm such that the range from ``low`` to it contains material.

        It is at most ``high``, and inf if there is no material between ``low`` and ``high``. It need not be
        the least such z.
        """
        # A face has material on one of its sides, so one hit within is enough. Flat faces are asked first,
        # because they answer much faster.
        inner = low + 2 * SAME_HEIGHT, high - 2 * SAME_HEIGHT
        found = self.flat.find_any_crossing_heights(points, *inner)
        near = self.find_faces_near(points)
        crossed = list_marked_columns(near & (self.boxes[:, 4] < inner[1]) & (self.boxes[:, 5] > inner[0]))
        every = list_marked_columns(near)
        for number, point in enumerate(points):
            if found[number] == inf:
                hits = (z for k in crossed[number] for z in self.find_crossings_with_face(point, k))
                found[number] = next((z for z in hits if inner[0] < z < inner[1]), inf)
            if found[number] < inf:
                found[number] = min(found[number] + 3 * SAME_HEIGHT, high)
            elif any(
                min(end, high) - max(start, low) > SAME_HEIGHT
                for start, end in self.find_material_intervals(point, every[number])
            ):
                found[number] = high
        return found


def list_marked_columns(marked: NDArray[np.bool_]) -> list[list[int]]:
    """Return for each row of an array (N, M) the sorted indices of the columns that are True."""
    found: list[list[int]] = [[] for _ in marked]
    for row, column in np.argwhere(marked).tolist():
        found[row].append(column)
    return found
