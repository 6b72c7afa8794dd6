"""Bounds of the rank of fixtures that are not yet proven: by pairs of clamps, and for all tilted fixtures.

Contacts of three locators and one clamp determine the locators' reactions to the clamp's force. So for any
two clamps at one seat it is approximately known whether they close, how far their forces may differ, and the
force on the strongest peg. ``listing.seat_order`` uses this where the ranking has a figure of the clamps.

Errors of the forces. The record of a clamp's contact has an error bound of its place. An error of place e
turns a normal by e over the radius of its arc, and changes a moment by e / L. The error of the reactions is
the error of normals and moments times the inverse of the locators' wrenches, divided by the clamp's push,
since the clamp moves along its line. All bounds are to first order, and generous; where a bound is not small,
the forces count as unknown.

A tilt costs points, and the location error has a lower bound. Pegs have the tolerance p and faces the
tolerance f, so a contact may be off by t = p + f along its normal. Along the tangent it may be off by p at
least, and by t at least if no two pegs touch the same arc. So the location error is at least sqrt(t^2 + p^2),
or t sqrt 2 (theorem "tilted fixtures" of docs/method-theorems.md).
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
    write_pair_bounds,
)
from workhold.listing.canonical_form import CandidateFixtures, make_candidates
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
from workhold.statics.contact_matrix import compute_outward_normals, compute_wrenches, invert_locator_matrices
from workhold.statics.judging import JudgingLimits
from workhold.statics.quality import find_main_direction, measure_faces

__all__ = [
    "BOUNDED",
    "find_first_clamp_figure",
    "bound_pairs",
    "list_preferred_angles",
    "bound_keys_when_tilted",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Figures that pairs of clamps bound, each with its column in a row of bounds.
BOUNDED = {CLAMP_FREEDOM: FREEDOM, CLOSURE_MARGIN: MARGIN, CLAMP_AMPLIFICATION: AMPLIFICATION}
# Further error of forces as a part of the largest, and the largest error with which forces count as known.
# Location errors are rounded by less than SHARE.
SHARE, MOST_SHARE = 1e-6, 1e-2
# Larger than any step of holes.
MANY = 1 << 20


def find_first_clamp_figure(query: Query) -> int | None:
    """Return the index in the query's ranking of the first figure that pairs of clamps bound; None if there
    is none.

    The figures that pairs of clamps bound are the keys of :data:`BOUNDED`.
    """
    keys = {FIGURES[number].key for number in BOUNDED}
    return next((place for place, key in enumerate(query.rank_by) if key in keys), None)


def bound_pairs(
    order: IntArray,
    starts: IntArray,
    records: Sequence[PackedContacts],
    problems: Sequence[Problem],
    query: Query,
) -> Array:
    """Return bounds of figures over all pairs of clamps at each of S seats, (S, 3).

    Columns: see ``kernels.contact.seats``.

    Parameters
    ----------
    order : (M,) indices of contacts, seat by seat, counted through the records of all directions.
    starts : (S,) index in ``order`` at which each seat begins.
    records, problems : contacts and problem of each direction of the clamp.
    """
    forces, directions = np.empty((len(order), FORCE_LENGTH)), np.empty(len(order), np.int64)
    seat = np.cumsum(np.bincount(starts, minlength=len(order))) - 1
    edges = np.cumsum([0, *map(len, records)])
    for number, (part, problem) in enumerate(zip(records, problems, strict=True)):
        there = np.flatnonzero((order >= edges[number]) & (order < edges[number + 1]))
        some = part.take(order[there] - edges[number])
        forces[there] = compute_clamp_forces(some, make_candidates(some, problem), problem)
        directions[there] = find_direction_number(problem.toolkit)
    kept = np.flatnonzero(forces[:, OFF] >= 0.0)
    ends = np.searchsorted(seat[kept], np.arange(len(starts) + 1))
    asked = np.zeros((len(DIRECTION_NAMES), len(DIRECTION_NAMES)), np.int64)
    for arrangement in query.toolkit.arrangements:
        one, other = (arrangement.direction or "").split()
        asked[DIRECTION_NAMES.index(one), DIRECTION_NAMES.index(other)] = 1
    out, place = np.empty((len(starts), BOUND_LENGTH)), find_first_clamp_figure(query)
    wants_margin = place is not None and query.rank_by[place] == FIGURES[CLOSURE_MARGIN].key
    write_pair_bounds(ends, directions[kept], forces[kept], asked, wants_margin, out, np.empty((2, LOCATORS)))
    return out


def compute_clamp_forces(records: Array, c: CandidateFixtures, problem: Problem) -> Array:
    """Return the forces of N contacts of three locators and a clamp, (N, 5); see ``kernels.contact.seats``.

    Columns: the locators' forces in the order of their holes on the plate, the force at the clamp's face, and
    an error bound. The bound is inf if the forces are not known, and -1 for a clamp that surely holds the
    part alone. ``records`` (N, 19) and ``c`` describe the same contacts.
    """
    column, row = problem.frame.map_step_to_toolkit(c.column[:, LOCATOR_CONTACTS], c.row[:, LOCATOR_CONTACTS])
    places = np.argsort(column * MANY + row, axis=1)
    out = np.empty((len(records), FORCE_LENGTH))
    out[:, :LOCATORS] = np.take_along_axis(c.force[:, LOCATOR_CONTACTS], places, axis=1)
    out[:, FACE] = c.force[:, TIP]
    rows = problem.rows[c.feature]
    each = compute_wrenches(c.point, compute_outward_normals(rows, c.point), problem.wrench_length)
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


# Degrees by which preferred ranges are widened: far more than any orientation is off.
BESIDE = 1e-3


def list_preferred_angles(query: Query) -> list[tuple[float, float]]:
    """Return the four ranges (low, high) in degrees of the part's angle that the ranking prefers.

    They are a quarter turn apart, about as narrow as ``SQUARE_TILT`` on each side of their middles. In the
    usual ranking the middles are the multiples of 90 degrees; in any other, the angles at which the part's
    main direction is square to the toolkit.
    """
    direction = 0.0 if query.has_house_order else find_main_direction(query.workpiece)
    beside = SQUARE_TILT + BESIDE
    middles = [90.0 * k - direction for k in range(4)]
    return [(middle - beside, middle + beside) for middle in middles]


def bound_keys_when_tilted(query: Query, problem: Problem) -> OrderKeys | None:
    """Return lower bounds of the ranking keys of all fixtures at other than the preferred angles, one row.

    None if the angle makes no difference, and if no bound is known: for flat jaws or fences, and for parts
    with several outlines.

    Parameters
    ----------
    problem : problem of the query, or of one direction of its clamps.
    """
    toolkit, part = query.toolkit, query.workpiece
    if toolkit.has_flats or part.outlines:
        return None
    if query.has_house_order:
        # Where the drawing lies aslant, other angles may be square.
        tilt = SQUARE_TILT if find_main_direction(part) == 0.0 else 0.0
        return bound_keys_of_tilt(query, problem, tilt)
    tilted, square = (bound_keys_of_tilt(query, problem, tilt) for tilt in (SQUARE_TILT, 0.0))
    return None if (tilted.first == square.first).all() else tilted


def list_shared_arcs(query: Query) -> list[int]:
    """Return the numbers of the arcs that two locating pegs may touch at the same time, ascending.

    Two pegs are at least a pitch or the smallest gap apart, so a chord of the offset arc must be as long.
    """
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
    """Return lower bounds of the ranking keys of all fixtures tilted by ``tilt`` degrees or more, one row.

    The fixtures must be at other than the preferred angles.
    """
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
    quality[:, PENALTY] = JudgingLimits.from_toolkit(
        problem.wrench_length, query.toolkit, tolerance
    ).compute_penalty(quality)
    aslant = next(factor.times for factor in FACTORS if factor.key == "other_angle")
    error = quality[:, LOCATION_ERROR] * aslant if query.has_house_order else None
    keys = make_order_keys(quality, query, error, np.full(len(cases), 2))
    if keys.error is None:
        return keys.take(keys.sort(None)[:1])
    # The least values of the keys may belong to different cases.
    rest = keys.rest[np.lexsort(keys.rest.T[::-1])[:1]]
    return OrderKeys(keys.first[:1], keys.error.min(keepdims=True), rest)
