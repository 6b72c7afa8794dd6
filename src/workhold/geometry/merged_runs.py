"""The merging of runs of short chords, or of arcs, that are one line or one arc within rounding.

Programs without arcs write them as hundreds of chords. Programs that cut curves into arcs give each arc its
own centre, and those that cut a circle round each arc by itself. For a peg these are one face, and the search
would have to separate hundreds of nearly equal contacts.

Glossary
--------
chain : as many neighbouring arcs of a loop as there are that turn the same way and are nearly tangent where
    they meet.
run : neighbouring segments of a loop that one line or arc through the ends of the run stands for.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2, cos, dist, floor, inf, isfinite, log10, pi, sin, tan, tau

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.conventions import DISGUISE, DRAWN_ON, READING, SHORTEST
from workhold.geometry.curve_fit import fit_circle, ignore_interrupt
from workhold.geometry.loop import cut_into_runs
from workhold.geometry.rational import bound_departure, join_pieces, split_arc
from workhold.geometry.segment import Arc, Line, Point, Segment, make_segment_from_bulge

__all__ = [
    "ChordedArcs",
    "MergedLoop",
    "find_chorded_arcs",
    "describe_chords",
    "merge_chords",
    "put_arcs_on_one_circle",
]

Array = NDArray[np.float64]


def put_arcs_on_one_circle(vertices: Array, segments: Sequence[Segment]) -> tuple[Array, int]:
    """Return a loop's vertices after moving each chain of arcs within ``READING`` mm of one circle onto that
    circle.

    The first and last point of a chain stay where they are, unless the whole loop is one chain. A second call
    changes nothing more.

    Parameters
    ----------
    vertices : (N, 3) of a loop.
    segments : its segments.

    Returns
    -------
    tuple
        The vertices (N, 3), read-only, and the number of changed arcs.
    """
    out, changed = np.array(vertices), 0
    for chain in find_arc_chains(segments):
        arcs = [segment for k in chain if isinstance(segment := segments[k], Arc)]
        circle = None if have_equal_circles(arcs) else fit_common_circle(arcs, len(chain) == len(segments))
        if circle is not None:
            write_chain(out, chain, circle, len(segments))
            changed += len(chain)
    out.setflags(write=False)
    return out, changed


def have_equal_circles(arcs: Sequence[Arc]) -> bool:
    """Return whether all arcs have the same centre and radius, within the rounding of a drawing."""
    first, hair = arcs[0], READING / 100
    return all(dist(arc.center, first.center) + abs(arc.radius - first.radius) < hair for arc in arcs)


def may_share_circle(one: Segment, other: Segment) -> bool:
    """Return whether segment ``other``, next after ``one``, may lie on the same circle.

    Both must be arcs of similar radius that turn the same way and are nearly tangent where they meet. (An arc
    within e of a circle is turned against it by at most about 4 e / chord.)
    """
    if not (isinstance(one, Arc) and isinstance(other, Arc)) or one.sign != other.sign:
        return False
    if abs(one.radius - other.radius) > 0.1 * (one.radius + other.radius) or one.is_full or other.is_full:
        return False
    ends = one.compute_normal(one.sign * one.half_sweep), other.compute_normal(-other.sign * other.half_sweep)
    chord = min(arc.radius * min(sin(min(arc.half_sweep, pi / 2)), 1.0) * 2 for arc in (one, other))
    return dist(*ends) <= 16 * READING / chord + 1e-9


def find_arc_chains(segments: Sequence[Segment]) -> list[list[int]]:
    """Return each chain of two or more arcs that may lie on one circle, as a list of their indices in running
    order.
    """

    def continues(one: int, other: int) -> bool:
        return may_share_circle(segments[one], segments[other])

    found = cut_into_runs(range(len(segments)), continues)
    return [chain for chain in found if len(chain) > 1 and isinstance(segments[chain[0]], Arc)]


def fit_common_circle(arcs: Sequence[Arc], whole: bool) -> tuple[Point, float] | None:
    """Return centre and radius in mm of a circle that is within ``READING`` mm of all arcs of a chain.

    None if there is no such circle.

    The circle goes through both ends of the chain, unless ``whole`` says that the chain is a closed loop. It
    is the least-squares circle through the arcs' ends and middles (I. Kasa, "A circle fitting procedure and
    its error analysis", IEEE Transactions on Instrumentation and Measurement 25 (1976) 8-14), with its centre
    moved so that it is equally far from both ends.
    """
    if len(arcs) < 2 or (whole and abs(sum(arc.half_sweep for arc in arcs) - pi) > 1e-3):
        return None
    points = np.array(
        [point for arc in arcs for point in (arc.start, arc.compute_point(0.0))] + [arcs[-1].end]
    )
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    (a, b, c), *_ = np.linalg.lstsq(np.column_stack([x, y, np.ones(len(x))]), x * x + y * y, rcond=None)
    center, radius = middle + np.array([a, b]) / 2, float(np.sqrt(max(c + (a * a + b * b) / 4, 0.0)))
    if not whole:
        start, end = points[0], points[-1]
        along = end - start
        size = float(np.hypot(*along))
        if size < 1e-3 * radius:
            return None
        center = center - along * float(along @ (center - (start + end) / 2)) / size**2
        radius = float(np.hypot(*(start - center)))
    place = float(center[0]), float(center[1])
    return (place, radius) if all(is_near(arc, place, radius) for arc in arcs) else None


def is_near(arc: Arc, center: Point, radius: float) -> bool:
    """Return whether all points of an arc are within ``READING`` mm of the circle with this centre and radius
    in mm.

    The distance from the centre is extreme at the arc's ends, and on the line through both centres.
    """
    points = [arc.start, arc.end, arc.compute_point(0.0)]
    toward = atan2(arc.center[1] - center[1], arc.center[0] - center[0])
    for angle in (toward, toward + pi):
        parameter = (angle - arc.mid_angle + pi) % tau - pi
        if abs(parameter) <= arc.half_sweep:
            points.append(arc.compute_point(parameter))
    return all(abs(dist(point, center) - radius) <= READING for point in points)


def write_chain(out: Array, chain: Sequence[int], circle: tuple[Point, float], count: int) -> None:
    """Move a chain of arcs onto a circle, in place in the vertices ``out`` (N, 3) of a loop.

    The chain's inner vertices and its bulges are written. ``chain`` are the indices of its arcs, ``count`` is
    N.
    """
    (cx, cy), radius = circle
    places = [*chain, (chain[-1] + 1) % count]
    angles = [atan2(out[k, 1] - cy, out[k, 0] - cx) for k in places]
    sign = 1.0 if out[places[0], 2] > 0 else -1.0
    first = 0 if len(chain) == count else 1
    for k, angle in zip(places[first:-1], angles[first:-1], strict=True):
        out[k, :2] = cx + radius * cos(angle), cy + radius * sin(angle)
    for k, one, other in zip(places[:-1], angles[:-1], angles[1:], strict=True):
        out[k, 2] = sign * tan((sign * (other - one)) % tau / 4)


# Radians. Chords that meet at more than this are a corner.
CORNER_OF_CHORDS = 0.4
# Smallest number of chords that can be an arc: four corners of a drawing lie on one only on purpose.
LEAST_CHORDS = 4


@frozen
class MergedLoop:
    """A loop in which runs of segments are replaced by one segment each.

    Parameters
    ----------
    vertices : (N, 3) array of x, y in mm and bulge.
    firsts : for each segment, the index of the first of the original segments that it replaces.
    merged : number of segments that the loop has less than the original.
    departure : upper bound in mm of the distance of any point of either loop from the other loop.
    """

    vertices: Array
    firsts: tuple[int, ...]
    merged: int
    departure: float


@frozen
class MergedPiece:
    """A segment that replaces one or several original segments.

    Parameters
    ----------
    start : its first point, in mm; it ends where the next piece starts.
    bulge : tan(sweep / 4), 0 for a line.
    first : index of the first original segment that it replaces.
    kept : whether it must not be merged further.
    departure : upper bound of its distance from the original segments, in mm.
    """

    start: Point
    bulge: float
    first: int
    kept: bool
    departure: float = 0.0


def merge_chords(
    vertices: Array,
    fit: float | None = None,
    kept: Sequence[bool] = (),
    interrupt: Callable[[], None] = ignore_interrupt,
) -> MergedLoop:
    """Return a loop in which each run of segments that lies within ``DISGUISE`` mm of one line or arc is
    replaced by it.

    Parameters
    ----------
    vertices : (N, 3) array of a loop.
    fit : larger tolerance in mm within which chords are replaced by an arc; None to use ``DISGUISE``.
    kept : for each segment whether it is kept unchanged; empty if all may be replaced.
    interrupt : called before every run; may raise an error to stop.
    """
    pieces = [
        MergedPiece((float(x), float(y)), float(b), k, bool(kept) and kept[k])
        for k, (x, y, b) in enumerate(vertices)
    ]
    count = len(pieces)
    tolerance = DISGUISE if fit is None else max(fit, DISGUISE)
    whole = fit_whole_circle(pieces, tolerance)
    if whole is not None:
        pieces = whole
    elif count > 2:
        drawn = begin_at_corner(pieces)
        pieces = merge_all_runs(drawn, tolerance, interrupt)
        if 1 < len(pieces) < count:
            # Where a run has ended the loop can begin: no other goes across.
            number = next(k for k, piece in enumerate(drawn) if piece.first == pieces[1].first)
            pieces = merge_all_runs(drawn[number:] + drawn[:number], tolerance, interrupt)
    if len(pieces) == count:
        return MergedLoop(vertices, tuple(range(count)), 0, 0.0)
    begin = min(range(len(pieces)), key=lambda k: pieces[k].first)
    pieces = pieces[begin:] + pieces[:begin]
    rows = np.array([(*piece.start, piece.bulge) for piece in pieces])
    away = max(piece.departure for piece in pieces)
    return MergedLoop(rows, tuple(piece.first for piece in pieces), count - len(pieces), away)


# mm. Vertices this near to a circle count as drawn on it, in a file with few digits.
CHORDS_ON = 0.01
# mm and a share of the radius: chords farther inside their circle than both are sides of a polygon; the share is
# that of 20 sides to the circle.
COARSE, COARSE_SHARE = 0.5, 0.0123
# Leading digits of the tolerances that are proposed.
FITS = (1.0, 2.0, 5.0, 10.0, 20.0)


@frozen
class ChordedArcs:
    """Arcs and circles that a loop approximates by chords, with a departure too large for silent merging.

    Parameters
    ----------
    chords : how many chords.
    radii : of the arcs, in mm, each once.
    departure : distance of the chords from the arcs, in mm.
    fit : tolerance in mm with which :func:`merge_chords` turns them into arcs.
    """

    chords: int
    radii: tuple[float, ...]
    departure: float
    fit: float


def find_chorded_arcs(
    vertices: Array, kept: Sequence[bool] = (), interrupt: Callable[[], None] = ignore_interrupt
) -> ChordedArcs | None:
    """Return the arcs that a loop approximates by chords; None if it has none.

    Four chords or more count as an arc where neighbours meet at less than ``CORNER_OF_CHORDS`` and all ends
    lie on one circle. So a regular polygon of up to 15 sides stays a polygon, and one of 16 sides may be a
    circle: four chords per quarter turn are the coarsest that programs write. Chords also stay a polygon where
    they run farther inside the circle than both ``COARSE`` mm and ``COARSE_SHARE`` of its radius.

    Parameters
    ----------
    vertices, kept, interrupt : as in :func:`merge_chords`.
    """
    if len(vertices) <= LEAST_CHORDS:
        return None
    pieces = [
        MergedPiece((float(x), float(y)), float(b), k, b != 0.0 or (bool(kept) and kept[k]))
        for k, (x, y, b) in enumerate(vertices)
    ]
    found = fit_whole_circle(pieces, inf, CHORDS_ON)
    if found is None:
        found = merge_longest_runs(begin_at_corner(pieces), CHORDS_ON, inf, LEAST_CHORDS, interrupt)
    arcs = [
        (piece, after)
        for piece, after in zip(found, found[1:] + found[:1], strict=True)
        if piece.bulge and piece.departure > DISGUISE and not is_coarse(piece, after)
    ]
    if not arcs:
        return None
    away = max(piece.departure for piece, _ in arcs)
    scale = 10.0 ** floor(log10(away))
    fit = next(step * scale for step in FITS if step * scale >= 1.05 * away)
    fit = float(f"{fit:.1g}")
    merged = merge_chords(vertices, fit, kept, interrupt)
    chords = len(vertices) - len(merged.vertices)
    if chords <= 0 or not merged.vertices[:, 2].any():
        return None
    radii = list[float]()
    for piece, after in arcs:
        arc = make_segment_from_bulge(piece.start, after.start, piece.bulge)
        if isinstance(arc, Arc) and not any(abs(arc.radius - radius) < CHORDS_ON for radius in radii):
            radii.append(arc.radius)
    return ChordedArcs(chords + len(arcs), tuple(radii), away, fit)


def is_coarse(piece: MergedPiece, after: MergedPiece) -> bool:
    """Return whether chords are so far inside the arc through their ends that a polygon is meant.

    ``piece`` is the arc; it ends where ``after`` starts.
    """
    arc = make_segment_from_bulge(piece.start, after.start, piece.bulge)
    return isinstance(arc, Arc) and piece.departure > max(COARSE, COARSE_SHARE * arc.radius)


def describe_chords(found: Sequence[ChordedArcs], fit: str) -> list[str]:
    """Return a list of one sentence on arcs that were given as chords; an empty list where ``found`` is
    empty.

    Parameters
    ----------
    fit : name of the option with which a user sets the tolerance.
    """
    if not found:
        return []
    radii = sorted({float(f"{radius:.4g}") for one in found for radius in one.radii})
    named = ", ".join(f"{radius:g}" for radius in radii[:5]) + (" mm and others" if len(radii) > 5 else " mm")
    chords, away = sum(one.chords for one in found), max(one.departure for one in found)
    return [
        f"{chords} straight pieces lie on arcs or circles of radius {named}, up to {away:.2g} mm inside them: "
        f"give {fit} {max(one.fit for one in found):g} to read these as arcs; without it each piece is a face."
    ]


def merge_all_runs(
    pieces: list[MergedPiece], tolerance: float, interrupt: Callable[[], None]
) -> list[MergedPiece]:
    """Return an open chain of pieces in which each run that is one line or arc is merged into one piece.

    Runs whose vertices lie on the line or arc to a drawing's last digits are merged before others.
    ``tolerance`` is in mm.
    """
    for near in (min(DRAWN_ON, tolerance), tolerance):
        pieces = merge_longest_runs(pieces, near, tolerance, LEAST_CHORDS, interrupt)
    return merge_longest_runs(pieces, DISGUISE, DISGUISE, 2, interrupt)


def begin_at_corner(pieces: list[MergedPiece]) -> list[MergedPiece]:
    """Return the pieces of a loop in the same cyclic order, starting at its sharpest corner.

    A loop without corners starts at its longest piece.
    """
    turns, points = np.abs(compute_turns(pieces)), list_starts(pieces)
    lengths = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    sharpest = int(np.argmax(turns))
    first = sharpest if turns[sharpest] > CORNER_OF_CHORDS else int(np.argmax(lengths))
    return pieces[first:] + pieces[:first]


def list_starts(pieces: Sequence[MergedPiece]) -> Array:
    """Return the start points (N, 2) of pieces, in mm."""
    return np.array([piece.start for piece in pieces])


def compute_turns(pieces: Sequence[MergedPiece]) -> Array:
    """Return the angle in radians by which a loop turns at the start of each piece (N,), positive
    counter-clockwise.
    """
    points = list_starts(pieces)
    along = np.roll(points, -1, axis=0) - points
    chord, half = np.arctan2(along[:, 1], along[:, 0]), 2 * np.arctan([piece.bulge for piece in pieces])
    turned = chord - half - np.roll(chord + half, 1)
    return np.asarray((turned + pi) % (2 * pi) - pi)


def fit_whole_circle(
    pieces: list[MergedPiece], tolerance: float, near: float | None = None
) -> list[MergedPiece] | None:
    """Return the two halves of the circle that is within a tolerance in mm of a loop; None if there is no
    such circle.

    The loop's vertices must be within ``near`` mm of the circle; None stands for the tolerance.
    """
    count = len(pieces)
    if not is_worth_fitting(pieces, 2 * LEAST_CHORDS) or any(piece.kept for piece in pieces):
        return None
    if (np.abs(compute_turns(pieces)) > CORNER_OF_CHORDS).any():
        return None
    points = list_starts([*pieces, pieces[0]])
    circle = fit_circle(
        points[:-1] if all(p.bulge == 0.0 for p in pieces) else insert_middles(pieces, points)
    )
    if circle is None:
        return None
    (cx, cy), radius = circle
    turned = sum(compute_turns(pieces)) + sum(4 * np.arctan(piece.bulge) for piece in pieces)
    sign = 1.0 if turned > 0 else -1.0
    angle = atan2(points[0, 1] - cy, points[0, 0] - cx)
    away = measure_departure(
        pieces, points, Arc((cx, cy), radius, angle + pi, pi, sign), near or tolerance, tolerance
    )
    if not isfinite(away) or (count == 2 and away < READING):
        return None
    x, y = cx + radius * np.cos(angle), cy + radius * np.sin(angle)
    one = MergedPiece((float(x), float(y)), sign, pieces[0].first, True, away)
    return [
        one,
        MergedPiece((float(2 * cx - x), float(2 * cy - y)), sign, pieces[count // 2].first, True, away),
    ]


def is_worth_fitting(pieces: Sequence[MergedPiece], least: int) -> bool:
    """Return whether there are enough pieces to be merged: two where all are arcs, else ``least``."""
    arcs = sum(piece.bulge != 0.0 for piece in pieces)
    return len(pieces) >= (2 if arcs == len(pieces) else least)


def merge_longest_runs(
    pieces: list[MergedPiece],
    near: float,
    tolerance: float,
    least: int,
    interrupt: Callable[[], None] = ignore_interrupt,
) -> list[MergedPiece]:
    """Return an open chain of pieces in which runs that are one line or arc are merged into one piece each.

    From the start of the chain on, the longest possible run is merged. Runs end at corners and at pieces that
    are kept.

    Parameters
    ----------
    near : largest distance of vertices from the line or arc, in mm.
    tolerance : largest distance in mm of the segments between the vertices; for arcs at most ``DISGUISE``.
    least : least number of pieces of a run with chords. Runs of fewer than ``LEAST_CHORDS`` become lines
        only.
    """
    points = list_starts([*pieces, pieces[0]])
    corner = np.abs(compute_turns(pieces)) > CORNER_OF_CHORDS
    ends = np.array([piece.kept for piece in pieces]) | np.roll([piece.kept for piece in pieces], 1) | corner
    # Ends of runs: kept pieces and corners.
    stops = np.append(np.flatnonzero(ends), len(pieces))
    out: list[MergedPiece] = []
    k = 0
    while k < len(pieces):
        interrupt()
        stop = int(stops[np.searchsorted(stops, k + 1)])
        # A run starts with two arcs, or ``least`` chords, and grows in steps that double and then halve.
        best, taken, step, growing = None, k + 1, 1, True
        for fewest in (2, least):
            if best is None and k + fewest <= stop:
                taken = k + fewest
                best = make_one_piece(pieces[k:taken], points[k : taken + 1], near, tolerance, least)
        while best is not None and step and taken < stop:
            further = min(taken + step, stop)
            longer = make_one_piece(pieces[k:further], points[k : further + 1], near, tolerance, least)
            growing = growing and longer is not None
            step = 2 * step if growing else step // 2
            if longer is not None:
                best, taken = longer, further
        if best is None:
            taken = k + 1
        out.append(pieces[k] if best is None else best)
        k = taken
    return out


def make_one_piece(
    pieces: Sequence[MergedPiece], points: Array, near: float, tolerance: float, least: int
) -> MergedPiece | None:
    """Return the line or arc that replaces a run of N pieces; None where neither is near enough.

    ``points`` (N + 1, 2) are the ends of the pieces. See :func:`merge_longest_runs` for the other parameters.
    """
    if not is_worth_fitting(pieces, least):
        return None
    start, end = (float(points[0, 0]), float(points[0, 1])), (float(points[-1, 0]), float(points[-1, 1]))
    chord = dist(start, end)
    if chord < SHORTEST:
        return None
    before = max(piece.departure for piece in pieces)
    line = Line(start, end)
    away = measure_departure(pieces, points, line, near, tolerance)
    if isfinite(away):
        return MergedPiece(start, 0.0, pieces[0].first, False, before + away)
    if not is_worth_fitting(pieces, LEAST_CHORDS):
        return None
    arc = fit_arc(pieces, points, line)
    if arc is None:
        return None
    away = measure_departure(pieces, points, arc, near, tolerance)
    return (
        MergedPiece(start, arc.sign * tan(arc.half_sweep / 2), pieces[0].first, True, before + away)
        if isfinite(away)
        else None
    )


def insert_middles(pieces: Sequence[MergedPiece], points: Array) -> Array:
    """Return ``points`` followed by the middle points of those pieces that are arcs."""
    chords = np.diff(points, axis=0)
    bulges = np.array([piece.bulge for piece in pieces])[:, None]
    middles = points[:-1] + chords / 2 + np.column_stack([chords[:, 1], -chords[:, 0]]) * bulges / 2
    return np.concatenate([points, middles[bulges[:, 0] != 0.0]])


def fit_arc(pieces: Sequence[MergedPiece], points: Array, line: Line) -> Arc | None:
    """Return the least-squares arc through a run's points and exactly through its ends; None where there is
    no such arc.

    ``line`` runs between these ends.
    """
    circle = fit_circle(insert_middles(pieces, points))
    if circle is None:
        return None
    (cx, cy), _ = circle
    (mx, my), (tx, ty) = line.middle, line.tangent
    along = (cx - mx) * tx + (cy - my) * ty
    cx, cy = cx - along * tx, cy - along * ty
    radius = dist(line.start, (cx, cy))
    angles = np.arctan2(points[:, 1] - cy, points[:, 0] - cx)
    sweep = float(((np.diff(angles) + pi) % (2 * pi) - pi).sum())
    # One bulge near a whole turn fixes the centre badly.
    if not 1e-9 < abs(sweep) < 1.9 * pi:
        return None
    return Arc((cx, cy), radius, float(angles[0]) + sweep / 2, abs(sweep) / 2, 1.0 if sweep > 0 else -1.0)


def measure_departure(
    pieces: Sequence[MergedPiece], points: Array, segment: Segment, near: float, tolerance: float
) -> float:
    """Return the largest distance in mm of a run of pieces from a line or arc.

    inf if it exceeds ``tolerance`` (or ``near`` for vertices), or if the run does not go forward along the
    segment.
    """
    if isinstance(segment, Arc):
        cx, cy = segment.center
        x, y = points[:, 0] - cx, points[:, 1] - cy
        away = np.abs(np.hypot(x, y) - segment.radius)
        forward = segment.sign * (x[:-1] * y[1:] - y[:-1] * x[1:])
    else:
        (x0, y0), (tx, ty) = segment.start, segment.tangent
        x, y = points[:, 0] - x0, points[:, 1] - y0
        away = np.abs(x * ty - y * tx)
        forward = np.diff(x * tx + y * ty)
    if away.max() > near or (forward <= 0.0).any():
        return inf
    if all(piece.bulge == 0.0 for piece in pieces):
        if isinstance(segment, Line):
            return float(away.max())
        # The foot of the centre on a chord is the nearest point; about a circle it lies between the ends, or
        # is no nearer.
        step = np.diff(points, axis=0)
        size = np.hypot(*step.T)
        share = np.clip(-(x[:-1] * step[:, 0] + y[:-1] * step[:, 1]) / size**2, 0.0, 1.0)
        feet = np.hypot(x[:-1] + share * step[:, 0], y[:-1] + share * step[:, 1])
        found = max(float(away.max()), float(np.abs(feet - segment.radius).max()))
        return found if found <= tolerance else inf
    ends = [(float(x), float(y)) for x, y in points]
    curves = [split_arc(ends[k], ends[k + 1], piece.bulge) for k, piece in enumerate(pieces)]
    return bound_departure(join_pieces(curves), segment, min(tolerance, DISGUISE))
