"""Fixtures of a fence with two clamps: seats of wall and locator with their clamps, paired and written out.

As on a plate (``listing.paired``), but a seat is a hull edge on the wall and a locator: one orientation each, rows counted
from the wall, and nothing that a turn makes the same.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from attrs import define
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import NO_REACTION, SAME_PLACE
from workhold.kernels.contact.clamp_pairs import Clamps
from workhold.listing.canonical_form import changes, clusters, packed
from workhold.listing.on_fence import Pressed, clear_holes, listed_once, turned
from workhold.listing.paired import ChosenPairs, PairedFixtures
from workhold.listing.plate_identity import FAR, clamps_of
from workhold.listing.seats import NAMES, presses_too_much
from workhold.model.result import FixtureTable

__all__ = ["PairedOnFence", "SeatsOnFence", "seats_on_fence"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@define(frozen=True, eq=False)
class SeatsOnFence:
    """S seats of a hull edge on the wall and a locator, and their clamps.

    Parameters
    ----------
    edge, row, feature : (S,) hull edge, row of the locator, and the feature that it touches.
    locator : (S, 2) its centre along the hull edge from its start and above it, in mm.
    clamps : all clamps that may push there, but those that hold the part alone; places count along the wall from the
        locator, columns of holes and lines likewise.
    clamp_feature : (M,) of each clamp.
    """

    edge: IntArray
    row: IntArray
    feature: IntArray
    locator: Array
    clamps: Clamps
    clamp_feature: IntArray

    def __len__(self) -> int:
        return len(self.edge)

    @property
    def spans(self) -> IntArray:
        """The column 0 and the row (S, 2) of the locators."""
        return np.stack([np.zeros(len(self), np.int64), self.row], axis=1)


def seats_on_fence(parts: Sequence[tuple[Pressed, Problem, str]]) -> SeatsOnFence:
    """The seats of the contacts that the searches of some directions proved, with their problems and names."""
    contacts = [one_direction(*part) for part in parts]
    pressed = Pressed.joined([one for one, _, _, _ in contacts])
    direction = np.concatenate([np.full(len(one), number) for one, number, _, _ in contacts])
    starts = np.cumsum([0, *(len(one) for one, _, _, _ in contacts)])
    contact = np.concatenate([index + start for (_, _, index, _), start in zip(contacts, starts, strict=False)])
    hole = np.concatenate([numbers for _, _, _, numbers in contacts])
    words = packed((pressed.edge[:, None], int(pressed.edge.max(initial=0))), (pressed.row[:, None], FAR))
    order = np.lexsort(words[::-1])
    order, fresh = clusters(order, changes([word[order] for word in words]), (pressed.locator[:, 0], SAME_PLACE))
    seat = np.empty(len(order), np.int64)
    seat[order] = np.cumsum(fresh) - 1
    by_seat = np.lexsort([pressed.feature[:, 0], seat])
    first = by_seat[np.diff(seat[by_seat], prepend=-1) > 0]
    listed = np.lexsort([pressed.feature[:, 1], pressed.line, direction, seat])
    rank = np.empty(len(listed), np.int64)
    rank[listed] = np.arange(len(listed))
    by_clamp = np.argsort(rank[contact], kind="stable")
    clamp_of, bolted = rank[contact][by_clamp], hole[by_clamp]
    ends = np.searchsorted(clamp_of, np.arange(len(listed) + 1))
    chosen = pressed.take(listed)
    along, toolkit = direction[listed] < NAMES.index("-y"), parts[0][1].toolkit
    tip = np.stack([chosen.tip[:, 0] - chosen.locator[:, 0], chosen.tip[:, 1]], axis=1)
    column = np.where(along[clamp_of], bolted, chosen.line[clamp_of])
    row = np.where(along[clamp_of], chosen.line[clamp_of], bolted)
    place = np.stack([column, row], axis=1) * np.array(toolkit.carriers[0].pitch) + np.array(toolkit.carriers[0].offset)
    if not toolkit.moving.has_a_hole:
        place = tip[clamp_of]
    clamps = Clamps(
        starts=np.searchsorted(seat[listed], np.arange(len(first) + 1)).astype(np.int64),
        integers=np.stack([direction[listed], chosen.line, ends[:-1], ends[1:]], axis=1).astype(np.int64),
        reals=np.column_stack([chosen.null[:, [2, 0, 1]], chosen.push, chosen.doubt, tip]),
        holes=np.column_stack([column, row, place, np.hypot(*(tip[clamp_of] - place).T)]).astype(np.float64),
    )
    return SeatsOnFence(
        pressed.edge[first],
        pressed.row[first],
        pressed.feature[first, 0],
        pressed.locator[first],
        clamps,
        chosen.feature[:, 1],
    )


def one_direction(pressed: Pressed, problem: Problem, direction: str) -> tuple[Pressed, int, IntArray, IntArray]:
    """Contacts of one direction, each once, without clamps that hold the part alone, press a locator too much
    (:func:`presses_too_much`) or have no hole; the direction's number; and holes, with the numbers of their contacts in
    front."""
    pressed = listed_once(pressed)
    taken = pressed.null[:, :3]
    needed = taken.min(axis=1, initial=1.0) <= NO_REACTION * (1.0 + np.abs(taken).sum(axis=1))
    pressed = pressed.take(needed & ~presses_too_much(taken, pressed.push))
    index, hole = clear_holes(pressed, problem, every=True)
    kept = np.unique(index)
    return pressed.take(kept), NAMES.index(direction), np.searchsorted(kept, index), hole


class PairedOnFence(PairedFixtures):
    """The fixtures of a fence with two clamps found so far, or the best of them."""

    def first_half(self, seats: SeatsOnFence) -> IntArray:  # type: ignore[override]
        """1 for all: no turn makes one fixture another."""
        return np.ones(len(seats), np.int64)

    def sharpened(self, seats: SeatsOnFence, rows: Array) -> SeatsOnFence:  # type: ignore[override]
        """As they are: what doubles do not tell well enough was told by balls."""
        return seats

    def written_out(self, rows: Array, seats: SeatsOnFence) -> FixtureTable:  # type: ignore[override]
        """Pairs (N, 10) in holes of the plate; of their quality closure margin and clamp freedom are known."""
        pairs, flush, count = ChosenPairs.of(rows, seats.clamps), self.query.workpiece.flush, len(rows)
        seat, upright, in_hole = pairs.seat, pairs.upright, self.toolkit.travel is not None
        zero = np.zeros((count, 1), np.int64)
        across = np.where(upright, pairs.line, pairs.hole[..., 0] if in_hole else FAR)
        lowest = np.minimum(across.min(axis=1, initial=0), 0)[:, None]
        across = np.where(across == FAR, 0, across - lowest)
        column = np.hstack([zero - lowest, zero, zero, across])
        upward = np.where(upright, pairs.hole[..., 1] if in_hole else 0, pairs.line)
        row = np.hstack([seats.row[seat][:, None], zero, zero, upward])
        # Places along the wall count from the locator, which now stands in this column.
        shift = np.hstack([-lowest * self.toolkit.pitch[0], np.zeros((count, 1))])
        theta, faces = flush.theta[seats.edge[seat]], self.problem.faces
        start = np.stack([shift[:, 0] - seats.locator[seat, 0], np.zeros(count)], axis=1)
        one, two = faces[seats.feature[seat]][:, None], faces[seats.clamp_feature[pairs.clamp]]
        return pairs.in_holes(
            column,
            row,
            self.toolkit.carriers[0],
            shift,
            face=np.hstack([one, flush.face[seats.edge[seat]], two]).astype(np.int32),
            theta=theta,
            position=start - turned(flush.ends[seats.edge[seat], 0], theta),
        )

    def smallest(self, table: FixtureTable) -> tuple[IntArray, Array]:
        """Of each fixture the first of the forms that the part's rotations give it: whole numbers (N, K), and places
        (N, P) along the wall and of tips."""
        flush = self.query.workpiece.flush
        images = np.min([flush.number(flush.theta - rotation.angle) for rotation in self.rotations], axis=0)
        upright, tips = clamps_of(table, self.toolkit)
        line = np.where(upright, table.column[:, 3:] - table.column[:, :1] + FAR, table.row[:, 3:])
        key = np.column_stack([table.arrangement, images[flush.number(table.theta)], table.row[:, 0], line])
        # Where the locator stands along the wall tells seats of one row apart.
        locator = table.column[:, [0]] * self.toolkit.pitch[0]
        along, ahead = flush.x(table.theta, table.position)[:, :1] - locator, np.where(upright, tips, tips - locator)
        every = self.query.listing == "all"
        return (key if every else key[:, :3]).astype(np.int64), np.hstack([along, ahead]) if every else along
