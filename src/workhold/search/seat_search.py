"""Every seat of three locators on a plate: their holes, the faces they touch, and the pose.

Three locators are two chords that share a peg. The search for three locators and a clamp finds such chords;
here it lists them without a clamp. A seat is a set of contacts that fixes the pose as a simple root
(``proof.locator_seats``). Two seats count as equal if they differ only by steps of the lattice, by the names
of the locators or, if this moves no hole for a bolt, by half a turn of the plate.
"""

from __future__ import annotations

from math import pi
from threading import Event

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.conventions import FIGURE_DECIMALS, SAME_PLACE, SAME_POSE
from workhold.errors import InputError
from workhold.fixels.plate import Plate
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import rotate_vectors
from workhold.kernels.contact.quality import write_figures
from workhold.kernels.contact.record import RECORD_LENGTH
from workhold.kernels.curves.block_work import CANDIDATES
from workhold.limits import MOST_WAYS
from workhold.listing.canonical_form import mark_changes, split_into_clusters
from workhold.listing.results import SearchWork, make_proof, make_stage_progress
from workhold.model.fixture_table import FixtureTable, make_unknown_quality
from workhold.model.quality import EDGE_DISTANCE, END_DISTANCE, LOCATION_ERROR, SMALLEST_FACE, TILT
from workhold.model.query import Query
from workhold.model.requirements import lie_in_angle_ranges
from workhold.model.search_report import ProofReport
from workhold.proof.locator_seats import LOCATORS, SeatContacts, decide_seats
from workhold.search.cells import estimate_cost, run_blocks
from workhold.search.toolkit_search import ToolkitSearch
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.quality import (
    compute_tilts,
    find_main_direction,
    find_silhouette_extremes,
    measure_faces,
)

