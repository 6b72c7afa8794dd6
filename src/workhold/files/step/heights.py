"""Outlines by height: the border that pegs meet between two heights, and the segments that they may touch.

The outline U(a, p) is the projection of the solid's part between the heights a and p. Its border consists of
edges, folds and cuts (see ``files.step.projected``); the material beside them decides which pieces belong to
it.

Glossary
--------
peg height : the height p in mm above the plane on which the part lies up to which pegs reach.
head room : the space kept free above the pegs, in mm.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from attrs import define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.errors import InputError
from workhold.files.questions import PEG_HEIGHT, SECTION
from workhold.files.step.bands import KnownWalls, WallsByCarrier
from workhold.files.step.edge_curves import EdgeCurve, Found, list_edge_curves
from workhold.files.step.faces import SolidFace, compute_plane_height, list_solid_faces
from workhold.files.step.library import compute_bounding_box, list_sub_shapes, occ, raise_shape
from workhold.files.step.material import Material
from workhold.files.step.projected import (
    FLAT,
    OtherCurveError,
    PlainCurves,
    ProjectedCurves,
    cut_face_at_height,
    find_folds,
    has_plain_cuts,
    list_projected_curves,
    refuse_others,
)
from workhold.files.step.strips import Strip, make_run_rows, make_touchable_strips
from workhold.geometry.loop import compute_signed_area, make_loop_segments
from workhold.geometry.segment import Arc, Line, Segment, are_parallel_lines
from workhold.geometry.subdivision import (
    BorderPiece,
    Inside,
    find_border_pieces,
    join_border_loops,
    subdivide,
)
from workhold.model.solid import NO_LEVELS, Band, HeightRow, RunRows, SolidOutline, slides_at_every_height

__all__ = [
    "HEAD_ROOM",
    "LEAST_BAND",
    "HeightOutline",
    "OwnDrawing",
    "StandingSolid",
    "advise_on_height",
    "describe_outline_by_height",
    "tabulate_peg_heights",
    "measure_outline",
    "draw_own_outlines",
    "stand_solid",
]

# What is kept free above the pegs, and the shortest band that may be touched, both in mm.
HEAD_ROOM, LEAST_BAND = 0.5, 1.0


@define(frozen=True, slots=False, eq=False)
class HeightOutline:
    """The outline between two heights, with the band of heights that may be touched at each segment.

    Parameters
    ----------
    loops : strips in running order with the material on the left.
    peg_height, head_room, least_band : height of the pegs, space kept free above them, and shortest band that
        may be touched, in mm.
    """

    loops: tuple[tuple[Strip, ...], ...]
    peg_height: float
    head_room: float
    least_band: float

    @cached_property
    def ordered(self) -> list[tuple[Strip, ...]]:
        """The loops by signed area, from the largest down, so that outer ones come first."""
        return sorted(
            self.loops, key=lambda loop: -compute_signed_area(make_loop_segments(collect_vertices(loop)))
        )

    @property
    def vertices(self) -> tuple[NDArray[np.float64], ...]:
        """Vertices (N, 3) of each loop of ``ordered``: x and y in mm, and the bulge."""
        return tuple(collect_vertices(loop) for loop in self.ordered)

    @property
    def bands(self) -> tuple[Band | None, ...]:
        """The heights (z0, z1) in mm touchable all along each segment, loop by loop as in ``ordered``; None
        where no height is touchable.
        """
        return tuple(strip.band for loop in self.ordered for strip in loop)

    @property
    def faces(self) -> tuple[tuple[int, ...], ...]:
        """The indices of the upright faces over every segment, loop by loop as in ``ordered``."""
        return tuple(strip.faces for loop in self.ordered for strip in loop)

    @property
    def runs(self) -> tuple[RunRows, ...]:
        """For every segment, the range of heights covered by walls that contains the segment's band.

        Rows are those of :func:`make_run_rows`; the whole tuple is () when the rows of all segments are empty.
        """
        found = tuple(make_run_rows(strip) for loop in self.ordered for strip in loop)
        return found if any(found) else ()

    @property
    def feet(self) -> int:
        """Number of outer loops: separate pieces of the part at these heights."""
        return sum(compute_signed_area(make_loop_segments(loop)) > 0 for loop in self.vertices)


def collect_vertices(loop: Sequence[Any]) -> NDArray[np.float64]:
    """Return the vertices (N, 3), x and y in mm and bulge, of a loop of strips in running order."""
    return np.array([(*strip.start, strip.bulge) for strip in loop])


@define(slots=False)
class StandingSolid:
    """A solid with its axis up and its lowest point at height 0.

    Parameters
    ----------
    shape : Open CASCADE's solid in mm, its axis along z.
    edge_boxes : (E, 5) for every edge: least x and y, greatest x and y, greatest z, in mm.
    """

    shape: Any
    faces: list[SolidFace] = field(init=False)
    edges: list[EdgeCurve] = field(init=False)
    edge_boxes: NDArray[np.float64] = field(init=False)
    material: Material = field(init=False)
    folds: dict[int, list[Found]] = field(init=False, factory=dict)
    # Squares that hold folds which are neither lines nor arcs, see ``files.step.enclosing``.
    fold_squares: dict[tuple[int, float], set[tuple[int, int]]] = field(init=False, factory=dict)
    # What outlines of all heights have in common.
    known_walls: KnownWalls = field(init=False, factory=KnownWalls)
    # Outlines by their heights and shortest band: the table and whoever looks for a height ask for the same.
    known_outlines: dict[tuple[float, ...], HeightOutline] = field(init=False, factory=dict)
    # The face that was last found to refuse an outline: it is likely to refuse that of a height nearby.
    suspect: SolidFace | None = field(init=False, default=None)

    def __attrs_post_init__(self) -> None:
        self.faces = list_solid_faces(self.shape)
        self.edges = list_edge_curves(self.faces)
        ends = [(edge.points.min(axis=0), edge.points.max(axis=0)) for edge in self.edges]
        self.edge_boxes = np.array([(*low[:2], *high[:2], high[2]) for low, high in ends]).reshape(-1, 5)
        self.material = Material(self.shape, self.faces, self.edges)

    @property
    def height(self) -> float:
        """z in mm of the top: of the highest level face if it is within rounding
        of the highest point, otherwise of that point.
        """
        top = max(face.high for face in self.faces)
        level = [face.high for face in self.faces if face.lie == "level" and top - face.high <= SAME_HEIGHT]
        return max(level, default=top)

    @cached_property
    def plain(self) -> PlainCurves:
        """All lines and arcs among the projected edges, and
        the curves along which leaning faces stand upright.

        They may border the outlines of any height.
        """
        edges = [edge.segment for edge in self.edges if edge.segment is not None]
        leaning = [index for index, face in enumerate(self.faces) if face.lie == "leaning"]
        every = [one for index in leaning for one in self.find_folds_of_face(index)]
        return PlainCurves.from_segments([*edges, *(one for one in every if isinstance(one, Line | Arc))])

    def find_folds_of_face(self, index: int) -> list[Found]:
        """Return the curves, seen from above, along which the leaning face with index ``index`` stands
        upright; the result is cached.
        """
        if index not in self.folds:
            self.folds[index] = find_folds(self.faces[index])
        return self.folds[index]

    def make_outline(
        self,
        peg_height: float | None = None,
        head_room: float = HEAD_ROOM,
        least_band: float = LEAST_BAND,
        low: float = 0.0,
        silhouette: Sequence[Segment] = (),
    ) -> HeightOutline:
        """Return the outline that pegs meet, with the bands that they may touch.

        Parameters
        ----------
        peg_height : height in mm up to which pegs reach; the solid's height when None.
        head_room : space kept free above the pegs, in mm.
        least_band : shortest band in mm that may be touched.
        low : height in mm from which pegs reach; 0 or less stands for pegs that reach from below the part.
        silhouette : segments of the border, where it is known that the outline is the silhouette; else empty.

        Raises
        ------
        InputError
            When there is no material between the heights, and where the outline has a curve that is neither
            line nor arc.
        """
        top = self.height if peg_height is None else peg_height
        key = top, head_room, least_band, low
        if not silhouette and key in self.known_outlines:
            return self.known_outlines[key]
        walls = self.make_walls(top, low)
        loops = self.find_border(low if low > 0.0 else -inf, top + head_room, walls, silhouette)
        strips = tuple(tuple(make_touchable_strips(loop, walls, least_band)) for loop in loops)
        outline = HeightOutline(strips, top, head_room, least_band)
        if not silhouette:
            self.known_outlines[key] = outline
        return outline

    def make_walls(self, top: float, low: float = 0.0) -> WallsByCarrier:
        """Return the upright faces, with their heights limited to the range from ``low`` to ``top`` mm and to
        the solid.
        """
        return WallsByCarrier(self.faces, self.edges, max(low, 0.0), min(top, self.height), self.known_walls)

    def measure_outline_area(self, peg_height: float, head_room: float) -> float | None:
        """Return the area in mm² of the outline of pegs that
        reach from below the part up to ``peg_height`` mm.

        ``head_room`` mm above are kept free. None if the outline is refused. If the curve of a face is the
        reason, the face is stored in ``suspect`` and tested first in the next call.
        """
        high = peg_height + head_room
        suspect = self.suspect
        try:
            if suspect is not None:
                cuts = [one for one in cut_face_at_height(suspect, high) if not isinstance(one, Line | Arc)]
                refuse_others(
                    [(0, one) for one in cuts], [suspect], self.make_inside_test(-1.0, high), self.plain
                )
            loops = self.find_border(-inf, high, self.make_walls(peg_height))
        except OtherCurveError as error:
            self.suspect = error.face
            return None
        except InputError:
            return None
        return sum(compute_signed_area(make_loop_segments(collect_vertices(loop))) for loop in loops)

    def make_inside_test(self, low: float, high: float) -> Inside:
        """Return a function that takes points (x, y) and returns for each whether the
        solid has material over it between two z in mm.
        """
        return lambda points: self.material.lies_between(points, low, high)

    def find_border(
        self, low: float, high: float, walls: WallsByCarrier | None = None, silhouette: Sequence[Segment] = ()
    ) -> list[list[BorderPiece]]:
        """Return the border of the projection of the solid's part between two z in mm, as loops of border
        pieces.

        ``low`` is -inf where the part reaches from below the solid.

        Parameters
        ----------
        walls : upright faces whose covered height ranges also cut the border; None for no such cuts.
        silhouette : see :meth:`make_outline`.

        Raises
        ------
        InputError
            When there is no material between the heights, or naming the face whose border is neither line nor
            arc.
        """
        low, high = max(low, -1.0), min(high, self.height + 1.0)
        inside = self.make_inside_test(low, high)
        more = walls.find_cut_points() if walls else []
        if silhouette:
            curves = ProjectedCurves(
                tuple(silhouette), tuple(walls.find_level_edge_ends() if walls else ()), ()
            )
        else:
            curves = list_projected_curves(self.faces, self.edges, low, high, self.find_folds_of_face)
            refuse_others(curves.others, self.faces, inside, PlainCurves.from_segments(curves.segments))
        carriers = subdivide(curves.segments, (*curves.cuts, *more))
        pieces = find_border_pieces(carriers, inside)
        if not pieces:
            raise InputError(
                f"no part of the solid lies between the heights {max(low, 0):g} and {high:g} mm."
            )
        try:
            return self.close_loops(pieces, curves)
        except InputError:
            # A cut this near to a corner has sides too narrow to be looked at, and is one with the cut through it.
            corner = float(self.corners[np.abs(self.corners - high).argmin()])
            if curves.others or silhouette or not 0.0 < abs(corner - high) <= SAME_HEIGHT:
                raise
        return self.find_border(low, corner, walls)

    @cached_property
    def corners(self) -> NDArray[np.float64]:
        """Sorted z in mm of the ends, the lowest and the highest points of all edges."""
        ends = [(*edge.points[[0, -1], 2].tolist(), edge.low, edge.high) for edge in self.edges]
        return np.unique(np.array(ends, np.float64))

    def close_loops(self, pieces: Sequence[BorderPiece], curves: ProjectedCurves) -> list[list[BorderPiece]]:
        """Return the loops that the pieces of a border make.

        Raises
        ------
        InputError
            When they do not close; the error is an OtherCurveError with the face if there are curves that are
            neither line nor arc.
        """
        try:
            return join_border_loops(pieces)
        except InputError as error:
            if curves.others:
                kinds = [self.faces[index] for index, _ in curves.others]
                raise OtherCurveError(min(kinds, key=lambda face: face.kind in FLAT)) from error
            raise


def stand_solid(shape: Any, low: float | None = None) -> StandingSolid:
    """Return the first solid of a shape, moved along z so
    that its lowest point is at height 0, and right side out.

    The shape's axis points up already. ``low`` is the least z in mm of its bounding box, computed when None.
    """
    shape = list_sub_shapes(shape, "SOLID")[0]
    occ.BRepLib.OrientClosedSolid_s(shape)
    return StandingSolid(raise_shape(shape, -find_foot_height(shape, low)))


def find_foot_height(shape: Any, low: float | None = None) -> float:
    """Return the z in mm of a shape's lowest point; where a level face lies there, exactly that face's z.

    ``low`` is the least z of the bounding box, computed when None.
    """
    low = compute_bounding_box(shape)[0][2] if low is None else low
    level = [compute_plane_height(occ.BRepAdaptor_Surface(face)) for face in list_sub_shapes(shape, "FACE")]
    return min((z for z in level if z is not None and z - low <= SAME_HEIGHT), default=low)


# Heights of the pegs that the table looks at, at most.
MOST_ROWS = 60
# Edges of a solid times heights that the table looks at, at most: of parts with many faces it has fewer rows.
MOST_EDGES = 6_000
# Heights at which a range is looked at that may be refused in part, and how exactly in mm its end is found. A
# wall that is this much lower than what may be touched is not.
PROBES, BEFORE = 8, 1e-3
# Outlines whose areas differ by no more than this share are one.
WHOLE = 1e-9


def measure_outline(outline: HeightOutline) -> tuple[float, float, float, float]:
    """Return (area, border, touchable border, shortest band) of an outline: mm² for the area, mm for the
    lengths.

    The shortest band is 0 where nothing may be touched.
    """
    border = touchable = area = 0.0
    bands = []
    for loop in outline.loops:
        segments = make_loop_segments(collect_vertices(loop))
        area += compute_signed_area(segments)
        border += sum(segment.length for segment in segments)
        for segment, strip in zip(segments, loop, strict=True):
            if strip.band is not None:
                touchable += segment.length
                bands.append(strip.band[1] - strip.band[0])
    return area, border, touchable, min(bands, default=0.0)


def is_parallel_only(outline: HeightOutline) -> bool:
    """Return whether the touchable segments of an outline are all parallel lines."""
    strips = [
        (segment, strip)
        for loop in outline.loops
        for segment, strip in zip(make_loop_segments(collect_vertices(loop)), loop, strict=True)
    ]
    return are_parallel_lines(segment for segment, strip in strips if strip.band is not None)


def tabulate_peg_heights(solid: StandingSolid, room: float, least: float) -> list[HeightRow]:
    """Return ranges of peg heights, from the lowest up, each with
    area and touchable border of the outline at its upper end.

    Ranges end where a face begins or ends, or meets the head room, and where a wall becomes high enough to be
    touched. Neighbouring ranges with the same outline are merged; ranges whose outline is refused are left
    out.

    Parameters
    ----------
    room : head room kept free above the pegs, in mm.
    least : shortest range of heights in mm that may be touched.
    """
    levels = {round(z, 6) for face in solid.faces for z in (face.low, face.high)}
    starts = {face.low if face.lie == "upright" else face.high for face in solid.faces}
    levels |= {round(z - room, 6) for z in levels} | {round(solid.height, 6)}
    heights = sorted(z for z in levels if least < z <= solid.height + SAME_HEIGHT)
    most = min(MOST_ROWS, max(2, MOST_EDGES // len(solid.edges)))
    if len(heights) > most:
        heights = [heights[round(k)] for k in np.linspace(0, len(heights) - 1, most)]
    rows: list[HeightRow] = []
    whole = WholeOutline.from_height(solid, heights[-1], room, least) if heights else None
    # What is less than the shortest band above the plane touches nothing.
    for low, high in pairwise([least, *heights]):
        is_whole = bool(whole and rows and rows[-1].high == low and whole.has_area(rows[-1].area))
        border = whole.border if whole and is_whole else ()
        if whole and is_whole and has_equal_outline(rows[-1], whole.row):
            # Of one outline pegs that reach farther touch no less.
            rows[-1] = evolve(whole.row, low=rows[-1].low)
            break
        for row in list_height_rows_between(solid, low, high, room, least, whole, is_whole):
            if rows and rows[-1].high == row.low and has_equal_outline(rows[-1], row):
                rows[-1] = evolve(row, low=rows[-1].low)
                continue
            # Just before a wall is high enough, all is as it was before.
            reached = [round(z + least, 6) for z in sorted(starts) if row.low < z + least - BEFORE < row.high]
            for height in reached if rows and rows[-1].touchable < row.touchable else ():
                before = make_height_row(solid, row.low, height, room, least, BEFORE, border)
                if before is None or has_equal_outline(before, row):
                    continue
                if rows and rows[-1].high == before.low and has_equal_outline(rows[-1], before):
                    rows[-1] = evolve(before, low=rows[-1].low)
                else:
                    rows.append(before)
                row = evolve(row, low=height)
            rows.append(row)
    return rows


@frozen
class WholeOutline:
    """The outline of the highest pegs.

    Outlines grow with the height of the pegs, so the outline of lower pegs is the same if it has the same
    area.

    Parameters
    ----------
    row : peg heights that give it, with its area and touchable border.
    border : segments of its border.
    """

    row: HeightRow
    border: tuple[Segment, ...]

    @classmethod
    def from_height(
        cls, solid: StandingSolid, height: float, room: float, least: float
    ) -> WholeOutline | None:
        """Return the outline of pegs of a height in mm; None where it is refused.

        ``room`` is the head room, ``least`` the shortest band that may be touched, both in mm.
        """
        # Heights of the table are rounded, and that of the solid was most likely asked for before.
        asked = None if abs(height - solid.height) <= SAME_HEIGHT else height
        try:
            outline = solid.make_outline(asked, room, least)
        except InputError:
            return None
        pieces = [one for loop in outline.loops for strip in loop for one in strip.covered]
        border = tuple(one.piece.carrier.segment.cut_part(one.low, one.high) for one in pieces)
        return cls(HeightRow(0.0, height, *measure_outline(outline), is_parallel_only(outline)), border)

    def has_area(self, area: float) -> bool:
        """Return whether an area in mm² is that of this outline, within rounding."""
        return abs(self.row.area - area) <= WHOLE * self.row.area


def make_height_row(
    solid: StandingSolid,
    low: float,
    high: float,
    room: float,
    least: float,
    before: float = 0.0,
    border: Sequence[Segment] = (),
) -> HeightRow | None:
    """Return the row for peg heights from ``low`` to ``high`` mm, with area and
    touchable border of the outline at ``high - before``.

    None where that outline is refused.

    Parameters
    ----------
    room, least : see :func:`tabulate_peg_heights`.
    border : see ``silhouette`` of :meth:`StandingSolid.make_outline`.
    """
    try:
        outline = solid.make_outline(high - before, room, least, silhouette=border)
    except InputError:
        return None
    return HeightRow(low, high, *measure_outline(outline), is_parallel_only(outline))


def list_height_rows_between(
    solid: StandingSolid,
    low: float,
    high: float,
    room: float,
    least: float,
    whole: WholeOutline | None,
    is_whole: bool,
) -> Iterator[HeightRow]:
    """Yield the parts of a range of peg heights, ``low``
    to ``high`` in mm, in which the outline is not refused.

    Within the range no face begins or ends. In parts of the range the outline may be refused, because a face
    is cut there in curves that are neither lines nor arcs. The ends of these parts are found by bisection.

    Parameters
    ----------
    room, least : see :func:`tabulate_peg_heights`.
    whole : outline of the highest pegs, if there is one.
    is_whole : whether ``whole`` is already known to be the outline at all heights of the range.
    """
    if is_whole or not any(
        face.lie == "leaning"
        and face.low < high + room - SAME_HEIGHT
        and face.high > low + room + SAME_HEIGHT
        and not has_plain_cuts(face)
        for face in solid.faces
    ):
        row = make_height_row(
            solid, low, high, room, least, border=whole.border if whole and is_whole else ()
        )
        if row is not None:
            yield row
        return
    ends = [low + (high - low) * k / PROBES for k in range(PROBES)]
    # Just above the lower end is the first place of the range.
    ends[0] += min(BEFORE, (high - low) / 2 / PROBES)
    places = [*ends, high]
    taken: list[bool] = []
    for place in places:
        area = None if is_whole else solid.measure_outline_area(place, room)
        is_whole = is_whole or bool(whole and area is not None and whole.has_area(area))
        taken.append(is_whole or area is not None)
    first = low if taken[0] else None
    for (a, b), (one, following) in zip(pairwise(places), pairwise(taken), strict=True):
        if one == following:
            continue
        refused, read = (b, a) if one else (a, b)
        while abs(read - refused) > BEFORE:
            middle = (refused + read) / 2
            if solid.measure_outline_area(middle, room) is None:
                refused = middle
            else:
                read = middle
        if not one:
            first = read
        elif first is not None:
            row = make_height_row(solid, first, read, room, least)
            if row is not None:
                yield row
            first = None
    if taken[-1] and first is not None:
        row = make_height_row(
            solid, first, high, room, least, border=whole.border if whole and is_whole else ()
        )
        if row is not None:
            yield row


def has_equal_outline(a: HeightRow, b: HeightRow) -> bool:
    """Return whether area, border and touchable length of two ranges agree to a millionth."""
    pairs = ((a.area, b.area), (a.border, b.border), (a.touchable, b.touchable))
    return all(abs(one - other) <= 1e-6 * max(one, 1.0) for one, other in pairs)


def find_longest_row(rows: Sequence[HeightRow]) -> HeightRow | None:
    """Return the range with the longest touchable border, of
    equal ones the highest; None where nothing is touchable.
    """
    most = max((row.touchable for row in rows), default=0.0)
    return max(
        (row for row in rows if row.touchable >= most * (1 - 1e-9) > 0),
        key=lambda row: row.high,
        default=None,
    )


def advise_on_height(solid: StandingSolid, room: float, least: float) -> str:
    """Return advice for an error message: the peg height
    with the longest touchable border, or another remedy.

    ``room`` and ``least`` are as in :func:`tabulate_peg_heights`.
    """
    best = find_longest_row(tabulate_peg_heights(solid, room, least))
    if best is None:
        return f"give another axis, or {SECTION}"
    return f"give {PEG_HEIGHT} {best.high:.6g}mm, or another axis"


def describe_outline_by_height(
    outline: HeightOutline, found: SolidOutline, rows: Sequence[HeightRow]
) -> list[str]:
    """Return remarks, a sentence each, on the part's height and how much of the outline can be touched.

    Parameters
    ----------
    found : the solid of the outline.
    rows : ranges of peg heights of :func:`tabulate_peg_heights`, for a hint at a better one.
    """
    _, border, touchable, band = measure_outline(outline)
    reach = (
        "pegs are taken to reach as high"
        if outline.peg_height == found.height
        else f"the outline is what pegs of {outline.peg_height:.6g} mm, with {outline.head_room:g} mm free "
        "above, can meet"
    )
    remarks = [f"The part is {found.height:.6g} mm high along {found.axis}; {reach}."]
    if outline.feet > 1:
        remarks.append(f"It has {outline.feet} separate pieces, between which pegs may stand.")
    if touchable < border * (1 - 1e-9):
        remarks.append(
            f"Upright faces stand over {touchable:.4g} of {border:.4g} mm of the outline, and only these are "
            f"touched; the shortest is {band:.4g} mm high there."
        )
    elif band < min(outline.peg_height, found.height) - SAME_HEIGHT:
        remarks.append(f"The shortest upright face on the outline is {band:.4g} mm high there.")
    return [*remarks, *suggest_better_height(rows, touchable)]


def suggest_better_height(rows: Sequence[HeightRow], touchable: float) -> list[str]:
    """Return one sentence naming the peg height at which most can be touched, or [].

    ``touchable`` is the length in mm of the border that can be touched at the present height. There is a
    sentence only if more can be touched at another height.
    """
    best = find_longest_row(rows)
    if best is None or slides_at_every_height(rows) or best.touchable <= touchable * (1 + 1e-6):
        return []
    return [f"With {PEG_HEIGHT} {best.high:.6g}mm most could be touched: {best.touchable:.4g} mm."]


@frozen(eq=False)
class OwnDrawing:
    """The outline that carriers with heights of their own meet: loops (N, 3), and the solid with their bands.

    Parameters
    ----------
    role : role of the carriers.
    loops : vertices, x and y in mm and bulge.
    """

    role: str
    loops: tuple[NDArray[np.float64], ...]
    solid: SolidOutline


def draw_own_outlines(
    solid: StandingSolid, heights: Mapping[str, Sequence[float]], found: SolidOutline
) -> Iterator[OwnDrawing]:
    """Yield the outline that the carriers of each role meet.

    Parameters
    ----------
    heights : lowest and highest z in mm over which the carriers reach, by role.
    found : the solid with the outline that all other pegs meet.

    Raises
    ------
    InputError
        Naming the role, for an outline that cannot be made or has nothing to touch.
    """
    for role, (low, high) in heights.items():
        where = f"along {found.axis}, from {low:g} to {high:g} mm, where the {role} reaches"
        if low >= solid.height:
            raise InputError(
                f"{where}, there is nothing of the part, which is {solid.height:.6g} mm high: give heights "
                f"of the {role} that begin below that."
            )
        try:
            outline = solid.make_outline(high, found.head_room, found.least_band, low)
        except InputError as error:
            raise InputError(
                f"{where}, {str(error).rstrip('.')}: give other heights of the {role}."
            ) from error
        if not any(outline.bands):
            raise InputError(
                f"{where}, no upright face of the part is at least {found.least_band:g} mm high: give other "
                f"heights of the {role}."
            )
        own = evolve(found, low=low, peg_height=high, bands=outline.bands)
        own = evolve(own, faces=outline.faces, runs=outline.runs)
        own = evolve(own, **NO_LEVELS)
        yield OwnDrawing(role, outline.vertices, own)
