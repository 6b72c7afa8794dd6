"""A program's effect on supports: its forces as loads in space, and keep-out zones around the swept space.

Cutting forces are loads with heights, the thrust of drills and the pull of helices. For each tool, milling,
drilling and plunging are separate loads, one for each different force; if these are many, one with the
largest. A path is replaced by its convex hull, and arcs by polygons around them, so that no load is
understated. A force may act in any direction.

No pad may stand where tools sweep below the part, such as where a drill comes through. No tip may stand where
they sweep at the heights of the clamp. Each swept piece is a zone, straight or bent, as wide as the tool with
the clearance.

Only few of the pieces above the part border the free places. They are found by a quadtree of squares on the
face. Let c be the middle of a square and h its half diagonal. Let s(t) be the least distance of a place t
from the paths, less the distance that has to be kept. Between two places s changes by at most their distance.
So a square is covered by the piece nearest to c where s(c) < -h, and free where s(c) > h. All others are
quartered. In a square as small as ``FINEST``, the piece nearest to c, widened by 2 h, replaces all others. So
the free places are clear of every piece, and every place with 2 h more clearance is found.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from math import atan, pi

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.swept import SweptSpans, find_span_path
from workhold.contact.trimming import measure_distances
from workhold.model.cutting_forces import CUT_KINDS, DRILLING, MILLING, PLUNGING, CuttingForces
from workhold.model.cutting_tool import ANY
from workhold.model.moves import MoveStretches
from workhold.model.program import PathVertex, Program, SweptPiece
from workhold.model.query import Query
from workhold.model.requirements import Load, Zone, make_zone
from workhold.model.support_bodies import size_clamp_pieces
from workhold.model.support_request import SpatialLoad, SupportRequest
from workhold.model.workpiece import Workpiece
from workhold.statics.path_forces import compute_hull, enclose_arcs, list_all_pieces
from workhold.supports.faces import TouchableFace

__all__ = ["list_acting_loads", "make_capsule", "make_cutting_loads", "add_program_zones"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
# Largest number of different forces of one tool that are loads of their own.
MOST_FORCES = 8
# Half diagonals in mm of the smallest squares, tried until there are few zones.
FINEST = (0.01, 0.05, 0.25, 1.0)
# Zones above the part among which the clamp's place is still found fast, and zones below it.
MOST_ABOVE, MOST_BELOW = 40, 400
# Squares along the longer side of a face to begin with.
FIRST = 16


def list_acting_loads(query: Query, thickness: float) -> tuple[Load | SpatialLoad, ...]:
    """Return the loads of a query, followed by those that its program exerts on a part of this thickness in
    mm.
    """
    return (*query.loads, *(() if query.program is None else make_cutting_loads(query.program, thickness)))


def make_cutting_loads(program: Program, thickness: float) -> tuple[SpatialLoad, ...]:
    """Return the loads in space that a program exerts on a part of this thickness in mm; none without cutting
    forces.
    """
    forces = program.forces
    if forces is None:
        return ()
    found = list[SpatialLoad]()
    for tool in program.tools:
        for kind in (MILLING, DRILLING, PLUNGING):
            rows = np.flatnonzero((forces.kind == kind) & (program.moves.tool == tool))
            for group in group_by_torque(forces, rows):
                found += make_loads(program, forces, group, thickness, f"T{tool} {CUT_KINDS[kind]}")
    return tuple(found)


def group_by_torque(forces: CuttingForces, rows: IntArray) -> Iterator[IntArray]:
    """Yield groups of ``rows``, indices of moves: those with equal torque together.

    If there are more than eight different torques, all rows are one group.
    """
    values, which = np.unique(forces.torque[rows], return_inverse=True)
    if len(values) > MOST_FORCES:
        yield rows
    else:
        yield from (rows[which == k] for k in range(len(values)))


def make_loads(
    program: Program, forces: CuttingForces, rows: IntArray, thickness: float, name: str
) -> Iterator[SpatialLoad]:
    """Yield two loads that contain the cutting forces of some moves: with positive and with negative torque.

    ``rows`` are the indices of the moves.
    """
    count, own = len(program.moves), np.isin(forces.stretches.move, rows)
    only = np.zeros(count)
    only[rows] = 1.0
    none = np.zeros(count)
    cut = forces.stretches
    cut = MoveStretches(cut.move[own], cut.first[own], cut.last[own])
    any_way = CuttingForces(only, none, np.zeros((count, 2)), none, ANY, stretches=cut)
    pieces = list_all_pieces(evolve(program, forces=any_way), (0.0, 0.0))
    is_arc = pieces.radius > 0.0
    x, y = enclose_arcs(pieces, np.flatnonzero(is_arc))
    points = np.concatenate(
        [np.stack([pieces.x[~is_arc], pieces.y[~is_arc]], axis=1), np.stack([x.ravel(), y.ravel()], axis=1)]
    )
    parts = program.moves.cut_into_stretches(cut)
    tip = np.concatenate([parts.start[:, 2], parts.end[:, 2]]) + np.tile(forces.height[cut.move], 2)
    # What a tool does below the part or over it acts at its lower or upper side.
    heights = np.clip([tip.min(), tip.max()], 0.0, thickness)
    load = SpatialLoad(
        points=compute_hull(points).tolist(),
        force=float(forces.force[rows].max()),
        heights=(float(heights[0]), float(heights[1])),
        axial=(float(forces.axial[rows, 0].min()), float(forces.axial[rows, 1].max())),
        moment=float(forces.torque[rows].max()),
        name=name,
    )
    yield load
    yield evolve(load, moment=-load.moment)


def add_program_zones(
    request: SupportRequest, workpiece: Workpiece, program: Program | None
) -> SupportRequest:
    """Return a request with the zones that a program's tools sweep added to its own zones.

    Without a program, the request is returned unchanged.
    """
    if program is None:
        return request

    def make_face(loops: tuple[Array, ...] | None) -> TouchableFace:
        return TouchableFace.from_loops(workpiece.loops if loops is None else loops)

    below = list_zones_below(
        program, request.pad_radius, request.pad_margin, KeyedFace(make_face(request.bottom))
    )
    above = list_zones_above(
        program, list_levels(request), request.tip_radius, KeyedFace(make_face(request.top))
    )

    def join_zones(own: tuple[Zone, ...], more: tuple[Zone, ...]) -> tuple[Zone, ...]:
        return (*own, *(zone for zone in more if zone not in own))

    return evolve(
        request,
        bottom_zones=join_zones(request.bottom_zones, below),
        top_zones=join_zones(request.top_zones, above),
    )


@frozen
class KeyedFace:
    """A face as a key for caches, equal to another where their borders are equal."""

    face: TouchableFace

    def __eq__(self, other: object) -> bool:
        return isinstance(other, KeyedFace) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)

    @property
    def key(self) -> bytes:
        """Bytes of the borders' coordinates."""
        borders = self.face.borders
        return borders.starts.tobytes() + borders.ends.tobytes() + borders.arcs.tobytes()


