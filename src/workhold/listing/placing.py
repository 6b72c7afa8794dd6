"""Placing fixtures in the holes of the carriers, if possible.

Pegs stand in the columns nearest to those of the other carrier. The largest travel or a blocked hole may
demand that they move outward, first the fixed ones, then the moving ones. Rows are shifted so that the lowest
is 0, or centred if the carriers have an end; a blocked hole shifts them as little as possible. A clamp on a
plate of locators is bolted in a hole of its line instead (``listing.make_clamp_placement``). All this happens
in the frame of the search; the last step changes to the toolkit's own frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from attrs import define, evolve, fields
from numpy.typing import NDArray

from workhold.contact.problem import Problem, SearchFrame
from workhold.conventions import GAP_SLACK
from workhold.geometry.symmetry import rotate_vectors
from workhold.listing.canonical_form import CandidateFixtures
from workhold.listing.clamp_placement import ClampPlacement, find_axis, find_last_holes, is_bolted
from workhold.model.fixture_table import FixtureTable, make_unknown_quality
from workhold.model.requirements import lie_in_angle_ranges
from workhold.proof.deciding import is_standing
from workhold.rowwise import find_largest, find_smallest

__all__ = [
    "PlacedCandidates",
    "arrange_candidates",
    "are_at_angle",
    "make_clamp_placement",
    "are_placeable",
    "place_candidates",
]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Indices of the contacts of candidates on a plate with a clamp.
LOCATOR_CONTACTS, TIP = slice(0, 3), 3


@define(frozen=True, eq=False)
class PlacedCandidates:
    """N candidates in the holes of the carriers.

    Parameters
    ----------
    candidates : the candidates; those that fit only after half a turn are turned.
    standing : (N,) number of columns by which the fixed pegs are moved outward from their innermost place.
    moving : (N,) the same for the moving pegs.
    lift : (N,) number of rows by which all pegs are shifted up.
    fits : (N,) whether the candidate has a place in the holes.
    """

    candidates: CandidateFixtures
    standing: IntArray
    moving: IntArray
    lift: IntArray
    fits: BoolArray

    def compute_travel(self, frame: SearchFrame) -> Array:
        """Return the travel (N,) of the moving carrier in mm."""
        outward = (self.standing + self.moving) * frame.lattice.pitch_x
        return np.asarray(self.candidates.gap - outward + frame.travel_at_rest)


def arrange_candidates(c: CandidateFixtures, problem: Problem) -> PlacedCandidates:
    """Return the places of candidates in the holes of both carriers.

    ``fits`` tells which have a place at an allowed angle. If a candidate does not fit, it is tried after a
    half turn that swaps the carriers.
    """
    angles, frame = problem.restrictions.angles, problem.frame
    clear = are_bodies_clear(c, frame)
    found = place_as_is(c, frame)
    found = evolve(found, fits=found.fits & clear & are_at_angle(c.theta, angles, frame))
    if not (angles or any(carrier.blocked for carrier in frame.carriers)):
        return found
    # What does not fit may fit after the half turn that swaps the carriers.
    again = np.flatnonzero(~found.fits & (c.standing == frame.swapped_peg_count) & clear)
    turned = turn_half(c.take(again), frame.swapped_peg_count)
    other = place_as_is(turned, frame)
    good = other.fits & are_at_angle(turned.theta, angles, frame)
    return replace_rows(found, again[good], other, good)


def replace_rows(
    one: PlacedCandidates, rows: IntArray, other: PlacedCandidates, chosen: BoolArray
) -> PlacedCandidates:
    """Return ``one`` with rows replaced by rows of ``other``.

    ``rows`` are the indices to replace, ``chosen`` is the mask that selects as many rows of ``other``, in
    order.
    """
    names = [a.name for a in fields(CandidateFixtures)]
    candidates = {name: getattr(one.candidates, name).copy() for name in names}
    for name, values in candidates.items():
        values[rows] = getattr(other.candidates, name)[chosen]
    moves = {name: getattr(one, name).copy() for name in ("standing", "moving", "lift", "fits")}
    for name, values in moves.items():
        values[rows] = getattr(other, name)[chosen]
    return PlacedCandidates(CandidateFixtures(**candidates), **moves)


def turn_half(c: CandidateFixtures, swapped: int) -> CandidateFixtures:
    """Return candidates after half a turn of pegs and part together, which swaps the two carriers.

    Each carrier has ``swapped`` pegs.
    """
    column = c.column.copy()
    for carrier in (slice(0, swapped), slice(swapped, 2 * swapped)):
        column[:, carrier] = column[:, carrier].max(axis=1, keepdims=True, initial=0) - column[:, carrier]
    row = c.row.max(axis=1, keepdims=True, initial=0) - c.row
    backward = [
        np.ascontiguousarray(values[:, ::-1]) for values in (c.feature, column, row, c.point, c.null, c.force)
    ]
    feature, column, row, point, null, force = backward
    return CandidateFixtures(c.standing, feature, column, row, c.theta + np.pi, point, c.gap, null, force)


def are_bodies_clear(c: CandidateFixtures, frame: SearchFrame) -> BoolArray:
    """Return a mask (N,): True for candidates whose pegs' bodies do not overlap."""
    clear = np.ones(len(c.standing), np.bool_)
    if all(carrier.body_radius == carrier.peg_radius for carrier in frame.carriers):
        # Neighbouring holes are far enough apart for the pegs themselves.
        return clear
    radius = np.where(is_standing(c.standing), *(carrier.body_radius for carrier in frame.carriers))
    for a in range(4):
        for b in range(a):
            apart = np.hypot(*(c.point[:, a] - c.point[:, b]).T)
            clear &= apart >= radius[:, a] + radius[:, b] - GAP_SLACK
    return clear


