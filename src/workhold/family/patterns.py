"""The pattern of each fixture of a table, and a fixture moved onto the pegs of a set-up.

A pattern is written as packed whole numbers that are equal for equal patterns. Fixtures are moved by whole
lattice steps or half a turn. A moved fixture touches the same faces with the same forces. The half turn of a
vise changes which jaw stands still, and with it the location error. So a list counts a fixture and its half
turn as one fixture, but they locate a machined part differently.
"""

from __future__ import annotations

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.conventions import GAP_SLACK
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.symmetry import rotate_vectors
from workhold.listing.canonical_form import pack_integers
from workhold.model.fixture_table import FixtureTable
from workhold.model.setup import PartZero

__all__ = [
    "NOTHING",
    "Hole",
    "map_carriers_by_half_turn",
    "list_holes",
    "move_onto_pattern",
    "encode_patterns",
    "encode_places",
    "shift_fixture",
    "rotate_fixtures_by_half_turn",
    "encode_zeros",
]

IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Columns, rows and arrangements in packed numbers; more columns or rows than this no search can look through.
MOST_STEPS, MOST_ARRANGEMENTS = (1 << 18) - 1, 15
# Places of part zeros within this, in mm, and turns of parts within this, in degrees, are one. Where one such
# step ends and the next begins is at no round number, so that rounding does not make equal values differ.
SAME_ZERO, SAME_TURN, BEGINNING = 1e-3, 1e-4, 0.3819660113
# Larger than any column or row.
NO_PLACE = 1 << 40


def group_carriers_by_columns(toolkit: Toolkit) -> list[int]:
    """Return a group number for each carrier; carriers with the same number must be shifted by the same
    columns.

    Each sliding jaw is a group by itself; all other carriers are in group 0.
    """
    slides = [carrier.has_lattice and carrier.travel is not None for carrier in toolkit.carriers]
    return [number if own else 0 for number, own in enumerate(slides)]


def map_carriers_by_half_turn(toolkit: Toolkit, arrangement: int) -> tuple[int, ...] | None:
    """Return for each carrier the index of the carrier whose place it takes after half a turn of everything.

    ``arrangement`` is the arrangement's index. An entry is negative for a carrier without pegs that has no
    counterpart. Returns None if the half turn changes the arrangement.
    """
    places, one = toolkit.half_turned, toolkit.arrangements[arrangement]
    if places is None:
        return None
    known = all(place >= 0 or not count for place, count in zip(places, one.pegs, strict=True))
    if not known or any(
        one.pegs[place] != count for place, count in zip(places, one.pegs, strict=True) if count
    ):
        return None
    return places


def encode_patterns(table: FixtureTable, toolkit: Toolkit) -> IntArray:
    """Return the patterns (N, W) of N fixtures, each as W whole numbers (words), equal for equal patterns.

    Their lexicographic order is that of the patterns' identities.
    """
    carriers = toolkit.find_peg_carriers(table.arrangement).astype(np.int64)
    counts = np.array([one.counted_axes for one in toolkit.carriers])[carriers]
    groups = np.array(group_carriers_by_columns(toolkit))[carriers]
    column, row = table.column.astype(np.int64), table.row.astype(np.int64)
    for group in range(int(groups.max(initial=0)) + 1):
        inside = counts[:, :, 0] & (groups == group)
        column = np.where(groups == group, column - find_least_counted(column, inside), column)
    if not toolkit.datum.fixes_rows:
        row = row - find_least_counted(row, counts[:, :, 1])
    column, row = np.where(counts[:, :, 0], column, 0), np.where(counts[:, :, 1], row, 0)
    order = np.argsort((carriers << 40) + (column << 20) + row, axis=1, kind="stable")
    column, row = (np.take_along_axis(values, order, axis=1) for values in (column, row))
    kind = table.arrangement.astype(np.int64)[:, None]
    return np.column_stack(pack_integers((kind, MOST_ARRANGEMENTS), (column, MOST_STEPS), (row, MOST_STEPS)))


def find_least_counted(values: IntArray, inside: BoolArray) -> IntArray:
    """Return (N, 1): the smallest of each row of ``values`` (N, P) among the entries where ``inside`` (N, P)
    is True.

    It is 0 in a row where none is True.
    """
    found = np.where(inside, values, NO_PLACE).min(axis=1, keepdims=True, initial=NO_PLACE)
    return np.where(found == NO_PLACE, 0, found)


