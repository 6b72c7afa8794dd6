"""Bounds of the rank of fixtures that are not proven yet: of pairs of clamps, and of all that is tilted.

Contacts of three locators and one clamp already say what the locators take up of the clamp's force. So of
any two at one seat it is known to some digits whether they close, how far their forces may differ, and what
the strongest peg carries. ``listing.seat_order`` asks for it where a figure of the clamps is ranked by.

How far forces may be off: a clamp's contact is as far off as its record says. That turns a normal by so much
over the radius of its arc, and changes a moment by so much over L. The reactions are off by that times the
inverse of the locators' wrenches, over the clamp's push where it moves along its line. All of it is taken
generously, and to first order; where it is not small, the forces are taken as not known.

A tilt costs points, and no location error is small. Pegs are off by p and faces by f, so that a contact is
off by t = p + f along its normal. Along the tangent it is off by p or more as well, and by t where no arc is
touched by two pegs. So the location error is no less than sqrt(t^2 + p^2), or t sqrt 2 (theorem "tilted
fixtures" of docs/method-theorems.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import LOOSE, NO_REACTION, SQUARE_TILT
from workhold.geometry.segment import Arc
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
from workhold.listing.canonical_form import Candidates, make_candidates
from workhold.listing.clamp_placement import DIRECTION_NAMES, find_direction_number
from workhold.listing.contact_groups import PackedContacts
from workhold.listing.placing import LOCATOR_CONTACTS, TIP
from workhold.listing.ranking import OrderKeys, make_best_possible_figures, make_order_keys
from workhold.model.clamps import LOCATORS
from workhold.model.first_choice import FACTORS
from workhold.model.quality import (
    CLAMP_AMPLIFICATION,
    CLAMP_FREEDOM,
    CLOSURE_MARGIN,
    FIGURES,
    LOCATION_ERROR,
    PENALTY,
    SMALLEST_FACE,
    TILT,
)
from workhold.model.query import Query
from workhold.statics.contact_matrix import compute_outward_normals, invert_locator_matrices, wrenches
from workhold.statics.judging import Judging
from workhold.statics.quality import main_direction, measure_faces

__all__ = [
    "BOUNDED",
    "find_first_clamp_figure",
    "bound_pairs",
    "list_preferred_angles",
    "bound_keys_when_tilted",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# The figures that pairs bound, by where they stand in a row of bounds.
BOUNDED = {CLAMP_FREEDOM: FREEDOM, CLOSURE_MARGIN: MARGIN, CLAMP_AMPLIFICATION: AMPLIFICATION}
# What forces may be off by besides, as a part of the largest, and most with which they are known at all.
# Location errors are rounded by less than the first.
SHARE, MOST_SHARE = 1e-6, 1e-2
# Larger than any step of holes.
MANY = 1 << 20


def find_first_clamp_figure(query: Query) -> int | None:
    """Return the place in a ranking of the first figure that pairs of clamps bound; None if no figure is."""
    keys = {FIGURES[number].key for number in BOUNDED}
    return next((place for place, key in enumerate(query.rank_by) if key in keys), None)


def bound_pairs(
    order: IntArray,
    starts: IntArray,
    records: Sequence[PackedContacts],
    problems: Sequence[Problem],
    query: Query,
) -> Array:
    """Return the bounds (S, 3) of the pairs of clamps at seats, see ``kernels.contact.seats``.

    ``order`` (M,) are numbers of contacts, counted through all directions, seat by seat, and ``starts`` (S,)
    where each seat begins. Records and problems are those of each direction.
    """
    forces, directions = np.empty((len(order), FORCE_LENGTH)), np.empty(len(order), np.int64)
    seat = np.cumsum(np.bincount(starts, minlength=len(order))) - 1
    edges = np.cumsum([0, *map(len, records)])
    for number, (part, problem) in enumerate(zip(records, problems, strict=True)):
        there = np.flatnonzero((order >= edges[number]) & (order < edges[number + 1]))
        some = part.take(order[there] - edges[number])
        forces[there] = clamp_forces(some, make_candidates(some, problem), problem)
        directions[there] = find_direction_number(problem.toolkit)
    kept = np.flatnonzero(forces[:, OFF] >= 0.0)
    ends = np.searchsorted(seat[kept], np.arange(len(starts) + 1))
    asked = np.zeros((len(DIRECTION_NAMES), len(DIRECTION_NAMES)), np.int64)
    for arrangement in query.toolkit.arrangements:
        one, other = (arrangement.direction or "").split()
        asked[DIRECTION_NAMES.index(one), DIRECTION_NAMES.index(other)] = 1
    out, place = np.empty((len(starts), BOUND_LENGTH)), find_first_clamp_figure(query)
    wants_margin = place is not None and query.rank_by[place] == FIGURES[CLOSURE_MARGIN].key
    bounds_of_pairs(ends, directions[kept], forces[kept], asked, wants_margin, out, np.empty((2, LOCATORS)))
    return out


def clamp_forces(records: Array, c: Candidates, problem: Problem) -> Array:
    """Return the forces (N, 5) of contacts of three locators and a clamp, see ``kernels.contact.seats``.

    Locators are in the order of their holes, whatever the direction of the clamp. Less than no doubt stands
    for a clamp that surely holds the part alone, and needs no other.
    """
    column, row = problem.frame.step_back(c.column[:, LOCATOR_CONTACTS], c.row[:, LOCATOR_CONTACTS])
    places = np.argsort(column * MANY + row, axis=1)
    out = np.empty((len(records), FORCE_LENGTH))
    out[:, :LOCATORS] = np.take_along_axis(c.force[:, LOCATOR_CONTACTS], places, axis=1)
    out[:, FACE] = c.force[:, TIP]
    rows = problem.rows[c.feature]
    each = wrenches(c.point, compute_outward_normals(rows, c.point), problem.wrench_length)
    norm = np.abs(invert_locator_matrices(each)).sum(axis=2).max(axis=1, initial=0.0)
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


# Degrees beside preferred orientations that count as such: far more than any orientation is off.
BESIDE = 1e-3


def list_preferred_angles(query: Query) -> list[tuple[float, float]]:
    """Return the ranges in degrees of the part's angle in which the order prefers it: square, as drawn or by
    quarters.

    In the usual order these are quarters of a turn as written, else where the part's main direction is square.
    """
    direction = 0.0 if query.has_house_order else main_direction(query.workpiece)
    beside = SQUARE_TILT + BESIDE
    middles = [90.0 * k - direction for k in range(4)]
    return [(middle - beside, middle + beside) for middle in middles]


def bound_keys_when_tilted(query: Query, problem: Problem) -> OrderKeys | None:
    """Return the least keys, one row, that fixtures at other than the preferred angles can have.

    None where angles have no say, or nothing is bounded.

    Parameters
    ----------
    problem : the search of it, or of one of its directions.
    """
    toolkit, part = query.toolkit, query.workpiece
    if toolkit.has_flats or part.outlines:
        return None
    if query.has_house_order:
        # Where the drawing lies aslant, other angles may be square.
        tilt = SQUARE_TILT if main_direction(part) == 0.0 else 0.0
        return bound_keys_of_tilt(query, problem, tilt)
    tilted, square = (bound_keys_of_tilt(query, problem, tilt) for tilt in (SQUARE_TILT, 0.0))
    return None if (tilted.first == square.first).all() else tilted


def list_shared_arcs(query: Query) -> list[int]:
    """Return the numbers of the arcs that two pegs which fix the part may touch: pegs are a pitch or the gap apart."""
    carriers, gap = query.toolkit.carriers, query.toolkit.gap
    least = min((*(min(one.pitch) for one in carriers if one.has_lattice), *(() if gap is None else (gap,))))
    radius = max(one.peg_radius for one in carriers)
    out = []
    for face in query.workpiece.numbered.faces:
        arc = face.segment
        if isinstance(arc, Arc):
            # Pegs of any radius: about the centre of a bore they are no farther out than the bore.
            far = arc.radius + (radius if arc.sign > 0 else 0.0)
            if 2.0 * far * sin(min(arc.half_sweep, pi / 2)) >= least - LOOSE:
                out.append(face.number)
    return out


def bound_keys_of_tilt(query: Query, problem: Problem, tilt: float) -> OrderKeys:
    """Return the least keys that fixtures of a tilt in degrees or more, at other than preferred angles, can have."""
    part, tolerance = query.workpiece, query.tolerance
    sizes, off = measure_faces(part), tolerance.peg + tolerance.face
    arcs = list_shared_arcs(query)
    # Whether two pegs share an arc or not.
    cases = [(sqrt(2.0) * off, np.nanmax(sizes))]
    if arcs:
        cases.append((hypot(off, tolerance.peg), sizes[arcs].max()))
    quality = make_best_possible_figures(len(cases), query)
    quality[:, LOCATION_ERROR], quality[:, SMALLEST_FACE] = np.transpose(cases)
    quality[:, LOCATION_ERROR] *= 1.0 - SHARE
    quality[:, TILT] = tilt
    quality[:, PENALTY] = Judging.of(problem.wrench_length, query.toolkit, tolerance).penalty(quality)
    aslant = next(factor.times for factor in FACTORS if factor.key == "other_angle")
    error = quality[:, LOCATION_ERROR] * aslant if query.has_house_order else None
    keys = make_order_keys(quality, query, error, np.full(len(cases), 2))
    if keys.error is None:
        return keys.take(keys.order(None)[:1])
    # No one of them need have all that is least.
    rest = keys.rest[np.lexsort(keys.rest.T[::-1])[:1]]
    return OrderKeys(keys.first[:1], keys.error.min(keepdims=True), rest)
