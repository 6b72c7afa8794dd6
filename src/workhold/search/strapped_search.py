"""Seats of three locators with the straps that hold the part down there with the least force.

All seats are listed (``search.seat_search``), the best first: square to the drawing, then by their location
error. For the first seats, a push by hand that presses the part against all three locators is searched and,
if there are loads, the straps that need the least force (``supports.straps``). These seats are listed in the
order of that force. Seats that no push by hand can reach are unfit and come last.
"""

from __future__ import annotations

from collections.abc import Sequence
from threading import Event

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.contact.problem import Progress
from workhold.conventions import SQUARE_TILT
from workhold.fixels.carrier import Carrier
from workhold.geometry.symmetry import rotate_vectors
from workhold.listing.results import make_stage_progress
from workhold.model.fixture_table import FixtureTable
from workhold.model.notes import LeftUndecided, NoFixture, NoPlace, Note, Remark, Stage
from workhold.model.quality import (
    EDGE_DISTANCE,
    END_DISTANCE,
    LOCATION_ERROR,
    SMALLEST_FACE,
    TILT,
    round_number_coarsely,
)
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.straps import USUAL_SEATS, HandPush, Strap, StrappedHold
from workhold.search.seat_search import FoundSeats, find_seats
from workhold.supports.straps import StrapSearch, make_question
from workhold.supports.words_of_straps import describe_missing_places

