"""Runs of short chords and of arcs that are one line or one arc but for a hair, made one.

Programs that cannot say an arc write it as hundreds of chords. Those that cut curves into arcs give each a
centre of its own, and those that cut a circle round each sweep by itself. To a peg they are one face, and the
search would have to separate hundreds of nearly equal contacts.

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
from workhold.geometry.curve_fit import fit_circle, never_interrupt
from workhold.geometry.loop import cut_into_runs
from workhold.geometry.rational import departure, join_pieces, split_arc
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
    """Puts each chain of arcs that lies within ``READING`` of a circle onto it.

    The ends of a chain stay where they are, unless the whole loop is one. Done twice it changes nothing more.

    Parameters
    ----------
    vertices : (N, 3) of a loop.
    segments : its segments.

    Returns
    -------
    ((N, 3) array, read-only: the loop with one circle for each such chain; how many arcs were changed)
    """
    out, changed = np.array(vertices), 0
    for chain in chains(segments):
        arcs = [segment for k in chain if isinstance(segment := segments[k], Arc)]
        circle = None if is_one_already(arcs) else fit_common_circle(arcs, len(chain) == len(segments))
        if circle is not None:
            write_chain(out, chain, circle, len(segments))
            changed += len(chain)
    out.setflags(write=False)
    return out, changed


def is_one_already(arcs: Sequence[Arc]) -> bool:
    """Whether arcs differ by no more than the rounding of a drawing."""
    first, hair = arcs[0], READING / 100
    return all(dist(arc.center, first.center) + abs(arc.radius - first.radius) < hair for arc in arcs)


def follows(one: Segment, other: Segment) -> bool:
    """Whether neighbours may be of one circle: arcs of one turning sense, nearly tangent where they meet.

    An arc within e of a circle is turned against it by no more than some 4 e / chord.
    """
    if not (isinstance(one, Arc) and isinstance(other, Arc)) or one.sign != other.sign:
        return False
    if abs(one.radius - other.radius) > 0.1 * (one.radius + other.radius) or one.is_full or other.is_full:
        return False
    ends = one.normal(one.sign * one.half_sweep), other.normal(-other.sign * other.half_sweep)
    chord = min(arc.radius * min(sin(min(arc.half_sweep, pi / 2)), 1.0) * 2 for arc in (one, other))
    return dist(*ends) <= 16 * READING / chord + 1e-9


def chains(segments: Sequence[Segment]) -> list[list[int]]:
    """Segments' numbers of each chain of two or more arcs, in running order."""

    def continues(one: int, other: int) -> bool:
        return follows(segments[one], segments[other])

    found = cut_into_runs(range(len(segments)), continues)
    return [chain for chain in found if len(chain) > 1 and isinstance(segments[chain[0]], Arc)]


def fit_common_circle(arcs: Sequence[Arc], whole: bool) -> tuple[Point, float] | None:
    """Centre and radius of a circle within ``READING`` of arcs, through both ends unless they are ``whole``.

    The circle of least squares through ends and middles (I. Kasa, "A circle fitting procedure and its error
    analysis", IEEE Transactions on Instrumentation and Measurement 25 (1976) 8-14), whose centre is moved
    onto the axis of both ends.
    """
    if len(arcs) < 2 or (whole and abs(sum(arc.half_sweep for arc in arcs) - pi) > 1e-3):
        return None
    points = np.array([point for arc in arcs for point in (arc.start, arc.at(0.0))] + [arcs[-1].end])
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
    """Whether an arc is nowhere farther than ``READING`` from a circle.

    The distance from the centre has its extremes at the arc's ends and on the line through both centres.
    """
    points = [arc.start, arc.end, arc.at(0.0)]
    toward = atan2(arc.center[1] - center[1], arc.center[0] - center[0])
    for angle in (toward, toward + pi):
        parameter = (angle - arc.mid_angle + pi) % tau - pi
        if abs(parameter) <= arc.half_sweep:
            points.append(arc.at(parameter))
    return all(abs(dist(point, center) - radius) <= READING for point in points)


def write_chain(out: Array, chain: Sequence[int], circle: tuple[Point, float], count: int) -> None:
    """Puts the inner vertices of a chain on its circle, and writes the bulges of its arcs."""
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
# As many chords as can be an arc: four corners of a drawing are on none by chance.
LEAST_CHORDS = 4


@frozen
class MergedLoop:
    """A loop with one segment for each run.

    Parameters
    ----------
    vertices : (N, 3) array of x, y in mm and bulge.
    firsts : for each segment the number of the first one that it stands for.
    merged : how many segments were taken together.
    departure : bound of the distance between the loops, either way, in mm.
    """

    vertices: Array
    firsts: tuple[int, ...]
    merged: int
    departure: float


@frozen
class Piece:
    """A segment from a point, with the number of the first that it stands for, and its distance from them."""

    start: Point
    bulge: float
    first: int
    kept: bool
    departure: float = 0.0


