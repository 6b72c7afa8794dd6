"""Seats, with all clamps that may push there, and the pairs of clamps that close together but not alone.

A seat is a set of locators with the faces they touch and the pose. Contacts of locators with one clamp
(``listing.clamp_contacts``) that have the same locators and pose belong to one seat. With two clamps the
pairs at each seat are counted, and the best is listed.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import SAME_PLACE, SAME_POSE
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.contact.clamp_pairs import (
    CLAMPS,
    COUNT,
    DIRECTION,
    DOUBT,
    FREEDOM,
    HOLES,
    KIND,
    LINE,
    MARGIN,
    OPEN,
    PUSH,
    SEAT,
    TAKEN,
    TIP,
    Clamps,
    Hardware,
    list_pairs,
)
from workhold.listing.asked import are_precise
from workhold.listing.canonical_form import are_lowest, mark_changes, pack_integers, split_into_clusters
from workhold.listing.clamp_contacts import ClampContacts, make_box_beside
from workhold.listing.clamp_placement import (
    DIRECTION_NAMES,
    FAR,
    OPENING,
    find_last_holes,
    is_along_columns,
    is_bolted,
)
from workhold.listing.identity import allows_half_turns
from workhold.listing.ranking import measure_table_as_touched
from workhold.listing.results import RankedTable, SearchWork
from workhold.model.fixture_table import FixtureTable, make_unknown_quality
from workhold.model.quality import CLAMP_FREEDOM
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.search_report import AT_AN_EDGE, UndecidedCandidate
from workhold.proof.deciding import BALLS, SearchReport

if TYPE_CHECKING:
    from workhold.proof.ball_contacts import CandidateBox

__all__ = ["ClampedSeats", "Seats", "make_seats", "list_undecided_pairs"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@define(frozen=True, eq=False)
class Seats:
    """S seats of L locators each, and their clamps.

    Columns and rows count as in :class:`listing.clamp_contacts.ClampContacts`.

    Parameters
    ----------
    feature, column, row : (S, L) feature touched and hole of each locator; sorted by column, then by row.
    face : (S, 3) numbers of the faces that locators and wall touch; faces on the wall come last.
    theta : (S,) orientation of the part on the plate in radians, in [0, 2 pi) within rounding.
    point : (S, 2) a point of the part in its own coordinates, in mm.
    start : (S, 2) vector on the plate from that point to the first locator's centre.
    clamps : all clamps that may push at each seat, without those that hold the part alone.
    clamp_feature : (M,) index of the feature that each clamp touches.
    """

    feature: IntArray
    column: IntArray
    row: IntArray
    face: IntArray
    theta: Array
    point: Array
    start: Array
    clamps: Clamps
    clamp_feature: IntArray

    def __len__(self) -> int:
        return len(self.theta)

    @property
    def spans(self) -> IntArray:
        """Largest column and row of each seat's locators, (S, 2)."""
        return np.stack([self.column.max(axis=1, initial=0), self.row.max(axis=1, initial=0)], axis=1)


def make_seats(
    parts: Sequence[ClampContacts],
    problem: Problem,
    within: Sequence[tuple[float, float]] = ((-inf, inf),),
    is_limited: bool = False,
) -> Seats:
    """Return the seats that contacts of some directions make; contacts
    with equal locators and pose are one seat.

    Parameters
    ----------
    parts : contacts of each direction of the clamp.
    problem : problem of one of the directions.
    within : ranges [low, high) of orientation in radians; seats in none of them are left out.
    is_limited : whether contacts were found up to a limit of the location error.
    """
    found = ClampContacts.concatenate(parts)
    words = pack_integers((found.column, found.column.max(initial=0)), (found.row, found.row.max(initial=0)))
    order = np.lexsort(words[::-1])
    place = (found.point + found.start) @ np.array([1.0, 0.7548776662])
    order, fresh = split_into_clusters(
        order, mark_changes([word[order] for word in words]), (found.theta, SAME_POSE), (place, SAME_PLACE)
    )
    seat = np.empty(len(order), np.int64)
    seat[order] = np.cumsum(fresh) - 1
    count = int(fresh.sum())
    # A contact at a tangent joint is found on both features: the seat has those of the lowest numbers.
    by_seat = np.lexsort([*found.feature.T[::-1], seat])
    first = by_seat[np.diff(seat[by_seat], prepend=-1) > 0]
    theta = np.full(count, inf)
    np.minimum.at(theta, seat, found.theta)
    wanted = np.any([(theta >= low) & (theta < high) for low, high in within], axis=0)
    if is_limited:
        holes = np.stack([found.column[first], found.row[first]], axis=2) * problem.toolkit.carriers[0].pitch
        x, y = np.moveaxis(holes - holes[:, :1], 2, 0)
        away = np.stack(rotate_vectors(x, y, -theta[:, None]), axis=2)
        point = found.point[first][:, None] - problem.workpiece.center + away
        wanted &= are_lowest(found.feature[first], point, problem)
    number, first = np.where(wanted, np.cumsum(wanted) - 1, -1), first[wanted]
    return Seats(
        feature=found.feature[first],
        column=found.column[first],
        row=found.row[first],
        face=found.face[first],
        theta=theta[wanted],
        point=found.point[first],
        start=found.start[first],
        **make_clamp_columns(found, number[seat], len(first), problem),
    )


