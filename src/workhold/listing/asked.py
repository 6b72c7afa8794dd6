"""Which fixtures are as asked of each by itself: by the faces that it touches, and by its location error.

What a search finds is proven first and sifted by these rules after it, so its account counts all that was
proven, and the list is complete for what is asked.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from workhold.model.fixture_table import FixtureTable
from workhold.model.quality import LOCATION_ERROR
from workhold.model.query import Query
from workhold.model.wall_ends import wall_ends
from workhold.model.workpiece import Workpiece

__all__ = ["are_as_asked", "are_precise", "touch_all"]

BoolArray = NDArray[np.bool_]


def touch_all(table: FixtureTable, query: Query) -> BoolArray:
    """Return which fixtures (N,) touch each of the faces that they are to touch; a corner touches both of its faces."""
    part, toolkit = query.workpiece, query.toolkit
    wanted, good = find_faces_named(query.restrictions.touch, part), np.ones(len(table), np.bool_)
    corners: list[set[int]] = [set()] * len(table)
    if wanted and toolkit.ends_on_walls and len(table):
        ends = wall_ends(part, toolkit, table.theta, table.position)
        corners = [{face for end in ends.touching(row) for face in end} for row in range(len(table))]
    for face in sorted(wanted):
        good &= (table.face == face).any(axis=1) | np.array([face in own for own in corners], np.bool_)
    return good


def find_faces_named(numbers: tuple[int, ...], workpiece: Workpiece) -> set[int]:
    """Return the numbers of faces, each of which may be named by any of its segments."""
    return {face.number for face in workpiece.numbered.faces if not set(face.segments).isdisjoint(numbers)}


def are_precise(table: FixtureTable, query: Query) -> BoolArray:
    """Return which fixtures (N,), whose figures are known, have a location error no larger than asked."""
    most = query.max_location_error
    return np.ones(len(table), np.bool_) if most is None else table.quality[:, LOCATION_ERROR] <= most


def are_as_asked(table: FixtureTable, query: Query) -> BoolArray:
    """Return which fixtures (N,), whose figures are known, are as asked of each by itself."""
    return touch_all(table, query) & are_precise(table, query)
