"""Chains, the pieces of a drawing before they are joined into loops, and the maps that place them.

Glossary
--------
chain : a run of lines and arcs drawn as one entity: N segments through N + 1 points.
label : name of one segment for messages, such as ``ARC 30 of INSERT 41``.
closed chain : its last point is its first.
bulge : tan of a quarter of an arc's sweep, positive counter-clockwise, 0 for a line.
drawing : content of a file: chains in mm, and remarks for the user.
placement : the plane affine map that puts a block or a group in its drawing.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from math import copysign, dist, hypot, isfinite, pi, sqrt, tan

from attrs import field, frozen

from workhold.conventions import CIRCULAR, SAME_POINT, SHORTEST
from workhold.errors import InputError
from workhold.geometry.rational import Pieces
from workhold.geometry.segment import Point, Segment, make_segment_from_bulge
from workhold.limits import MOST_LENGTH
from workhold.model.solid import FileSolid

__all__ = [
    "Chain",
    "CurveReading",
    "Drawing",
    "Placement",
    "list_arc_bulges",
    "drop_zero_lengths",
    "list_first_items",
    "compute_moved_bulge",
]


@frozen
class Placement:
    """The map x' = a x + c y + e, y' = b x + d y + f of the plane (letters as in SVG); of heights z' =
    ``height_scale`` z + ``height``.
    """

    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 1.0
    e: float = 0.0
    f: float = 0.0
    height_scale: float = 1.0
    height: float = 0.0

    def __call__(self, point: Sequence[float]) -> Point:
        """Return the image of the x and y of a point."""
        x, y = point[0], point[1]
        return (self.a * x + self.c * y + self.e, self.b * x + self.d * y + self.f)

    def compose_after(self, inner: Placement) -> Placement:
        """Return the map that applies ``inner`` first and then this one."""
        e, f = self((inner.e, inner.f))
        return Placement(
            self.a * inner.a + self.c * inner.b,
            self.b * inner.a + self.d * inner.b,
            self.a * inner.c + self.c * inner.d,
            self.b * inner.c + self.d * inner.d,
            e,
            f,
            self.height_scale * inner.height_scale,
            self.height_scale * inner.height + self.height,
        )

    @property
    def determinant(self) -> float:
        """Factor on areas; negative for a map that mirrors."""
        return self.a * self.d - self.b * self.c

    @property
    def flat(self) -> bool:
        """Whether the map crushes the plane onto a line or a point."""
        first, second = hypot(self.a, self.b), hypot(self.c, self.d)
        return not abs(self.determinant) > 1e-12 * max(first, second) ** 2

    @property
    def keeps_circles(self) -> bool:
        """Whether the image of a circle is a circle."""
        first, second = hypot(self.a, self.b), hypot(self.c, self.d)
        slack = CIRCULAR * max(first, second)
        return abs(first - second) <= slack and abs(self.a * self.c + self.b * self.d) <= slack * max(
            first, second
        )

    def map_bulges(self, bulges: Sequence[float]) -> tuple[float, ...]:
        """Return the bulges of a chain's image: with the other sign where the map mirrors."""
        return tuple(-b if b else 0.0 for b in bulges) if self.determinant < 0 else tuple(bulges)


# How many places a remark names before it only counts.
NAMED = 10


@frozen
class Chain:
    """A run of lines and arcs drawn as one entity.

    Parameters
    ----------
    points : N + 1 points (x, y) in mm.
    bulges : N bulges.
    labels : N names of the segments for messages.
    """

    points: tuple[Point, ...]
    bulges: tuple[float, ...]
    labels: tuple[str, ...]

    @property
    def closed(self) -> bool:
        """Whether the last point equals the first to within 1e-9 mm."""
        return dist(self.points[0], self.points[-1]) <= SAME_POINT

    @property
    def entity(self) -> str:
        """The entity's name: the first label without its segment number."""
        return strip_segment_number(self.labels[0])

    @property
    def segments(self) -> list[Segment]:
        """The lines and arcs of the chain, without those from a point to itself."""
        steps = zip(pairwise(self.points), self.bulges, strict=True)
        return [make_segment_from_bulge(start, end, bulge) for (start, end), bulge in steps if start != end]

    def reverse(self) -> Chain:
        """Return the chain run from its end to its start."""
        return Chain(
            self.points[::-1], tuple(-b if b else 0.0 for b in reversed(self.bulges)), self.labels[::-1]
        )


@frozen
class CurveReading:
    """The lines and arcs that stand for a curve.

    Parameters
    ----------
    place : point at which the curve begins, in mm.
    departure : bound of the distance between the curve and its lines and arcs, in mm.
    is_disguise : whether it is lines and arcs almost exactly, see ``geometry.curve_fit``.
    pieces : the curve itself, in mm.
    arcs : number of lines and arcs that stand for it.
    """

    place: Point
    departure: float
    is_disguise: bool
    pieces: Pieces
    arcs: int


@frozen
class Drawing:
    """The content of a drawing file.

    Parameters
    ----------
    chains : open and closed chains, in mm.
    remarks : sentences for the user.
    curves : readings of the curves among them, by their labels.
    layers : the layers that segments are on, by their labels; empty for files without layers.
    solids : all of a STEP file, the largest first.
    looks : the colour and line type that segments are drawn with, by their labels; segments for which the
        file does not say it are missing.
    """

    chains: tuple[Chain, ...]
    remarks: tuple[str, ...] = ()
    curves: Mapping[str, CurveReading] = field(factory=dict)
    layers: Mapping[str, str] = field(factory=dict)
    solids: tuple[FileSolid, ...] = ()
    looks: Mapping[str, str] = field(factory=dict)