@lru_cache(maxsize=8)
def list_zones_below(
    program: Program, pad_radius: float, pad_margin: float, keyed: KeyedFace
) -> tuple[Zone, ...]:
    """Return zones in which no pad may stand, since tools come down
    to the plane on which the part lies; cached.
    """
    swept = SweptSpans.from_program(program, 0.0)
    return find_zones(swept, program.clearance, pad_radius + pad_margin, pad_radius, keyed.face, MOST_BELOW)


@lru_cache(maxsize=8)
def list_zones_above(
    program: Program, levels: tuple[float, ...], tip_radius: float, keyed: KeyedFace
) -> tuple[Zone, ...]:
    """Return zones in which the clamp's tip may not stand, since tools come too near to the clamp; cached."""
    return find_zones(
        SweptSpans.from_pieces(list_swept_beside_clamp(program, levels, tip_radius)),
        program.clearance,
        tip_radius,
        tip_radius,
        keyed.face,
        MOST_ABOVE,
    )


def list_levels(request: SupportRequest) -> tuple[float, ...]:
    """Return the heights in mm of the faces on which the clamp may
    press, ascending; the last is the part's thickness.
    """
    lower = {height for height in request.top_heights or () if height < request.thickness}
    return *sorted(lower), request.thickness


def list_swept_beside_clamp(
    program: Program, levels: tuple[float, ...], tip_radius: float
) -> Iterator[SweptPiece]:
    """Yield the space that tools sweep at the heights of the clamp on each face, enlarged if the clamp is
    wider than its tip.
    """
    for low in levels:
        for height, share in size_clamp_pieces(low, levels[-1]):
            wider = max(share - 1.0, 0.0) * tip_radius
            for one in program.iterate_swept_pieces(low, low + height):
                yield SweptPiece(
                    one.line, one.tool, one.kind, one.path, one.tip, one.radius + wider, one.heights
                )
            low += height