__all__ = ["find_strapped_fixtures", "select_within_error"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# The share of the work, as progress reports it, that finds the seats.
SEATS = 0.2
# Columns of the figures that seats are ranked by; more is better of those after the first two.
COLUMNS = {
    "square": TILT,
    "location_error": LOCATION_ERROR,
    "edge_distance": EDGE_DISTANCE,
    "end_distance": END_DISTANCE,
    "smallest_face": SMALLEST_FACE,
}
LESS_IS_BETTER = ("square", "location_error")
NOT_LOADED = (
    "No load is given, so no straps are chosen: give a load to have them, with the force that they need."
)


def find_strapped_fixtures(
    query: Query, threads: int = 1, progress: Progress | None = None, cancel: Event | None = None
) -> Result:
    """Return every seat of a part on the plate of a query, or the best seats; the first ones have straps."""
    found = find_seats(query, threads, make_stage_progress(progress, 0.0, SEATS), cancel)
    table = place_on_plate(select_within_error(found.table, query), query)
    table = table.take(order_seats(table, query))
    whole = make_result(table, found, query)
    holds, is_whole = find_strapped_holds(whole, make_stage_progress(progress, SEATS, 1.0), cancel)
    order = rank_seats(holds, table, query)
    chosen = order[: query.best]
    table, holds = move_into_view(table.take(np.array(order, np.int64)), [holds[k] for k in order], query)
    return evolve(
        whole,
        table=table.take(slice(0, len(chosen))),
        holds=tuple(holds[: len(chosen)]),
        notes=(*whole.notes, *remark_if_no_straps_hold(holds, query)),
        complete=whole.complete and is_whole,
    )


def remark_if_no_straps_hold(holds: Sequence[StrappedHold], query: Query) -> list[Note]:
    """Return a list with the remark that straps hold none of the examined seats, with the reason; empty if
    they hold one.

    Also empty without loads. ``holds`` has the straps at each seat.
    """
    seen = [hold for hold in holds if hold.is_looked_at and not hold.is_unfit]
    if not query.is_loaded or not seen or not all(hold.holds_nothing for hold in seen):
        return []
    why = "no force of the straps holds everything there: take more straps, or ask for more of the seats."
    if not any(hold.straps for hold in seen):
        why = describe_missing_places(make_question(query))
    none = "The best seat is not" if len(seen) == 1 else f"None of the {len(seen)} best seats is"
    return [Remark(f"{none} held: {why}")]


def select_within_error(table: FixtureTable, query: Query) -> FixtureTable:
    """Return the seats whose location error is at most that of the
    query; all seats where the query has no limit.
    """
    most = query.max_location_error
    return table if most is None else table.take(table.quality[:, LOCATION_ERROR] <= most)


def make_result(table: FixtureTable, found: FoundSeats, query: Query) -> Result:
    """Return the result of a table of seats, with notes but without straps."""
    name = query.toolkit.arrangements[0].name
    notes = list[Note]()
    undecided = len(found.proof.undecided)
    if undecided:
        notes.append(LeftUndecided(undecided))
    if found.is_complete and len(table) == 0 and not undecided:
        notes.append(explain_no_seat(found, query))
    if len(table) and not query.is_loaded:
        notes.append(Remark(NOT_LOADED))
    return Result(
        query=query,
        table=table,
        found={name: len(table)},
        distinct={name: count_sets(table, query)},
        complete=found.is_complete,
        notes=tuple(notes),
        statistics=found.statistics,
        proof=found.proof,
    )


def explain_no_seat(found: FoundSeats, query: Query) -> Note:
    """Return the note that says why a search found no seat."""
    wording = query.toolkit.wording
    if found.proof.verified:
        return NoPlace(found.proof.verified, wording)
    stages: tuple[tuple[Stage, bool], ...] = (
        ("shape", found.statistics["chord_curves"] == 0),
        ("pair", True),
    )
    return NoFixture(next(name for name, is_so in stages if is_so), wording)


def count_sets(table: FixtureTable, query: Query) -> int:
    """Return the number of distinct seats. Seats that a rotation of the part onto itself makes equal count
    once.
    """
    # Rotations of the part change neither holes nor the place of its centre, only angle and faces.
    from workhold.geometry.symmetry import compute_centroid_of_segments, find_rotations_onto_itself

    every = query.workpiece.numbered
    segments = [face.segment for face in every.faces]
    turns = [one.angle for one in find_rotations_onto_itself(segments, every.marks)]
    if len(turns) < 2 or len(table) == 0:
        return len(table)
    plate = query.toolkit.plates[0]
    kept = np.array(compute_centroid_of_segments(segments))
    lowest = np.column_stack([table.column.min(axis=1), table.row.min(axis=1)]) * np.array(plate.pitch)
    at = table.position + np.stack(rotate_vectors(kept[0], kept[1], table.theta), axis=1) - lowest
    period = np.pi if query.toolkit.half_turned is not None else 2 * np.pi
    seen = set[tuple[object, ...]]()
    spans = np.column_stack([np.ptp(table.column, axis=1), np.ptp(table.row, axis=1)])
    for k in range(len(table)):
        holes = sorted(
            zip(
                (table.column[k] - table.column[k].min()).tolist(),
                (table.row[k] - table.row[k].min()).tolist(),
                strict=True,
            )
        )
        images = list[tuple[object, ...]]()
        for turn in turns:
            theta = (float(table.theta[k]) - turn + 1e-6) % (2 * np.pi)
            place, where = at[k], holes
            if theta >= period:
                theta -= period
                place = spans[k] * np.array(plate.pitch) - place
                where = sorted((int(spans[k, 0]) - a, int(spans[k, 1]) - b) for a, b in holes)
            images.append(
                (round(theta, 5), tuple(where), round(float(place[0]), 4), round(float(place[1]), 4))
            )
        seen.add(min(images, key=str))
    return len(seen)


def place_on_plate(table: FixtureTable, query: Query) -> FixtureTable:
    """Return the seats in holes of the plate, with the part's middle
    as near to the plate's middle as possible.

    Along an axis in which the plate has no ends, the seats are not moved.
    """
    plate = query.toolkit.plates[0]
    cx, cy = query.workpiece.center
    middle = table.position + np.stack(rotate_vectors(cx, cy, table.theta), axis=1)
    moves = np.zeros((len(table), 2), np.int64)
    for axis, (count, numbers) in enumerate(((plate.columns, table.column), (plate.rows, table.row))):
        if count is None:
            continue
        spare = count - 1 - numbers.max(axis=1, initial=0)
        wanted = plate.offset[axis] + (count - 1) * plate.pitch[axis] / 2 - middle[:, axis]
        moves[:, axis] = np.clip(np.ceil(wanted / plate.pitch[axis] - 0.5 - 1e-9).astype(np.int64), 0, spare)
    return move_seats(table, moves, plate)


def move_seats(table: FixtureTable, moves: IntArray, plate: Carrier) -> FixtureTable:
    """Return N seats, each moved by a whole number of columns and rows, ``moves`` (N, 2)."""
    return evolve(
        table,
        column=(table.column + moves[:, :1]).astype(np.int32),
        row=(table.row + moves[:, 1:]).astype(np.int32),
        position=table.position + moves * np.array(plate.pitch),
    )


def order_seats(table: FixtureTable, query: Query) -> IntArray:
    """Return the indices (N,) that put seats in order by the query's
    ranking of their own figures, best first.

    Equally good seats keep their order. Figures of straps are not used.
    """
    keys = [one for name in query.rank_by if name in COLUMNS for one in [compute_seat_key(table, name)]]
    return np.asarray(np.lexsort([np.arange(len(table)), *keys[::-1]]), np.int64)


def compute_seat_key(table: FixtureTable, name: str) -> Array:
    """Return the sort keys (N,) of seats by one figure, given by name; better seats have smaller keys."""
    values = table.quality[:, COLUMNS[name]]
    if name == "square":
        return np.asarray(values >= SQUARE_TILT, np.float64)
    rounded = np.array([round_number_coarsely(one) for one in values.tolist()])
    return rounded if name in LESS_IS_BETTER else -rounded


def find_strapped_holds(
    result: Result, progress: Progress | None, cancel: Event | None
) -> tuple[list[StrappedHold], bool]:
    """Return (a hold by straps for each seat, whether the search came to its end).

    Seats are examined in order until as many as the query asks for can be seated by a push by hand; the
    others are marked as not examined.
    """
    query = result.query
    straps = query.toolkit.strap_set
    assert straps is not None
    asked, wanted, seated = make_question(query), query.strapped or USUAL_SEATS, 0
    unseen = StrappedHold((), None, None, (), straps.max_force, is_looked_at=False)
    holds = [unseen] * len(result)
    for place in range(len(result)):
        if seated == wanted:
            break
        if cancel is not None and cancel.is_set():
            return holds, False
        fixture = result[place]
        search = StrapSearch(fixture, query, asked)
        holds[place] = search.find_best(cancel) if query.is_loaded else search.find_unloaded_hold()
        seated += holds[place].push is not None
        if progress is not None:
            progress(seated / wanted, len(result))
    return holds, True


def rank_seats(holds: Sequence[StrappedHold], table: FixtureTable, query: Query) -> list[int]:
    """Return the indices of seats in the order of the list.

    Held seats come first, by the query's ranking; then seats not examined, then seats that straps do not
    hold, then seats that no push by hand reaches. Equally good seats keep their order.
    """

    def make_key(place: int) -> tuple[float, ...]:
        """Return the sort key of one seat."""
        hold = holds[place]
        if hold.is_unfit:
            return (3.0,)
        if not hold.is_looked_at:
            return (1.0,)
        if hold.holds_nothing:
            return (2.0,)
        numbers = list[float]()
        for name in query.rank_by:
            if name == "clamp_needed":
                need = hold.clamp_needed
                numbers.append(0.0 if need is None else round_number_coarsely(need))
            elif name in COLUMNS:
                numbers.append(float(compute_seat_key(table.take(slice(place, place + 1)), name)[0]))
        return (0.0, float(hold.is_beyond_rating), *numbers)

    # What is looked at comes before what is not; equal ones stay as they are.
    return sorted(range(len(holds)), key=make_key)


def move_into_view(
    table: FixtureTable, holds: Sequence[StrappedHold], query: Query
) -> tuple[FixtureTable, list[StrappedHold]]:
    """Return seats and straps moved by whole columns and rows so that none has a negative column or row.

    They are moved only along axes in which the plate has no ends.
    """
    plate, straps = query.toolkit.plates[0], query.toolkit.strap_set
    assert straps is not None
    ratio = np.round(np.array(plate.pitch) / np.array(straps.bolts.pitch)).astype(np.int64)
    moves = np.zeros((len(table), 2), np.int64)
    for place, hold in enumerate(holds):
        holes = np.array([strap.hole for strap in hold.straps], np.int64).reshape(-1, 2)
        for axis, count in enumerate((plate.columns, plate.rows)):
            if count is None:
                least = min(
                    int((holes[:, axis] // ratio[axis]).min(initial=0)),
                    *(one[axis] for one in hold.supports),
                    0,
                )
                moves[place, axis] = -least
    out = [
        hold if not move.any() else move_hold(hold, move, plate, move * ratio)
        for hold, move in zip(holds, moves, strict=True)
    ]
    return move_seats(table, moves, plate), out


def move_hold(hold: StrappedHold, pegs: IntArray, plate: Carrier, holes: IntArray) -> StrappedHold:
    """Return a hold with its straps, supports and push moved.

    The move is ``pegs`` (2,) columns and rows of the plate's holes for pegs, which is ``holes`` (2,) columns
    and rows of the holes for bolts.
    """
    dx, dy = (pegs * np.array(plate.pitch)).tolist()
    straps = tuple(
        Strap(
            (one.hole[0] + int(holes[0]), one.hole[1] + int(holes[1])),
            (one.at[0] + dx, one.at[1] + dy),
            one.height,
            None if one.over is None else (one.over[0] + int(pegs[0]), one.over[1] + int(pegs[1])),
        )
        for one in hold.straps
    )
    supports = tuple((column + int(pegs[0]), row + int(pegs[1])) for column, row in hold.supports)
    push = hold.push
    there = (
        None
        if push is None
        else HandPush((push.at[0] + dx, push.at[1] + dy), push.direction_deg, push.shares)
    )
    return evolve(hold, straps=straps, push=there, supports=supports)