def make_clamp_columns(found: ClampContacts, seat: IntArray, count: int, problem: Problem) -> dict[str, Any]:
    """Return the fields ``clamps`` and ``clamp_feature`` of :class:`Seats`: each clamp once, seat by seat.

    The clamps of a seat are sorted by direction, line and feature. ``seat`` (M,) is the index of each
    contact's seat, or -1 to leave the contact out; ``count`` is the number of seats.
    """
    chosen = np.flatnonzero(seat >= 0)
    words = pack_integers(
        (seat[chosen, None], max(count, 1)),
        (found.direction[chosen, None], len(DIRECTION_NAMES)),
        (
            found.line[chosen, None] - found.line.min(initial=0),
            int(np.ptp(found.line)) if len(found.line) else 0,
        ),
    )
    along = np.where(is_along_columns(found.direction), found.tip[:, 1], found.tip[:, 0])[chosen]
    order = np.lexsort(words[::-1])
    order, fresh = split_into_clusters(
        order, mark_changes([word[order] for word in words]), (along, SAME_PLACE)
    )
    clamp = np.empty(len(order), np.int64)
    clamp[order] = np.cumsum(fresh) - 1
    # A tip at a joint is on the feature with the lowest index; clamps are sorted by feature, then by place.
    lowest = np.lexsort([found.clamp_feature[chosen], clamp])
    first = lowest[np.diff(clamp[lowest], prepend=-1) > 0]
    listed = np.lexsort(
        [along[first], found.clamp_feature[chosen[first]], *(word[first] for word in words[::-1])]
    )
    kept = chosen[first[listed]]
    rank = np.full(len(seat), -1)
    rank[kept] = np.arange(len(kept))
    there = np.flatnonzero(rank[found.hole_of] >= 0)
    there = there[np.argsort(rank[found.hole_of[there]], kind="stable")]
    clamp_of, hole = rank[found.hole_of[there]], found.holes[there]
    tip = found.tip[kept][clamp_of]
    plate = problem.toolkit.carriers[0]
    place = (
        hole * np.array(plate.pitch) + np.array(plate.offset) if is_bolted(problem.toolkit.moving) else tip
    )
    ends = np.searchsorted(clamp_of, np.arange(len(kept) + 1))
    clamps = Clamps(
        starts=np.searchsorted(seat[kept], np.arange(count + 1)).astype(np.int64),
        integers=np.stack([found.direction[kept], found.line[kept], ends[:-1], ends[1:]], axis=1).astype(
            np.int64
        ),
        reals=np.column_stack([found.taken[kept], found.push[kept], found.doubt[kept], found.tip[kept]]),
        holes=np.column_stack([hole, place, np.hypot(*(tip - place).T)]).astype(np.float64),
    )
    return {"clamps": clamps, "clamp_feature": found.clamp_feature[kept]}


