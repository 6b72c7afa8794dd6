"""The best fixtures first: searches up to a limit of the location error that grows until enough are found.

In the usual ranking a fit fixture without warnings comes before every fixture whose effective location error
is a tenth larger. Once enough such fixtures are known, no fixture with an error a tenth above theirs can be
among the best. Therefore fixtures with a small error are searched first.

Three locators have a small error only far apart and on faces with different normals. So features are cut into
short stretches, called spots, and the error of three locators on three spots is bounded
(``kernels.contact.location_bounds``). Chords are made only between spots that two locators with a small error
may touch. A limited search is a small part of the whole search and works in the same way, with proof.

The effective error is larger by half at angles other than the drawing's and its quarter turns. So the limit
holds unchanged at square angles and is divided by 1.5 at others, where often no fixture is left.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, pi

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.curves import loosen_rows
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
    find_least_middle_error,
    join_near_spots,
)
from workhold.kernels.curves.near_spots import NEARLY_WHOLE
from workhold.listing.ranking import A_STEP, OrderKeys, make_best_possible_figures, make_order_keys
from workhold.model.first_choice import FACTORS
from workhold.model.quality import LOCATION_ERROR, PENALTY, SMALLEST_FACE, TILT
from workhold.model.query import Query
from workhold.search.toolkit_search import ASLANT, limit_precision
from workhold.statics.effective_error import find_unasked_faces
from workhold.statics.judging import JudgingLimits
from workhold.statics.quality import find_main_direction, find_silhouette_extremes, measure_faces

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

# The finest spots are no longer than the part's size divided by SPOTS_ACROSS, and on arcs turn by no more
# than MOST_TURN radians.
SPOTS_ACROSS, MOST_TURN = 32, pi / 8
# Largest number of times that a spot is halved.
MOST_CUTS = 3
# Triples are stored for up to this many spots; for more they would take too much memory.
MOST_TRIPLED = 360
# Points nearer to each other than this part of L count as one.
BESIDE = 0.1
# Numbers of directions over half a turn, and of outermost points, for which movements are bounded.
DIRECTIONS, OUTERMOST = 8, 8
# With one clamp and with two: the first limit over the least error of any three contacts; each next limit
# over the last, as long as too few fixtures are found; and how many limits are tried. With two clamps
# contacts wait together in memory, and grow with the tenth power of the limit, so limits grow slowly.
OF_ONE, OF_TWO = (1.1, 1.3, 9), (0.9, 1.1, 25)
IN_BORE = next(one.times for one in FACTORS if one.key == "dowel_in_bore")
# Number of values tried between the last limit and the largest useful one.
NEARER = 40


def can_limit_errors(query: Query) -> bool:
    """Return whether a query's best fixtures can be searched by limits of the location error.

    The query must ask for a number of best fixtures, in the usual ranking, with a tolerance above 0. The part
    must have the same outline for all carriers.
    """
    off = query.tolerance.peg + query.tolerance.face
    return query.best is not None and query.has_house_order and off > 0.0 and not query.workpiece.outlines


@frozen(eq=False)
class ErrorLimit:
    """A limit of the effective location error, and the contacts of locators that it leaves to search.

    Parameters
    ----------
    precision : error bounds with the limit, as the kernels take them.
    square : pairs and triples of spots that locators may touch when the part lies square to the drawing.
    aslant : the same for all other angles.
    boxes : number of triples of spots that were looked at.
    ruled_out : number of the triples that the bound ruled out.
    """

    precision: Precision
    square: NearSpots
    aslant: NearSpots
    boxes: int
    ruled_out: int

    @property
    def statistics(self) -> dict[str, int]:
        """Counts of boxes (triples of spots) by name, for ``Result.statistics``."""
        return {"boxes": self.boxes, "boxes_ruled_out": self.ruled_out}


@frozen(eq=False)
class LocatorSpots:
    """The spots, short stretches, of those features that standing pegs touch, in a tree by halving.

    Parameters
    ----------
    spots : (S, 7) spots, the coarsest first; columns see ``kernels.contact.location_bounds``.
    roots : number of coarsest spots.
    starts : (F + 1,) for F features; the finest spots of feature f have the numbers starts[f] to
        starts[f + 1] - 1.
    precision : error bounds without a limit.
    """

    spots: Array
    roots: int
    starts: IntArray
    precision: Precision

    @classmethod
    def from_problem(cls, problem: Problem) -> LocatorSpots:
        """Return the spots of the features that a problem's standing pegs touch.

        A whole circle is numbered as a single finest spot.
        """
        rows, precision = loosen_rows(problem.rows[:, :SEGMENT_LENGTH]), bound_location_errors(problem)
        apart = find_largest_distance(find_outermost_points(problem))
        first, end = problem.standing
        cut = [
            cut_feature(row, number, give, apart, problem.wrench_length)
            for number, (row, give) in enumerate(
                zip(rows[first:end], precision.gives[first:end].tolist(), strict=True)
            )
        ]
        # The place of a contact on a whole circle does not matter, so all its finest spots count as one.
        whole = (rows[first:end, IS_ARC] != 0.0) & (rows[first:end, HALF_EXTENT] > NEARLY_WHOLE)
        sizes = [1 if is_one else len(levels[-1]) for is_one, levels in zip(whole, cut, strict=True)]
        starts = np.cumsum([0, *sizes])
        roots = sum(len(levels[0]) for levels in cut)
        return cls(join_spots(cut, starts), roots, starts, precision)

    def make_error_limit(self, most: float) -> ErrorLimit:
        """Return the limit for an effective location error of at most ``most`` mm."""
        (square, one), (aslant, other) = self.find_near_spots(most), self.find_near_spots(most / ASLANT)
        boxes, ruled_out = (one + other).tolist()
        return ErrorLimit(limit_precision(self.precision, most), square, aslant, boxes, ruled_out)

    def find_near_spots(self, most: float) -> tuple[NearSpots, IntArray]:
        """Return (1) the spots that locators may touch together, and (2) counts (2,).

        The spots are given as the pairs and triples of finest spots that three locators may touch for an
        effective error of at most ``most`` mm. Triples are kept for up to :data:`MOST_TRIPLED` spots. The
        counts are: triples looked at, triples ruled out.
        """
        count, counts = int(self.starts[-1]), np.zeros(2, np.int64)
        kept = count if count <= MOST_TRIPLED else 0
        near = NearSpots(self.starts, np.zeros((count, count), np.int8), np.zeros((kept,) * 3, np.int8))
        waiting = np.empty((MOST_WAITING, 3), np.int64)
        join_near_spots(self.spots, self.roots, most, self.precision, near, counts, waiting, np.empty((4, 3)))
        return near, counts

    @property
    def least_middle_error(self) -> float:
        """Smallest effective location error in mm of three contacts in the middles of coarsest spots."""
        return float(find_least_middle_error(self.spots, self.roots, self.precision, np.empty((4, 3))))


def bound_location_errors(problem: Problem) -> Precision:
    """Return the kernels' bounds of a problem's location errors, without a limit (``most`` is inf)."""
    points = find_outermost_points(problem)
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


def find_outermost_points(problem: Problem) -> Array:
    """Return a few points (C, 2) in mm of the part's silhouette that are each outermost in one of 8
    directions.

    Coordinates are relative to the part's centre. Points nearly coincident with another one are left out.
    """
    corners, arcs = find_silhouette_extremes(problem.workpiece)
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
        # Points near one already chosen add nothing.
        if all(np.hypot(*(point - other)) > BESIDE * problem.wrench_length for other in out):
            out.append(point)
    return np.array(out)


def find_largest_distance(points: Array) -> float:
    """Return the largest distance in mm between two of the points (C, 2)."""
    return max(float(np.hypot(*(points - point).T).max()) for point in points)


def compute_contact_allowances(rows: Array, points: Array) -> Array:
    """Return for each feature an upper bound of the change of the location error per shift of the contact,
    (F,).

    The shift is in mm along a straight feature, in radians along an arc. ``rows`` are the kernel rows of F
    features; ``points`` (C, 2) are points of the silhouette in mm.
    """
    apart, hull = find_largest_distance(points), compute_convex_hull(map(tuple, points.tolist()))
    away = [
        measure_distance_from_hull(hull, place) if is_arc else 0.0
        for is_arc, *place in rows[:, [IS_ARC, X, Y]].tolist()
    ]
    return np.where(rows[:, IS_ARC] == 0.0, 2.0 / apart, 1.0 + 2.0 * np.array(away) / apart)


def measure_distance_from_hull(hull: Sequence[Point], place: Point) -> float:
    """Return the distance in mm of a point from a convex hull; 0 inside.

    ``hull`` lists the corners counter-clockwise.
    """
    sides = [Line(one, other) for one, other in zip(hull, [*hull[1:], hull[0]], strict=True)]
    if len(hull) > 2 and all(is_left_of(side, place) for side in sides):
        return 0.0
    return min(measure_distance_to_segment(place, side) for side in sides)


def is_left_of(side: Line, place: Point) -> bool:
    """Return whether a point is to the left of a directed segment, or on the line through it."""
    (x0, y0), (x1, y1) = side.start, side.end
    return (x1 - x0) * (place[1] - y0) >= (y1 - y0) * (place[0] - x0)


def cut_feature(row: Array, number: int, give: float, apart: float, length: float) -> list[Array]:
    """Return the spots of a feature as a list of arrays (2**k, 7), from the coarsest to the finest.

    Each array has twice as many spots as the one before: spot i is cut into the spots 2·i and 2·i + 1. There
    are at most ``MOST_CUTS + 1`` arrays.

    Parameters
    ----------
    row : kernel row of the feature.
    number : number of the feature.
    give : the feature's value from :func:`compute_contact_allowances`.
    apart : largest distance in mm between two points of the silhouette.
    length : characteristic length L of the wrenches, in mm.
    """
    half, is_arc = float(row[HALF_EXTENT]), row[IS_ARC] != 0.0
    size = 2.0 * half * (float(row[RADIUS]) if is_arc else 1.0)
    pieces = max(size * SPOTS_ACROSS / apart, 2.0 * half / MOST_TURN if is_arc else 1.0, 1.0)
    cuts = int(np.ceil(np.log2(pieces)))
    counts = [1 << cut for cut in range(max(cuts - MOST_CUTS, 0), cuts + 1)]
    return [make_spots(row, number, count, give, length) for count in counts]


def make_spots(row: Array, number: int, count: int, give: float, length: float) -> Array:
    """Return ``count`` equal spots of a feature, (count, 7); the columns that link to finer spots stay 0.

    Parameters as in :func:`cut_feature`.
    """
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
    """Return all spots of all features, (S, 7), from coarse to fine, each linked to the spots that it is cut
    into.

    The link columns of the input arrays are filled in place. A spot that is cut has count 2 and the index of
    its first half; a finest spot has its number.

    Parameters
    ----------
    cut : for each feature the arrays that :func:`cut_feature` returns.
    starts : (F + 1,); the finest spots of feature f have the numbers starts[f] to starts[f + 1] - 1.
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
    """Return lower bounds of the ranking keys of fixtures whose effective error is above ``most`` mm.

    The six rows are: drawn angle, quarter turn, other angle; each first without and then with a dowel in a
    bore.
    """
    times = [find_factor(key) for key in (None, "quarter_turn", "other_angle")]
    rows = [(place, times[place] * bore) for place in range(3) for bore in (1.0, IN_BORE)]
    quality = make_best_possible_figures(len(rows), query)
    quality[:, LOCATION_ERROR] = [most / total for _, total in rows]
    # Where the drawing lies aslant, other angles may be square.
    is_square = find_main_direction(query.workpiece) == 0.0
    quality[:, TILT] = [SQUARE_TILT * (is_square and place == 2) for place, _ in rows]
    quality[:, SMALLEST_FACE] = np.nanmax(measure_faces(query.workpiece))
    judging = JudgingLimits.from_toolkit(1.0, query.toolkit, query.tolerance)
    quality[:, PENALTY] = evolve(judging, small_face=0.0).compute_penalty(quality)
    return make_order_keys(quality, query, np.full(len(rows), most), np.array([place for place, _ in rows]))


