"""The level faces of a standing solid that supports and a clamp on top may touch.

Of an upper face that is what is open to the sky: all of it over which nothing of the solid lies. With it
stands what rises above each height, of which the head of a clamp keeps off, and which parts of the faces hang:
under these the material does not reach down to the plane on which the part lies.

All are regions of a planar subdivision. The border of a face, and what bounds the solid above or below it,
are cut where they meet. On which side of each piece the region lies is asked beside it. Of curves that are
neither line nor arc, such as the mouth of a bore aslant, what polygons around them hold is no part of a face.

Glossary
--------
open : of a face, that nothing of the solid lies above it.
rising : what the solid has above a height, seen from above.
hanging : of a face, that an upright line leaves the material between the face and the lying plane.
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
from workhold.geometry.loop import compute_signed_area, loop_segments, reverse_vertices
from workhold.geometry.rational import Pieces, point_at, points_along
from workhold.geometry.segment import (
    Line,
    Point,
    Segment,
    bounding_box,
    make_segment_from_bulge,
    segment_rows,
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
    """What a clamp on top has to know of the level faces of one height; loops (N, 3) of vertices.

    Parameters
    ----------
    height : of the faces, in mm.
    open : the parts of the faces that are open, outer loops counter-clockwise, openings clockwise.
    rising : what rises above the height.
    hanging : the open parts that hang.
    is_unclear : whether nothing is open because it is not known what rises or hangs there.
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
    loops : its vertices (N, 3), the face on the left; chords stand in the place of curves.
    bounds : its lines and arcs, and polygons that hold its curves.
    """

    loops: list[Array]
    bounds: Enclosure

    @property
    def is_plain(self) -> bool:
        """Whether it has no curves."""
        return not self.bounds.polygons


def collect_level_faces(solid: StandingSolid) -> dict[str, list[Any]]:
    """Return the level faces of a solid by the names that ``SolidOutline`` has for them."""
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
    """Return the loops (N, 3) of the faces on which the part lies: outer ones counter-clockwise, openings clockwise."""
    return trace_region_of_faces(find_lying_borders(solid))


def find_lying_borders(solid: StandingSolid) -> list[FaceBorder]:
    return read_borders(
        [face for face in solid.faces if face.lie == "level" and not face.upward and face.low <= SAME_HEIGHT]
    )


def find_open_level_tops(solid: StandingSolid) -> list[LevelTop]:
    """Return the open parts of the level faces of a solid, by height in the order of its faces.

    Faces of one height that lie side by side are one face; those of other heights stay faces of their own.
    """
    return [top for top in find_level_tops(solid) if top.open]


def find_level_tops(solid: StandingSolid) -> list[LevelTop]:
    """Return the tops of :func:`find_open_level_tops`, with the heights at which nothing is open."""
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
    """Return what is open of some upper faces of one height, with what rises beside them, and what of them
    hangs.

    Nothing is open where what rises cannot be told, or takes more than may be asked. ``lies_on`` says whether
    a point is surely on a face on which the solid lies, ``places`` at how many it may still be asked what
    lies above and below.
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

            def inside(point: Point) -> bool:
                return is_on(point) and not bounds.may_hold(point) and not is_above(point)

            if any(boxes_overlap(one.box, box) for one in above):
                open_ = trace_region(
                    [*list_border_segments(face_borders), *list_lines_near(bounds, box)], inside
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
    """Return whether a solid has something above a height over a point, as a function.

    Beside its foot a fillet is hardly above the level face that it runs into. ``is_on`` says whether a point
    is surely on a level face of that height; for ``places`` see :func:`make_level_top`.
    """
    are_above = solid.make_inside_test(height, solid.height + 1.0)

    def rises(point: Point) -> bool:
        places.spend()
        if are_above([point])[0]:
            return True
        intervals = solid.material.find_material_intervals(point)
        return bool(intervals) and intervals[-1][1] > height + JUST_ABOVE and not is_on(point)

    return rises


def find_bounds_between(
    solid: StandingSolid, low: float, high: float, is_there: Callable[[Point], bool]
) -> tuple[Enclosure, list[tuple[Segment, Point]]]:
    """Return what can bound a slab of a solid, seen from above, and points at which segments are to be cut
    besides.

    For ``is_there`` see :func:`enclosed_curves`.
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
    """Return the loops of what hangs of the open parts of upper faces of one height.

    For ``lies_on`` and ``places`` see :func:`make_level_top`. Refuses loops that do not close.
    """
    segments = make_segments(open_)
    boxes = np.array([bounding_box(one) for one in segments])
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
    rows = segment_rows(segments)

    def reaches_down(point: Point) -> bool:
        places.spend()
        intervals = solid.material.find_material_intervals(point)
        if not intervals or intervals[0][1] < height - SAME_HEIGHT:
            return False
        low = intervals[0][0]
        return low <= JUST_ABOVE or (low <= SAME_HEIGHT and lies_on(point))

    bounds, cuts = find_bounds_between(solid, -1.0, height, lambda point: not reaches_down(point))
    near = list_lines_near(bounds, box)

    def hangs(point: Point) -> bool:
        return is_inside(*point, rows) and (bounds.may_hold(point) or not reaches_down(point))

    return trace_region([*segments, *near], hangs, cuts)


def trace_region(
    segments: Sequence[Segment],
    inside: Callable[[Point], bool],
    cuts: Sequence[tuple[Segment, Point]] = (),
) -> list[Array]:
    """Return the loops (N, 3) around a region, which lies on their left; outer ones first, the largest before
    all.

    The segments hold all of its border, and ``inside`` says whether a point that lies on none of them belongs
    to it. Cuts are further points at which the carriers of segments are to be cut. Refuses a border that does
    not close.
    """
    pieces = find_border_pieces(
        subdivide(segments, cuts), lambda points: list(map(inside, points)), NEAR_BESIDE
    )
    loops = [merge_border_pieces(loop) for loop in join_border_loops(pieces)]
    sizes = [(compute_signed_area(loop_segments(loop)), loop) for loop in loops]
    return [loop for size, loop in sorted(sizes, key=lambda one: -one[0]) if abs(size) > SLIVER]


def trace_region_of_faces(face_borders: Sequence[FaceBorder]) -> list[Array]:
    """Return the loops (N, 3) of level faces of one height, without the edges along which they touch.

    CAD programs split a face where a line was once imprinted on it. One face without curves stays as it is.
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
    """Return whether a point surely lies on one of some faces, as a function."""
    rows = [segment_rows(make_segments(one.loops)) for one in face_borders]
    bounds = [one.bounds for one in face_borders]

    def is_on(point: Point) -> bool:
        # Curves along which two faces touch are lost, as polygons hold them on both sides.
        return any(is_inside(*point, own) for own in rows) and not any(one.may_hold(point) for one in bounds)

    return is_on


def list_border_segments(face_borders: Sequence[FaceBorder]) -> list[Segment]:
    """Return the segments and the polygons' sides of some borders."""
    return [one for border in face_borders for one in border.bounds.lines]


def list_lines_near(bounds: Enclosure, box: Box) -> Iterator[Segment]:
    x0, y0, x1, y1 = box
    for one in bounds.lines:
        low_x, low_y, high_x, high_y = bounding_box(one)
        if low_x <= x1 + OFF and high_x >= x0 - OFF and low_y <= y1 + OFF and high_y >= y0 - OFF:
            yield one


def compute_box_around(faces: Sequence[SolidFace]) -> Box:
    """Return the box around some faces, seen from above."""
    x0, y0, x1, y1 = np.array([face.box for face in faces]).T
    return float(x0.min()), float(y0.min()), float(x1.max()), float(y1.max())


def boxes_overlap(a: Box, b: Box) -> bool:
    """Return whether two boxes have more than a border in common."""
    return a[0] < b[2] - OFF and b[0] < a[2] - OFF and a[1] < b[3] - OFF and b[1] < a[3] - OFF


def make_segments(loops: Sequence[Array]) -> list[Segment]:
    return [segment for loop in loops for segment in loop_segments(loop)]


def merge_border_pieces(loop: Sequence[BorderPiece]) -> Array:
    """Return the vertices (N, 3) of a border's loop, where pieces that continue one line or half a circle are one."""
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
    return before.carrier is after.carrier


def compute_sweep(run: Sequence[BorderPiece]) -> float:
    """Return the angle over which pieces of one circle run, in radians; 0 on a line."""
    if isinstance(run[0].carrier.segment, Line):
        return 0.0
    return sum(piece.high - piece.low for piece in run)


def read_borders(faces: Sequence[SolidFace]) -> list[FaceBorder]:
    """Return the borders of level faces; without those that the library cannot tell."""
    return [border for face in faces if (border := find_face_border(face)) is not None]


def find_face_border(face: SolidFace) -> FaceBorder | None:
    """Return the border of a level face; None where it cannot be read."""
    try:
        edges = trace_borders(make_level_region(face.shape, face.low, face.upward))
        if not all(one.is_disguise for one in edges.curves.values()):
            # The section has curves of its own near the face's, which are exact.
            edges = trace_borders(face.shape)
        chains = [make_closed_loop(chain).vertices for chain in edges.chains]
        order = sorted(range(len(chains)), key=lambda k: -abs(compute_signed_area(loop_segments(chains[k]))))
        true = {label: one.pieces for label, one in edges.curves.items() if not one.is_disguise}
        bounds, loops = Enclosure(), list[Array]()
        for number, k in enumerate(order):
            loop = chains[k]
            if true.keys().isdisjoint(edges.chains[k].labels):
                bounds.segments += loop_segments(loop)
            else:
                loop = replace_curves_by_chords(edges.chains[k], true, bounds)
            is_turned = (compute_signed_area(loop_segments(chains[k])) > 0) != (number == 0)
            loops.append(reverse_vertices(loop) if is_turned else loop)
    except InputError:
        return None
    return FaceBorder(loops, bounds) if loops else None


def replace_curves_by_chords(chain: Chain, curves: Mapping[str, Pieces], bounds: Enclosure) -> Array:
    """Return the vertices (N, 3) of a face's border with chords in the place of its curves.

    The chain is the border with some lines and arcs in their place, and ``curves`` has the pieces of each by
    its label. Added to the bounds are its lines and arcs, and polygons that hold its curves. Refuses a curve
    that takes too many chords.
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
    """Return whether points along a curve run from its end to its start."""
    start, end = point_at(pieces, 0.0), point_at(pieces, float(len(pieces)))
    if dist(start, end) > SHORTEST:
        return dist(run[0], end) < dist(run[0], start)
    return (measure_enclosed_area(points_along(pieces, 8)) > 0) != (measure_enclosed_area(np.array(run)) > 0)


def measure_enclosed_area(points: Array) -> float:
    """Return the area in mm² within points (N, 2) in running order, positive where that is counter-clockwise."""
    x, y = points.T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