def encode_zeros(table: FixtureTable, toolkit: Toolkit, zero: PartZero) -> IntArray:
    """Return (N, 3) whole numbers: part zero relative to the pegs (x, y), and the part's turn, each rounded
    to steps.

    For fixtures of one pattern they are equal where the parts' zeros are at the same place and their turns
    are equal.
    """
    carriers = toolkit.find_peg_carriers(table.arrangement).astype(np.int64)
    counts = np.array([one.counted_axes for one in toolkit.carriers])[carriers]
    still = np.array(group_carriers_by_columns(toolkit))[carriers] == 0
    pitch = toolkit.carriers[0].pitch
    column = find_least_counted(table.column.astype(np.int64), counts[:, :, 0] & still)[:, 0]
    row = (
        0
        if toolkit.datum.fixes_rows
        else find_least_counted(table.row.astype(np.int64), counts[:, :, 1])[:, 0]
    )
    x, y = rotate_vectors(zero.point[0], zero.point[1], table.theta)
    x, y = x + table.position[:, 0] - column * pitch[0], y + table.position[:, 1] - row * pitch[1]
    return encode_places(x, y, np.degrees(table.theta))


def encode_places(x: NDArray[np.float64], y: NDArray[np.float64], degrees: NDArray[np.float64]) -> IntArray:
    """Return (N, 3) whole numbers: places (x, y) in mm and turns in degrees, each rounded to steps."""
    # A hair below a whole turn is none.
    places = [x / SAME_ZERO, y / SAME_ZERO, ((degrees + SAME_TURN / 2) % 360.0) / SAME_TURN]
    return np.stack([np.floor(values + BEGINNING).astype(np.int64) for values in places], axis=1)


# Number of a carrier, column and row.
Hole = tuple[int, int, int]
# What stands for a column or row that has no meaning, as of a clamp of which only the line is known.
NOTHING = 1 << 40


def shift_fixture(one: FixtureTable, toolkit: Toolkit, columns: dict[int, int], rows: int) -> FixtureTable:
    """Return a fixture (a table of one row) moved by whole columns and rows.

    ``columns`` gives the columns by group of carriers, see :func:`group_carriers_by_columns`; the part moves
    with group 0. All groups are shifted by the same ``rows``.
    """
    carriers = toolkit.find_peg_carriers(one.arrangement)[0]
    groups, pitch = group_carriers_by_columns(toolkit), toolkit.carriers[0].pitch
    counts = np.array([toolkit.carriers[number].counted_axes for number in carriers])
    steps = np.array([columns.get(groups[number], 0) for number in carriers])
    move = np.array([columns.get(0, 0) * pitch[0], rows * pitch[1]])
    column = one.column + np.where(counts[:, 0], steps, 0).astype(np.int32)
    row = one.row + np.where(counts[:, 1], rows, 0).astype(np.int32)
    moved = evolve(one, column=column, row=row, position=one.position + move)
    if not toolkit.tip_count:
        return evolve(
            moved, jaw_separation=one.jaw_separation + (columns.get(0, 0) - columns.get(1, 0)) * pitch[0]
        )
    return move_tips(moved, toolkit, find_tips(one, toolkit) + move)


def rotate_fixtures_by_half_turn(table: FixtureTable, toolkit: Toolkit) -> FixtureTable:
    """Return the fixtures after everything is turned by half a turn about z.

    All must be of one arrangement that the half turn leaves as it is. The pegs take up the same range of rows
    as before, in reverse, and mirrored columns. Figures are not recomputed.
    """
    if not len(table):
        return table
    number = int(table.arrangement[0])
    places = map_carriers_by_half_turn(toolkit, number)
    assert places is not None
    carriers, pitch = np.array(toolkit.arrangements[number].carriers), np.array(toolkit.carriers[0].pitch)
    in_column, in_row = np.array([toolkit.carriers[number].counted_axes for number in carriers]).T
    rows = table.row[:, in_row]
    ends = rows.min(axis=1) + rows.max(axis=1)
    moving = toolkit.moving
    if toolkit.tip_count:
        last = table.column[:, in_column].max(axis=1)
        middle = np.stack([last, ends], axis=1) * pitch
    else:
        last = np.full(len(table), moving.column_count - 1)
        opening = np.stack([table.jaw_separation, np.zeros(len(table))], axis=1)
        middle = np.stack([2 * last, ends], axis=1) * pitch + opening + np.array([0.0, moving.offset[1]])
    column = np.where(in_column, last[:, None] - table.column, 0)
    row = np.where(in_row, ends[:, None] - table.row, 0)
    order = np.lexsort((row, column, np.broadcast_to(np.array(places)[carriers], row.shape)), axis=-1)
    column, row, face = (np.take_along_axis(values, order, axis=1) for values in (column, row, table.face))
    if table.force.ndim > 2:
        force = np.take_along_axis(table.force, order[:, :, None], axis=1)[:, :, ::-1]
    else:
        force = np.take_along_axis(table.force, order, axis=1)
    out = evolve(
        table,
        column=column.astype(np.int32),
        row=row.astype(np.int32),
        face=face,
        theta=(table.theta + np.pi) % (2 * np.pi),
        position=middle - table.position,
        force=force,
    )
    if not toolkit.tip_count:
        return out
    return move_tips(out, toolkit, (middle[:, None] - find_tips(table, toolkit))[:, ::-1])


