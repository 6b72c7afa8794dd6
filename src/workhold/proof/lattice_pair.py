"""Whether two pegs of one lattice press a part that lies flush on a wall, in balls.

Everything is derived once more from the hull edge's corners and arcs, the outline's vertices and bulges and
the lattice. Their doubles are taken as exact numbers, and digits are added until the verdict is certain.
"""

from __future__ import annotations

from attrs import frozen
from flint import arb, ctx

from workhold.contact.problem import Problem
from workhold.conventions import LEAST_CLAMPING, LEAST_CLOSURE, LEAST_SPAN
from workhold.proof.deciding import BALLS
from workhold.proof.exact_contacts import exact_rows
from workhold.proof.flush import PRECISIONS, BallFeature, Contact, Point, half_chord, in_wall_frame, line_of

__all__ = ["LatticePair", "SharpPair", "verdict_on_pair"]


@frozen
class LatticePair:
    """Two pegs of one lattice that may press a part on a wall.

    Parameters
    ----------
    edge : number of the hull edge that lies on the wall.
    features : those that both pegs touch.
    step : columns and rows from the first peg's hole to the second's.
    branch : -1 or 1, which of two crossings it is.
    """

    edge: int
    features: tuple[int, int]
    step: tuple[int, int]
    branch: int


@frozen
class SharpPair:
    """A pair in balls: where its pegs are, and the forces of its contacts.

    Parameters
    ----------
    points : the pegs' centres in mm along the hull edge from its start and above it.
    null : the forces of the wall's two ends and both pegs, not scaled.
    """

    points: list[list[float]]
    null: list[float]


def verdict_on_pair(pair: LatticePair, problem: Problem) -> tuple[bool | None, SharpPair | None]:
    """Returns whether a pair presses the part, None where that stays open, and the pair if it does."""
    with BALLS:
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                contacts = contacts_of(pair, problem)
                if contacts is None:
                    return False, None
                verdict, null = judged(contacts, problem)
                if verdict is False:
                    return False, None
                if verdict:
                    points = [[float(value.mid()) for value in contact[0]] for contact in contacts[1:]]
                    return True, SharpPair(points, [float(entry.mid()) for entry in null])
    return None, None


def judged(contacts: tuple[arb, Contact, Contact], problem: Problem) -> tuple[bool | None, list[arb]]:
    """Returns the verdict on the contacts of a pair at the precision in force, and their null vector.

    See ``search.lattice_pairs.closure_of`` for its formula.
    """
    wall, ((u, v), a, slack), ((p, q), b, other) = contacts
    length, margin = arb(problem.wrench_length), arb(problem.contact_margin)
    along = a[0] * b[0]
    ahead, across = abs(b[0]), abs(a[0])
    last = (ahead * (u * a[1] - v * a[0]) + across * (p * b[1] - q * b[0])) / length
    both = wall * (ahead * a[1] + across * b[1]) / length
    null = [both - last, last, ahead * wall / length, across * wall / length]
    size = sum((abs(entry) for entry in null), arb(0))
    rules = [entry - LEAST_CLOSURE * size for entry in null]
    rules += [-along, size - LEAST_SPAN, both - LEAST_CLAMPING * size]
    rules += [end - margin for end in (*slack, *other)]
    if any(rule <= 0 for rule in rules):
        return False, null
    return (True if all(rule > 0 for rule in rules) else None), null


def contacts_of(pair: LatticePair, problem: Problem) -> tuple[arb, Contact, Contact] | None:
    """Returns the hull edge's length and both contacts: centre, normal, distances to ends; None on a miss."""
    start, tangent, wall = line_of(pair.edge, problem.workpiece)
    radii = [problem.frame.moving.peg_radius] * 2
    rows = [in_wall_frame(row, start, tangent) for row in exact_rows(pair.features, radii, problem)]
    pitch = problem.toolkit.moving.pitch
    shift = tuple(arb(one) * int(k) for one, k in zip(pitch, pair.step, strict=True))
    (x, y), (u, v) = (row.middle for row in rows)
    offset = crossing_of(rows[0], rows[1], (u - shift[0] - x, v - shift[1] - y), pair.branch)
    if offset is None:
        return None
    first = x + offset[0], y + offset[1]
    one = rows[0].contact(first)
    return wall, one, rows[1].contact((first[0] + shift[0], first[1] + shift[1]))


def crossing_of(one: BallFeature, other: BallFeature, between: Point, branch: int) -> Point | None:
    """Returns where two curves cross, from the middle of the first; None where that is not proven.

    Parameters
    ----------
    between : from the middle of the first to that of the second, in mm.
    branch : -1 or 1, which of two crossings.
    """
    x, y = between
    if one.radius is not None and other.radius is not None:
        apart = (x * x + y * y).sqrt()
        away = ((one.radius - other.radius) * (one.radius + other.radius) / apart + apart) / 2
        half = half_chord((one.radius - away) * (one.radius + away))
        x, y = x / apart, y / apart
        return None if half is None else (away * x - branch * half * y, away * y + branch * half * x)
    if other.radius is not None:
        return on_line(between, one.axis, other.radius, branch)
    if one.radius is not None:
        place = on_line((-x, -y), other.axis, one.radius, branch)
        return None if place is None else (place[0] + x, place[1] + y)
    (ax, ay), (bx, by) = one.axis, other.axis
    sine = ax * by - ay * bx
    if not abs(sine) > 0:
        return None
    along = (x * by - y * bx) / sine
    return along * ax, along * ay


def on_line(between: Point, axis: Point, radius: arb, branch: int) -> Point | None:
    """Returns where a line crosses a circle, from the line's middle; None where it surely misses it.

    Parameters
    ----------
    between : from the middle of the line to that of the circle, in mm.
    axis : unit vector along the line.
    """
    (ax, ay), (x, y) = axis, between
    away = ax * y - ay * x
    half = half_chord((radius - away) * (radius + away))
    if half is None:
        return None
    along = ax * x + ay * y + branch * half
    return along * ax, along * ay
