"""The level faces of a standing solid that supports from below and a clamp on top may touch.

A clamp may touch only the open parts of an upper face, which nothing of the solid covers. Two further kinds
of regions are computed. The head of a clamp must not enter the regions where the solid rises above the face.
Under the hanging parts of a face the material does not reach down to the plane on which the part lies.

All are regions of a planar subdivision. The border of a face, and the curves that bound the solid above or
below it, are cut where they cross. Points beside each piece decide on which side of it the region lies.
Curves that are neither line nor arc, such as the mouth of an inclined bore, are enclosed in polygons; no
polygon counts as part of a face.

Glossary
--------
open : said of a part of a face that nothing of the solid covers.
rising : the region of the solid above a height, seen from above.
hanging : said of a part of a face under which the material is interrupted above the lying plane.
lying plane : the plane z = 0 on which the part lies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import dist, pi, tan
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import ALIGNED, SAME_HEIGHT, SHORTEST
from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.outline.chain import Chain
from workhold.files.outline.joining import make_closed_loop
from workhold.files.step.enclosing import Enclosure, enclose_curves, split_near_chords
from workhold.files.step.faces import SolidFace
from workhold.files.step.heights import StandingSolid
from workhold.files.step.projected import list_projected_curves
from workhold.files.step.regions import make_level_region, trace_borders
from workhold.geometry.loop import compute_signed_area, make_loop_segments, reverse_vertices
from workhold.geometry.rational import Pieces, compute_point, sample_points
from workhold.geometry.segment import (
    Line,
    Point,
    Segment,
    compute_bounding_box,
    make_segment_from_bulge,
    make_segment_rows,
)
from workhold.geometry.subdivision import BorderPiece, find_border_pieces, join_border_loops, subdivide
from workhold.kernels.base.distance import is_inside

__all__ = ["LevelTop", "find_bottom_loops", "collect_level_faces", "find_open_level_tops"]

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]
# mm. What faces have in common but for this is no more than a border.
OFF = 1e-3
# mm. A face that leaves a level one by no more, however flat, is not above it.
JUST_ABOVE = 1e-10
# mm. How far beside a piece of a border its sides are looked at: curves that polygons hold are many and small.
NEAR_BESIDE = 4e-4
# mm². A loop around less than this, beside curves that polygons hold, is nothing that anything stands on.
SLIVER = 1e-6


@frozen(eq=False)
class LevelTop:
    """The level upper faces of one height and their surroundings, for clamps on top; all loops are vertices
    (N, 3).

    Each vertex is x and y in mm and the bulge of the segment that follows.

    Parameters
    ----------
    height : height of the faces in mm.
    open : the parts of the faces that are open, outer loops counter-clockwise, openings clockwise.
    rising : regions where the solid rises above the height.
    hanging : those parts of ``open`` under which the material does not reach down to z = 0.
    is_unclear : whether nothing is open because the rising or hanging regions are not known.
    """

    height: float
    open: list[Array]
    rising: list[Array]
    hanging: list[Array]
    is_unclear: bool = False


@frozen(eq=False)
class FaceBorder:
    """The border of a level face.

    Parameters
    ----------
    loops : its vertices (N, 3), the face on the left; chords replace curves that are neither line nor arc.
    bounds : its lines and arcs, and polygons that enclose its other curves.
    """

    loops: list[Array]
    bounds: Enclosure

    @property
    def is_plain(self) -> bool:
        """Whether it consists of lines and arcs only."""
        return not self.bounds.polygons


def collect_level_faces(solid: StandingSolid) -> dict[str, list[Any]]:
    """Return the level faces of a solid as the fields of ``SolidOutline`` by name.

    These are ``bottom``, ``top`` (with nothing above), ``rising`` (material above a face's height) and
    ``hanging`` (parts of ``top`` without material down to z = 0) with loops as nested lists, ``top_heights``
    and so on with a height in mm for each loop, and ``unclear_heights``.
    """
    found: dict[str, list[Any]] = {"bottom": [loop.tolist() for loop in find_bottom_loops(solid)]}
    every = find_level_tops(solid)
    tops = [top for top in every if top.open]
    found["unclear_heights"] = [top.height for top in every if top.is_unclear]
    for name, kind in (("top", "open"), ("rising", "rising"), ("hanging", "hanging")):
        loops = [(top.height, loop) for top in tops for loop in getattr(top, kind)]
        found[name] = [loop.tolist() for _, loop in loops]
        found[f"{name}_heights"] = [height for height, _ in loops]
    return found


def find_bottom_loops(solid: StandingSolid) -> list[Array]:
    """Return the loops (N, 3) of the faces on which the part
    lies: outer ones counter-clockwise, openings clockwise.
    """
    return trace_region_of_faces(find_lying_borders(solid))


def find_lying_borders(solid: StandingSolid) -> list[FaceBorder]:
    """Return the borders of the level faces at z = 0 that look down, on which the part lies."""
    return read_borders(
        [face for face in solid.faces if face.lie == "level" and not face.upward and face.low <= SAME_HEIGHT]
    )


def find_open_level_tops(solid: StandingSolid) -> list[LevelTop]:
    """Return the upper level faces of each height, leaving out heights at which all of them are covered by
    material.

    They are in the order of the solid's faces. Faces of the same height are one entry, faces of different
    heights are different entries.
    """
    return [top for top in find_level_tops(solid) if top.open]


def find_level_tops(solid: StandingSolid) -> list[LevelTop]:
    """Return the upper level faces of every height, including those that other material covers completely."""
    groups: list[list[SolidFace]] = []
    for face in solid.faces:
        if face.lie == "level" and face.upward:
            group = next((one for one in groups if abs(one[0].low - face.low) <= SAME_HEIGHT), None)
            if group is None:
                groups.append([face])
            else:
                group.append(face)
    lying, places = make_on_faces_test(find_lying_borders(solid)), Budget(LIMITS["tops"])
    return [make_level_top(solid, group, lying, places) for group in groups]


def make_level_top(
    solid: StandingSolid, faces: Sequence[SolidFace], lies_on: Callable[[Point], bool], places: Budget
) -> LevelTop:
    """Return the open parts of upper faces of one height, the regions of the solid above that height, and the
    open parts that hang.

    A part is open where nothing of the solid lies above, and hangs where the material below does not reach
    down to z = 0. Nothing is open, and ``is_unclear`` is set, where a border cannot be traced or the budget
    runs out.

    Parameters
    ----------
    faces : all at the same height.
    lies_on : returns whether a point is surely on a face on which the solid lies.
    places : budget of points at which the material above and below may still be computed; each one is
        subtracted.
    """
    height, box = faces[0].low, compute_box_around(faces)
    face_borders = read_borders(faces)
    nothing = LevelTop(height, [], [], [])
    above = [one for one in solid.faces if one.high > height + SAME_HEIGHT]
    try:
        if not above:
            bounds, rising = Enclosure(), list[Array]()
            open_ = trace_region_of_faces(face_borders)
        else:
            is_on = make_on_faces_test(face_borders)
            is_above = make_rises_above_test(solid, height, is_on, places)
            bounds, cuts = find_bounds_between(solid, height, solid.height + 1.0, is_above)
            rising = trace_region(bounds.lines, lambda point: bounds.may_hold(point) or is_above(point), cuts)

            def is_on_top(point: Point) -> bool:
                """Return whether a point is on one of the faces with surely nothing of the solid above."""
                return is_on(point) and not bounds.may_hold(point) and not is_above(point)

            if any(boxes_overlap(one.box, box) for one in above):
                open_ = trace_region(
                    [*list_border_segments(face_borders), *list_lines_near(bounds, box)], is_on_top
                )
            else:
                open_ = trace_region_of_faces(face_borders)
        if not open_:
            return nothing
        return LevelTop(height, open_, rising, find_hanging_loops(solid, open_, height, lies_on, places))
    except InputError:
        return LevelTop(height, [], [], [], is_unclear=True)


def make_rises_above_test(
    solid: StandingSolid, height: float, is_on: Callable[[Point], bool], places: Budget
) -> Callable[[Point], bool]:
    """Return a function that tells whether the solid has material above a height over a point (x, y).

    A fillet is hardly above the level face that it runs into: points at its lower edge count as on the face,
    so the answer there is False.

    Parameters
    ----------
    is_on : returns whether a point is surely on a level face of that height.
    places : budget, of which each call spends one.
    """
    are_above = solid.make_inside_test(height, solid.height + 1.0)

    def rises_above(point: Point) -> bool:
        """Return whether the solid has material above the height over a point."""
        places.spend()
        if are_above([point])[0]:
            return True
        intervals = solid.material.find_material_intervals(point)
        return bool(intervals) and intervals[-1][1] > height + JUST_ABOVE and not is_on(point)

    return rises_above


def find_bounds_between(
    solid: StandingSolid, low: float, high: float, is_there: Callable[[Point], bool]
) -> tuple[Enclosure, list[tuple[Segment, Point]]]:
    """Return (1) all curves that can bound the part of a solid between two z, seen from above, and (2) the
    points at which to cut them, as (segment, point).

    Curves that are neither line nor arc are enclosed in polygons.

    Parameters
    ----------
    low, high : z in mm.
    is_there : see :func:`enclose_curves`.
    """
    curves = list_projected_curves(solid.faces, solid.edges, low, high, solid.find_folds_of_face)
    bounds = Enclosure([*curves.segments])
    if curves.others:
        bounds.add(
            enclose_curves(
                solid.faces, solid.edges, low, high, solid.find_folds_of_face, solid.fold_squares, is_there
            )
        )
    return bounds, [*curves.cuts]


def find_hanging_loops(
    solid: StandingSolid,
    open_: Sequence[Array],
    height: float,
    lies_on: Callable[[Point], bool],
    places: Budget,
) -> list[Array]:
    """Return the loops (N, 3) of those parts of open faces
    under which the material does not reach down to z = 0.

    For ``lies_on`` and ``places`` see :func:`make_level_top`. Raises InputError for loops that do not close.

    Parameters
    ----------
    open_ : loops of the open parts.
    height : height of the faces in mm.
    """
    segments = make_segments(open_)
    boxes = np.array([compute_bounding_box(one) for one in segments])
    box: Box = (*boxes[:, :2].min(axis=0).tolist(), *boxes[:, 2:].max(axis=0).tolist())
    below = (
        one
        for one in solid.faces
        if one.lie != "upright"
        and one.low < height - SAME_HEIGHT
        and not (one.lie == "level" and not one.upward and one.low <= SAME_HEIGHT)
    )
    if not any(boxes_overlap(one.box, box) for one in below):
        return []
    rows = make_segment_rows(segments)

    def reaches_down(point: Point) -> bool:
        """Return whether the material under a point reaches from the height of the faces down to z = 0."""
        places.spend()
        intervals = solid.material.find_material_intervals(point)
        if not intervals or intervals[0][1] < height - SAME_HEIGHT:
            return False
        low = intervals[0][0]
        return low <= JUST_ABOVE or (low <= SAME_HEIGHT and lies_on(point))

    bounds, cuts = find_bounds_between(solid, -1.0, height, lambda point: not reaches_down(point))
    near = list_lines_near(bounds, box)

    def hangs(point: Point) -> bool:
        """Return whether a point is in the open parts and
        not surely over material that reaches down to z = 0.
        """
        return is_inside(*point, rows) and (bounds.may_hold(point) or not reaches_down(point))

    return trace_region([*segments, *near], hangs, cuts)


def trace_region(
    segments: Sequence[Segment],
    inside: Callable[[Point], bool],
    cuts: Sequence[tuple[Segment, Point]] = (),
) -> list[Array]:
    """Return the loops (N, 3) around a region, each with the region on its left.

    They are in order of signed area, from the largest down, so that outer loops come first. Loops around less
    than ``SLIVER`` are left out. Raises InputError for a border that does not close.

    Parameters
    ----------
    segments : they contain all of the region's border.
    inside : returns whether a point that lies on none of them belongs to the region.
    cuts : further points at which the carriers of segments are cut.
    """
    pieces = find_border_pieces(
        subdivide(segments, cuts), lambda points: list(map(inside, points)), NEAR_BESIDE
    )
    loops = [merge_border_pieces(loop) for loop in join_border_loops(pieces)]
    sizes = [(compute_signed_area(make_loop_segments(loop)), loop) for loop in loops]
    return [loop for size, loop in sorted(sizes, key=lambda one: -one[0]) if abs(size) > SLIVER]


def trace_region_of_faces(face_borders: Sequence[FaceBorder]) -> list[Array]:
    """Return the loops (N, 3) around the union of level faces of one height.

    CAD programs split a face where a line was once imprinted on it; such edges are left out. A single face
    without free-form curves keeps its loops. No loops where the border cannot be traced.
    """
    if len(face_borders) == 1 and face_borders[0].is_plain:
        return face_borders[0].loops
    if not face_borders:
        return []
    is_on = make_on_faces_test(face_borders)
    try:
        return trace_region(list_border_segments(face_borders), is_on)
    except InputError:
        return []


def make_on_faces_test(face_borders: Sequence[FaceBorder]) -> Callable[[Point], bool]:
    """Return a function that tells whether a point surely lies on one of some faces.

    Points in polygons that enclose curves of the border are not surely on a face.
    """
    rows = [make_segment_rows(make_segments(one.loops)) for one in face_borders]
    bounds = [one.bounds for one in face_borders]

    def is_on(point: Point) -> bool:
        """Return whether a point surely lies on one of the faces."""
        # Curves along which two faces touch are lost, as polygons hold them on both sides.
        return any(is_inside(*point, own) for own in rows) and not any(one.may_hold(point) for one in bounds)

    return is_on


def list_border_segments(face_borders: Sequence[FaceBorder]) -> list[Segment]:
    """Return the lines and arcs of some borders, with the sides of the polygons that enclose other curves."""
    return [one for border in face_borders for one in border.bounds.lines]


def list_lines_near(bounds: Enclosure, box: Box) -> Iterator[Segment]:
    """Yield the segments and polygon sides of an enclosure whose bounding boxes overlap or touch a box."""
    x0, y0, x1, y1 = box
    for one in bounds.lines:
        low_x, low_y, high_x, high_y = compute_bounding_box(one)
        if low_x <= x1 + OFF and high_x >= x0 - OFF and low_y <= y1 + OFF and high_y >= y0 - OFF:
            yield one


def compute_box_around(faces: Sequence[SolidFace]) -> Box:
    """Return the bounding box (x0, y0, x1, y1) in mm of some faces, seen from above."""
    x0, y0, x1, y1 = np.array([face.box for face in faces]).T
    return float(x0.min()), float(y0.min()), float(x1.max()), float(y1.max())


def boxes_overlap(a: Box, b: Box) -> bool:
    """Return whether two boxes (x0, y0, x1, y1) overlap by more than ``OFF`` mm in x and in y."""
    return a[0] < b[2] - OFF and b[0] < a[2] - OFF and a[1] < b[3] - OFF and b[1] < a[3] - OFF


def make_segments(loops: Sequence[Array]) -> list[Segment]:
    """Return the segments of all loops (N, 3), loop by loop."""
    return [segment for loop in loops for segment in make_loop_segments(loop)]


def merge_border_pieces(loop: Sequence[BorderPiece]) -> Array:
    """Return the vertices (N, 3) of a border's loop, with neighbouring pieces of one line or circle merged.

    Arcs are merged up to half a circle.
    """
    first = next((k for k in range(len(loop)) if not continues_piece(loop[k - 1], loop[k])), 0)
    runs: list[list[BorderPiece]] = []
    for piece in [*loop[first:], *loop[:first]]:
        if (
            runs
            and continues_piece(runs[-1][-1], piece)
            and compute_sweep([*runs[-1], piece]) <= pi + ALIGNED
        ):
            runs[-1].append(piece)
        else:
            runs.append([piece])
    return np.array(
        [(*run[0].start, tan(compute_sweep(run) / 4) * (1 if run[0].forward else -1)) for run in runs]
    )


def continues_piece(before: BorderPiece, after: BorderPiece) -> bool:
    """Return whether two pieces lie on the same line or circle."""
    return before.carrier is after.carrier


def compute_sweep(run: Sequence[BorderPiece]) -> float:
    """Return the total angle in radians of pieces of one circle; 0 for pieces of a line."""
    if isinstance(run[0].carrier.segment, Line):
        return 0.0
    return sum(piece.high - piece.low for piece in run)


def read_borders(faces: Sequence[SolidFace]) -> list[FaceBorder]:
    """Return the borders of level faces, leaving out faces whose border cannot be read."""
    return [border for face in faces if (border := find_face_border(face)) is not None]


def find_face_border(face: SolidFace) -> FaceBorder | None:
    """Return the border of a level face; None where it cannot be read."""
    try:
        edges = trace_borders(make_level_region(face.shape, face.low, face.upward))
        if not all(one.is_disguise for one in edges.curves.values()):
            # The section has curves of its own near the face's, which are exact.
            edges = trace_borders(face.shape)
        chains = [make_closed_loop(chain).vertices for chain in edges.chains]
        order = sorted(
            range(len(chains)), key=lambda k: -abs(compute_signed_area(make_loop_segments(chains[k])))
        )
        true = {label: one.pieces for label, one in edges.curves.items() if not one.is_disguise}
        bounds, loops = Enclosure(), list[Array]()
        for number, k in enumerate(order):
            loop = chains[k]
            if true.keys().isdisjoint(edges.chains[k].labels):
                bounds.segments += make_loop_segments(loop)
            else:
                loop = replace_curves_by_chords(edges.chains[k], true, bounds)
            is_turned = (compute_signed_area(make_loop_segments(chains[k])) > 0) != (number == 0)
            loops.append(reverse_vertices(loop) if is_turned else loop)
    except InputError:
        return None
    return FaceBorder(loops, bounds) if loops else None


def replace_curves_by_chords(chain: Chain, curves: Mapping[str, Pieces], bounds: Enclosure) -> Array:
    """Return the vertices (N, 3) of a border with its curves replaced by chords.

    Raises InputError for a curve that takes too many chords.

    Parameters
    ----------
    chain : the border, with lines and arcs that approximate its curves.
    curves : exact pieces of each curve, by its label in the chain.
    bounds : extended in place by the border's lines and arcs, and by polygons that enclose its curves.
    """
    vertices: list[tuple[float, float, float]] = []
    count, done = len(chain.bulges), set[str]()
    for k in range(count):
        label = chain.labels[k]
        if label not in curves:
            vertices.append((*chain.points[k], chain.bulges[k]))
            bounds.segments.append(
                make_segment_from_bulge(chain.points[k], chain.points[k + 1], chain.bulges[k])
            )
        elif label not in done:
            done.add(label)
            run = [chain.points[m] for m in range(count) if chain.labels[m] == label]
            points: list[Point] = []
            for control in split_near_chords(curves[label]):
                every = [(float(x), float(y)) for x, y in control]
                bounds.add_points(every)
                points = points or every[:1]
                points.append(every[-1])
            points = points[::-1] if runs_backwards(curves[label], run) else points
            vertices += [(x, y, 0.0) for x, y in points[:-1]]
    return np.array(vertices)


def runs_backwards(pieces: Pieces, run: Sequence[Point]) -> bool:
    """Return whether points along a curve, closed or open, run from its end to its start."""
    start, end = compute_point(pieces, 0.0), compute_point(pieces, float(len(pieces)))
    if dist(start, end) > SHORTEST:
        return dist(run[0], end) < dist(run[0], start)
    return (measure_enclosed_area(sample_points(pieces, 8)) > 0) != (measure_enclosed_area(np.array(run)) > 0)


def measure_enclosed_area(points: Array) -> float:
    """Return the area in mm² of the polygon of points (N, 2), positive when they run counter-clockwise."""
    x, y = points.T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
