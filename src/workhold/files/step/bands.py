"""Bands: the heights at which a peg may press on each piece of an outline, from the solid's upright faces.

Over a point of the outline's border an upright face covers ranges of height. The band of the point is the
least interval that holds them within the heights that a peg reaches. Between the ends, lowest and highest
points of the walls' edges, both of its ends run monotonically. So a piece has in common what both ends have.

Glossary
--------
wall : an upright face of the solid.
run : neighbouring pieces of one carrier over which the band's ends are continuous.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from math import pi, tan, tau

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from workhold.conventions import SAME_HEIGHT
from workhold.files.step.edge_curves import EdgeCurve
from workhold.files.step.faces import SolidFace
from workhold.geometry.segment import Arc, Line, Point, Segment
from workhold.geometry.subdivision import BorderPiece, CutCarrier
from workhold.model.solid import Band

__all__ = ["Strip", "Walls", "strips_of_loop"]

# How far inside a piece its ends are looked at: a share of it, and in units of what makes two points one.
INSIDE, STEP = 1e-7, 3.0
# Heights that differ by less, in mm, are one: of an edge, and of a band that goes on from piece to piece.
ONE_HEIGHT, SAME_BAND = 1e-9, 1e-5
# Edges this far from a carrier in mm, and farther, are not asked whether they lie on it.
NEAR = 1e-4
# Shares of a piece below this are not worth a strip of their own.
LEAST_SHARE = 1e-4
NOTHING = (0.0, 0.0)


@frozen
class Strip:
    """A segment of the outline with its band.

    Parameters
    ----------
    start, end : (x, y) in mm, run with the material on the left.
    bulge : of the segment.
    band : (z0, z1) in mm that all its points have in common; None where nothing may touch.
    faces : indices of the solid's upright faces over it, in their order.
    """

    start: Point
    end: Point
    bulge: float
    band: Band | None
    faces: tuple[int, ...]


@frozen
class Wall:
    """An upright face over a carrier.

    Parameters
    ----------
    index : of the face.
    edges : its edges that are not upright, each with its points' positions (N,) on the carrier.
    """

    index: int
    edges: tuple[tuple[EdgeCurve, NDArray[np.float64]], ...]

    def intervals(self, position: float, beside: float) -> list[Band]:
        """Ranges of z in mm that the face covers at a position, see :meth:`Walls.band`; the lowest first."""
        heights = sorted(z for edge, places in self.edges for z in heights_at(edge, places, position, beside))
        return list(zip(heights[0::2], heights[1::2], strict=False))


@define
class Walls:
    """The upright faces of a solid by the carrier that they stand on.

    Parameters
    ----------
    faces, edges : of the solid.
    low, high : z in mm between which a peg may press.
    """

    faces: Sequence[SolidFace]
    edges: Sequence[EdgeCurve]
    low: float
    high: float
    # Edges of upright faces that are not upright themselves, with the segments under them.
    upright: list[tuple[EdgeCurve, Segment]] = field(init=False)
    # Of each of them (x, y) of both ends and a radius of 0, or those of an arc's centre twice and its radius.
    places: NDArray[np.float64] = field(init=False)
    found: dict[int, list[Wall]] = field(init=False, factory=dict)

    def __attrs_post_init__(self) -> None:
        self.upright = [
            (edge, edge.segment)
            for edge in self.edges
            if self.faces[edge.face].lie == "upright" and edge.segment is not None
        ]
        places = [
            (*segment.center, *segment.center, segment.radius)
            if isinstance(segment, Arc)
            else (*segment.start, *segment.end, 0.0)
            for _, segment in self.upright
        ]
        self.places = np.array(places, np.float64).reshape(-1, 5)

    def cuts(self) -> list[tuple[Segment, Point]]:
        """Points at which an outline is to be cut: where an edge of a wall is highest or lowest."""
        return [(segment, point) for edge, segment in self.upright for point in edge.turning_points()]

    def over(self, carrier: CutCarrier) -> list[Wall]:
        """The walls that stand on a carrier."""
        if id(carrier) not in self.found:
            edges = defaultdict(list)
            for k in self.near(carrier.segment).tolist():
                edge, segment = self.upright[k]
                if carrier.holds(segment):
                    edges[edge.face].append((edge, positions(carrier, edge.points)))
            self.found[id(carrier)] = [Wall(index, tuple(own)) for index, own in edges.items()]
        return self.found[id(carrier)]

    def near(self, segment: Segment) -> NDArray[np.intp]:
        """Numbers of upright faces' edges that may lie on a segment's line or circle."""
        radius = self.places[:, 4]
        if isinstance(segment, Arc):
            away = np.abs(self.places[:, [0, 1, 4]] - (*segment.center, segment.radius)).max(
                axis=1, initial=0
            )
            return np.flatnonzero((radius > 0.0) & (away <= NEAR))
        (x, y), (tx, ty) = segment.middle, segment.tangent
        across = np.abs((self.places[:, 0:4:2] - x) * ty - (self.places[:, 1:4:2] - y) * tx)
        return np.flatnonzero((radius == 0.0) & (across.max(axis=1, initial=0) <= NEAR))

    def band(
        self, piece: BorderPiece, position: float, beside: float = 0.0
    ) -> tuple[Band | None, tuple[int, ...]]:
        """The band at a position of a piece, and the indices of the walls that make it.

        No wall there has its material on the other side: a peg would meet that, and the piece were no border.

        Parameters
        ----------
        position : on the piece's carrier.
        beside : where the position is an end of the piece, a small step into it. The band is then the limit
            from there, because at the end itself other edges begin.
        """
        covered = [
            (max(start, self.low), min(end, self.high), wall.index)
            for wall in self.over(piece.carrier)
            for start, end in wall.intervals(position, beside)
        ]
        covered = [one for one in covered if one[1] - one[0] > SAME_HEIGHT]
        if not covered:
            return None, ()
        band = min(one[0] for one in covered), max(one[1] for one in covered)
        return band, tuple(sorted({one[2] for one in covered}))


def positions(carrier: CutCarrier, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Positions (N,) of points on a carrier, on a circle without jumps."""
    found = np.array([carrier.position((x, y)) for x, y in points[:, :2].tolist()])
    return found if isinstance(carrier.segment, Line) else np.unwrap(found)


