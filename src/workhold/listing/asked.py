"""Tests of each fixture by itself: whether it touches the required faces, and whether its location error is
allowed.

Fixtures are proven first and tested afterwards, so the search report counts all that were proven, and the
list is complete for the query.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import LOCATION_ERROR
from workhold.model.query import Query
from workhold.model.wall_ends import find_wall_ends
from workhold.model.workpiece import Workpiece

__all__ = ["are_as_asked", "are_precise", "are_touching_all"]

BoolArray = NDArray[np.bool_]


def are_touching_all(table: FixtureTable, query: Query) -> BoolArray:
    """Return a mask (N,): True for fixtures that touch every face that the query requires.

    A corner that lies on a wall touches both faces that meet there.
    """
    part, toolkit = query.workpiece, query.toolkit
    wanted, good = find_faces_named(query.restrictions.touch, part), np.ones(len(table), np.bool_)
    corners: list[set[int]] = [set()] * len(table)
    if wanted and toolkit.ends_on_walls and len(table):
        ends = find_wall_ends(part, toolkit, table.theta, table.position)
        corners = [
            {face for end in ends.list_touching_faces(row) for face in end} for row in range(len(table))
        ]
    for face in sorted(wanted):
        good &= (table.face == face).any(axis=1) | np.array([face in own for own in corners], np.bool_)
    return good


def find_faces_named(numbers: tuple[int, ...], workpiece: Workpiece) -> set[int]:
    """Return the numbers of the faces that contain any segment with one of the given numbers."""
    return {face.number for face in workpiece.numbered.faces if not set(face.segments).isdisjoint(numbers)}


def are_precise(table: FixtureTable, query: Query) -> BoolArray:
    """Return a mask (N,): True for fixtures of a measured table whose location error the query allows."""
    most = query.max_location_error
    return np.ones(len(table), np.bool_) if most is None else table.quality[:, LOCATION_ERROR] <= most


def are_as_asked(table: FixtureTable, query: Query) -> BoolArray:
    """Return a mask (N,): True for fixtures that touch the required
    faces and whose location error is allowed.

    The table must be measured.
    """
    return are_touching_all(table, query) & are_precise(table, query)
