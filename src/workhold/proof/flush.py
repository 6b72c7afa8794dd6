"""Whether a locator and a clamp press a part that lies flush on a wall against both, in balls.

Everything is derived once more from the hull edge's corners and arcs, the outline's vertices and bulges and
the lattice. Their doubles are taken as exact numbers, and balls have as many digits as it takes. An arc's
centre rounded once would not do: where a row grazes an arc, 5e-16 mm move the contact by 7e-8 mm.
"""

from __future__ import annotations

from math import inf

from attrs import frozen
from flint import arb, ctx

from workhold.contact.problem import Problem
from workhold.conventions import LEAST_CLAMPING, LEAST_CLOSURE, LEAST_PUSH, LEAST_SEAT, LEAST_SPAN, STRAIGHT
from workhold.fixels.carrier import WALL
from workhold.fixels.toolkit import Carrier
from workhold.geometry.hull import HullEnd
from workhold.kernels.base.feature import HALF_EXTENT, HIGH_SLACK, LOW_SLACK, SIGN
from workhold.model.workpiece import Workpiece
from workhold.proof.deciding import BALLS
from workhold.proof.exact_contacts import SharpReactions, drawn_circle, exact_rows, rounded, sides_of

__all__ = [
    "Candidate",
    "SharpContacts",
    "SharpPlace",
    "pressing",
    "reactions_on_fence",
    "sharp_contacts",
    "sharp_place",
]

Point = tuple[arb, arb]

# Bits of the balls, one after the other.
PRECISIONS = (128, 256, 512)


@frozen
class Candidate:
    """A locator and a clamp that may press a part against a wall.

    Parameters
    ----------
    edge : number of the hull edge that lies on the wall.
    row, line : the locator's row; the clamp's, or its column from the locator's if it is upright.
    is_upright : whether the clamp is on a column.
    features : those that locator and clamp touch.
    branches : -1 or 1, which of its two contacts with an arc each is at.
    """

    edge: int
    row: int
    line: int
    is_upright: bool
    features: tuple[int, int]
    branches: tuple[float, float]


@frozen
class SharpContacts:
    """A candidate to the last digit.

    Parameters
    ----------
    locator, tip : their centres along the hull edge from its start and above it, in mm.
    null : forces of the wall's two ends, locator and clamp, not scaled.
    """

    locator: list[float]
    tip: list[float]
    null: list[float]


def pressing(
    candidate: Candidate, problem: Problem, plate: Carrier, push: tuple[float, float]
) -> bool | None:
    """Whether a candidate presses the part with contacts inside their features; None where undecided.

    Parameters
    ----------
    plate : in whose holes the locator stands.
    push : unit vector along which the clamp moves as it clamps.
    """
    with BALLS:
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                verdict = verdict_on(candidate, problem, plate, push)
            if verdict is not None:
                return verdict
    return None


def verdict_on(
    candidate: Candidate, problem: Problem, plate: Carrier, push: tuple[float, float]
) -> bool | None:
    """The verdict at the precision in force."""
    contacts = contacts_of(candidate, problem, plate)
    if contacts is None:
        return False
    length = arb(problem.wrench_length)
    wall, (_, a, slack), (_, b, other) = contacts
    null = null_of(contacts, length)
    size = sum((abs(entry) for entry in null), arb(0))
    margin = arb(problem.contact_margin)
    pushes = -(b[0] * push[0] + b[1] * push[1])
    if problem.pairing:
        rules = [abs(a[0]) * wall / length - LEAST_SEAT, pushes - LEAST_PUSH]
    else:
        rules = [entry - LEAST_CLOSURE * size for entry in null]
        rules += [-a[0] * b[0], size - LEAST_SPAN, null[3] * pushes - LEAST_CLAMPING * size]
    rules += [end - margin for end in (*slack, *other)]
    if any(rule <= 0 for rule in rules):
        return False
    return True if all(rule > 0 for rule in rules) else None


def sharp_contacts(candidate: Candidate, problem: Problem, plate: Carrier) -> SharpContacts | None:
    """A candidate that presses the part, to the last digit; None where it touches nothing."""
    with BALLS, ctx.workprec(PRECISIONS[-1]):
        contacts = contacts_of(candidate, problem, plate)
        if contacts is None:
            return None
        points = [[float(value.mid()) for value in contact[0]] for contact in contacts[1:]]
        null = [float(entry.mid()) for entry in null_of(contacts, arb(problem.wrench_length))]
    return SharpContacts(points[0], points[1], null)