def list_arc_bulges(sweep: float) -> list[float]:
    """Return the bulges of an arc whose sweep is ``sweep`` radians (negative for clockwise).

    The list has one bulge, or two of equal halves when the arc is nearly a full circle: a single bulge would
    determine its centre badly.
    """
    if abs(sweep) == pi:
        return [copysign(1.0, sweep)]
    return [tan(sweep / 4)] if abs(sweep) < 1.95 * pi else [tan(sweep / 8)] * 2


def compute_moved_bulge(start: Point, end: Point, bulge: float, new_start: Point, new_end: Point) -> float:
    """Return the new bulge of an arc whose ends have been moved a little.

    ``start``, ``end`` and ``bulge`` are those of the arc before. The new centre is the point nearest to the
    old one on the perpendicular bisector of the new chord. So centre and radius change by about the length of
    the movement times the ratio of the centre's distance to the chord, which no other choice of the centre
    can avoid.

    A line (bulge 0) stays a line; the old bulge is returned for a new chord of no length.
    """
    if bulge == 0.0:
        return 0.0
    chord = dist(start, end)
    size = abs(bulge)
    sign = 1.0 if bulge > 0 else -1.0
    # Signed distance from the chord's middle to the centre, to the left of the chord for a short
    # counter-clockwise arc.
    apart = sign * chord * (1 - size * size) / (4 * size)
    ux, uy = (end[0] - start[0]) / chord, (end[1] - start[1]) / chord
    center = ((start[0] + end[0]) / 2 - apart * uy, (start[1] + end[1]) / 2 + apart * ux)
    new_chord = dist(new_start, new_end)
    if new_chord < SHORTEST:
        return bulge
    vx, vy = (new_end[0] - new_start[0]) / new_chord, (new_end[1] - new_start[1]) / new_chord
    dx, dy = center[0] - (new_start[0] + new_end[0]) / 2, center[1] - (new_start[1] + new_end[1]) / 2
    distance = sign * (vx * dy - vy * dx)
    half = new_chord / 2
    radius = sqrt(half * half + distance * distance)
    # tan(half sweep / 2) in whichever form does not cancel.
    return sign * (half / (radius + distance) if distance >= 0 else (radius - distance) / half)


def list_first_items(items: Sequence[str]) -> str:
    """Return the first ten items joined by semicolons, and "and N more" for the rest."""
    more = len(items) - NAMED
    return "; ".join(items[:NAMED]) + (f"; and {more} more" if more > 0 else "")


def drop_zero_lengths(chains: Iterable[Chain]) -> Drawing:
    """Return a drawing of the chains without entities and segments of zero length (below 1e-7 mm).

    Its remarks name what was dropped. Raises InputError for coordinates or bulges that are not finite, or so
    large that the unit must be wrong.
    """
    kept: list[Chain] = []
    empty: list[str] = []
    doubled: list[str] = []
    for chain in chains:
        labels, bulges = (*chain.labels, chain.labels[-1]), (*chain.bulges, 0.0)
        for label, (x, y), bulge in zip(labels, chain.points, bulges, strict=True):
            refuse_numbers(label, x, y, bulge)
        good = drop_zero_segments(chain)
        if good is None:
            empty.append(f"{chain.entity} at {format_point(chain.points[0])}")
            continue
        if len(good.bulges) < len(chain.bulges):
            doubled.append(f"{chain.entity} at {format_point(chain.points[0])}")
        kept.append(good)
    remarks = []
    if empty:
        remarks.append(
            f"Left out {format_count(len(empty), 'entity', 'entities')} of zero length: {list_first_items(empty)}."
        )
    if doubled:
        remarks.append(
            f"Left out doubled vertices of {format_count(len(doubled), 'polyline', 'polylines')}: "
            f"{list_first_items(doubled)}."
        )
    return Drawing(tuple(kept), tuple(remarks))


def refuse_numbers(label: str, x: float = 0.0, y: float = 0.0, bulge: float = 0.0) -> None:
    """Raise InputError for coordinates in mm or a bulge
    of a segment that are not finite or absurdly large.
    """
    if not (isfinite(x) and isfinite(y) and isfinite(bulge)):
        raise InputError(
            f"{label} has a coordinate, radius or bulge that is not a finite number: correct it."
        )
    if max(abs(x), abs(y)) > MOST_LENGTH:
        raise InputError(
            f"{label} lies more than 1 km from the origin: check the drawing's unit, or move it to the "
            "origin."
        )
    if abs(bulge) > MOST_LENGTH / SHORTEST:
        raise InputError(f"{label} is an arc that bulges by {bulge:.3g} times half its chord: correct it.")


def drop_zero_segments(chain: Chain) -> Chain | None:
    """Return the chain without segments of zero length; None when nothing is left."""
    if len(chain.bulges) == 1:
        return chain if dist(*chain.points) >= SHORTEST else None
    points, bulges, labels = [chain.points[0]], [], []
    for k, point in enumerate(chain.points[1:]):
        if dist(point, points[-1]) < SHORTEST:
            continue
        points.append(point)
        bulges.append(chain.bulges[k])
        labels.append(chain.labels[k])
    if not bulges:
        return None
    if len(bulges) < len(chain.bulges):
        points[-1] = chain.points[-1]
    return Chain(tuple(points), tuple(bulges), tuple(labels))


def strip_segment_number(label: str) -> str:
    """Return a label without its segment number: the name of the whole entity."""
    return re.sub(r" segment \d+", "", label)


def format_point(point: Point) -> str:
    """Return a point as "(x, y)"."""
    return f"({point[0]:.6g}, {point[1]:.6g})"


def format_count(count: int, one: str, many: str) -> str:
    """Return a count with its noun, in the singular (``one``) or the plural (``many``)."""
    return f"{count} {one if count == 1 else many}"
