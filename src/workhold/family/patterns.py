"""The pattern of each fixture of a table, as packed whole numbers that are the same for the same pattern."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.fixels.toolkit import Toolkit
from workhold.geometry.rotation import rotated
from workhold.listing.canonical_form import packed
from workhold.model.part_zero import PartZero
from workhold.model.result import FixtureTable

__all__ = ["column_groups", "half_turn", "pattern_words", "zero_words"]

IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Columns, rows and arrangements in packed numbers; more columns or rows than this no search can look through.
MOST_STEPS, MOST_ARRANGEMENTS = (1 << 18) - 1, 15
# Places of part zeros within this, in mm, and turns of parts within this, in degrees, are one. Where one such step ends and
# the next begins is at no round number, so that rounding does not tell apart what is equal.
SAME_ZERO, SAME_TURN, BEGINNING = 1e-3, 1e-4, 0.3819660113
# Larger than any column or row.
BEYOND = 1 << 40


def column_groups(toolkit: Toolkit) -> list[int]:
    """For each carrier the number of those whose columns it shares: a jaw that slides has its own."""
    slides = [carrier.has_lattice and carrier.travel is not None for carrier in toolkit.carriers]
    return [number if own else 0 for number, own in enumerate(slides)]


def half_turn(toolkit: Toolkit, arrangement: int) -> tuple[int, ...] | None:
    """For each carrier the one whose place it takes after half a turn of everything, where that turn leaves an arrangement
    as it is; None where it does not."""
    places, one = toolkit.half_turned, toolkit.arrangements[arrangement]
    if places is None:
        return None
    known = all(place >= 0 or not count for place, count in zip(places, one.pegs, strict=True))
    if not known or any(one.pegs[place] != count for place, count in zip(places, one.pegs, strict=True) if count):
        return None
    return places


def pattern_words(table: FixtureTable, toolkit: Toolkit) -> IntArray:
    """The patterns (N, W) of fixtures as they stand; their lexicographic order is that of identities."""
    carriers = toolkit.peg_carriers(table.arrangement).astype(np.int64)
    counts = np.array([one.counted for one in toolkit.carriers])[carriers]
    groups = np.array(column_groups(toolkit))[carriers]
    column, row = table.column.astype(np.int64), table.row.astype(np.int64)
    for group in range(int(groups.max(initial=0)) + 1):
        inside = counts[:, :, 0] & (groups == group)
        column = np.where(groups == group, column - least(column, inside), column)
    if not toolkit.datum.fixes_rows:
        row = row - least(row, counts[:, :, 1])
    column, row = np.where(counts[:, :, 0], column, 0), np.where(counts[:, :, 1], row, 0)
    order = np.argsort((carriers << 40) + (column << 20) + row, axis=1, kind="stable")
    column, row = (np.take_along_axis(values, order, axis=1) for values in (column, row))
    kind = table.arrangement.astype(np.int64)[:, None]
    return np.column_stack(packed((kind, MOST_ARRANGEMENTS), (column, MOST_STEPS), (row, MOST_STEPS)))


def least(values: IntArray, inside: BoolArray) -> IntArray:
    """The smallest (N, 1) of the values (N, P) that count, 0 where none does."""
    found = np.where(inside, values, BEYOND).min(axis=1, keepdims=True, initial=BEYOND)
    return np.where(found == BEYOND, 0, found)


def zero_words(table: FixtureTable, toolkit: Toolkit, zero: PartZero) -> IntArray:
    """Where the zero of a part lies from the pegs of its fixtures, and how the part is turned, (N, 3) in whole steps.

    They are the same for fixtures of one pattern in which parts have their zeros at one place and are turned alike.
    """
    carriers = toolkit.peg_carriers(table.arrangement).astype(np.int64)
    counts = np.array([one.counted for one in toolkit.carriers])[carriers]
    still = np.array(column_groups(toolkit))[carriers] == 0
    pitch = toolkit.carriers[0].pitch
    column = least(table.column.astype(np.int64), counts[:, :, 0] & still)[:, 0]
    row = 0 if toolkit.datum.fixes_rows else least(table.row.astype(np.int64), counts[:, :, 1])[:, 0]
    x, y = rotated(zero.point[0], zero.point[1], table.theta)
    degrees = np.degrees(table.theta) + SAME_TURN / 2
    places = [
        (x + table.position[:, 0] - column * pitch[0]) / SAME_ZERO,
        (y + table.position[:, 1] - row * pitch[1]) / SAME_ZERO,
        # A hair below a whole turn is none.
        (degrees % 360.0) / SAME_TURN,
    ]
    return np.stack([np.floor(values + BEGINNING).astype(np.int64) for values in places], axis=1)
