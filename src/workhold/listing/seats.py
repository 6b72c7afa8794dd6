"""Seats: locators, the faces they touch and the pose, with all the clamps that may push there.

Contacts of locators with one clamp (``listing.clamp_contacts``) that share their locators and the pose are
one seat.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Any

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import SAME_PLACE, SAME_POSE
from workhold.kernels.contact.clamp_pairs import Clamps
from workhold.listing.canonical_form import changes, clusters, packed
from workhold.listing.clamp_contacts import ClampContacts
from workhold.listing.clamp_placement import DIRECTION_NAMES, is_upright

__all__ = ["Seats", "seats_of"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@define(frozen=True, eq=False)
class Seats:
    """S seats of L locators each, and their clamps; columns and rows as of
    :class:`listing.clamp_contacts.ClampContacts`.

    Parameters
    ----------
    feature, column, row : (S, L) of the locators, in the order of columns and rows.
    face : (S, 3) numbers of the faces that locators touch, those on a wall last.
    theta : (S,) orientation of the workpiece on the plate in radians, in [0, 2 pi) up to a hair.
    point : (S, 2) a point of the part in its own coordinates, in mm.
    start : (S, 2) the first locator's centre from that point, on the plate.
    clamps : all clamps that may push there, but those that hold the part alone.
    clamp_feature : (M,) of each clamp.
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
        """The largest columns and rows (S, 2) of the locators."""
        return np.stack([self.column.max(axis=1, initial=0), self.row.max(axis=1, initial=0)], axis=1)


def seats_of(parts: Sequence[ClampContacts], problem: Problem, within: tuple[float, float] = (-inf, inf)) -> Seats:
    """The seats of the contacts of some directions.

    Parameters
    ----------
    parts : contacts of each direction.
    problem : the search of one of them.
    within : orientations in radians, from and up to but without the second, of the seats that are wanted;
        others are left out, whole.
    """
    found = ClampContacts.joined(parts)
    words = packed((found.column, found.column.max(initial=0)), (found.row, found.row.max(initial=0)))
    order = np.lexsort(words[::-1])
    place = (found.point + found.start) @ np.array([1.0, 0.7548776662])
    order, fresh = clusters(
        order, changes([word[order] for word in words]), (found.theta, SAME_POSE), (place, SAME_PLACE)
    )
    seat = np.empty(len(order), np.int64)
    seat[order] = np.cumsum(fresh) - 1
    count = int(fresh.sum())
    # A contact at a tangent joint is found on both features: the seat has those of the lowest numbers.
    by_seat = np.lexsort([*found.feature.T[::-1], seat])
    first = by_seat[np.diff(seat[by_seat], prepend=-1) > 0]
    theta = np.full(count, inf)
    np.minimum.at(theta, seat, found.theta)
    wanted = (theta >= within[0]) & (theta < within[1])
    number, first = np.where(wanted, np.cumsum(wanted) - 1, -1), first[wanted]
    return Seats(
        feature=found.feature[first],
        column=found.column[first],
        row=found.row[first],
        face=found.face[first],
        theta=theta[wanted],
        point=found.point[first],
        start=found.start[first],
        **clamps_of(found, number[seat], len(first), problem),
    )


def clamps_of(found: ClampContacts, seat: IntArray, count: int, problem: Problem) -> dict[str, Any]:
    """The clamps of seats, each once, in the order of seats, directions, lines and features; ``seat`` (M,) is
    -1 for contacts that are left out."""
    chosen = np.flatnonzero(seat >= 0)
    words = packed(
        (seat[chosen, None], max(count, 1)),
        (found.direction[chosen, None], len(DIRECTION_NAMES)),
        (found.line[chosen, None] - found.line.min(initial=0), int(np.ptp(found.line)) if len(found.line) else 0),
    )
    along = np.where(is_upright(found.direction), found.tip[:, 1], found.tip[:, 0])[chosen]
    order = np.lexsort(words[::-1])
    order, fresh = clusters(order, changes([word[order] for word in words]), (along, SAME_PLACE))
    clamp = np.empty(len(order), np.int64)
    clamp[order] = np.cumsum(fresh) - 1
    # Of a tip at a joint the feature of the lowest number; then clamps by their features, and where they
    # touch them.
    lowest = np.lexsort([found.clamp_feature[chosen], clamp])
    first = lowest[np.diff(clamp[lowest], prepend=-1) > 0]
    listed = np.lexsort([along[first], found.clamp_feature[chosen[first]], *(word[first] for word in words[::-1])])
    kept = chosen[first[listed]]
    rank = np.full(len(seat), -1)
    rank[kept] = np.arange(len(kept))
    there = np.flatnonzero(rank[found.hole_of] >= 0)
    there = there[np.argsort(rank[found.hole_of[there]], kind="stable")]
    clamp_of, hole = rank[found.hole_of[there]], found.holes[there]
    tip = found.tip[kept][clamp_of]
    plate = problem.toolkit.carriers[0]
    place = hole * np.array(plate.pitch) + np.array(plate.offset) if problem.toolkit.moving.has_a_hole else tip
    ends = np.searchsorted(clamp_of, np.arange(len(kept) + 1))
    clamps = Clamps(
        starts=np.searchsorted(seat[kept], np.arange(count + 1)).astype(np.int64),
        integers=np.stack([found.direction[kept], found.line[kept], ends[:-1], ends[1:]], axis=1).astype(np.int64),
        reals=np.column_stack([found.taken[kept], found.push[kept], found.doubt[kept], found.tip[kept]]),
        holes=np.column_stack([hole, place, np.hypot(*(tip - place).T)]).astype(np.float64),
    )
    return {"clamps": clamps, "clamp_feature": found.clamp_feature[kept]}