def heights_at(edge: EdgeCurve, places: NDArray[np.float64], position: float, beside: float) -> list[float]:
    """The z in mm at which an edge passes a position, as its limit from a step beside.

    Parameters
    ----------
    places : positions (N,) of the edge's points.
    """
    found = []
    for turn in (0.0,) if isinstance(edge.segment, Line) else (-tau, 0.0, tau):
        away = places - (position + turn + beside)
        for k in np.flatnonzero(away[:-1] * away[1:] < 0):
            ends = sorted((float(places[k]), float(places[k + 1])))
            wanted = min(max(position + turn, ends[0]), ends[1])
            first, last = float(edge.points[k, 2]), float(edge.points[k + 1, 2])
            share = (wanted - float(places[k])) / float(places[k + 1] - places[k])
            if len(places) == 2 or abs(last - first) <= ONE_HEIGHT or share in (0.0, 1.0):
                found.append(first + share * (last - first))
            else:
                found.append(refined(edge, int(k), places, wanted))
    return found


def refined(edge: EdgeCurve, k: int, places: NDArray[np.float64], position: float) -> float:
    """The z in mm at which a curved edge passes a position between its points k and k + 1."""
    segment = edge.segment
    assert segment is not None
    own = segment.parameter((float(edge.points[k, 0]), float(edge.points[k, 1])))
    step = 1.0 if isinstance(segment, Arc) else direction_of(segment, edge.points, places)

    def along(point: tuple[float, float, float]) -> float:
        value = segment.parameter((point[0], point[1]))
        if isinstance(segment, Arc):
            value = own + (value - own + pi) % tau - pi
        return value

    return edge.point_at(k, along, own + step * (position - float(places[k])))[2]


def direction_of(segment: Segment, points: NDArray[np.float64], places: NDArray[np.float64]) -> float:
    """1 where positions on the carrier grow with the segment's own parameter, else -1."""
    own = np.array([segment.parameter((x, y)) for x, y in points[:, :2].tolist()])
    return 1.0 if float(np.dot(own - own.mean(), places - places.mean())) > 0 else -1.0


@frozen
class Ends:
    """A piece of the border with its band at both of its ends, in the direction of its run.

    Parameters
    ----------
    piece : of the border.
    first, last : bands at its first and its last point; None where nothing may touch.
    faces : indices of the walls over it.
    """

    piece: BorderPiece
    first: Band | None
    last: Band | None
    faces: tuple[int, ...]

    def at(self, share: float) -> float:
        """The position at a share of the run."""
        low, high = self.piece.low, self.piece.high
        return low + share * (high - low) if self.piece.forward else high - share * (high - low)


def ends_of(piece: BorderPiece, walls: Walls) -> Ends:
    """A piece with its band at both ends."""
    first, used = walls.band(piece, *end_of(piece, at_end=False))
    last, more = walls.band(piece, *end_of(piece, at_end=True))
    return Ends(piece, first, last, tuple(sorted({*used, *more})))


def end_of(piece: BorderPiece, *, at_end: bool) -> tuple[float, float]:
    """The position of an end of a piece's run, and the step from there into the piece."""
    step = min(STEP * piece.carrier.slack, (piece.high - piece.low) / 4)
    return (piece.high, -step) if at_end == piece.forward else (piece.low, step)


def strips_of_loop(loop: Sequence[BorderPiece], walls: Walls, least: float) -> list[Strip]:
    """The segments of a loop with their bands, in running order.

    Parameters
    ----------
    loop : pieces in running order, see ``geometry.subdivision``.
    least : shortest band in mm that may be touched.
    """
    ends = [ends_of(piece, walls) for piece in loop]
    # Begin where the band jumps or the carrier changes, so that no run passes the loop's first point.
    first = next((k for k in range(len(ends)) if not continues(ends[k - 1], ends[k])), 0)
    ends = ends[first:] + ends[:first]
    runs: list[list[Ends]] = []
    for one in ends:
        if runs and continues(runs[-1][-1], one):
            runs[-1].append(one)
        else:
            runs.append([one])
    return [strip for run in runs for strip in strips_of_run(run, walls, least)]


