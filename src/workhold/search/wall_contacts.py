"""Contacts of round pegs on lines with a part that lies flush on a wall, and whether two of them press it
there.

Both are in closed form and with bounds of the error. In the wall's frame a part lies on a hull edge: u runs
along it from its start, v up from it. The lines are rows (each with one v) or columns (each with one u). Each
line meets a straight feature in at most one point and an arc in at most two. The null vector of the four
wrenches, computed in doubles, shows whether a locator and a clamp press the part against the wall.

Bounds of the error. Two errors count; everything else is exact. The tangent of the hull edge is wrong by up
to ``turn`` radians; sums and products of lengths up to ``size`` mm are wrong by up to ``off`` mm in total.
The error of a contact is then ``off`` divided by the sine of the angle at which its line meets the feature.
Its normal is off by ``turn`` and, on an arc, by the contact's error over the radius; the factors below are
generous. Where a line only grazes an arc there is no bound, and the contact is decided in ball arithmetic
(midpoint and radius).
"""

from __future__ import annotations

import numpy as np
from attrs import define, fields, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import (
    LEAST_CLAMPING,
    LEAST_CLOSURE,
    LEAST_PUSH,
    LEAST_SEAT,
    LEAST_SPAN,
    LOOSE,
    PARALLEL,
)
from workhold.kernels.base.feature import (
    AXIS_X,
    AXIS_Y,
    HALF_EXTENT,
    HIGH_SLACK,
    IS_ARC,
    LOW_SLACK,
    RADIUS,
    SIGN,
    X,
    Y,
)
from workhold.kernels.contact.rules import ROUNDING
from workhold.listing.canonical_form import RowArrays
from workhold.search.flush_search import PartOnWall

