"""Outlines by height: what pegs that reach over some heights may run into, and what they may touch.

The outline U(a, p) is the projection of what a solid has between two heights. Its border consists of edges,
folds and cuts (see ``files.step.projected``); which pieces of these it has is decided by the material beside
them.

Glossary
--------
peg height : the height p in mm above the plane on which the part lies up to which pegs reach.
head room : what is kept free above the pegs, in mm.
interval : a range of z in mm in which an upright line runs inside the solid.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.errors import InputError
from workhold.files.step.bands import Walls
from workhold.files.step.edge_curves import EdgeCurve, Found, edge_curves
from workhold.files.step.faces import SolidFace, plane_height, solid_faces
from workhold.files.step.folds import folds
from workhold.files.step.library import bounding_box, occ, sub_shapes
from workhold.files.step.plane_faces import PlaneFaces
from workhold.files.step.projected import FLAT, ProjectedCurves, other_curve, projected_curves, refuse_others
from workhold.files.step.strips import Strip, strips_of_loop
from workhold.geometry.segment import Point
from workhold.geometry.subdivision import BorderPiece, border_loops, border_pieces, subdivide

__all__ = ["HEAD_ROOM", "LEAST_BAND", "HeightOutline", "Material", "StandingSolid"]

# What is kept free above the pegs, and the shortest band that may be touched, both in mm.
HEAD_ROOM, LEAST_BAND = 0.5, 1.0
# How far in mm a line may miss a face's border and still meet the face.
ON_FACE = 1e-7


@frozen
class HeightOutline:
    """The outline between two heights with what may be touched of it.

    Parameters
    ----------
    loops : strips in running order with the material on the left; the largest outer loop first.
    peg_height, head_room, least_band : in mm.
    """

    loops: tuple[tuple[Strip, ...], ...]
    peg_height: float
    head_room: float
    least_band: float


@define
class StandingSolid:
    """A solid with its axis up and its lowest point at height 0.

    Parameters
    ----------
    shape : Open CASCADE's solid in mm, its axis along z.
    edge_boxes : (E, 5) of every edge the least x and y, the greatest x and y, and the greatest z, in mm.
    """

    shape: Any
    faces: list[SolidFace] = field(init=False)
    edges: list[EdgeCurve] = field(init=False)
    edge_boxes: NDArray[np.float64] = field(init=False)
    material: Material = field(init=False)
    folds: dict[int, list[Found]] = field(init=False, factory=dict)

    def __attrs_post_init__(self) -> None:
        self.faces = solid_faces(self.shape)
        self.edges = edge_curves(self.faces)
        ends = [(edge.points.min(axis=0), edge.points.max(axis=0)) for edge in self.edges]
        self.edge_boxes = np.array([(*low[:2], *high[:2], high[2]) for low, high in ends]).reshape(-1, 5)
        self.material = Material(self.shape, self.faces, self.edges)

    @property
    def height(self) -> float:
        """Height of its highest point in mm; of a level face there, if there is one."""
        top = max(face.high for face in self.faces)
        level = [face.high for face in self.faces if face.lie == "level" and top - face.high <= SAME_HEIGHT]
        return max(level, default=top)

    def folds_of(self, index: int) -> list[Found]:
        """Where the face of a number stands upright, seen from above; found once."""
        if index not in self.folds:
            self.folds[index] = folds(self.faces[index])
        return self.folds[index]

    def outline(
        self,
        peg_height: float | None = None,
        head_room: float = HEAD_ROOM,
        least_band: float = LEAST_BAND,
        low: float = 0.0,
    ) -> HeightOutline:
        """The outline of pegs that reach from below up to a height, or from another height.

        Parameters
        ----------
        peg_height : in mm; the solid's height when None.
        head_room : kept free above the pegs, in mm.
        least_band : shortest band in mm that may be touched.
        low : from which pegs reach, in mm; 0 is from below.

        Raises
        ------
        InputError
            For heights that leave nothing, and where the outline has a curve that is neither line nor arc.
        """
        top = self.height if peg_height is None else peg_height
        walls = Walls(self.faces, self.edges, max(low, 0.0), min(top, self.height))
        loops = self.border(low if low > 0.0 else -inf, top + head_room, walls)
        strips = tuple(tuple(strips_of_loop(loop, walls, least_band)) for loop in loops)
        return HeightOutline(strips, top, head_room, least_band)

    def border(self, low: float, high: float, walls: Walls | None = None) -> list[list[BorderPiece]]:
        """The loops of U(low, high), heights in mm.

        Raises
        ------
        InputError
            Naming the face whose border is neither line nor arc.
        """
        low, high = max(low, -1.0), min(high, self.height + 1.0)

        def inside(point: tuple[float, float]) -> bool:
            return self.material.reaches_into(point, low, high)

        curves = projected_curves(self.faces, self.edges, low, high, self.folds_of)
        refuse_others(curves.others, self.faces, inside)
        more = walls.cuts() if walls else []
        carriers = subdivide(curves.segments, (*curves.cuts, *more))
        pieces = border_pieces(carriers, inside)
        if not pieces:
            raise InputError(
                f"nothing of the solid lies between the heights {max(low, 0):g} and {high:g} mm."
            )
        return self.closed(pieces, curves)

    def closed(self, pieces: Sequence[BorderPiece], curves: ProjectedCurves) -> list[list[BorderPiece]]:
        """The loops of a border's pieces.

        Raises
        ------
        InputError
            When they do not close, naming the face whose border is neither line nor arc, if there is one.
        """
        try:
            return border_loops(pieces)
        except InputError as error:
            if curves.others:
                kinds = [self.faces[index] for index, _ in curves.others]
                raise other_curve(min(kinds, key=lambda face: face.kind in FLAT)) from error
            raise


def standing(shape: Any) -> StandingSolid:
    """A solid moved so that its lowest point is at height 0, and turned right side out."""
    shape = sub_shapes(shape, "SOLID")[0]
    occ.BRepLib.OrientClosedSolid_s(shape)
    move = occ.gp_Trsf()
    move.SetTranslation(occ.gp_Vec(0.0, 0.0, -foot_height(shape)))
    return StandingSolid(shape.Moved(occ.TopLoc_Location(move)))


def foot_height(shape: Any) -> float:
    """The height of a shape's lowest point in mm, with the very number of a level face that lies there."""
    low = bounding_box(shape)[0][2]
    level = [plane_height(occ.BRepAdaptor_Surface(face)) for face in sub_shapes(shape, "FACE")]
    return min((z for z in level if z is not None and z - low <= SAME_HEIGHT), default=low)


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