@frozen
class SharpPlace:
    """A contact of a peg in a row: its centre in mm along and above the hull edge, and its outward normal.

    The slack is its distance in mm to the nearer end of its feature.
    """

    point: list[float]
    normal: list[float]
    slack: float


def sharp_place(
    edge: int, row: int, feature: int, branch: float, problem: Problem, plate: Carrier
) -> SharpPlace | None:
    """The contact of a peg in a row of a plate with a feature, the part on a hull edge, to the last digit.

    None where they do not meet.
    """
    with BALLS, ctx.workprec(PRECISIONS[-1]):
        start, tangent, _ = line_of(edge, problem.workpiece)
        level = arb(plate.offset[1]) + arb(plate.pitch[1]) * row
        (drawn,) = exact_rows([feature], [problem.frame.standing.peg_radius], problem)
        contact = touched(drawn, start, tangent, level, False, branch)
        if contact is None:
            return None
        point, normal, slacks = contact
        least = min((float(slack.mid()) for slack in slacks), default=inf)
        return SharpPlace([float(v.mid()) for v in point], [float(v.mid()) for v in normal], least)


def null_of(contacts: tuple[arb, Contact, Contact], length: arb) -> list[arb]:
    """Forces of the wall's two ends, locator and clamp, not scaled; see ``search.wall_contacts.closure``."""
    wall, ((u, v), a, _), ((p, q), b, _) = contacts
    across, ahead = abs(a[0]), abs(b[0])
    last = (ahead * (u * a[1] - v * a[0]) + across * (p * b[1] - q * b[0])) / length
    both = wall * (ahead * a[1] + across * b[1]) / length
    return [both - last, last, ahead * wall / length, across * wall / length]


Contact = tuple[Point, Point, list[arb]]


def contacts_of(
    candidate: Candidate, problem: Problem, plate: Carrier
) -> tuple[arb, Contact, Contact] | None:
    """The hull edge's length, and locator's and clamp's contacts (:func:`touched`); None where one misses."""
    start, tangent, wall = line_of(candidate.edge, problem.workpiece)
    level = arb(plate.offset[1]) + arb(plate.pitch[1]) * candidate.row
    radii = problem.frame.standing.peg_radius, problem.frame.moving.peg_radius
    rows = exact_rows(candidate.features, radii, problem)
    locator = touched(rows[0], start, tangent, level, False, candidate.branches[0])
    if locator is None:
        return None
    if candidate.is_upright:
        level = locator[0][0] + arb(plate.pitch[0]) * candidate.line
    else:
        level = arb(plate.offset[1]) + arb(plate.pitch[1]) * candidate.line
    clamp = touched(rows[1], start, tangent, level, candidate.is_upright, candidate.branches[1])
    return None if clamp is None else (wall, locator, clamp)


def reactions_on_fence(
    candidate: Candidate, problem: Problem, plate: Carrier, push: tuple[float, float]
) -> SharpReactions | None:
    """Forces of the wall's two ends and the locator per unit of the clamp's, and the clamp's push.

    They are right to the last digit; None where they cannot be made out.

    Parameters
    ----------
    plate, push : see :func:`pressing`.
    """
    with BALLS, ctx.workprec(PRECISIONS[-1]):
        contacts = contacts_of(candidate, problem, plate)
        if contacts is None:
            return None
        wall, ((u, v), a, _), ((p, q), b, _) = contacts
        if not (abs(a[0]) > 0):
            return None
        force = -b[0] / a[0]
        last = (force * (u * a[1] - v * a[0]) + p * b[1] - q * b[0]) / wall
        return rounded([force * a[1] + b[1] - last, last, force], -(b[0] * push[0] + b[1] * push[1]))


def line_of(number: int, workpiece: Workpiece) -> tuple[Point, Point, arb]:
    """Start of a hull edge about the workpiece's center, unit vector along it, and its length, as drawn."""
    edge, center = workpiece.hull_edges[number], workpiece.center
    (x, y, radius), (x1, y1, other) = (drawn_end(end, workpiece) for end in (edge.start, edge.end))
    dx, dy = x1 - x, y1 - y
    # The common tangent of two circles on whose left both lie; a corner is a circle of radius 0.
    across = radius - other
    square = dx * dx + dy * dy
    length = (square - across * across).sqrt()
    tx, ty = (length * dx - across * dy) / square, (across * dx + length * dy) / square
    return (x - center[0] + radius * ty, y - center[1] - radius * tx), (tx, ty), length