def find_zones(
    swept: SweptSpans, clearance: float, on_face: float, disc: float, face: TouchableFace, most: int
) -> tuple[Zone, ...]:
    """Return zones that keep discs clear of the swept space, with as few shapes as possible.

    Parameters
    ----------
    clearance : least distance in mm between the swept cylinders and a disc.
    on_face : least distance in mm of a disc's centre from the border of the face.
    disc : radius of the discs in mm.
    face : face on which the discs lie.
    most : if there would be more zones than this, fewer and wider ones are tried.
    """
    if not len(swept) or not face.faces:
        return ()
    finest, chosen, boxes = FINEST[0], np.zeros(0, np.int64), np.zeros(0, np.int64)
    for finest in FINEST:
        chosen, boxes = find_needed_spans(swept, clearance + disc, on_face, face, finest)
        if len(chosen) + len(boxes) <= most:
            break
    wide = clearance + 2 * finest
    return (
        *(
            make_zone(make_capsule(find_span_path(swept.tree.rows[k]), float(swept.tree.radius[k]) + wide))
            for k in chosen.tolist()
        ),
        *(
            make_zone([[x0, y0, 0.0], [x1, y0, 0.0], [x1, y1, 0.0], [x0, y1, 0.0]])
            for x0, y0, x1, y1 in swept.filled[boxes].tolist()
        ),
    )


def find_needed_spans(
    swept: SweptSpans, keep: float, on_face: float, face: TouchableFace, finest: float
) -> tuple[IntArray, IntArray]:
    """Return the indices (1) of the swept spans and (2) of the filled boxes that bound the free places of a
    face.

    Parameters
    ----------
    keep : least distance in mm of a disc's centre from the cylinders.
    on_face : least distance in mm of a disc's centre from the border of the face.
    finest : half diagonal of the smallest squares, in mm.
    """
    low, high = face.box
    side = float(max(high - low)) / FIRST
    x, y = (np.arange(low[k] + side / 2, high[k] + side / 2, side) for k in (0, 1))
    points = np.stack([grid.ravel() for grid in np.meshgrid(x, y)], axis=1)
    border, covered, spans, boxes = [], [], [], set[int]()
    while len(points):
        half = side / 2**0.5
        points = points[face.measure_room(points) >= on_face - half]
        reach, nearest = swept.find_nearest_spans(points, points)
        inside, which = find_filled_boxes(swept, points, half)
        boxes.update(which[inside].tolist())
        slack = reach - keep
        hidden = slack < -half
        covered.append(np.column_stack([points, np.full(len(points), half)])[hidden & ~inside])
        spans.append(nearest[hidden & ~inside])
        open_ = ~inside & ~hidden & (slack <= half)
        if half <= finest:
            border.append(nearest[open_])
            break
        # A square into which the box reaches stays open, as places beside the box's corner may be free.
        side /= 2
        quarters = side / 2 * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])
        points = (points[open_][:, None] + quarters).reshape(-1, 2)
    first = np.unique(np.concatenate([np.zeros(0, np.int64), *border]))
    squares, own = np.concatenate([np.zeros((0, 3)), *covered]), np.concatenate([first[:0], *spans])
    return choose_covering_spans(swept, first, squares, own, keep), np.array(sorted(boxes), np.int64)