def are_at_angle(theta: Array, angles: Sequence[Sequence[float]], frame: SearchFrame) -> BoolArray:
    """Return a mask (N,): True for orientations at which the part's angle lies in one of some ranges.

    ``theta`` is in radians in the frame of the search; ``angles`` are ranges in degrees in the toolkit's
    frame; without ranges all are True.
    """
    return np.asarray(lie_in_angle_ranges(np.degrees(theta) + 90.0 * frame.quarters, angles))


def count_free_columns(c: CandidateFixtures, frame: SearchFrame) -> tuple[IntArray, IntArray]:
    """Return the number of free columns outward of the pegs: (on the fixed carrier, on the moving carrier),
    (N,) each.
    """
    standing = is_standing(c.standing)
    return (
        frame.standing.column_count - 1 - find_largest(np.where(standing, c.column, 0)),
        frame.moving.column_count - 1 - find_largest(np.where(standing, 0, c.column)),
    )


def count_free_rows(c: CandidateFixtures, frame: SearchFrame) -> IntArray:
    """Return the number of free rows above the pegs, (N,): the smaller number of both carriers.

    0 if no carrier has an end; negative if the pegs do not fit.
    """
    if all(carrier.rows is None for carrier in frame.carriers):
        return np.zeros(len(c.standing), np.int64)
    ends = np.where(
        is_standing(c.standing), *(np.inf if k.rows is None else k.rows - 1.0 for k in frame.carriers)
    )
    spare = find_smallest(ends - c.row)
    return np.where(np.isinf(spare), 0, spare).astype(np.int64)