__all__ = ["FoundSeats", "find_seats", "turn_seats_by_half", "make_locating_query"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# The share of the work, as progress reports it, that goes into finding records.
FOUND = 0.8


@frozen(eq=False)
class FoundSeats:
    """The seats of a query, in the order of their angles, holes and faces.

    Parameters
    ----------
    table : the seats; the lowest column and row of each seat are 0, forces are not known (0).
    proof : report on all contacts that were examined.
    statistics : counts by name that show how much work the search was.
    is_complete : whether the search came to its end.
    """

    table: FixtureTable
    proof: ProofReport
    statistics: dict[str, int]
    is_complete: bool


def find_seats(
    query: Query, threads: int = 1, progress: Progress | None = None, cancel: Event | None = None
) -> FoundSeats:
    """Return all seats of a part on the plate of a query.

    Raises
    ------
    InputError
        Where ``Problem.from_query`` raises it, and for a part with more seats than can be examined.
    """
    problem = Problem.from_query(make_locating_query(query), pairing=True)
    search = ToolkitSearch.from_problem(problem, threads=threads, cancel=cancel)
    search.problem = evolve(problem, moving=(0, 0))
    blocks = search.make_blocks(problem.query.types)
    x0, y0, x1, y1 = query.workpiece.bounds
    if estimate_cost(blocks) > MOST_WAYS:
        pitch = query.toolkit.plates[0].pitch
        raise InputError(
            f"the part is {x1 - x0:.6g} x {y1 - y0:.6g} mm large, and three locators in holes {pitch[0]:g} x "
            f"{pitch[1]:g} mm apart can touch it in too many ways to look at: use a larger pitch, fewer columns and "
            "rows, or a small range of angles."
        )
    records, done = run_blocks(
        blocks, threads, make_stage_progress(progress, 0.0, FOUND), cancel, stop=search.stop
    )
    contacts, account = decide_seats(
        np.concatenate(records) if records else np.zeros((0, RECORD_LENGTH)),
        problem,
        query.toolkit.arrangements[0].title,
    )
    table = make_seat_table(contacts, problem, query)
    work = SearchWork(
        len(done) == len(blocks),
        search.statistics,
        sum(block.cells for block in done),
        int(search.totals[CANDIDATES]),
    )
    table = evolve(table, quality=measure_seats(table, query, problem))
    return FoundSeats(table, make_proof(account, work), search.statistics, work.complete)


def make_locating_query(query: Query) -> Query:
    """Return a query of a plate with one clamp whose three locators are those of a query's plate.

    The faces to touch are left out of its restrictions.
    """
    toolkit = query.toolkit
    plate = toolkit.plates[0]
    return Query(
        query.workpiece,
        Plate(plate.pitch, plate.peg_radius, plate.columns, plate.rows, directions="-x"),
        restrictions=evolve(query.restrictions, touch=()),
        contact_margin=query.contact_margin,
        peg_height=query.peg_height,
        thickness=query.thickness,
        program=query.program,
    )


def make_seat_table(contacts: SeatContacts, problem: Problem, query: Query) -> FixtureTable:
    """Return the table of those seats that fit on the plate and satisfy the query's angles and faces to
    touch, each once.
    """
    toolkit, plate = query.toolkit, query.toolkit.plates[0]
    lowest = [numbers.min(axis=1, keepdims=True, initial=0) for numbers in (contacts.column, contacts.row)]
    column, row = contacts.column - lowest[0], contacts.row - lowest[1]
    order = np.lexsort((row, column), axis=-1)
    column, row, feature = (np.take_along_axis(one, order, axis=1) for one in (column, row, contacts.feature))
    theta = -contacts.psi
    first = order[:, :1]
    point = np.take_along_axis(contacts.point, first[..., None], axis=1)[:, 0] + problem.workpiece.center
    at = np.column_stack([column[:, 0], row[:, 0]]) * np.array(plate.pitch) + np.array(plate.offset)
    turned = np.stack(rotate_vectors(point[:, 0], point[:, 1], theta), axis=1)
    table = FixtureTable(
        arrangement=np.zeros(len(theta), np.int8),
        column=column.astype(np.int32),
        row=row.astype(np.int32),
        face=problem.faces[feature].astype(np.int32),
        theta=(theta + SAME_POSE) % (2 * pi) - SAME_POSE,
        position=at - turned,
        jaw_separation=np.zeros(len(theta)),
        force=np.zeros((len(theta), LOCATORS)),
        quality=make_unknown_quality(np.full(len(theta), np.nan)),
    )
    fits = np.ones(len(table), np.bool_)
    for numbers, most in ((column, plate.columns), (row, plate.rows)):
        fits &= True if most is None else numbers.max(axis=1, initial=0) < most
    for face in query.restrictions.touch:
        fits &= (table.face == face).any(axis=1)
    return list_seats_once(table.take(fits), toolkit, query)


def list_seats_once(table: FixtureTable, toolkit: Toolkit, query: Query) -> FixtureTable:
    """Return the seats at angles that the query allows, each once, in the order of angle, holes and faces.

    Where half a turn of the plate maps holes to holes, a seat at half a turn or more is turned back by half a
    turn if the query allows its new angle.
    """
    angles = query.restrictions.angles
    if toolkit.half_turned is not None:
        # The half below half a turn is kept, or else the one that is asked for.
        other = turn_seats_by_half(table, toolkit)
        is_upper = table.theta >= pi - SAME_POSE
        swaps = is_upper & lies_at(other.theta, angles)
        chosen = np.where(swaps, len(table), 0) + np.arange(len(table))
        table = FixtureTable.concatenate([table, other]).take(chosen)
    table = table.take(lies_at(table.theta, angles))
    if len(table) == 0:
        return table
    keys = [*table.face.T[::-1], *table.row.T[::-1], *table.column.T[::-1]]
    by_holes = np.lexsort(keys)
    words = [one[by_holes] for one in (*table.column.T.astype(np.int64), *table.row.T.astype(np.int64))]
    place = table.position @ np.array([1.0, 0.7548776662])
    order, fresh = split_into_clusters(
        by_holes, mark_changes(words), (table.theta, SAME_POSE), (place, SAME_PLACE)
    )
    # A contact at a tangent joint is found on both faces: the seat has those of the lowest numbers.
    group = np.cumsum(fresh) - 1
    within = np.lexsort([*table.face[order].T[::-1], group])
    first = np.searchsorted(group[within], np.arange(int(fresh.sum())))
    kept = table.take(order[within[first]])
    rounded = np.round(kept.theta, 7)
    return kept.take(np.lexsort([*kept.face.T[::-1], *kept.row.T[::-1], *kept.column.T[::-1], rounded]))


def lies_at(theta: Array, angles: tuple[tuple[float, float], ...]) -> NDArray[np.bool_]:
    """Return a mask (N,): True for orientations in radians that lie in one of some ranges in degrees.

    Without ranges, True for all.
    """
    return np.asarray(lie_in_angle_ranges(np.degrees(theta), angles))


def turn_seats_by_half(table: FixtureTable, toolkit: Toolkit) -> FixtureTable:
    """Return the seats after half a turn of the plate, moved so that
    each one's lowest column and row are 0 again.
    """
    plate = toolkit.plates[0]
    column, row = (
        numbers.max(axis=1, keepdims=True, initial=0) - numbers for numbers in (table.column, table.row)
    )
    spans = np.column_stack([one.max(axis=1, initial=0) for one in (table.column, table.row)])
    order = np.lexsort((row, column), axis=-1)
    column, row, face = (np.take_along_axis(one, order, axis=1) for one in (column, row, table.face))
    middle = 2 * np.array(plate.offset) + spans * np.array(plate.pitch)
    return evolve(
        table,
        column=column,
        row=row,
        face=face,
        theta=(table.theta + pi + SAME_POSE) % (2 * pi) - SAME_POSE,
        position=middle - table.position,
    )


def measure_seats(table: FixtureTable, query: Query, problem: Problem) -> Array:
    """Return the figures of quality (N, Q) of N seats.

    Location error, distances from ends and edges, tilt and smallest face are computed; the other columns are
    taken from the table.
    """
    quality = np.array(table.quality)
    if len(table) == 0:
        return quality
    part, plate = query.workpiece, query.toolkit.plates[0]
    touched = TouchableFeatures.from_workpiece(part, query.toolkit, length=problem.wrench_length)
    at = np.stack([table.column, table.row], axis=2) * np.array(plate.pitch) + np.array(plate.offset)
    away = at - table.position[:, None]
    back = np.stack(rotate_vectors(away[..., 0], away[..., 1], -table.theta[:, None]), axis=2)
    found = touched.compute_locators(np.ascontiguousarray(back - touched.center), table.face.astype(np.int64))
    inverses = np.array(found.inverses)
    inverses[:, LOCATORS] = 1.0
    out, work = np.empty((len(table), 7)), np.empty((10, 3))
    tolerance = query.tolerance
    corners, arcs = find_silhouette_extremes(part)
    write_figures(
        np.ascontiguousarray(found.points),
        np.ascontiguousarray(found.normals),
        np.ascontiguousarray(found.ends),
        np.ascontiguousarray(found.edges),
        np.ascontiguousarray(inverses),
        np.ascontiguousarray(table.face.astype(np.int64)),
        touched.length,
        np.array([tolerance.peg, tolerance.face]),
        corners,
        arcs,
        np.zeros((0, 11)),
        out,
        work,
    )
    quality[:, LOCATION_ERROR] = out[:, 3]
    quality[:, END_DISTANCE], quality[:, EDGE_DISTANCE] = out[:, 4], out[:, 6]
    quality[:, TILT] = compute_tilts(table.theta, find_main_direction(part))
    quality[:, SMALLEST_FACE] = measure_faces(part)[table.face].min(axis=1)
    return np.round(quality, FIGURE_DECIMALS + 3)