def choose_first_limit(spots: Sequence[LocatorSpots], query: Query) -> float:
    """Return the first limit of the effective location error in mm, from the spots of each direction of the
    clamp.
    """
    return choose_limit_growth(query)[0] * min(one.least_middle_error for one in spots)


def choose_limit_growth(query: Query) -> tuple[float, float, int]:
    """Return how the limits of the location error grow.

    The result is (first limit divided by the least error, each further limit divided by the one before,
    largest number of limits).
    """
    return OF_ONE if query.toolkit.travel_count == 1 else OF_TWO


def is_enough(most: float, kept: OrderKeys, query: Query) -> bool:
    """Return whether the best fixtures surely have an effective error up to ``most`` mm.

    ``kept`` are the ranking keys of the fixtures found up to that limit.
    """
    if most == inf:
        return True
    bound = bound_keys_beyond_limit(most, query)
    return bool(bound.are_beaten(kept, query.best or 0, bound.lowest_error).all())


def choose_next_limit(most: float, kept: OrderKeys, query: Query, number: int) -> float:
    """Return the next limit in mm, after ``most`` was not enough; inf where limits do not help any longer.

    ``kept`` are the ranking keys of the fixtures found up to ``most`` mm, ``number`` is how many limits were
    tried.
    """
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


def find_factor(key: str | None) -> float:
    """Return the factor by which a drawback multiplies the location error; 1.0 for None.

    ``key`` is the drawback's key in ``FACTORS``, such as "quarter_turn".
    """
    return next((one.times for one in FACTORS if one.key == key), 1.0)