def find_filled_boxes(swept: SweptSpans, points: Array, half: float) -> tuple[NDArray[np.bool_], IntArray]:
    """Return (1) whether squares about points (N, 2) lie in a filled
    box, (N,), and (2) the box's index; -1 for none.

    A square counts as in a box if its centre is at least ``half`` mm from the box's sides.
    """
    inside, which = np.zeros(len(points), np.bool_), np.full(len(points), -1)
    for number, (x0, y0, x1, y1) in enumerate(swept.filled.tolist()):
        x, y = points.T
        now = (x0 + half <= x) & (x <= x1 - half) & (y0 + half <= y) & (y <= y1 - half) & ~inside
        inside, which = inside | now, np.where(now, number, which)
    return inside, which


def choose_covering_spans(
    swept: SweptSpans, first: IntArray, squares: Array, own: IntArray, keep: float
) -> IntArray:
    """Return indices of spans, ascending, that cover all of some squares: ``first``, and more as needed.

    ``squares`` (N, 3) are (centre x, centre y, half diagonal); ``own`` (N,) is the index of a span that
    covers each square. Spans are widened by ``keep`` mm.
    """
    chosen, open_ = first, np.ones(len(squares), np.bool_)
    for number in first.tolist():
        open_[open_] = ~covers(swept, number, squares[open_], keep)
    while open_.any():
        # The one that most of the open squares are nearest to is as good as the best.
        number = int(np.bincount(own[open_]).argmax())
        chosen = np.append(chosen, number)
        open_[open_] = ~covers(swept, number, squares[open_], keep)
    return np.sort(chosen)


def covers(swept: SweptSpans, number: int, squares: Array, keep: float) -> NDArray[np.bool_]:
    """Return a mask (N,): True for squares that span ``number``, widened by ``keep`` mm, covers.

    ``squares`` (N, 3) are (centre x, centre y, half diagonal).
    """
    row = swept.tree.rows[number : number + 1]
    away = measure_distances(row, squares[None, :, 0], squares[None, :, 1])[0]
    hidden: NDArray[np.bool_] = away - swept.tree.radius[number] - keep < -squares[:, 2]
    return hidden


def make_capsule(path: tuple[PathVertex, ...], radius: float) -> list[list[float]]:
    """Return the border of all points within ``radius`` mm of a path,
    as vertices [x, y, bulge], counter-clockwise.

    The path is a point, a segment, or an arc of at most half a turn.
    """
    x, y, bulge = path[0]
    if len(path) == 1:
        return [[x - radius, y, 1.0], [x + radius, y, 1.0]]
    if bulge < 0.0:
        (to_x, to_y, _) = path[1]
        return make_capsule(((to_x, to_y, -bulge), (x, y, 0.0)), radius)
    start, end = np.array([x, y]), np.array(path[1][:2])
    chord = end - start
    along = chord / np.hypot(*chord)
    if bulge == 0.0:
        right = radius * np.array([along[1], -along[0]])
        corners = [(start + right, 0.0), (end + right, 1.0), (end - right, 0.0), (start - right, 1.0)]
        return [[*place.tolist(), bent] for place, bent in corners]
    half = 2.0 * atan(bulge)
    size = float(np.hypot(*chord)) / (2 * np.sin(half))
    center = (start + end) / 2 + np.array([-along[1], along[0]]) * size * np.cos(half)
    out, back = (start - center) / size, (end - center) / size
    outer = [(start + radius * out, bulge)]
    if size > radius:
        corners = [
            *outer,
            (end + radius * back, 1.0),
            (end - radius * back, -bulge),
            (start - radius * out, 1.0),
        ]
        return [[*place.tolist(), bent] for place, bent in corners]
    # There is no inner border; the circles about both ends meet behind the centre.
    middle, half_chord = (start + end) / 2, float(np.hypot(*chord)) / 2
    apex = middle + np.array([-along[1], along[0]]) * np.sqrt(max(radius**2 - half_chord**2, 0.0))
    turns = [
        measure_sweep_between(end, end + radius * back, apex),
        measure_sweep_between(start, apex, start + radius * out),
    ]
    corners = [*outer, (end + radius * back, np.tan(turns[0] / 4)), (apex, np.tan(turns[1] / 4))]
    return [[*place.tolist(), float(bent)] for place, bent in corners]


def measure_sweep_between(center: Array, one: Array, other: Array) -> float:
    """Return the counter-clockwise angle about a centre from one point to
    another, in radians in [0, 2 pi).
    """
    a, b = one - center, other - center
    return float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)) % (2 * pi)
