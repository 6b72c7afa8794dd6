"""Where round pegs on lines touch a part that lies flush on a wall, and whether two press it there.

Both are in closed form and with bounds of the error. In the wall's frame a part lies on a hull edge: u runs
along it from its start, v up from it. The lines are rows, of one v each, or columns, of one u each; every one
meets a straight feature in one point at most and an arc in two. A locator and a clamp press the part against
the wall where the null vector of the four wrenches, in doubles, says so.

Bounds of the error. Everything is exact but for two roundings. The tangent of the hull edge is off by
``turn`` radians; sums and products of lengths up to ``size`` mm are off by ``off`` mm together. A contact is
then off by ``off`` over the sine of the angle at which its line meets the feature. Its normal is off by
``turn`` and, on an arc, by the contact's error over the radius; the factors below are generous. Where a line
only grazes an arc there is no bound, and the contact is decided in balls.
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
    reach, swing : (M,) error bounds of the place in mm and of the normal in radians.
    branch : (M,) -1 or 1 for the lower or the upper of the two points on an arc; 1 on a straight feature.
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
    features, within error bounds ``margin`` inside their ends.

    At a tangent joint there is a contact with either feature.

    Parameters
    ----------
    chosen : first and past-the-last index of the features.
    levels : (K,) v of rows, or u of columns if ``upright``, in mm.
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
    """Return all columns of contacts except ``line`` and ``feature``, in order."""
    return tuple(getattr(places, one.name) for one in fields(PinContacts))[2:]


def find_line_contacts(
    lying: PartOnWall, rows: Array, levels: Array, along: tuple[int, int], across: tuple[int, int]
) -> PinContacts:
    """Return the contacts of lines at ``levels`` with straight
    features; features parallel to the lines have none.

    ``along`` and ``across`` are the columns (of position, of axis) for the coordinate along the lines first,
    then across them.
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
    """Return the contacts of lines at ``levels`` with arcs, up to two for each line and arc.

    Those beyond the ends of arcs are left out where that is sure.
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
    """Return half angles (F,) in radians of arcs (F, 12),
    enlarged by a little past their ends, at most pi.
    """
    past = np.maximum(rows[:, HIGH_SLACK], rows[:, LOW_SLACK]) + PAST_END
    return np.asarray(np.minimum(rows[:, HALF_EXTENT] + past / rows[:, RADIUS] + PAST_END, np.pi))


def compute_least_ahead(rows: Array) -> Array:
    """Return (F,) the smallest coordinate in mm along an arc's
    axis, from its centre, of contacts not far past its ends.

    -inf for whole circles.
    """
    angle = compute_half_angles(rows)
    return np.asarray(np.where(angle >= np.pi, -np.inf, rows[:, RADIUS] * np.cos(angle)))


def bound_heights(rows: Array, across: tuple[int, int], spare: Array) -> tuple[Array, Array]:
    """Return the least and the largest coordinate (F,) in mm,
    from the centre, of contacts not far past the ends of arcs.

    The range is wider by ``spare`` (F,) mm on both sides. ``across`` are the two columns of ``rows`` (F, 12)
    with the axis's component along the lines and across them; the coordinate is that across.
    """
    turn, half = np.arctan2(np.abs(rows[:, across[0]]), rows[:, across[1]]), compute_half_angles(rows)
    low = -np.cos(np.maximum(np.pi - turn - half, 0.0))
    return rows[:, RADIUS] * low - spare, rows[:, RADIUS] * np.cos(np.maximum(turn - half, 0.0)) + spare


BoolArray = NDArray[np.bool_]


@frozen(eq=False)
class ContactPairs:
    """M pairs of a contact of a clamp and one of the locator.

    Parameters
    ----------
    places : contacts of the clamp's tip; their ``line`` is a row, or a column relative to the locator's.
    which : (M,) index of the tip's contact in ``places``.
    locator : (M,) index of the locator's contact.
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
    """Return a mask (M,) that is False only for pairs that :func:`closure` is sure to reject.

    The locator and the clamp must push against each other along the wall. ``one`` are the locator's contacts.
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
    """Return null vectors, pushes, verdicts and doubts of pairs
    with one of two clamps: wall and locator must fix the part.

    As :func:`closure`, except that the three locating contacts need not press; the clamp must push. The null
    vectors (M, 4) are the forces of the wall's two ends and the locator, divided by that at the clamp's face.
    With the notation of :func:`closure` the locator's force is -b_u / a_u, and the determinant of the three
    wrenches is |a_u| l.
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
    """Return (null, pushes, held, open) of pairs of a locator's and a clamp's contact.

    ``null`` (M, 4) are unscaled forces of the wall's two ends, locator and clamp; ``pushes`` (M,) the share
    of the clamp's force along its direction ``push`` that its face passes on; ``held`` (M,) whether the pair
    surely presses the part; ``open`` (M,) whether doubles leave that undecided. ``locator`` (M,) indexes
    ``one``.

    Let a, b be the normals and m, M the moments of locator and clamp about the start of the hull edge of
    length l, lengths in parts of L. With p = -b_u sign a_u, q = |a_u| and t = p m + q M, the null vector is
    (l (p a_v + q b_v) - t, t, p l, q l).
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