def drawn_end(end: HullEnd, workpiece: Workpiece) -> tuple[arb, arb, arb]:
    """Centre and radius in mm of an end of a hull edge: its arc as drawn, or a corner, of radius 0."""
    rounded_once = arb(end.center[0]), arb(end.center[1]), arb(end.radius)
    if end.radius == 0.0:
        return rounded_once
    own, _ = workpiece.outline_of(WALL)
    side = sides_of(own)[own.outer_faces[end.faces[0]].segments[0]]
    # An arc may be a run of chords in the drawing.
    return drawn_circle(side) if abs(side[0][2]) >= STRAIGHT else rounded_once


def touched(
    row: list[float], start: Point, tangent: Point, level: arb, upright: bool, branch: float
) -> tuple[Point, Point, list[arb]] | None:
    """Centre of a peg on a line that touches a feature, the normal there and distances to the ends' rule.

    None where they do not meet.
    """
    feature = in_wall_frame(row, start, tangent)
    (middle, axis), (half, sign, high, low) = (feature.middle, feature.axis), feature.ends
    across = 0 if upright else 1
    up = level - middle[across]
    if feature.radius is None:
        s = up / axis[across]
        point = middle[0] + s * axis[0], middle[1] + s * axis[1]
        return point, (axis[1], -axis[0]), [half - s + high, half + s + low]
    radius = feature.radius
    rest = half_chord(radius * radius - up * up)
    if rest is None:
        return None
    ray = (up, branch * rest) if upright else (branch * rest, up)
    point, normal = (middle[0] + ray[0], middle[1] + ray[1]), (sign * ray[0] / radius, sign * ray[1] / radius)
    if half >= arb.pi():
        return point, normal, []
    angle = arb.atan2(axis[0] * ray[1] - axis[1] * ray[0], axis[0] * ray[0] + axis[1] * ray[1])
    return point, normal, [(half - angle) * radius + high, (half + angle) * radius + low]


def half_chord(square: arb) -> arb | None:
    """Returns the root of a square that may be zero; None where it is surely negative."""
    if square < 0:
        return None
    return square.sqrt() if square > 0 else arb(0, abs(square).abs_upper().sqrt().upper())


@frozen
class BallFeature:
    """A feature in the wall's frame, in balls: middle, unit vector, radius (None of a line), and row."""

    middle: Point
    axis: Point
    radius: arb | None
    row: list[float]

    @property
    def ends(self) -> tuple[float, float, float, float]:
        """Half the extent, the sign, and the slacks of the end ahead and of the one behind."""
        half, sign, high, low = (self.row[k] for k in (HALF_EXTENT, SIGN, HIGH_SLACK, LOW_SLACK))
        return half, sign, high, low

    def contact(self, point: Point) -> Contact:
        """Returns a peg's centre on it, the outward normal there, and the distances to its ends."""
        half, sign, high, low = self.ends
        (ax, ay), ray = self.axis, (point[0] - self.middle[0], point[1] - self.middle[1])
        along = ax * ray[0] + ay * ray[1]
        if self.radius is None:
            return point, (ay, -ax), [half - along + high, half + along + low]
        normal = sign * ray[0] / self.radius, sign * ray[1] / self.radius
        if half >= arb.pi():
            return point, normal, []
        angle = arb.atan2(ax * ray[1] - ay * ray[0], along)
        return point, normal, [(half - angle) * self.radius + high, (half + angle) * self.radius + low]


def in_wall_frame(row: list[float], start: Point, tangent: Point) -> BallFeature:
    """Returns a feature as it lies on a hull edge from a start along a tangent."""
    is_arc, x, y, ax, ay, _, radius, _, rest_x, rest_y, _, _ = row
    tx, ty = tangent
    dx, dy = arb(x) + rest_x - start[0], arb(y) + rest_y - start[1]
    # Axes of features are unit vectors but for rounding.
    size = (arb(ax) * ax + arb(ay) * ay).sqrt()
    axis = (ax * tx + ay * ty) / size, (ay * tx - ax * ty) / size
    return BallFeature((dx * tx + dy * ty, dy * tx - dx * ty), axis, arb(radius) if is_arc else None, row)