def place_as_is(c: CandidateFixtures, frame: SearchFrame) -> PlacedCandidates:
    """Return the places of candidates without half turns, as few columns outward as possible.

    ``fits`` does not take account of angles and bodies.
    """
    pitch, travel = frame.lattice.pitch_x, frame.moving.travel
    assert travel is not None
    free_standing, free_moving = count_free_columns(c, frame)
    at_rest = c.gap + frame.travel_at_rest
    least = np.zeros(len(c.standing), np.int64)
    if travel.most is not None:
        least = np.maximum(np.ceil((at_rest - travel.most - GAP_SLACK) / pitch).astype(np.int64), 0)
    most = np.minimum(free_standing + free_moving, np.floor((at_rest - travel.least + GAP_SLACK) / pitch))
    spare = count_free_rows(c, frame)
    fits = (least <= most) & (spare >= 0)
    move_standing = np.minimum(least, free_standing)
    found = PlacedCandidates(c, move_standing, least - move_standing, spare // 2, fits)
    if len(c.standing) == 0 or not any(carrier.blocked for carrier in frame.carriers):
        return found
    room = np.stack([least, most.astype(np.int64), free_standing, free_moving], axis=1)
    return move_clear_of_blocked(found, frame, room, spare)


def move_clear_of_blocked(
    found: PlacedCandidates, frame: SearchFrame, room: IntArray, spare: IntArray
) -> PlacedCandidates:
    """Return the places with pegs moved outward and in rows until none stands in a blocked hole.

    ``fits`` is False if there is no such place.

    Parameters
    ----------
    room : (N, 4) fewest and most columns outward, both carriers together; free columns on the standing and on
        the moving carrier.
    spare : (N,) free rows above the topmost peg, where the carriers have an end.
    """
    c = found.candidates
    standing = is_standing(c.standing)
    open_ = np.flatnonzero(found.fits)
    out = {name: getattr(found, name).copy() for name in ("standing", "moving", "lift")}
    fits = np.zeros(len(c.standing), np.bool_)
    endless = all(carrier.rows is None for carrier in frame.carriers)
    for one, two in list_outward_moves(frame.standing.column_count, frame.moving.column_count):
        if len(open_) == 0:
            break
        least, most, free_standing, free_moving = room[open_].T
        may = (least <= one + two) & (one + two <= most) & (one <= free_standing) & (two <= free_moving)
        for offset in list_row_offsets(frame, endless, spare):
            lift = found.lift[open_] + offset
            inside = may if endless else may & (lift >= 0) & (lift <= spare[open_])
            index, lift = open_[inside], lift[inside]
            shift = np.where(standing[index], (room[index, 2] - one)[:, None], two)
            free = ~are_in_blocked_holes(
                c.column[index] + shift, c.row[index] + lift[:, None], standing[index], frame
            )
            good = index[free]
            out["standing"][good], out["moving"][good], out["lift"][good] = one, two, lift[free]
            fits[good] = True
            kept = ~fits[open_]
            open_, may = open_[kept], may[kept]
    return PlacedCandidates(c, out["standing"], out["moving"], out["lift"], fits)


def list_outward_moves(standing: int, moving: int) -> Iterator[tuple[int, int]]:
    """Yield (columns of the standing pegs, columns of the moving pegs) to move outward.

    The smallest sum comes first; of equal sums the one that moves the standing pegs farthest. ``standing``
    and ``moving`` are the numbers of columns of the carriers.
    """
    for total in range(standing + moving - 1):
        for two in range(max(0, total - standing + 1), min(total, moving - 1) + 1):
            yield total - two, two


def list_row_offsets(frame: SearchFrame, endless: bool, spare: IntArray) -> list[int]:
    """Return the numbers of rows to shift pegs by, smallest first.

    Two cases: (a) on endless carriers from 0 to one row above the highest blocked one; (b) otherwise both
    ways, by up to the largest of ``spare``.
    """
    if endless:
        blocked = [
            holes.row for carrier in frame.carriers for holes in carrier.blocked if holes.row is not None
        ]
        return list(range(max(blocked, default=-1) + 2))
    most = int(spare.max(initial=0))
    return sorted(range(-most, most + 1), key=lambda shift: (abs(shift), shift))


def are_in_blocked_holes(
    column: IntArray, row: IntArray, standing: BoolArray, frame: SearchFrame
) -> BoolArray:
    """Return a mask (N,): True for fixtures with a peg in a blocked hole.

    ``column``, ``row`` and ``standing`` (whether a peg is on the standing carrier) are (N, 4).
    """
    hit = np.zeros(column.shape, np.bool_)
    for carrier in frame.carriers:
        for holes in carrier.blocked:
            there = (standing == (carrier is frame.standing)) & (column == holes.column)
            hit |= there if holes.row is None else there & (row == holes.row)
    return np.asarray(hit.any(axis=1))


def make_clamp_placement(c: CandidateFixtures, problem: Problem) -> ClampPlacement:
    """Return the data for placing the clamps of candidates on a plate.

    They are in the frame of the search; columns count from the locators' lowest.
    """
    frame = problem.frame
    pitch_x, pitch_y = frame.lattice[:2]
    last_column, last_row = find_last_holes(frame.toolkit.carriers[0])[:: -1 if frame.quarters % 2 else 1]
    last = c.column[:, LOCATOR_CONTACTS].max(axis=1, initial=0)
    along = last * pitch_x + c.gap
    return ClampPlacement(
        frame.moving,
        axis=0,
        back=1,
        tip=np.stack([along, c.row[:, TIP] * pitch_y], axis=1),
        locators=np.stack(
            [c.column[:, LOCATOR_CONTACTS] * pitch_x, c.row[:, LOCATOR_CONTACTS] * pitch_y], axis=2
        ),
        place=along,
        pitch=pitch_x,
        first=last - last_column,
        last=np.full(len(last), last_column),
        fits=(c.row.max(axis=1, initial=0) <= last_row) & (last <= last_column),
        seen=c.point[:, TIP],
        theta=c.theta,
    )


def are_placeable(c: CandidateFixtures, problem: Problem) -> BoolArray:
    """Return a mask (N,): True for candidates that have a place in the toolkit at an allowed angle."""
    if problem.frame.moving.on is None:
        return arrange_candidates(c, problem).fits
    _, fits = make_clamp_placement(c, problem).find_nearest_holes(problem)
    return np.asarray(fits & are_at_angle(c.theta, problem.restrictions.angles, problem.frame))


def place_candidates(c: CandidateFixtures, problem: Problem) -> FixtureTable:
    """Return the table of candidates in the holes of the toolkit, in the same order; all must have a place.

    Of the figures of quality only the closure margin is known, the others are NaN.
    """
    if problem.frame.moving.on is not None:
        return place_candidates_with_clamp(c, problem)
    frame = problem.frame
    found = arrange_candidates(c, problem)
    c = found.candidates
    standing = is_standing(c.standing)
    first = count_free_columns(c, frame)[0] - found.standing
    column, row = frame.map_holes_to_toolkit(
        standing,
        c.column + np.where(standing, first[:, None], found.moving[:, None]),
        c.row + found.lift[:, None],
    )
    return make_table(c, problem, column, row, found.compute_travel(frame))


def place_candidates_with_clamp(c: CandidateFixtures, problem: Problem) -> FixtureTable:
    """Return the table of candidates on a plate with a bolted clamp, see :func:`place_candidates`."""
    frame, placement = problem.frame, make_clamp_placement(c, problem)
    hole, _ = placement.find_nearest_holes(problem)
    column = np.concatenate([c.column[:, LOCATOR_CONTACTS], hole[:, None]], axis=1)
    column, row = (
        numbers - numbers.min(axis=1, keepdims=True, initial=1 << 30)
        for numbers in frame.map_step_to_toolkit(column, c.row)
    )
    travelled = placement.place - hole * frame.lattice.pitch_x
    clamp = frame.toolkit.moving
    if not is_bolted(clamp):
        # The tip is counted from the first column, or row, of the plate.
        across, along = frame.toolkit.moving_axis
        x, y = clamp.compute_hole_center(column[:, TIP], row[:, TIP])
        travelled += x * across + y * along
        (row if find_axis(clamp) else column)[:, TIP] = 0
    return make_table(c, problem, column, row, travelled)


def make_table(
    c: CandidateFixtures, problem: Problem, column: IntArray, row: IntArray, travel: Array
) -> FixtureTable:
    """Return the table of candidates in given holes of the toolkit.

    ``column`` and ``row`` (N, 4) are the holes, ``travel`` (N,) is that of the moving carrier in mm.
    """
    frame = problem.frame
    theta = c.theta if frame.quarters == 0 else (c.theta + frame.quarters * np.pi / 2) % (2 * np.pi)
    anchor = c.point[:, 0] + np.asarray(problem.workpiece.center)
    anchor = np.stack(rotate_vectors(anchor[:, 0], anchor[:, 1], theta), axis=1)
    hole = frame.toolkit.carriers[0].compute_hole_center(column[:, 0], row[:, 0])
    return FixtureTable(
        arrangement=frame.toolkit.find_arrangement_numbers(c.standing).astype(np.int8),
        column=column.astype(np.int32),
        row=row.astype(np.int32),
        face=problem.faces.astype(np.int32).take(c.feature),
        theta=theta,
        position=np.stack(hole, axis=1) - anchor,
        jaw_separation=travel,
        force=c.force,
        quality=make_unknown_quality(find_smallest(c.null)),
    )