def merge_chords(
    vertices: Array,
    fit: float | None = None,
    kept: Sequence[bool] = (),
    interrupt: Callable[[], None] = never_interrupt,
) -> MergedLoop:
    """One line or arc for each run of segments that is nowhere farther from it than ``DISGUISE``.

    Parameters
    ----------
    vertices : (N, 3) array of a loop.
    fit : how far chords may be from an arc that stands for them, in mm, where that is more.
    kept : for each segment whether it stays as it is; none does if this is empty.
    interrupt : is called before every run, and may raise an error.
    """
    pieces = [
        Piece((float(x), float(y)), float(b), k, bool(kept) and kept[k])
        for k, (x, y, b) in enumerate(vertices)
    ]
    count = len(pieces)
    tolerance = DISGUISE if fit is None else max(fit, DISGUISE)
    whole = whole_circle(pieces, tolerance)
    if whole is not None:
        pieces = whole
    elif count > 2:
        drawn = from_a_corner(pieces)
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


# mm. Vertices this near to a circle are drawn on it, with the digits of a file that gives few.
CHORDS_ON = 0.01
# mm and a share of the radius: chords farther inside their circle than both are sides of a polygon; the share is
# that of 20 sides to the circle.
COARSE, COARSE_SHARE = 0.5, 0.0123
# Steps of the fits that are proposed.
FITS = (1.0, 2.0, 5.0, 10.0, 20.0)


@frozen
class ChordedArcs:
    """Arcs and circles that a loop has as chords, farther from them than a disguise may be.

    Parameters
    ----------
    chords : how many.
    radii : of the arcs, in mm.
    departure : how far the chords are from the arcs, in mm.
    fit : with which :func:`merge_chords` makes them arcs, in mm.
    """

    chords: int
    radii: tuple[float, ...]
    departure: float
    fit: float


def find_chorded_arcs(
    vertices: Array, kept: Sequence[bool] = (), interrupt: Callable[[], None] = never_interrupt
) -> ChordedArcs | None:
    """The arcs that a loop has as chords; None where it has none.

    Four chords and more are an arc where they meet at less than ``CORNER_OF_CHORDS`` and all their ends lie on
    one circle. So a polygon of 15 equal sides and fewer is a polygon, and one of 16 may be a circle: a quarter
    turn of four chords is the coarsest that programs write. Where they are farther than ``COARSE`` inside the
    circle besides, they are a polygon too.

    Parameters
    ----------
    vertices, kept, interrupt : as in :func:`merge_chords`.
    """
    if len(vertices) <= LEAST_CHORDS:
        return None
    pieces = [
        Piece((float(x), float(y)), float(b), k, b != 0.0 or (bool(kept) and kept[k]))
        for k, (x, y, b) in enumerate(vertices)
    ]
    found = whole_circle(pieces, inf, CHORDS_ON)
    if found is None:
        found = merge_longest_runs(from_a_corner(pieces), CHORDS_ON, inf, LEAST_CHORDS, interrupt)
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


def is_coarse(piece: Piece, after: Piece) -> bool:
    """Whether the chords of an arc are the sides of a polygon that somebody meant."""
    arc = make_segment_from_bulge(piece.start, after.start, piece.bulge)
    return isinstance(arc, Arc) and piece.departure > max(COARSE, COARSE_SHARE * arc.radius)


def describe_chords(found: Sequence[ChordedArcs], fit: str) -> list[str]:
    """What to say of arcs that came as chords.

    Parameters
    ----------
    fit : what the choice of a fit is called.
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


def merge_all_runs(pieces: list[Piece], tolerance: float, interrupt: Callable[[], None]) -> list[Piece]:
    """A row of pieces with its runs merged, first those with vertices on them to a file's digits."""
    for near in (min(DRAWN_ON, tolerance), tolerance):
        pieces = merge_longest_runs(pieces, near, tolerance, LEAST_CHORDS, interrupt)
    return merge_longest_runs(pieces, DISGUISE, DISGUISE, 2, interrupt)


def from_a_corner(pieces: list[Piece]) -> list[Piece]:
    """The pieces of a loop, begun at a corner, or else where the longest begins."""
    turns, points = np.abs(turns_of(pieces)), points_of(pieces)
    lengths = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    sharpest = int(np.argmax(turns))
    first = sharpest if turns[sharpest] > CORNER_OF_CHORDS else int(np.argmax(lengths))
    return pieces[first:] + pieces[:first]


def points_of(pieces: Sequence[Piece]) -> Array:
    """(N, 2) starts."""
    return np.array([piece.start for piece in pieces])


def turns_of(pieces: Sequence[Piece]) -> Array:
    """(N,) signed angles by which a loop turns where each piece begins."""
    points = points_of(pieces)
    along = np.roll(points, -1, axis=0) - points
    chord, half = np.arctan2(along[:, 1], along[:, 0]), 2 * np.arctan([piece.bulge for piece in pieces])
    turned = chord - half - np.roll(chord + half, 1)
    return np.asarray((turned + pi) % (2 * pi) - pi)