def find_tips(table: FixtureTable, toolkit: Toolkit) -> NDArray[np.float64]:
    """Return the places (N, K, 2) in mm of the tips of the K clamps of each of N fixtures."""
    x, y = toolkit.compute_hole_places(table.arrangement, table.column, table.row, table.jaw_separation)
    count = 1 if table.jaw_separation.ndim == 1 else table.jaw_separation.shape[1]
    return np.stack([x[:, -count:], y[:, -count:]], axis=2)


def move_tips(table: FixtureTable, toolkit: Toolkit, tips: NDArray[np.float64]) -> FixtureTable:
    """Return fixtures of one arrangement with the tips of their clamps at the places ``tips`` (N, K, 2), in
    mm.
    """
    carriers = toolkit.arrangements[int(table.arrangement[0])].carriers
    travelled = np.zeros(tips.shape[:2])
    for clamp, peg in enumerate(range(len(carriers) - tips.shape[1], len(carriers))):
        carrier = toolkit.carriers[carriers[peg]]
        assert carrier.travel is not None
        x, y = carrier.compute_hole_center(table.column[:, peg], table.row[:, peg])
        along, across = carrier.travel.unit
        travelled[:, clamp] = (tips[:, clamp, 0] - x) * along + (tips[:, clamp, 1] - y) * across
    return evolve(table, jaw_separation=travelled.reshape(table.jaw_separation.shape))


def list_holes(one: FixtureTable, toolkit: Toolkit) -> list[Hole]:
    """Return (carrier index, column, row) of each peg of a fixture, sorted, without the ends of a wall.

    A column or row that has no meaning for a peg is ``NOTHING``.
    """
    out = []
    carriers = toolkit.find_peg_carriers(one.arrangement)
    places = (rows[0].tolist() for rows in (carriers, one.column, one.row))
    for number, column, row in zip(*places, strict=True):
        in_column, in_row = toolkit.carriers[number].counted_axes
        if in_column or in_row:
            out.append((number, column if in_column else NOTHING, row if in_row else NOTHING))
    return sorted(out)


def move_onto_pattern(one: FixtureTable, target: FixtureTable, toolkit: Toolkit) -> FixtureTable | None:
    """Return a fixture moved into the holes of ``target``, a fixture of the same pattern.

    Both are tables of one row. Returns None if the fixture cannot be moved into these holes or the jaw
    opening would be out of range.
    """
    mine, theirs, groups = (
        list_holes(one, toolkit),
        list_holes(target, toolkit),
        group_carriers_by_columns(toolkit),
    )
    steps = {
        groups[number]: column - own
        for (number, own, _), (_, column, _) in reversed(list(zip(mine, theirs, strict=True)))
        if own != NOTHING
    }
    rows = next(row - own for (_, _, own), (_, _, row) in zip(mine, theirs, strict=True) if own != NOTHING)
    moved = shift_fixture(one, toolkit, steps, rows)
    if list_holes(moved, toolkit) != theirs:
        return None
    travel = toolkit.moving.travel
    assert travel is not None
    most = np.inf if travel.most is None else travel.most
    # A clamp keeps its stroke, but jaws now stand nearer or farther apart.
    if (
        toolkit.moving.has_lattice
        and not travel.least - GAP_SLACK <= moved.jaw_separation[0] <= most + GAP_SLACK
    ):
        return None
    return moved