@define(eq=False)
class ClampedSeats:
    """The fixtures with two clamps found so far, or only the best of them.

    Pairs of clamps are rows (N, 10), whose columns ``kernels.contact.seats`` or the kernel that lists pairs
    defines.

    Parameters
    ----------
    query : the query, in a toolkit with two clamps.
    problem : problem of one direction of the clamps; only data common to all directions are used.
    is_limited : whether only fixtures without a warning are of interest.
    looked_at : number of seats examined.
    seats : number of combinations of a seat and a pair of directions in which two clamps hold the part.
    pairs : number of pairs of clamps that hold the part.
    """

    query: Query
    problem: Problem
    is_limited: bool = False
    toolkit: Toolkit = field(init=False)
    hardware: Hardware = field(init=False)
    ranked: RankedTable = field(init=False)
    looked_at: int = field(default=0, init=False)
    seats: int = field(default=0, init=False)
    pairs: int = field(default=0, init=False)
    undecided: list[UndecidedCandidate] = field(factory=list, init=False)

    def __attrs_post_init__(self) -> None:
        self.toolkit, self.ranked = self.query.toolkit, RankedTable(self.query, self.problem)
        kinds = np.full((len(DIRECTION_NAMES), len(DIRECTION_NAMES)), -1, np.int64)
        for number, arrangement in enumerate(self.toolkit.arrangements):
            one, other = (arrangement.direction or "").split()
            kinds[DIRECTION_NAMES.index(one), DIRECTION_NAMES.index(other)] = number
        clamp = self.problem.toolkit.moving
        self.hardware = Hardware(
            kinds, 2 * clamp.peg_radius, *find_last_holes(self.toolkit.carriers[0]), is_bolted(clamp)
        )

    def __len__(self) -> int:
        return len(self.ranked)

    @property
    def turns_half(self) -> bool:
        """Whether half a turn of pegs and part together gives a set-up of the same toolkit."""
        return allows_half_turns(self.toolkit)

    def mark_paired_seats(self, seats: Seats) -> IntArray:
        """Return for each seat 1 if its opposite clamps are to be paired, else 0, (S,).

        Two cases: (a) where half a turn carries the toolkit onto itself, 1 for the seats with an orientation
        in [0, pi); half a turn turns every other fixture with opposite clamps into one of these; (b)
        otherwise 1 for all.
        """
        return ((seats.theta < pi - SAME_POSE) | (not self.turns_half)).astype(np.int64)

    def count_fixtures(self, seats: Seats) -> int:
        """Return the number of listed fixtures of the seats; pairs whose closure is undecided count as well."""
        every = self.query.listing == "all"
        rows = list_pairs(seats.spans, self.mark_paired_seats(seats), seats.clamps, self.hardware, every)
        if every:
            return int(rows[:, COUNT].sum())
        return self.count_held_seats(rows)

    def count_held_seats(self, rows: Array) -> int:
        """Return the number of different combinations of seat and pair of directions among pairs of clamps
        (N, 10).
        """
        return len(np.unique(rows[:, SEAT] * len(self.toolkit.arrangements) + rows[:, KIND]))

    def add(self, seats: Seats) -> None:
        """Find the pairs of clamps that hold at some seats; add their
        fixtures, counts and undecided pairs.
        """
        self.looked_at += len(seats)
        half, every = self.mark_paired_seats(seats), self.query.listing == "all"
        rows = list_pairs(seats.spans, half, seats.clamps, self.hardware, every)
        if self.turns_half and (rows[:, OPEN] != 0.0).any():
            if self.query.best is not None and not every:
                rows = self.select_of_interest(rows, seats)
                kept = np.zeros(len(seats), np.bool_)
                kept[rows[:, SEAT].astype(np.int64)] = True
                half[~kept] = -1
            seats = self.sharpen_seats(seats, rows[rows[:, OPEN] != 0.0])
            rows = list_pairs(seats.spans, half, seats.clamps, self.hardware, every)
        rows = self.select_precise(rows, seats)
        is_open = rows[:, OPEN] != 0.0
        self.undecided += list_undecided_pairs(self.make_table(rows[is_open], seats), self.toolkit)
        rows = rows[~is_open]
        self.pairs += int(rows[:, COUNT].sum())
        self.seats += self.count_held_seats(rows)
        self.ranked.add(self.make_table(rows, seats))

    def select_precise(self, rows: Array, seats: Seats) -> Array:
        """Return the pairs of clamps at seats whose location error is no larger than the query allows.

        ``rows`` (N, 10) are pairs of clamps at ``seats``.
        """
        if self.query.max_location_error is None or not len(rows):
            return rows
        table = measure_table_as_touched(self.make_table(rows, seats), self.query, self.ranked.touched)
        return np.asarray(rows[are_precise(table, self.query)])

    def select_of_interest(self, rows: Array, seats: Seats) -> Array:
        """Return the pairs of clamps at seats that may be among the
        best; ``rows`` (N, 10) are pairs at ``seats``.

        An undecided pair hardly closes, so it has a warning, and is not the best of a seat that has another
        pair.
        """
        seat, is_open = rows[:, SEAT].astype(np.int64), rows[:, OPEN] != 0.0
        known, has_one = rows[~is_open], np.zeros(len(seats), np.bool_)
        has_one[seat[~is_open]] = True
        wanted = ~has_one & (not self.is_limited)
        wanted[
            seat[~is_open][~self.ranked.are_beaten(self.ranked.make_keys(self.make_table(known, seats)), 0)]
        ] = True
        self.ranked.has_dropped |= not wanted[seat].all()
        return rows[wanted[seat]]

    def sharpen_seats(self, seats: Seats, rows: Array) -> Seats:
        """Return the seats with the locators' reactions to some clamps computed in ball arithmetic.

        They are the clamps of the pairs ``rows`` (N, 10).
        """
        from workhold.proof.exact_contacts import bound_reactions

        reals = seats.clamps.reals.copy()
        with BALLS:
            for seat, clamp in sorted(
                {(int(row[SEAT]), int(row[CLAMPS + k])) for row in rows for k in range(2)}
            ):
                sharp = bound_reactions(self.make_candidate_box(seats, seat, clamp), self.problem.limits)
                if sharp is not None:
                    reals[clamp, TAKEN : TAKEN + 3], reals[clamp, DOUBT] = sharp.taken, sharp.doubt
        return evolve(seats, clamps=seats.clamps._replace(reals=reals))

    def make_candidate_box(self, seats: Seats, seat: int, clamp: int) -> CandidateBox:
        """Return a seat and one of its clamps, given by their indices, as a box about the solution.

        In the frame of the box the clamp opens along +x.
        """
        pitch, integers = np.array(self.toolkit.carriers[0].pitch), seats.clamps.integers[clamp]
        carrier = self.toolkit.find_carrier(f"clamp {DIRECTION_NAMES[integers[DIRECTION]]}")
        assert carrier.travel is not None
        cosine, sine = carrier.travel.unit
        turn = np.array([[cosine, sine], [-sine, cosine]])
        holes = np.stack([seats.column[seat], seats.row[seat]], axis=1) * pitch
        places, tip = (
            (holes - holes[0]) @ turn.T,
            turn @ (seats.clamps.reals[clamp, TIP : TIP + 2] - holes[0]),
        )
        x, y = (seats.point[seat] - self.problem.workpiece.center).tolist()
        features = [*seats.feature[seat], seats.clamp_feature[clamp]]
        offsets = [*map(tuple, places.tolist()), (0.0, compute_line_height(integers, holes[0], pitch, turn))]
        middle = carrier.travel.direction - float(seats.theta[seat]), x, y, float(tip[0])
        return make_box_beside(features, offsets, middle, self.problem)

    def make_table(self, rows: Array, seats: Seats) -> FixtureTable:
        """Return pairs of clamps (N, 10) as a table of fixtures in holes of the plate.

        Of the figures of quality only closure margin and clamp freedom are known, the others are NaN.
        """
        seat, clamp = rows[:, SEAT].astype(np.int64), rows[:, [CLAMPS, CLAMPS + 1]].astype(np.int64)
        direction, reals = seats.clamps.integers[clamp, DIRECTION], seats.clamps.reals[clamp]
        plate, (column, row, lowest) = self.toolkit.carriers[0], self.find_holes(rows, seats)
        at = np.stack([column, row], axis=2) * np.array(plate.pitch) + np.array(plate.offset)
        tip = reals[..., TIP : TIP + 2] - (lowest * np.array(plate.pitch))[:, None]
        push, force = reals[..., PUSH], np.zeros((len(rows), 5, 2))
        force[:, :3] = np.swapaxes(reals[..., TAKEN : TAKEN + 3] / push[..., None], 1, 2)
        force[:, 3, 0], force[:, 4, 1] = 1.0 / push[:, 0], 1.0 / push[:, 1]
        quality = make_unknown_quality(rows[:, MARGIN])
        quality[:, CLAMP_FREEDOM] = rows[:, FREEDOM]
        theta, point = seats.theta[seat], seats.point[seat]
        face = np.hstack([seats.face[seat], self.problem.faces[seats.clamp_feature[clamp]]])
        return FixtureTable(
            arrangement=rows[:, KIND].astype(np.int8),
            column=column.astype(np.int32),
            row=row.astype(np.int32),
            face=face.astype(np.int32),
            theta=theta,
            position=at[:, 0]
            - seats.start[seat]
            - np.stack(rotate_vectors(point[:, 0], point[:, 1], theta), axis=1),
            jaw_separation=((tip - at[:, 3:]) * OPENING[direction]).sum(axis=2),
            force=force,
            quality=quality,
            pairs=rows[:, COUNT].astype(np.int32),
        )

    def find_holes(self, rows: Array, seats: Seats) -> tuple[IntArray, IntArray, IntArray]:
        """Return (1) columns (N, 5), (2) rows (N, 5), and (3) the lowest
        column and row (N, 2) that were subtracted.

        The contacts of a fixture are in the order locators, wall ends, clamps. Rows beside a wall are not
        shifted.
        """
        seat, clamp, bolted = (
            rows[:, columns].astype(np.int64) for columns in (SEAT, [CLAMPS, CLAMPS + 1], [HOLES, HOLES + 1])
        )
        direction, line = (seats.clamps.integers[clamp, number] for number in (DIRECTION, LINE))
        upright, hole = is_along_columns(direction), seats.clamps.holes[bolted, :2].astype(np.int64)
        if not self.hardware.bolted:
            hole = np.full_like(hole, FAR)
        locators, clamps = (
            (seats.column[seat], seats.row[seat]),
            (
                np.where(upright, line, hole[..., 0]),
                np.where(upright, hole[..., 1], line),
            ),
        )
        lowest = np.stack(
            [np.minimum(*(v.min(axis=1) for v in pair)) for pair in zip(locators, clamps, strict=True)],
            axis=1,
        )
        # Rows count from a wall, whose ends are listed after the locator.
        lowest[:, 1] *= self.turns_half
        ends = np.zeros((len(rows), 3 - seats.column.shape[1]), np.int64)
        column, row = (
            np.hstack([standing - first, ends, np.where(moving == FAR, 0, moving - first)])
            for standing, moving, first in zip(locators, clamps, lowest.T[..., None], strict=True)
        )
        return column, row, lowest

    def make_result(self, account: SearchReport, work: SearchWork) -> Result:
        """Return the result of all seats added, with undecided pairs in the report."""
        account = evolve(account, undecided=(*account.undecided, *self.undecided))
        result = self.ranked.make_result(account, work)
        return result if self.ranked.has_dropped else evolve(result, pairs=self.pairs, seats=self.seats)


def list_undecided_pairs(table: FixtureTable, toolkit: Toolkit) -> list[UndecidedCandidate]:
    """Return the fixtures of a table as entries of the search report for undecided candidates."""
    columns = table.arrangement, table.face, table.column, table.row, np.degrees(table.theta) % 360.0
    return [
        UndecidedCandidate(
            toolkit.arrangements[kind].title, tuple(face), tuple(column), tuple(row), angle, AT_AN_EDGE, 0.0
        )
        for kind, face, column, row, angle in zip(*(values.tolist() for values in columns), strict=True)
    ]


def compute_line_height(integers: IntArray, first: Array, pitch: Array, turn: Array) -> float:
    """Return the height in mm of a clamp's line above the first locator, in a turned frame.

    ``integers`` is the clamp's row of integers, ``first`` (2,) the locator's place in mm, ``turn`` (2, 2) the
    matrix that turns vectors into the frame.
    """
    upright = bool(is_along_columns(integers[DIRECTION]))
    away = integers[LINE] * pitch[0 if upright else 1] - first[0 if upright else 1]
    return float(turn[1] @ ((away, 0.0) if upright else (0.0, away)))