def whole_circle(pieces: list[Piece], tolerance: float, near: float | None = None) -> list[Piece] | None:
    """The two halves of the circle that a loop is to within a tolerance; None where it is none.

    Its vertices are as near to the circle, or as ``near`` says.
    """
    count = len(pieces)
    if not worth(pieces, 2 * LEAST_CHORDS) or any(piece.kept for piece in pieces):
        return None
    if (np.abs(turns_of(pieces)) > CORNER_OF_CHORDS).any():
        return None
    points = points_of([*pieces, pieces[0]])
    circle = fit_circle(points[:-1] if all(p.bulge == 0.0 for p in pieces) else with_middles(pieces, points))
    if circle is None:
        return None
    (cx, cy), radius = circle
    turned = sum(turns_of(pieces)) + sum(4 * np.arctan(piece.bulge) for piece in pieces)
    sign = 1.0 if turned > 0 else -1.0
    angle = atan2(points[0, 1] - cy, points[0, 0] - cx)
    away = off(pieces, points, Arc((cx, cy), radius, angle + pi, pi, sign), near or tolerance, tolerance)
    if not isfinite(away) or (count == 2 and away < READING):
        return None
    x, y = cx + radius * np.cos(angle), cy + radius * np.sin(angle)
    one = Piece((float(x), float(y)), sign, pieces[0].first, True, away)
    return [one, Piece((float(2 * cx - x), float(2 * cy - y)), sign, pieces[count // 2].first, True, away)]


def worth(pieces: Sequence[Piece], least: int) -> bool:
    """Whether so few pieces can be a run: two arcs or two lines can, few lines and an arc only by chance."""
    arcs = sum(piece.bulge != 0.0 for piece in pieces)
    return len(pieces) >= (2 if arcs == len(pieces) else least)


def merge_longest_runs(
    pieces: list[Piece],
    near: float,
    tolerance: float,
    least: int,
    interrupt: Callable[[], None] = never_interrupt,
) -> list[Piece]:
    """The longest runs one after the other; those of fewer than ``LEAST_CHORDS`` chords are lines only.

    Vertices may be ``near`` mm from a line or an arc, chords between them ``tolerance``, for arcs
    ``DISGUISE`` at most. A run has ``least`` chords or more.
    """
    points = points_of([*pieces, pieces[0]])
    corner = np.abs(turns_of(pieces)) > CORNER_OF_CHORDS
    ends = np.array([piece.kept for piece in pieces]) | np.roll([piece.kept for piece in pieces], 1) | corner
    # Where the row of pieces that may be one run with a piece ends.
    stops = np.append(np.flatnonzero(ends), len(pieces))
    out: list[Piece] = []
    k = 0
    while k < len(pieces):
        interrupt()
        stop = int(stops[np.searchsorted(stops, k + 1)])
        # Two arcs can be a run, and so many chords; then steps that double and afterwards halve.
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
    pieces: Sequence[Piece], points: Array, near: float, tolerance: float, least: int
) -> Piece | None:
    """The line or arc that a run is; None where it is none.

    ``points`` are the (N + 1, 2) ends of the run's N pieces.
    """
    if not worth(pieces, least):
        return None
    start, end = (float(points[0, 0]), float(points[0, 1])), (float(points[-1, 0]), float(points[-1, 1]))
    chord = dist(start, end)
    if chord < SHORTEST:
        return None
    before = max(piece.departure for piece in pieces)
    line = Line(start, end)
    away = off(pieces, points, line, near, tolerance)
    if isfinite(away):
        return Piece(start, 0.0, pieces[0].first, False, before + away)
    if not worth(pieces, LEAST_CHORDS):
        return None
    arc = fit_arc(pieces, points, line)
    if arc is None:
        return None
    away = off(pieces, points, arc, near, tolerance)
    return (
        Piece(start, arc.sign * tan(arc.half_sweep / 2), pieces[0].first, True, before + away)
        if isfinite(away)
        else None
    )


def with_middles(pieces: Sequence[Piece], points: Array) -> Array:
    chords = np.diff(points, axis=0)
    bulges = np.array([piece.bulge for piece in pieces])[:, None]
    middles = points[:-1] + chords / 2 + np.column_stack([chords[:, 1], -chords[:, 0]]) * bulges / 2
    return np.concatenate([points, middles[bulges[:, 0] != 0.0]])


def fit_arc(pieces: Sequence[Piece], points: Array, line: Line) -> Arc | None:
    """Arc of least squares through both ends of a run; see ``curve_fit.fit_circle``."""
    circle = fit_circle(with_middles(pieces, points))
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


def off(pieces: Sequence[Piece], points: Array, segment: Segment, near: float, tolerance: float) -> float:
    """Distance in mm of a run from a line or arc; infinity where it is too far or runs backward."""
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
    return departure(join_pieces(curves), segment, min(tolerance, DISGUISE))
