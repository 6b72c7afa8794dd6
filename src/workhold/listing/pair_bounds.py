"""What the clamps of a seat say of its pairs before anything is proven.

Contacts of three locators and one clamp already say what the locators take up of the clamp's force. So of
any two at one seat it is known to some digits whether they close, how far their forces may differ, and what
the strongest peg carries. ``listing.seat_order`` asks for it where a figure of the clamps is ranked by.

How far forces may be off: a clamp's contact is as far off as its record says. That turns a normal by so much
over the radius of its arc, and changes a moment by so much over L. The reactions are off by that times the
inverse of the locators' wrenches, over the clamp's push where it moves along its line. All of it is taken
generously, and to first order; where it is not small, the forces are taken as not known.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import NO_REACTION
from workhold.kernels.base.feature import IS_ARC, RADIUS
from workhold.kernels.contact import record
from workhold.kernels.contact.seats import (
    AMPLIFICATION,
    BOUND_LENGTH,
    FACE,
    FORCE_LENGTH,
    FREEDOM,
    MARGIN,
    OFF,
    bounds_of_pairs,
)
from workhold.listing.canonical_form import Candidates, candidates_of
from workhold.listing.clamp_placement import DIRECTION_NAMES
from workhold.listing.packed_contacts import PackedContacts
from workhold.listing.placing import LOCATOR_CONTACTS, TIP
from workhold.model.clamps import LOCATORS
from workhold.model.quality import CLAMP_AMPLIFICATION, CLAMP_FREEDOM, CLOSURE_MARGIN, FIGURES
from workhold.model.query import Query
from workhold.statics.contact_matrix import locators_inverse, outward_normals, wrenches

__all__ = ["BOUNDED", "first_of_clamps", "pair_bounds"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# The figures that pairs bound, by where they stand in a row of bounds.
BOUNDED = {CLAMP_FREEDOM: FREEDOM, CLOSURE_MARGIN: MARGIN, CLAMP_AMPLIFICATION: AMPLIFICATION}
# What forces may be off by besides, as a part of the largest, and most with which they are known at all.
SHARE, MOST_SHARE = 1e-6, 1e-2
# Larger than any step of holes.
MANY = 1 << 20


def first_of_clamps(query: Query) -> int | None:
    """The place in a ranking of the first figure that pairs of clamps bound; None where there is none."""
    keys = {FIGURES[number].key for number in BOUNDED}
    return next((place for place, key in enumerate(query.ranking) if key in keys), None)


def pair_bounds(
    order: IntArray,
    starts: IntArray,
    records: Sequence[PackedContacts],
    problems: Sequence[Problem],
    query: Query,
) -> Array:
    """Bounds (S, 3) of the pairs of clamps at seats, see ``kernels.contact.seats``.

    Parameters
    ----------
    order : (M,) numbers of contacts, counted through all directions, seat by seat.
    starts : (S,) where each seat begins in the order.
    records, problems : of each direction.
    query : what is asked.
    """
    forces, directions = np.empty((len(order), FORCE_LENGTH)), np.empty(len(order), np.int64)
    seat = np.cumsum(np.bincount(starts, minlength=len(order))) - 1
    edges = np.cumsum([0, *map(len, records)])
    for number, (part, problem) in enumerate(zip(records, problems, strict=True)):
        there = np.flatnonzero((order >= edges[number]) & (order < edges[number + 1]))
        some = part.take(order[there] - edges[number])
        forces[there] = clamp_forces(some, candidates_of(some, problem), problem)
        directions[there] = DIRECTION_NAMES.index(problem.toolkit.arrangements[0].direction or "")
    kept = np.flatnonzero(forces[:, OFF] >= 0.0)
    ends = np.searchsorted(seat[kept], np.arange(len(starts) + 1))
    asked = np.zeros((len(DIRECTION_NAMES), len(DIRECTION_NAMES)), np.int64)
    for arrangement in query.toolkit.arrangements:
        one, other = (arrangement.direction or "").split()
        asked[DIRECTION_NAMES.index(one), DIRECTION_NAMES.index(other)] = 1
    out, place = np.empty((len(starts), BOUND_LENGTH)), first_of_clamps(query)
    wants_margin = place is not None and query.ranking[place] == FIGURES[CLOSURE_MARGIN].key
    bounds_of_pairs(ends, directions[kept], forces[kept], asked, wants_margin, out, np.empty((2, LOCATORS)))
    return out


def clamp_forces(records: Array, c: Candidates, problem: Problem) -> Array:
    """Forces (N, 5) of contacts of three locators and a clamp, see ``kernels.contact.seats``.

    Locators are in the order of their holes, whatever the direction of the clamp. Less than no doubt stands
    for a clamp that surely holds the part alone, and needs no other.
    """
    column, row = problem.frame.step_back(c.column[:, LOCATOR_CONTACTS], c.row[:, LOCATOR_CONTACTS])
    places = np.argsort(column * MANY + row, axis=1)
    out = np.empty((len(records), FORCE_LENGTH))
    out[:, :LOCATORS] = np.take_along_axis(c.force[:, LOCATOR_CONTACTS], places, axis=1)
    out[:, FACE] = c.force[:, TIP]
    rows = problem.rows[c.feature]
    each = wrenches(c.point, outward_normals(rows, c.point), problem.wrench_length)
    norm = np.abs(locators_inverse(each)).sum(axis=2).max(axis=1, initial=0.0)
    curved = (1.0 / np.where(rows[..., IS_ARC] != 0.0, rows[..., RADIUS], inf)).max(axis=1, initial=0.0)
    place = 16.0 * (records[:, record.LARGEST_RADIUS] + records[:, record.REACH] * problem.wrench_length)
    share = SHARE + 16.0 * norm * place * (1.0 / problem.wrench_length + curved) * out[:, FACE]
    size = 1.0 + np.abs(out[:, :LOCATORS]).sum(axis=1)
    known = (records[:, record.STANDING] > 0) & (share < MOST_SHARE) & (out[:, FACE] > 0.0) & (size < inf)
    # A clamp that only grazes an arc has no finite force.
    with np.errstate(invalid="ignore"):
        out[:, OFF] = np.where(known, share * size * out[:, FACE], inf)
        alone = out[:, :LOCATORS].min(axis=1, initial=inf) > NO_REACTION * (out[:, FACE] + size) + out[:, OFF]
    out[alone, OFF] = -1.0
    return out