__all__ = [
    "ContactPairs",
    "PinContacts",
    "judge_closure",
    "may_oppose",
    "find_pin_contacts",
    "judge_seating",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# mm and radians. A place further past the end of an arc is surely no contact: unless a line grazes the arc,
# its place is off by less.
PAST_END = 1e-4
# Pairs of lines and features looked at together.
TOGETHER = 1 << 19


@define(frozen=True, eq=False)
class PinContacts(RowArrays):
    """M contacts of pegs on lines, in the wall's frame.

    Parameters
    ----------
    line : (M,) index of the line.
    feature : (M,) index of the feature touched.
    point : (M, 2) centre of the peg, u and v in mm.
    normal : (M, 2) outward unit normal of the part there.
    slack : (M,) distance in mm to the nearer end of the feature, negative beyond it; inf on a whole circle.
    reach : (M,) error bound of ``point``, in mm.
    swing : (M,) error bound of ``normal``, in radians.
    branch : (M,) -1 or 1 for the point on an arc with the smaller or larger coordinate along the line; 1 on a
        straight feature.
    """

    line: IntArray
    feature: IntArray
    point: Array
    normal: Array
    slack: Array
    reach: Array
    swing: Array
    branch: Array


def find_pin_contacts(
    lying: PartOnWall, chosen: tuple[int, int], levels: Array, upright: bool, margin: float
) -> PinContacts:
    """Return the contacts of pegs on parallel lines with some
    features, at least ``margin`` mm inside their ends.

    Contacts are left out only where the error bounds exclude them. At a tangent joint there is a contact with
    each of the two features.

    Parameters
    ----------
    chosen : first index, and index past the last, of the features.
    levels : (K,) coordinates of the lines in mm: v of rows, or u of columns if ``upright``.
    upright : whether the lines are columns; else they are rows.
    margin : smallest distance in mm from the end of a feature.
    """
    first, last = chosen
    rows = lying.rows[first:last]
    along, across = ((Y, X) if upright else (X, Y)), ((AXIS_Y, AXIS_X) if upright else (AXIS_X, AXIS_Y))
    together = max(TOGETHER // max(len(rows), 1), 1)
    parts = []
    for start in range(0, max(len(levels), 1), together):
        some = levels[start : start + together]
        for part in (
            find_line_contacts(lying, rows, some, along, across),
            find_arc_contacts(lying, rows, some, along, across),
        ):
            inside = part.slack - margin > -(1.2 * part.reach + LOOSE)
            kept = part if inside.all() else part.take(inside)
            parts.append(PinContacts(kept.line + start, kept.feature + first, *list_shared_columns(kept)))
    return PinContacts.concatenate(parts)


def list_shared_columns(places: PinContacts) -> tuple[Array, ...]:
    """Return all fields of contacts except ``line`` and ``feature``, in the order of their declaration."""
    return tuple(getattr(places, one.name) for one in fields(PinContacts))[2:]


def find_line_contacts(
    lying: PartOnWall, rows: Array, levels: Array, along: tuple[int, int], across: tuple[int, int]
) -> PinContacts:
    """Return the contacts of pegs on lines with straight features; features parallel to the lines have none.

    ``levels`` (K,) has the coordinate of each line in mm: v of a row, u of a column. ``rows`` (F, 12) are the
    kernel rows of the features. ``along`` are the two columns of ``rows`` with a feature's position, along
    and across the lines. ``across`` are the two columns with its axis, along and across the lines.
    """
    straight = np.flatnonzero((rows[:, IS_ARC] == 0.0) & (np.abs(rows[:, across[1]]) > PARALLEL))
    some = rows[straight]
    rises = np.abs(some[:, across[1]])
    # Most pairs of a line and a feature are far from each other: the bound below solved for s, generously.
    farthest = 1.01 * (some[:, HALF_EXTENT] + 4.0 * lying.off / rises + LOOSE)
    farthest[4.0 * lying.turn > 0.009 * rises] = np.inf
    line, which = np.nonzero(np.abs(levels[:, None] - some[:, along[1]]) <= farthest * rises)
    s = (levels[line] - some[which, along[1]]) / some[which, across[1]]
    reach = 4.0 * (lying.off + lying.turn * np.abs(s)) / rises[which]
    near = np.abs(s) <= some[which, HALF_EXTENT] + (reach + LOOSE)
    line, which, s, reach = line[near], which[near], s[near], reach[near]
    part = some.T[:, which]
    point = np.stack([part[X] + s * part[AXIS_X], part[Y] + s * part[AXIS_Y]], axis=1)
    slack = np.minimum(part[HALF_EXTENT] - s + part[HIGH_SLACK], part[HALF_EXTENT] + s + part[LOW_SLACK])
    normal = np.stack([part[AXIS_Y], -part[AXIS_X]], axis=1)
    turned = np.full(len(s), 2.0 * lying.turn)
    return PinContacts(line, straight[which], point, normal, slack, reach, turned, np.ones(len(s)))


def find_arc_contacts(
    lying: PartOnWall, rows: Array, levels: Array, along: tuple[int, int], across: tuple[int, int]
) -> PinContacts:
    """Return the contacts of pegs on lines with arcs, up to two for each line and arc.

    Parameters as in :func:`find_line_contacts`. Contacts surely beyond the ends of arcs are left out.
    """
    round_ = np.flatnonzero(rows[:, IS_ARC] != 0.0)
    some = rows[round_]
    radius, place = some[:, RADIUS], some[:, along[1]]
    # For a grazing line the square root below is of rounding errors: the place is off by at most both roots.
    # Its normal is across the line to within its error bound, so only ball arithmetic decides that such a
    # contact presses.
    least = 16.0 * lying.off * radius
    low, high = bound_heights(some, across, 3.0 * np.sqrt(least) + PAST_END)
    line, which = np.nonzero(np.abs(levels[:, None] - (place + (low + high) / 2.0)) <= (high - low) / 2.0)
    up = levels[line] - place[which]
    met = np.abs(up) <= radius[which] + 2.0 * lying.off
    line, which, up = line[met], which[met], up[met]
    part = some.T[:, which]
    half = np.sqrt(np.maximum((part[RADIUS] - up) * (part[RADIUS] + up), 0.0))
    grazing = ~(half * half > least[which])
    one, other = part[across[0]] * half, part[across[1]] * up
    ahead = np.stack([other - one, other + one], axis=1)
    chosen, side = np.nonzero(grazing[:, None] | (ahead >= compute_least_ahead(some)[which][:, None]))
    line, which = line[chosen], which[chosen]
    up, half, grazing = up[chosen], half[chosen], grazing[chosen]
    part, branch = part[:, chosen], np.array([-1.0, 1.0])[side]
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = 4.0 * lying.off * part[RADIUS] / half
    reach[grazing] = half[grazing] + np.sqrt(2.0 * least[which[grazing]])
    ray = np.empty((len(up), 2))
    upright = along[0] == Y
    ray[:, int(upright)], ray[:, 1 - int(upright)] = branch * half, up
    angle = np.arctan2(
        part[AXIS_X] * ray[:, 1] - part[AXIS_Y] * ray[:, 0],
        part[AXIS_X] * ray[:, 0] + part[AXIS_Y] * ray[:, 1],
    )
    slack = np.minimum(
        (part[HALF_EXTENT] - angle) * part[RADIUS] + part[HIGH_SLACK],
        (part[HALF_EXTENT] + angle) * part[RADIUS] + part[LOW_SLACK],
    )
    slack[part[HALF_EXTENT] >= np.pi] = np.inf
    normal = part[SIGN][:, None] * ray / part[RADIUS][:, None]
    swing = 2.0 * (lying.turn + (reach + lying.off) / part[RADIUS])
    point = np.stack([part[X] + ray[:, 0], part[Y] + ray[:, 1]], axis=1)
    return PinContacts(line, round_[which], point, normal, slack, reach, swing, branch)


def compute_half_angles(rows: Array) -> Array:
    """Return the half angles (F,) in radians of arcs, enlarged so that
    they reach a little past the ends; at most pi.

    ``rows`` (F, 12) are the kernel rows of the arcs.
    """
    past = np.maximum(rows[:, HIGH_SLACK], rows[:, LOW_SLACK]) + PAST_END
    return np.asarray(np.minimum(rows[:, HALF_EXTENT] + past / rows[:, RADIUS] + PAST_END, np.pi))


def compute_least_ahead(rows: Array) -> Array:
    """Return the smallest coordinate in mm that a contact can have
    along the arc's axis, from its centre, (F,).

    Contacts a little past the arc's ends are included; -inf for whole circles. ``rows`` (F, 12) are the
    kernel rows of the arcs.
    """
    angle = compute_half_angles(rows)
    return np.asarray(np.where(angle >= np.pi, -np.inf, rows[:, RADIUS] * np.cos(angle)))


def bound_heights(rows: Array, across: tuple[int, int], spare: Array) -> tuple[Array, Array]:
    """Return (the least, the largest) coordinate across the lines of contacts with arcs, (F,) each.

    Coordinates are in mm from the arcs' centres; contacts a little past the ends are included. ``rows`` (F,
    12) are the kernel rows of the arcs. ``across`` are the two columns of ``rows`` with the axis's component
    along the lines and across them. The range is wider by ``spare`` (F,) mm on both sides.
    """
    turn, half = np.arctan2(np.abs(rows[:, across[0]]), rows[:, across[1]]), compute_half_angles(rows)
    low = -np.cos(np.maximum(np.pi - turn - half, 0.0))
    return rows[:, RADIUS] * low - spare, rows[:, RADIUS] * np.cos(np.maximum(turn - half, 0.0)) + spare


BoolArray = NDArray[np.bool_]


@frozen(eq=False)
class ContactPairs:
    """M pairs of a clamp's contact and the locator's contact.

    Parameters
    ----------
    places : contacts of the clamp's tip; their ``line`` is a row, or a column counted from the locator's
        column.
    which : (M,) index of the tip's contact in ``places``.
    locator : (M,) index of the locator's contact among the contacts of locators.
    """

    places: PinContacts
    which: IntArray
    locator: IntArray

    def __len__(self) -> int:
        return len(self.locator)

    def take(self, order: IntArray | BoolArray) -> ContactPairs:
        """Return the pairs that an index array or a mask selects."""
        return ContactPairs(self.places, self.which[order], self.locator[order])


def may_oppose(lying: PartOnWall, one: PinContacts, clamps: ContactPairs, problem: Problem) -> BoolArray:
    """Return a mask (M,) that is False only for pairs that :func:`judge_closure` surely rejects.

    Rejected are pairs whose locator and clamp do not push against each other along the wall. ``one`` are the
    contacts of locators.
    """
    length, two = problem.wrench_length, clamps.places
    reach, swing = (
        max(x.max(initial=0.0), y.max(initial=0.0))
        for x, y in ((one.reach, two.reach), (one.swing, two.swing))
    )
    band = 20.0 * swing + 4.0 * (reach + lying.off) / length + ROUNDING
    ahead = -two.normal[clamps.which, 0] * np.copysign(1.0, one.normal[:, 0])[clamps.locator]
    return np.asarray(~(ahead * (lying.length / length) < -1.2 * band))


def judge_seating(
    lying: PartOnWall,
    one: PinContacts,
    two: PinContacts,
    locator: IntArray,
    push: tuple[float, float],
    problem: Problem,
) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Return (null, pushes, held, open) of M pairs of a locator and one of two clamps.

    A pair is held if wall and locator fix the part, and the clamp pushes on it; the locator and the wall need
    not be pressed. The parameters, ``pushes``, ``held`` and ``open`` are those of :func:`judge_closure`.
    ``null`` (M, 4) are the forces of the wall's two ends, the locator and the clamp, divided by the clamp's.
    With the letters of :func:`judge_closure` the locator's force is -b_u / a_u, and the determinant of the
    three locating wrenches is |a_u| l.
    """
    length = problem.wrench_length
    a, b = one.normal[locator], two.normal
    p, q = one.point[locator] / length, two.point / length
    wall = lying.length / length
    with np.errstate(divide="ignore", invalid="ignore"):
        force = -b[:, 0] / a[:, 0]
        last = (
            force * (p[:, 0] * a[:, 1] - p[:, 1] * a[:, 0]) + q[:, 0] * b[:, 1] - q[:, 1] * b[:, 0]
        ) / wall
        null = np.stack([force * a[:, 1] + b[:, 1] - last, last, force, np.ones(len(force))], axis=1)
        reach = np.maximum(one.reach[locator], two.reach)
        swing = np.maximum(one.swing[locator], two.swing)
        pushes = -(b[:, 0] * push[0] + b[:, 1] * push[1])
        slack = np.minimum(one.slack[locator], two.slack) - problem.contact_margin
        fixed = np.abs(a[:, 0]) * wall - LEAST_SEAT
        band = 2.0 * swing + ROUNDING
        worst = np.minimum(
            slack / (1.2 * reach + 1e-12), np.minimum((pushes - LEAST_PUSH) / band, fixed / (wall * band))
        )
    held = worst > 1.0
    return null, pushes, held, ~held & ~(worst < -1.0)


def judge_closure(
    lying: PartOnWall,
    one: PinContacts,
    two: PinContacts,
    locator: IntArray,
    push: tuple[float, float],
    problem: Problem,
) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Return (null, pushes, held, open) of M pairs of a contact of a locator and one of a clamp.

    ``null`` (M, 4) are the forces of the wall's two ends, the locator and the clamp, up to a common factor.
    ``pushes`` (M,) is the cosine of the angle between the clamp's direction ``push`` and the force of its tip
    on the part. ``held`` (M,) is True for pairs that surely press the part, ``open`` (M,) for pairs that
    double arithmetic leaves undecided. ``one`` are the contacts of locators, and ``locator`` (M,) has each
    pair's index in it; ``two`` are the M contacts of the clamp.

    The formula: a and b are the normals of the part at locator and clamp, m and M the moments of these
    normals about the start of the hull edge, l the length of the hull edge; lengths are divided by the
    characteristic length L. The index u marks components along the edge, v components up from it. With p =
    -b_u sign a_u, q = |a_u| and t = p m + q M, the null vector is (l (p a_v + q b_v) - t, t, p l, q l).
    """
    length = problem.wrench_length
    a, b = one.normal[locator], two.normal
    p = one.point[locator] / length
    q = two.point / length
    across, ahead = np.abs(a[:, 0]), -b[:, 0] * np.copysign(1.0, a[:, 0])
    wall = lying.length / length
    last = ahead * (p[:, 0] * a[:, 1] - p[:, 1] * a[:, 0]) + across * (q[:, 0] * b[:, 1] - q[:, 1] * b[:, 0])
    both = wall * (ahead * a[:, 1] + across * b[:, 1])
    forces = both - last, last, ahead * wall, across * wall
    null = np.stack(forces, axis=1)
    reach = np.maximum(one.reach[locator], two.reach)
    swing = np.maximum(one.swing[locator], two.swing)
    with np.errstate(divide="ignore", invalid="ignore"):
        pushes = -(b[:, 0] * push[0] + b[:, 1] * push[1])
        band = 20.0 * swing + 4.0 * (reach + lying.off) / length + ROUNDING
        size = sum(map(np.abs, forces))
        smallest = np.minimum(np.minimum(*forces[:2]), np.minimum(*forces[2:]))
        least = np.minimum(smallest - LEAST_CLOSURE * size, size - LEAST_SPAN)
        force = null[:, 3] * pushes - LEAST_CLAMPING * size
        slack = np.minimum(one.slack[locator], two.slack) - problem.contact_margin
        worst = np.minimum(least / band, force / (3.0 * band + size * swing))
        worst = np.minimum(worst, slack / np.maximum(1.2 * reach, 1e-300))
    held = worst > 1.1
    return null, pushes, held, ~held & ~(worst < -1.1)
