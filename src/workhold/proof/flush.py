"""Whether two pegs press a part that lies flush on a wall, decided in ball arithmetic (midpoint and radius).

The pegs are a locator and a clamp, or two pegs of one lattice. Everything is computed again from the hull
edge's corners and arcs, the outline's vertices and bulges, and the lattice. Their doubles are taken as exact
numbers, and balls get as many digits as the decision needs. A rounded centre of an arc would be too coarse:
for a row that grazes an arc, 5e-16 mm move the contact by 7e-8 mm.

Glossary
--------
contacts : the hull edge's length in mm, and the contact of both pegs: the peg's centre, the outward normal
    there, and the distance in mm by which the contact keeps the rule of both ends of its feature. Places are
    measured along the hull edge from its start, and above the hull edge.
branch : -1 or 1, to select one of two places on an arc, or one of two crossings.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from attrs import frozen
from flint import arb, ctx

from workhold.contact.problem import Problem
from workhold.conventions import LEAST_CLAMPING, LEAST_CLOSURE, LEAST_PUSH, LEAST_SEAT, LEAST_SPAN, STRAIGHT
from workhold.fixels.carrier import WALL
from workhold.fixels.toolkit import Carrier
from workhold.geometry.hull import HullEnd
from workhold.model.workpiece import Workpiece
from workhold.proof.deciding import BALLS
from workhold.proof.exact_contacts import (
    SharpReactions,
    find_drawn_circle,
    find_drawn_segment,
    make_exact_rows,
    round_reactions,
)

__all__ = [
    "WallCandidate",
    "LatticePair",
    "is_pressing",
    "compute_fence_reactions",
    "locate_contacts_exactly",
    "locate_contact_exactly",
    "decide_pair",
]

Point = tuple[arb, arb]
Contact = tuple[Point, Point, list[arb]]
Contacts = tuple[arb, Contact, Contact]

# Bits of the balls, one after the other.
PRECISIONS = (128, 256, 512)


@frozen
class WallCandidate:
    """A locator and a clamp that may press a part against a wall.

    Parameters
    ----------
    edge : number of the hull edge that lies on the wall.
    row : the locator's row.
    line : the clamp's row; if ``is_upright``, its column minus the locator's.
    is_upright : whether the clamp is on a column.
    features : numbers of those that locator and clamp touch.
    branches : -1 or 1 for locator and clamp: which of two places on an arc.
    """

    edge: int
    row: int
    line: int
    is_upright: bool
    features: tuple[int, int]
    branches: tuple[float, float]


@frozen
class LatticePair:
    """Two pegs of one lattice that may press a part on a wall.

    Parameters
    ----------
    edge : number of the hull edge that lies on the wall.
    features : numbers of those that both pegs touch.
    step : columns and rows from the first peg's hole to the second's.
    branch : -1 or 1: which of two crossings it is.
    """

    edge: int
    features: tuple[int, int]
    step: tuple[int, int]
    branch: int


@frozen
class SharpContacts:
    """The contacts of two pegs to the last digit.

    Parameters
    ----------
    points : their centres along the hull edge from its start and above it, in mm.
    null : forces of the wall's start and end and of both pegs, not scaled.
    """

    points: list[list[float]]
    null: list[float]

    @classmethod
    def from_balls(cls, contacts: Contacts, problem: Problem) -> SharpContacts:
        """Return the contacts and forces with each ball replaced by its midpoint."""
        return cls(
            [list_middles(point) for point, _, _ in contacts[1:]],
            list_middles(compute_null_forces(contacts, problem)),
        )


def list_middles(values: Sequence[arb]) -> list[float]:
    """Return the midpoints of balls as doubles."""
    return [float(value.mid()) for value in values]


def is_pressing(
    candidate: WallCandidate, problem: Problem, plate: Carrier, push: tuple[float, float]
) -> bool | None:
    """Return whether a candidate presses the part with contacts inside their features; None if that stays
    undecided.

    Parameters
    ----------
    plate : plate in whose holes the locator stands.
    push : unit vector along which the clamp moves as it clamps, in the wall's frame.
    """
    with BALLS:
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                contacts = find_contacts(candidate, problem, plate)
                if contacts is None:
                    return False
                pushes = compute_push_share(contacts, push)
                if problem.pairing:
                    wall, (_, normal, _), _ = contacts
                    rules = [abs(normal[0]) * wall / problem.wrench_length - LEAST_SEAT, pushes - LEAST_PUSH]
                else:
                    rules = list_closing_rules(
                        contacts, compute_null_forces(contacts, problem)[3] * pushes, problem
                    )
                verdict = decide_rules(rules, contacts, problem)
            if verdict is not None:
                return verdict
    return None


def decide_pair(pair: LatticePair, problem: Problem) -> tuple[bool | None, SharpContacts | None]:
    """Return (verdict, contacts) of a lattice pair.

    The verdict tells whether the pair presses the part, or is None where that stays undecided. The contacts
    are None unless the verdict is True.
    """
    with BALLS:
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                contacts = find_pair_contacts(pair, problem)
                if contacts is None:
                    return False, None
                pressed = sum(compute_null_forces(contacts, problem)[:2], arb(0))
                verdict = decide_rules(list_closing_rules(contacts, pressed, problem), contacts, problem)
                if verdict is not None:
                    return verdict, SharpContacts.from_balls(contacts, problem) if verdict else None
    return None, None


def list_closing_rules(contacts: Contacts, clamping: arb, problem: Problem) -> list[arb]:
    """Return the numbers that must all be positive for contacts to close and clamp.

    ``clamping`` is the clamping force that belongs to the forces of :func:`compute_null_forces`.
    """
    null, (_, (_, a, _), (_, b, _)) = compute_null_forces(contacts, problem), contacts
    size = sum((abs(entry) for entry in null), arb(0))
    rules = [entry - LEAST_CLOSURE * size for entry in null]
    return [*rules, -a[0] * b[0], size - LEAST_SPAN, clamping - LEAST_CLAMPING * size]


def decide_rules(rules: Sequence[arb], contacts: Contacts, problem: Problem) -> bool | None:
    """Return True where all rules certainly hold, False where one is certainly broken, None where neither is
    certain.

    Each ball in ``rules`` must be positive, and each contact in ``contacts`` must lie at least the contact margin
    inside its feature.
    """
    ends = (end - arb(problem.contact_margin) for _, _, slacks in contacts[1:] for end in slacks)
    every = [*rules, *ends]
    if any(rule <= 0 for rule in every):
        return False
    return True if all(rule > 0 for rule in every) else None


def compute_null_forces(contacts: Contacts, problem: Problem) -> list[arb]:
    """Return the forces of the wall's start and end and of both pegs, not scaled; see
    ``search.wall_contacts.judge_closure``."""
    wall, ((u, v), a, _), ((p, q), b, _) = contacts
    length, across, ahead = arb(problem.wrench_length), abs(a[0]), abs(b[0])
    last = (ahead * (u * a[1] - v * a[0]) + across * (p * b[1] - q * b[0])) / length
    both = wall * (ahead * a[1] + across * b[1]) / length
    return [both - last, last, ahead * wall / length, across * wall / length]


def compute_push_share(contacts: Contacts, push: tuple[float, float]) -> arb:
    """Return the component of the clamp's force on its face along the unit vector ``push``, per unit of that
    force."""
    _, _, (_, normal, _) = contacts
    return -(normal[0] * push[0] + normal[1] * push[1])


def locate_contacts_exactly(
    candidate: WallCandidate, problem: Problem, plate: Carrier
) -> SharpContacts | None:
    """Return the contacts of a candidate to the last digit; None where a peg misses its feature."""
    with BALLS, ctx.workprec(PRECISIONS[-1]):
        contacts = find_contacts(candidate, problem, plate)
        return None if contacts is None else SharpContacts.from_balls(contacts, problem)


def locate_contact_exactly(
    edge: int, row: int, feature: int, branch: float, problem: Problem, plate: Carrier
) -> tuple[list[float], list[float], float] | None:
    """Return the contact, to the last digit, of a peg in row ``row`` of a plate with a feature of a part that
    lies on a hull edge.

    Return (centre, outward normal, the lesser distance in mm to an end with its slack), in the wall's frame;
    None where row and feature do not meet. The distance is inf on a whole circle.
    """
    with BALLS, ctx.workprec(PRECISIONS[-1]):
        start, tangent, _ = locate_hull_edge(edge, problem.workpiece)
        (drawn,) = make_exact_rows([feature], [problem.frame.standing.peg_radius], problem)
        contact = BallFeature.from_row(drawn, start, tangent).find_contact_on_line(
            find_row_level(plate, row), False, branch
        )
        if contact is None:
            return None
        point, normal, slacks = contact
        return list_middles(point), list_middles(normal), min(list_middles(slacks), default=inf)


def compute_fence_reactions(
    candidate: WallCandidate, problem: Problem, plate: Carrier, push: tuple[float, float]
) -> SharpReactions | None:
    """Return (1) the forces of the wall's start, the wall's end and the locator per unit of the clamp's
    force, and (2) the clamp's push.

    They are right to the last digit; None where they cannot be determined.

    Parameters
    ----------
    plate, push : see :func:`is_pressing`.
    """
    with BALLS, ctx.workprec(PRECISIONS[-1]):
        contacts = find_contacts(candidate, problem, plate)
        if contacts is None:
            return None
        wall, ((u, v), a, _), ((p, q), b, _) = contacts
        if not (abs(a[0]) > 0):
            return None
        force = -b[0] / a[0]
        last = (force * (u * a[1] - v * a[0]) + p * b[1] - q * b[0]) / wall
        return round_reactions([force * a[1] + b[1] - last, last, force], compute_push_share(contacts, push))


def find_contacts(candidate: WallCandidate, problem: Problem, plate: Carrier) -> Contacts | None:
    """Return the contacts of locator and clamp at the precision in force; None where a peg misses its
    feature."""
    start, tangent, wall = locate_hull_edge(candidate.edge, problem.workpiece)
    radii = problem.frame.standing.peg_radius, problem.frame.moving.peg_radius
    one, other = (
        BallFeature.from_row(row, start, tangent)
        for row in make_exact_rows(candidate.features, radii, problem)
    )
    locator = one.find_contact_on_line(find_row_level(plate, candidate.row), False, candidate.branches[0])
    if locator is None:
        return None
    if candidate.is_upright:
        level = locator[0][0] + arb(plate.pitch[0]) * candidate.line
    else:
        level = find_row_level(plate, candidate.line)
    clamp = other.find_contact_on_line(level, candidate.is_upright, candidate.branches[1])
    return None if clamp is None else (wall, locator, clamp)


def find_row_level(plate: Carrier, row: int) -> arb:
    """Return the height in mm of a row of a plate above the wall."""
    return arb(plate.offset[1]) + arb(plate.pitch[1]) * row


def find_pair_contacts(pair: LatticePair, problem: Problem) -> Contacts | None:
    """Return the contacts of both pegs of a pair at the precision in
    force; None where their curves are not shown to cross.
    """
    start, tangent, wall = locate_hull_edge(pair.edge, problem.workpiece)
    radii = [problem.frame.moving.peg_radius] * 2
    one, other = (
        BallFeature.from_row(row, start, tangent) for row in make_exact_rows(pair.features, radii, problem)
    )
    across, up = (arb(a) * int(k) for a, k in zip(problem.toolkit.moving.pitch, pair.step, strict=True))
    between = other.middle[0] - across - one.middle[0], other.middle[1] - up - one.middle[1]
    ray = find_crossing(one, other, between, pair.branch)
    if ray is None:
        return None
    return wall, one.make_contact(ray), other.make_contact((ray[0] - between[0], ray[1] - between[1]))


def locate_hull_edge(number: int, workpiece: Workpiece) -> tuple[Point, Point, arb]:
    """Return the start of a hull edge about the workpiece's centre, the
    unit vector along it, and its length in mm, as drawn.
    """
    edge, center = workpiece.hull_edges[number], workpiece.center
    (x, y, radius), (x1, y1, other) = (find_drawn_end(end, workpiece) for end in (edge.start, edge.end))
    dx, dy = x1 - x, y1 - y
    # The common tangent of two circles on whose left both lie; a corner is a circle of radius 0.
    across = radius - other
    square = dx * dx + dy * dy
    length = (square - across * across).sqrt()
    tx, ty = (length * dx - across * dy) / square, (across * dx + length * dy) / square
    return (x - center[0] + radius * ty, y - center[1] - radius * tx), (tx, ty), length


def find_drawn_end(end: HullEnd, workpiece: Workpiece) -> tuple[arb, arb, arb]:
    """Return (centre x, centre y, radius) in mm of the arc at one end of a hull edge, as it is drawn.

    A corner counts as an arc of radius 0.
    """
    rounded_once = arb(end.center[0]), arb(end.center[1]), arb(end.radius)
    if end.radius == 0.0:
        return rounded_once
    own, _ = workpiece.find_outline(WALL)
    side = find_drawn_segment(own, own.outer_faces[end.faces[0]].segments[0])
    # An arc may be a run of chords in the drawing.
    return find_drawn_circle(side) if abs(side[0][2]) >= STRAIGHT else rounded_once


@frozen
class BallFeature:
    """A feature in the wall's frame (along the hull edge from its start, and above it), in balls.

    Parameters
    ----------
    middle, axis : a point of a line and its direction; an arc's centre and the direction of its middle.
    radius : of an arc in mm, None for a line.
    half : largest parameter, in mm on a line and in radians on an arc.
    sign : 1 where the outward normal points away from an arc's centre, else -1.
    low, high : slacks in mm of the low and the high end.
    """

    middle: Point
    axis: Point
    radius: arb | None
    half: float
    sign: float
    low: float
    high: float

    @classmethod
    def from_row(cls, row: Sequence[float], start: Point, tangent: Point) -> BallFeature:
        """Return the feature of a row (12,), with the part on the hull edge
        that begins at ``start`` with direction ``tangent``.
        """
        is_arc, x, y, ax, ay, half, radius, sign, rest_x, rest_y, low, high = row
        tx, ty = tangent
        dx, dy = arb(x) + rest_x - start[0], arb(y) + rest_y - start[1]
        # Axes of features are unit vectors but for rounding.
        size = (arb(ax) * ax + arb(ay) * ay).sqrt()
        axis = (ax * tx + ay * ty) / size, (ay * tx - ax * ty) / size
        middle = dx * tx + dy * ty, dy * tx - dx * ty
        return cls(middle, axis, arb(radius) if is_arc else None, half, sign, low, high)

    def make_contact(self, ray: Point) -> Contact:
        """Return the contact of a peg whose centre is on the feature;
        ``ray`` leads there from the feature's middle, in mm.
        """
        point, (ax, ay) = (self.middle[0] + ray[0], self.middle[1] + ray[1]), self.axis
        along = ax * ray[0] + ay * ray[1]
        if self.radius is None:
            return point, (ay, -ax), [self.half - along + self.high, self.half + along + self.low]
        normal = self.sign * ray[0] / self.radius, self.sign * ray[1] / self.radius
        if self.half >= arb.pi():
            return point, normal, []
        angle = arb.atan2(ax * ray[1] - ay * ray[0], along)
        ends = (self.half - angle) * self.radius + self.high, (self.half + angle) * self.radius + self.low
        return point, normal, [*ends]

    def find_contact_on_line(self, level: arb, upright: bool, branch: float) -> Contact | None:
        """Return the contact of a peg in a line of holes with the feature; None where the line misses the
        feature.

        The line is a row at the height ``level`` in mm or, if ``upright``, a column at ``level`` along the
        hull edge. ``branch`` (-1 or 1) selects one of two places on an arc.
        """
        across = 0 if upright else 1
        up = level - self.middle[across]
        if self.radius is None:
            along = up / self.axis[across]
            return self.make_contact((along * self.axis[0], along * self.axis[1]))
        rest = compute_half_chord(self.radius * self.radius - up * up)
        if rest is None:
            return None
        return self.make_contact((up, branch * rest) if upright else (branch * rest, up))


def find_crossing(one: BallFeature, other: BallFeature, between: Point, branch: int) -> Point | None:
    """Return the vector from the middle of feature ``one`` to its crossing with ``other``; None where no
    crossing is proven.

    ``between`` leads from the middle of ``one`` to that of ``other``, in mm; ``branch`` (-1 or 1) selects one
    of two crossings.
    """
    x, y = between
    if one.radius is not None and other.radius is not None:
        apart = (x * x + y * y).sqrt()
        away = ((one.radius - other.radius) * (one.radius + other.radius) / apart + apart) / 2
        half = compute_half_chord((one.radius - away) * (one.radius + away))
        x, y = x / apart, y / apart
        return None if half is None else (away * x - branch * half * y, away * y + branch * half * x)
    if other.radius is not None:
        return intersect_line_with_circle(between, one.axis, other.radius, branch)
    if one.radius is not None:
        place = intersect_line_with_circle((-x, -y), other.axis, one.radius, branch)
        return None if place is None else (place[0] + x, place[1] + y)
    (ax, ay), (bx, by) = one.axis, other.axis
    sine = ax * by - ay * bx
    if not abs(sine) > 0:
        return None
    along = (x * by - y * bx) / sine
    return along * ax, along * ay


def intersect_line_with_circle(between: Point, axis: Point, radius: arb, branch: int) -> Point | None:
    """Return the vector from a line's middle to a crossing with a circle; None where the line certainly
    misses the circle.

    ``between`` leads from the middle of the line to the centre of the circle in mm, ``axis`` is the unit
    vector along the line, ``branch`` (-1 or 1) selects the crossing.
    """
    (ax, ay), (x, y) = axis, between
    away = ax * y - ay * x
    half = compute_half_chord((radius - away) * (radius + away))
    if half is None:
        return None
    along = ax * x + ay * y + branch * half
    return along * ax, along * ay


def compute_half_chord(square: arb) -> arb | None:
    """Return the square root of a number as a ball; None where the number is certainly negative.

    Where it may be 0, the ball is around 0 and holds both roots.
    """
    if square < 0:
        return None
    return square.sqrt() if square > 0 else arb(0, abs(square).abs_upper().sqrt().upper())