def continues(before: Ends, after: Ends) -> bool:
    """Whether a piece continues another: the same carrier and direction, and no jump of the band."""
    if before.piece.carrier is not after.piece.carrier or before.piece.forward != after.piece.forward:
        return False
    if before.last is None or after.first is None:
        return before.last is after.first
    return all(abs(a - b) <= SAME_BAND for a, b in zip(before.last, after.first, strict=True))


def strips_of_run(run: Sequence[Ends], walls: Walls, least: float) -> list[Strip]:
    """A run cut where the common band would fall below the least.

    Strips are made as long as they can be, one after the other. Over one piece each end of the band rises or
    falls only, so a part of a piece has in common what its own two ends have.
    """
    if all(one.first is None and one.last is None for one in run):
        return strips_between(run[0], 0.0, run[-1], 1.0, None, run)
    strips: list[Strip] = []
    opened: tuple[int, float] | None = None
    common: Band | None = None

    def close(k: int, share: float) -> None:
        nonlocal opened, common
        if opened is not None:
            parts = run[opened[0] : k + 1]
            strips.extend(strips_between(parts[0], opened[1], parts[-1], share, common, parts))
        opened, common = None, None

    for k, one in enumerate(run):
        share = 0.0
        while share < 1.0:
            here = band_at(one, walls, share)
            if length(here) < least - SAME_HEIGHT:
                begin = first_share(share, partial(is_long, one, walls, None, least))
                close(k, share)
                strips += strips_between(one, share, one, begin, None, [one])
                share = begin
                continue
            opened = opened or (k, share)
            sofar = overlap(common, here)
            whole = overlap(sofar, band_at(one, walls, 1.0))
            if length(whole) >= least - SAME_HEIGHT:
                common = whole
                break
            end = first_share(share, partial(is_short, one, walls, sofar, least))
            if end - share > LEAST_SHARE:
                common = overlap(sofar, band_at(one, walls, end))
                close(k, end)
                share = end
            elif opened != (k, share):
                close(k, share)
            else:
                opened = None
                strips += strips_between(one, share, one, 1.0, None, [one])
                break
    close(len(run) - 1, 1.0)
    return strips


def band_at(one: Ends, walls: Walls, share: float) -> Band:
    """The band at a share of a piece's run; one of no length where nothing may touch."""
    if share <= INSIDE:
        return one.first or NOTHING
    if share >= 1 - INSIDE:
        return one.last or NOTHING
    return walls.band(one.piece, one.at(share))[0] or NOTHING


def is_long(one: Ends, walls: Walls, sofar: Band | None, least: float, share: float) -> bool:
    """Whether the band at a share of a piece has enough in common with what there is so far."""
    return length(overlap(sofar, band_at(one, walls, share))) >= least - ONE_HEIGHT


def is_short(one: Ends, walls: Walls, sofar: Band | None, least: float, share: float) -> bool:
    """Whether the band at a share of a piece has too little in common with what there is so far."""
    return not is_long(one, walls, sofar, least, share)


def overlap(a: Band | None, b: Band) -> Band:
    """What two bands have in common; the second alone without a first."""
    return b if a is None else (max(a[0], b[0]), min(a[1], b[1]))


def length(band: Band) -> float:
    """Length of a band in mm, below 0 where two bands had nothing in common."""
    return band[1] - band[0]


def first_share(start: float, holds: Callable[[float], bool], steps: int = 32) -> float:
    """The least share after a start from which on something holds that does not there; 1 for never."""
    low = start
    for step in range(1, steps + 1):
        high = start + (1.0 - start) * step / steps
        if holds(high):
            for _ in range(50):
                middle = (low + high) / 2
                low, high = (low, middle) if holds(middle) else (middle, high)
            return high
        low = high
    return 1.0


def strips_between(
    first: Ends, start: float, last: Ends, stop: float, band: Band | None, parts: Sequence[Ends]
) -> list[Strip]:
    """The strip from a share of one piece to a share of another on the same carrier; two for a wide arc."""
    carrier, forward = first.piece.carrier, first.piece.forward
    begin = first.at(start)
    covered = sum(one.piece.high - one.piece.low for one in parts)
    covered -= start * (first.piece.high - first.piece.low) + (1 - stop) * (last.piece.high - last.piece.low)
    if covered <= carrier.slack:
        return []
    faces = tuple(sorted({index for one in parts for index in one.faces})) if band is not None else ()
    pieces = 2 if isinstance(carrier.segment, Arc) and covered > pi else 1
    step = covered / pieces if forward else -covered / pieces
    bulge = tan(step / 4) if isinstance(carrier.segment, Arc) else 0.0
    ends = [carrier.at(begin + step * k) for k in range(pieces + 1)]
    return [Strip(a, b, bulge, band, faces) for a, b in pairwise(ends)]
