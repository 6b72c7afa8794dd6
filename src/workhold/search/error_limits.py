"""The best fixtures first: searches up to a limit of the location error, which grows until enough are found.

In the usual order one fixture surely comes before another whose effective location error is a tenth larger,
if it is fit for a workshop and has no warning. So once as many such fixtures are known as are asked for,
nothing with an error a tenth above theirs is among the best. What is searched first is therefore what has a
small error.

Three locators have a small error only far apart and on faces that do not all look the same way. So features
are cut into short stretches, spots, and a bound of the error is found for all three of them
(``kernels.contact.location_bounds``). Chords that join no two spots of a seat with a small error are not even
made. What is left of a limited search is a small part of all, and is searched as always, with proof.

Other angles than those of the drawing, by quarters, count half as much again. So square to the drawing the
limit holds as it is. Elsewhere it is a smaller one, below which there is often nothing at all.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, pi

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.curves import loosened
from workhold.contact.problem import Problem
from workhold.conventions import SQUARE_TILT
from workhold.geometry.hull import compute_convex_hull
from workhold.geometry.segment import Line, Point, measure_distance_to_segment
from workhold.kernels.base.feature import HALF_EXTENT, IS_ARC, RADIUS, SEGMENT_LENGTH, SIGN, X, Y
from workhold.kernels.base.tables import NearSpots, Precision
from workhold.kernels.contact.location_bounds import (
    MOST_WAITING,
    SPOT_COUNT,
    SPOT_FIRST,
    SPOT_LENGTH,
    join_near_spots,
    least_middle_error,
)
from workhold.kernels.curves.near_spots import NEARLY_WHOLE
from workhold.listing.ranking import A_STEP, OrderKeys, make_best_possible_figures, make_order_keys
from workhold.model.first_choice import FACTORS
from workhold.model.quality import LOCATION_ERROR, PENALTY, SMALLEST_FACE, TILT
from workhold.model.query import Query
from workhold.search.toolkit_search import ASLANT, limit_precision
from workhold.statics.effective_error import find_unasked_faces
from workhold.statics.judging import Judging
from workhold.statics.quality import extremes, main_direction, measure_faces

__all__ = [
    "ErrorLimit",
    "LocatorSpots",
    "can_limit_errors",
    "choose_first_limit",
    "is_enough",
    "bound_keys_beyond_limit",
    "choose_next_limit",
    "bound_location_errors",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# The finest spots are no longer than the part's size over this, and no arc turns by more in one, in radians.
SPOTS_ACROSS, MOST_TURN = 32, pi / 8
# Spots are cut in two so many times at most.
MOST_CUTS = 3
# Of more spots no triples are kept, which would take too much memory.
MOST_TRIPLED = 360
# Points nearer than this part of L are side by side.
BESIDE = 0.1
# Directions over half a turn, and points of the silhouette, in which movements are looked at.
DIRECTIONS, OUTERMOST = 8, 8
# The first limit is so many times the least error of any three contacts, and the next so many times the last
# one as long as too few fixtures are found. After so many there is none. The contacts of two clamps wait
# together in memory, and grow with the tenth power of the limit. So their limits grow slowly.
OF_ONE, OF_TWO = (1.1, 1.3, 9), (0.9, 1.1, 25)
IN_BORE = next(one.times for one in FACTORS if one.key == "dowel_in_bore")
# Limits between two among which the next is chosen.
NEARER = 40


def can_limit_errors(query: Query) -> bool:
    """Whether the best fixtures of a query are found by limits of the location error."""
    off = query.tolerance.peg + query.tolerance.face
    return query.best is not None and query.has_house_order and off > 0.0 and not query.workpiece.outlines


@frozen(eq=False)
class ErrorLimit:
    """A limit of the effective location error, and what it leaves of the search.

    Parameters
    ----------
    precision : for the kernels.
    square, aslant : which two spots locators may touch square to the drawing, and elsewhere.
    boxes, ruled_out : how many triples of spots were looked at, and how many the bound ruled out.
    """

    precision: Precision
    square: NearSpots
    aslant: NearSpots
    boxes: int
    ruled_out: int

    @property
    def statistics(self) -> dict[str, int]:
        """Counts for the account of the search."""
        return {"boxes": self.boxes, "boxes_ruled_out": self.ruled_out}


@frozen(eq=False)
class LocatorSpots:
    """The spots of the features that standing pegs of a problem touch.

    Parameters
    ----------
    spots : (S, 7), see ``kernels.contact.location_bounds``, the coarsest first.
    roots : how many of them are the coarsest.
    starts : (F + 1,) numbers of the finest ones of each feature.
    precision : without a limit.
    """

    spots: Array
    roots: int
    starts: IntArray
    precision: Precision

    @classmethod
    def of(cls, problem: Problem) -> LocatorSpots:
        """The spots of a problem."""
        rows, precision = loosened(problem.rows[:, :SEGMENT_LENGTH]), bound_location_errors(problem)
        apart = find_largest_distance(outermost(problem))
        first, end = problem.standing
        cut = [
            cut_feature(row, number, give, apart, problem.wrench_length)
            for number, (row, give) in enumerate(
                zip(rows[first:end], precision.gives[first:end].tolist(), strict=True)
            )
        ]
        # Nobody asks where on a whole circle a contact is, so all its spots count as one.
        whole = (rows[first:end, IS_ARC] != 0.0) & (rows[first:end, HALF_EXTENT] > NEARLY_WHOLE)
        sizes = [1 if is_one else len(levels[-1]) for is_one, levels in zip(whole, cut, strict=True)]
        starts = np.cumsum([0, *sizes])
        roots = sum(len(levels[0]) for levels in cut)
        return cls(join_spots(cut, starts), roots, starts, precision)

    def limit(self, most: float) -> ErrorLimit:
        """A limit of the effective error in mm."""
        (square, one), (aslant, other) = self.near(most), self.near(most / ASLANT)
        boxes, ruled_out = (one + other).tolist()
        return ErrorLimit(limit_precision(self.precision, most), square, aslant, boxes, ruled_out)

    def near(self, most: float) -> tuple[NearSpots, IntArray]:
        """Which two spots locators may touch up to an effective error in mm, and counts of boxes."""
        count, counts = int(self.starts[-1]), np.zeros(2, np.int64)
        kept = count if count <= MOST_TRIPLED else 0
        near = NearSpots(self.starts, np.zeros((count, count), np.int8), np.zeros((kept,) * 3, np.int8))
        waiting = np.empty((MOST_WAITING, 3), np.int64)
        join_near_spots(self.spots, self.roots, most, self.precision, near, counts, waiting, np.empty((4, 3)))
        return near, counts

    @property
    def least(self) -> float:
        """The least effective error in mm of three contacts in the middles of the coarsest spots."""
        return float(least_middle_error(self.spots, self.roots, self.precision, np.empty((4, 3))))


def bound_location_errors(problem: Problem) -> Precision:
    """What bounds location errors of a problem, without a limit."""
    points = outermost(problem)
    query, length = problem.query, problem.wrench_length
    angles = np.arange(DIRECTIONS) * (pi / DIRECTIONS)
    along = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    turn = (along[:, None, 1] * points[None, :, 0] - along[:, None, 0] * points[None, :, 1]) / length
    probes = np.concatenate([np.repeat(along, len(points), axis=0), turn.reshape(-1, 1)], axis=1)
    doubts = np.ones(len(problem.rows))
    if all(carrier.contact.is_placed for carrier in query.toolkit.carriers):
        doubts[find_unasked_faces(query)[problem.faces]] = IN_BORE
    tolerance = query.tolerance
    return Precision(
        problem.faces.astype(np.int64),
        doubts,
        compute_contact_allowances(problem.rows, points),
        np.ascontiguousarray(probes),
        tolerance.peg,
        tolerance.face,
        inf,
        inf,
    )


def outermost(problem: Problem) -> Array:
    """A few points (C, 2) of the silhouette about the centre, outermost in some directions."""
    corners, arcs = extremes(problem.workpiece)
    points = [corners]
    for x, y, radius, ahead, aside, cosine in arcs.tolist():
        half, middle = np.arccos(np.clip(cosine, -1.0, 1.0)), np.arctan2(aside, ahead)
        angle = middle + half * np.linspace(-1.0, 1.0, 2 * OUTERMOST + 1)
        points.append(np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1))
    every = np.concatenate(points)
    angles = np.arange(OUTERMOST) * (2.0 * pi / OUTERMOST) + pi / 8
    chosen = {int(np.argmax(every @ [np.cos(angle), np.sin(angle)])) for angle in angles}
    out: list[Array] = []
    for point in every[sorted(chosen)]:
        # Of two that are side by side one is enough.
        if all(np.hypot(*(point - other)) > BESIDE * problem.wrench_length for other in out):
            out.append(point)
    return np.array(out)


def find_largest_distance(points: Array) -> float:
    """The largest distance in mm of two points."""
    return max(float(np.hypot(*(points - point).T).max()) for point in points)


def compute_contact_allowances(rows: Array, points: Array) -> Array:
    """What contacts on features (F,) may be off by for a location error of 1.

    On a line it is for each mm that the contact is moved, on an arc for each radian. Points (C, 2) are those
    of the silhouette. Nothing between them moves farther than they.
    """
    apart, hull = find_largest_distance(points), compute_convex_hull(map(tuple, points.tolist()))
    away = [
        measure_distance_from_hull(hull, place) if is_arc else 0.0
        for is_arc, *place in rows[:, [IS_ARC, X, Y]].tolist()
    ]
    return np.where(rows[:, IS_ARC] == 0.0, 2.0 / apart, 1.0 + 2.0 * np.array(away) / apart)


def measure_distance_from_hull(hull: Sequence[Point], place: Point) -> float:
    """The distance in mm of a place from a convex hull, as ``geometry.hull`` gives it; 0 inside."""
    sides = [Line(one, other) for one, other in zip(hull, [*hull[1:], hull[0]], strict=True)]
    if len(hull) > 2 and all(is_left_of(side, place) for side in sides):
        return 0.0
    return min(measure_distance_to_segment(place, side) for side in sides)


def is_left_of(side: Line, place: Point) -> bool:
    """Whether a place is to the left of a segment, or on its line."""
    (x0, y0), (x1, y1) = side.start, side.end
    return (x1 - x0) * (place[1] - y0) >= (y1 - y0) * (place[0] - x0)


def cut_feature(row: Array, number: int, give: float, apart: float, length: float) -> list[Array]:
    """The spots of a feature, coarse ones first, in as many lists as it is cut.

    Parameters
    ----------
    give : see :func:`compute_contact_allowances`.
    apart : the largest distance in mm of two points of the silhouette.
    length : L in mm.
    """
    half, is_arc = float(row[HALF_EXTENT]), row[IS_ARC] != 0.0
    size = 2.0 * half * (float(row[RADIUS]) if is_arc else 1.0)
    pieces = max(size * SPOTS_ACROSS / apart, 2.0 * half / MOST_TURN if is_arc else 1.0, 1.0)
    cuts = int(np.ceil(np.log2(pieces)))
    counts = [1 << cut for cut in range(max(cuts - MOST_CUTS, 0), cuts + 1)]
    return [spots_of(row, number, count, give, length) for count in counts]


def spots_of(row: Array, number: int, count: int, give: float, length: float) -> Array:
    """So many spots (count, 7) of a feature, of which nobody knows yet what they are made of."""
    half, out = float(row[HALF_EXTENT]) / count, np.zeros((count, SPOT_LENGTH))
    at = (2.0 * np.arange(count) + 1.0 - count) * half
    axis = row[[3, 4]]
    if row[IS_ARC] == 0.0:
        place, normal = row[[X, Y]] + at[:, None] * axis, np.tile([axis[1], -axis[0]], (count, 1))
        off = half
    else:
        cosine, sine = np.cos(at)[:, None], np.sin(at)[:, None]
        ray = cosine * axis + sine * np.array([-axis[1], axis[0]])
        place, normal = row[[X, Y]] + row[RADIUS] * ray, row[SIGN] * ray
        off = min(half, 2.0)
    out[:, 0:2] = normal
    out[:, 2] = (place[:, 0] * normal[:, 1] - place[:, 1] * normal[:, 0]) / length
    out[:, 3], out[:, 4] = off * give, number
    return out


def join_spots(cut: Sequence[Sequence[Array]], starts: IntArray) -> Array:
    """All spots (S, 7) of features, the coarsest of each first, and what they are made of.

    Parameters
    ----------
    cut : of each feature, see :func:`cut_feature`.
    starts : numbers of the finest ones of each feature.
    """
    sizes = np.array(
        [[len(level[k]) if k < len(level) else 0 for level in cut] for k in range(MOST_CUTS + 1)]
    )
    offsets = (np.cumsum(sizes.ravel()) - sizes.ravel()).reshape(sizes.shape)
    for number, levels in enumerate(cut):
        for k, spots in enumerate(levels):
            if k < len(levels) - 1:
                spots[:, SPOT_COUNT] = 2.0
                spots[:, SPOT_FIRST] = offsets[k + 1, number] + 2 * np.arange(len(spots))
            else:
                # The spots of a whole circle have one number.
                last = starts[number + 1] - 1
                spots[:, SPOT_FIRST] = np.minimum(starts[number] + np.arange(len(spots)), last)
    return np.concatenate([levels[k] for k in range(MOST_CUTS + 1) for levels in cut if k < len(levels)])


def bound_keys_beyond_limit(most: float, query: Query) -> OrderKeys:
    """The least keys of fixtures that are not found up to a limit of the effective error in mm.

    They are one row for each class of angles, without and with a dowel in a bore, which the limit counts.
    """
    times = [factor(key) for key in (None, "quarter_turn", "other_angle")]
    rows = [(place, times[place] * bore) for place in range(3) for bore in (1.0, IN_BORE)]
    quality = make_best_possible_figures(len(rows), query)
    quality[:, LOCATION_ERROR] = [most / total for _, total in rows]
    # Where the drawing lies aslant, other angles may be square.
    is_square = main_direction(query.workpiece) == 0.0
    quality[:, TILT] = [SQUARE_TILT * (is_square and place == 2) for place, _ in rows]
    quality[:, SMALLEST_FACE] = np.nanmax(measure_faces(query.workpiece))
    judging = Judging.of(1.0, query.toolkit, query.tolerance)
    quality[:, PENALTY] = evolve(judging, small_face=0.0).penalty(quality)
    return make_order_keys(quality, query, np.full(len(rows), most), np.array([place for place, _ in rows]))


def choose_first_limit(spots: Sequence[LocatorSpots], query: Query) -> float:
    """The limit in mm to begin with, given the spots of each way of the toolkit."""
    return choose_limit_growth(query)[0] * min(one.least for one in spots)


def choose_limit_growth(query: Query) -> tuple[float, float, int]:
    """The first limit and each next one, relative to the one before, and how many there are."""
    return OF_ONE if query.toolkit.travels == 1 else OF_TWO


def is_enough(most: float, kept: OrderKeys, query: Query) -> bool:
    """Whether nothing beyond a limit in mm is among the best, given the keys of what was found up to it."""
    if most == inf:
        return True
    bound = bound_keys_beyond_limit(most, query)
    return bool(bound.are_beaten(kept, query.best or 0, bound.lowest).all())


def choose_next_limit(most: float, kept: OrderKeys, query: Query, number: int) -> float:
    """The limit in mm after one that was not enough, the so-manieth, given the keys of what it found."""
    known = kept.find_last_fine_error(query.best or 0)
    if known is None:
        _, times, limits = choose_limit_growth(query)
        return inf if number >= limits else times * most
    # Of the limits up to where all others surely have a step more, the least that will be enough.
    last = A_STEP * known
    if last <= most:
        return inf
    nearer = np.linspace(most, last, NEARER + 1)[1:].tolist()
    return next((limit for limit in nearer if is_enough(limit, kept, query)), last)


def factor(key: str | None) -> float:
    """The factor of a doubt; 1 for none."""
    return next((one.times for one in FACTORS if one.key == key), 1.0)
