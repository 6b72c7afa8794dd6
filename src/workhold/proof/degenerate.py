r"""Contacts that can never hold a part, recognized by their features and their pegs' holes.

Four wrenches close only if every three of them are independent (``kernels.contact.rules``). With two clamps
the wrenches of the three standing pegs must be independent. If lengths of a part and of a lattice agree
exactly, some three wrenches are dependent in the only place where the pegs can touch. Such a place is a
double root of the contact equations or one of a continuum of solutions. After the rounding of a drawing it
takes long to decide, and the decision is meaningless. Each family is a theorem:

parallels : on three parallel lines all normals are parallel.
centre : on three arcs about one centre all normals pass through it.
antipodal : two pegs of one carrier as far apart, or as near, as two features allow touch them on a common
    normal, so that both wrenches lie on one line. For arcs of radii r and s whose centres are D apart the
    most is D + r + s. The least is 2 max(D, r, s) - (D + r + s); for a line h from an arc's centre it is h -
    r, for parallel lines their distance.
turning : two of three pegs of one carrier, on arcs about one centre, fix where it is on the carrier; a turn
    about it is left. The third peg goes around it at a distance D. It meets a line h from the centre where D
    cos phi = h. It meets an arc of radius r about a point e from the centre where it is r from that, which is
    between \|D - e\| and D + e. With D = h, or r at an end of its range, it is there at phi = 0 alone. Its
    normal then passes through the centre as well.
sliding : two of three pegs of one carrier, on parallel lines, fix the orientation; a slide along the lines is
    left. The third peg's way may be just the radius from an arc's centre. Then it touches that arc where its
    normal is square to the way, as the other two normals are.
lined up : two of three pegs of one carrier may touch arcs of one radius whose centres are as far apart as
    they. The part goes around a circle without a turn, or it turns. Both ways meet where both normals lie on
    the line through the centres. The third peg may just touch there, and leave its feature at once on both
    ways. That is a double root, and the only one nearby.

Antipodal contacts are those of I.-M. Chen and J. W. Burdick, "Finding antipodal point grasps on irregularly
shaped objects", IEEE Transactions on Robotics and Automation 9 (1993) 507-512.

Centres are one and directions parallel as ``SAME_CENTER`` and ``PARALLEL`` say. Where a length misses the
exact one by m, normals are off by sqrt(2 m / r), with r the smallest length that bends. In ``turning`` the
third passes the centre at sqrt(2 m D e / r), on a line at sqrt(2 m D). Lengths agree where that is at most
``DEPENDENT``, or this part of L. Let M be the distance of the two in ``lined up``. Normals are off by M / r
of what turns the part, and moments by M / L of what takes it around the circle.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import DEPENDENT, PARALLEL, SAME_CENTER
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, IS_ARC, RADIUS, X, Y
from workhold.kernels.base.tables import Lattice
from workhold.kernels.contact import record
from workhold.kernels.proof.newton_kantorovich import LEAST_REACH

__all__ = ["cannot_hold"]

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Points = NDArray[np.complex128]


class TouchedFeatures(NamedTuple):
    """The features that one peg touches in each of N records; points
    and directions of the plane are complex numbers.

    Parameters
    ----------
    is_arc : (N,) whether the feature is an arc.
    middle, axis, radius : (N,) an arc's centre, the direction of its middle and its radius in mm; a point of
        a line, its direction, and 0.
    place : (N,) of the peg's hole on its carrier, in mm.
    """

    is_arc: Bools
    middle: Points
    axis: Points
    radius: Array
    place: Points

    def take(self, numbers: NDArray[np.int64]) -> TouchedFeatures:
        """Return the features of the records with these indices."""
        is_arc, middle, axis, radius, place = self
        return TouchedFeatures(
            is_arc[numbers], middle[numbers], axis[numbers], radius[numbers], place[numbers]
        )


def cannot_hold(records: Array, problem: Problem) -> Bools:
    """Return, for each record (N, 19), whether its contacts cannot hold the part, whatever solution is in its
    box.

    The families of such contacts are listed at the head of this file. See ``kernels.contact.record`` for the
    layout of records.
    """
    rows = problem.rows[records[:, record.FEATURES : record.COLUMNS].astype(np.int64)]
    pegs = list_touched_features(records, rows, problem.frame.lattice)
    standing = records[:, record.STANDING]
    # Of one of two clamps it is the standing pegs that must fix the pose.
    asked = range(3 if problem.pairing else 4)
    out = np.zeros(len(records), np.bool_)
    for one, other in combinations(asked, 2):
        together = (one >= standing) == (other >= standing)
        out |= together & are_antipodal(pegs[one], pegs[other])
    for triple in combinations(asked, 3):
        a, b, c = (pegs[n] for n in triple)
        out |= are_parallel(a, b) & are_parallel(b, c) & are_parallel(a, c)
        out |= are_concentric(a, b) & are_concentric(b, c) & are_concentric(a, c)
    # No carrier but the one that stands still has three pegs.
    left = np.flatnonzero(~out & (standing == 3.0))
    if len(left):
        some, three = records[left], [peg.take(left) for peg in pegs[:3]]
        for k in range(3):
            a, b, c = three[k - 2], three[k - 1], three[k]
            out[left] |= are_turning(some, a, b, c, problem.wrench_length) | are_sliding(some, a, b, c)
            out[left] |= are_lined_up(some, a, b, c, problem.wrench_length)
    return out


def list_touched_features(records: Array, rows: Array, lattice: Lattice) -> list[TouchedFeatures]:
    """Return the features touched by each of the four pegs of
    records, given the rows (N, 4, 12) of these features.
    """
    is_arc = rows[..., IS_ARC] != 0.0
    middle, axis = rows[..., X] + 1j * rows[..., Y], rows[..., AXIS_X] + 1j * rows[..., AXIS_Y]
    radius = np.where(is_arc, rows[..., RADIUS], 0.0)
    columns, lines = records[:, record.COLUMNS : record.ROWS], records[:, record.ROWS : record.PSI]
    place = columns * lattice.pitch_x + 1j * lines * lattice.pitch_y
    return [
        TouchedFeatures(is_arc[:, k], middle[:, k], axis[:, k], radius[:, k], place[:, k]) for k in range(4)
    ]


def compute_dot_products(a: Points, b: Points) -> Array:
    """Return the scalar products of plane vectors given as complex numbers."""
    return np.asarray((np.conj(a) * b).real)


def cross(a: Points, b: Points) -> Array:
    """Return the cross products of plane vectors given as complex numbers."""
    return np.asarray((np.conj(a) * b).imag)


def are_equal_lengths(one: Array, other: Array, bends: Array) -> Bools:
    """Return, for each pair of lengths, whether they agree to within ``DEPENDENT``² / 2 times the length
    ``bends``.

    All are arrays (N,) in mm; ``bends`` is the length r over which a normal turns, see the head of this file.
    """
    return np.asarray(np.abs(one - other) <= DEPENDENT**2 / 2.0 * bends)


def are_parallel(a: TouchedFeatures, b: TouchedFeatures) -> Bools:
    """Return, for each record, whether both features are lines, and parallel."""
    return np.asarray(~a.is_arc & ~b.is_arc & (np.abs(cross(a.axis, b.axis)) <= PARALLEL))


def are_concentric(a: TouchedFeatures, b: TouchedFeatures) -> Bools:
    """Return, for each record, whether both features are arcs about one centre."""
    return np.asarray(a.is_arc & b.is_arc & (np.abs(a.middle - b.middle) <= SAME_CENTER))


def are_antipodal(a: TouchedFeatures, b: TouchedFeatures) -> Bools:
    """Return, for each record, whether two pegs of one carrier are as
    far apart, or as near, as their features allow.
    """
    between, apart = np.abs(b.place - a.place), np.abs(b.middle - a.middle)
    whole = apart + a.radius + b.radius
    one, two = (np.where(each.is_arc, each.radius, np.inf) for each in (a, b))
    bends = np.minimum(between, np.minimum(one, two))
    least = 2.0 * np.maximum(apart, np.maximum(a.radius, b.radius)) - whole
    arcs = (
        a.is_arc
        & b.is_arc
        & (are_equal_lengths(between, whole, bends) | are_equal_lengths(between, least, bends))
    )
    axis = np.where(a.is_arc, b.axis, a.axis)
    gap = np.abs(cross(axis, b.middle - a.middle)) - a.radius - b.radius
    lines = (are_parallel(a, b) | (a.is_arc != b.is_arc)) & are_equal_lengths(between, gap, bends)
    return np.asarray(arcs | lines)


def yield_both_roots(known: Array) -> Iterator[Array]:
    """Yield the two square roots of numbers, the positive ones first; negative numbers count as 0."""
    root = np.sqrt(np.maximum(known, 0.0))
    yield root
    yield -root


def are_turning(
    records: Array, a: TouchedFeatures, b: TouchedFeatures, c: TouchedFeatures, length: float
) -> Bools:
    """Return, for each record, whether it is of the family "turning": pegs a and b are on arcs about one
    centre, and c can touch at one place only.

    ``length`` is L in mm, by which moments are divided. Every solution in the record's box must be of the
    family.
    """
    chord = b.place - a.place
    apart = np.where(chord == 0.0, 1.0, np.abs(chord))
    along = (apart + (a.radius - b.radius) * (a.radius + b.radius) / apart) / 2.0
    psi, first = records[:, record.PSI], records[:, record.TAIL_X] + 1j * records[:, record.TAIL_Y]
    away = a.middle - first
    seen = away * np.exp(-1j * psi)
    turn, off = (
        records[:, record.REACH] + LEAST_REACH / length,
        records[:, record.LARGEST_RADIUS] + LEAST_REACH,
    )
    reach = 1.5 * off + turn * np.abs(away)
    to_center = a.middle - c.middle
    far = np.where(c.is_arc, np.abs(to_center), np.abs(cross(c.axis, to_center)))
    some, every = np.zeros(len(records), np.bool_), np.ones(len(records), np.bool_)
    for beside in yield_both_roots((a.radius - along) * (a.radius + along)):
        center = a.place + (along + 1j * beside) * chord / apart
        distance = np.abs(center - c.place)
        lever = np.where(c.is_arc, distance * far, distance)
        bends = length**2 * np.where(c.is_arc, c.radius, 1.0) / np.where(lever == 0.0, 1.0, lever)
        ends = are_equal_lengths(c.radius, np.abs(distance - far), bends) | are_equal_lengths(
            c.radius, distance + far, bends
        )
        here = np.abs(center - seen) <= reach
        some |= here
        every &= ~here | np.where(c.is_arc, ends, are_equal_lengths(distance, far, bends))
    return np.asarray(are_concentric(a, b) & some & every)


def are_sliding(records: Array, a: TouchedFeatures, b: TouchedFeatures, c: TouchedFeatures) -> Bools:
    """Return, for each record, whether it is of the family "sliding": pegs a and b are on parallel lines, and
    c passes an arc tangentially.

    Every solution in the record's box must be of the family.
    """
    chord, third = b.place - a.place, c.place - a.place
    size = np.where(chord == 0.0, 1.0, np.abs(chord))
    gap, height = cross(b.middle - a.middle, a.axis), cross(c.middle - a.middle, a.axis)
    ahead, aside = compute_dot_products(chord, third) / size**2, cross(chord, third) / size**2
    turn = records[:, record.REACH] + LEAST_REACH
    some, every = np.zeros(len(records), np.bool_), np.ones(len(records), np.bool_)
    for along in yield_both_roots((size - gap) * (size + gap)):
        # The chord lies ``along`` the axis and by the gap to its right.
        psi = np.angle((along - 1j * gap) * a.axis / np.where(chord == 0.0, 1.0, chord))
        here = np.abs(np.exp(1j * (records[:, record.PSI] - psi)) - 1.0) <= turn
        some |= here
        every &= ~here | are_equal_lengths(np.abs(ahead * gap - aside * along - height), c.radius, c.radius)
    return np.asarray(are_parallel(a, b) & c.is_arc & some & every)


def are_lined_up(
    records: Array, a: TouchedFeatures, b: TouchedFeatures, c: TouchedFeatures, length: float
) -> Bools:
    """Return, for each record, whether it is of the family "lined up": pegs a and b touch equal arcs on the
    line through the arcs' centres.

    The third peg must touch its feature c there, which then is a double root and the only root in the box.
    ``length`` is L in mm, by which moments are divided.
    """
    between, chord, radius = b.middle - a.middle, b.place - a.place, a.radius
    apart = np.where(between == 0.0, 1.0, np.abs(between))
    turned, along = between / np.where(chord == 0.0, 1.0, chord), between / apart
    misfit = np.abs(a.radius - b.radius) + np.abs(np.abs(between) - np.abs(chord))
    psi, first = records[:, record.PSI], records[:, record.TAIL_X] + 1j * records[:, record.TAIL_Y]
    turn, off = records[:, record.REACH] + LEAST_REACH, records[:, record.LARGEST_RADIUS] + LEAST_REACH
    reach = 1.5 * off + turn * np.abs(a.place)
    # A box that holds the record's and the double root.
    turn = turn + 1.1 * np.abs(np.exp(1j * psi) - turned)
    arm, out = turned * (c.place - a.place), np.zeros(len(records), np.bool_)
    for side in (1.0, -1.0):
        touch = a.middle + side * radius * along
        third = touch + arm - c.middle
        wide = reach + np.abs(first + np.exp(1j * psi) * a.place - touch)
        with np.errstate(divide="ignore", invalid="ignore"):
            normal = np.where(c.is_arc, third / np.abs(third), 1j * c.axis)
            rest = np.abs(compute_dot_products(normal, third) - c.radius)
            # How fast the third peg leaves its feature, around the circle and as the part turns.
            slide = np.abs(compute_dot_products(normal, 1j * along))
            rate = np.abs(
                compute_dot_products(normal, 1j * (arm - between / 2.0 + side * radius / 2.0 * along))
            )
            curved = np.where(c.is_arc, 1.0 / c.radius, 0.0)
            lever = np.abs(arm) + apart + radius
            bent = lever + apart**2 / radius + lever**2 * curved
            alone = (slide * radius > 4.0 * wide * (1.0 + radius * curved)) & (rate > 4.0 * turn * bent)
            alone &= 4.0 * turn * apart <= radius
            # What misfits turn the part by, and the normals of the two along the circle.
            swing = np.sqrt(misfit * radius * slide / (apart * rate)) + rest / rate
            round_ = swing * np.abs(arm) / (radius * slide) + rest / (radius * slide)
            exact = swing * apart / radius + round_ * apart / length <= DEPENDENT
        out |= alone & exact
    return np.asarray(a.is_arc & b.is_arc & out)
