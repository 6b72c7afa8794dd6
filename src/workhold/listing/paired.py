"""Fixtures with two clamps gathered while a search goes on: paired, written out, measured, counted and ranked."""

from __future__ import annotations

from math import inf, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.conventions import SAME_POSE
from workhold.geometry.rotation import rotated
from workhold.geometry.symmetry import Rotation
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
    pairs_of,
)
from workhold.listing.canonical_form import packed
from workhold.listing.distinct import one_of_each_set, rotations_of
from workhold.listing.listed import Work, proof_of
from workhold.listing.plate_identity import FAR, identity_order, smallest_images
from workhold.listing.ranking import best_marked, rank
from workhold.listing.seats import ALONG, NAMES, Seats, box_beside
from workhold.model.notes import undecided_note
from workhold.model.plate import Plate
from workhold.model.proof import AT_AN_EDGE, Undecided
from workhold.model.quality import CLAMP_FREEDOM, CLOSURE_MARGIN
from workhold.model.query import Query
from workhold.model.result import FixtureTable, Result, unknown_quality
from workhold.model.toolkit import Carrier
from workhold.proof.deciding import BALLS, Account
from workhold.statics.contact_matrix import Touched
from workhold.statics.quality import quality_of

if TYPE_CHECKING:
    from workhold.proof.interval_newton import CandidateBox

__all__ = ["FAR", "ChosenPairs", "PairedFixtures"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]


@define(frozen=True, eq=False)
class ChosenPairs:
    """N pairs of clamps of some seats, taken apart.

    Parameters
    ----------
    rows : (N, 10) as kernels tell them (``kernels.contact.clamp_pairs``).
    seat, kind : (N,) numbers of seats and pairs of directions.
    clamp, direction, line : (N, 2) numbers of both clamps, of their directions and lines.
    hole : (N, 2, 2) column and row in which each is bolted.
    reals : (N, 2, 7) of both.
    """

    rows: Array
    seat: IntArray
    kind: IntArray
    clamp: IntArray
    direction: IntArray
    line: IntArray
    hole: IntArray
    reals: Array

    @classmethod
    def of(cls, rows: Array, clamps: Clamps) -> ChosenPairs:
        """Those of (N, 10) rows."""
        whole = rows[:, [SEAT, KIND, CLAMPS, CLAMPS + 1, HOLES, HOLES + 1]].astype(np.int64)
        clamp, bolted = whole[:, 2:4], whole[:, 4:6]
        return cls(
            rows,
            seat=whole[:, 0],
            kind=whole[:, 1],
            clamp=clamp,
            direction=clamps.integers[clamp, DIRECTION],
            line=clamps.integers[clamp, LINE],
            hole=clamps.holes[bolted, :2].astype(np.int64),
            reals=clamps.reals[clamp],
        )

    @property
    def upright(self) -> NDArray[np.bool_]:
        """Which clamps (N, 2) push along columns."""
        return np.asarray(self.direction >= NAMES.index("-y"))

    def in_holes(
        self, column: IntArray, row: IntArray, plate: Carrier, shift: Array, **placed: NDArray[Any]
    ) -> FixtureTable:
        """The pairs as fixtures.

        Parameters
        ----------
        column, row : (N, 5) in which pegs stand on the plate.
        shift : (N, 2) from where places of tips count to the plate's origin, in mm.
        placed : the other columns that tell of the pose.
        """
        tip = self.reals[..., TIP : TIP + 2] + shift[:, None]
        at = np.stack([column[:, 3:], row[:, 3:]], axis=2) * np.array(plate.pitch) + np.array(plate.offset)
        push = self.reals[..., PUSH]
        force = np.zeros((len(self.rows), 5, 2))
        force[:, :3] = np.swapaxes(self.reals[..., TAKEN : TAKEN + 3] / push[..., None], 1, 2)
        force[:, 3, 0], force[:, 4, 1] = 1.0 / push[:, 0], 1.0 / push[:, 1]
        quality = unknown_quality(self.rows[:, MARGIN])
        quality[:, CLAMP_FREEDOM] = self.rows[:, FREEDOM]
        return FixtureTable(
            arrangement=self.kind.astype(np.int8),
            column=column.astype(np.int32),
            row=row.astype(np.int32),
            jaw_separation=((tip - at) * ALONG[self.direction]).sum(axis=2),
            force=force,
            quality=quality,
            pairs=self.rows[:, COUNT].astype(np.int32),
            **placed,
        )


@define(eq=False)
class PairedFixtures:
    """The fixtures with two clamps found so far, or the best of them.

    Parameters
    ----------
    query : what is asked, in a toolkit with two clamps.
    problem : the search of one of its directions, for what all have in common.
    """

    query: Query
    problem: Problem
    toolkit: Plate = field(init=False)
    hardware: Hardware = field(init=False)
    touched: Touched = field(init=False)
    rotations: tuple[Rotation, ...] = field(init=False)
    tables: list[FixtureTable] = field(init=False)
    seats_looked_at: int = field(default=0, init=False)
    pairs: int = field(default=0, init=False)
    seats: int = field(default=0, init=False)
    found: IntArray = field(init=False)
    keys: list[tuple[IntArray, Array]] = field(factory=list, init=False)
    undecided: list[Undecided] = field(factory=list, init=False)

    def __attrs_post_init__(self) -> None:
        toolkit = self.query.toolkit
        assert isinstance(toolkit, Plate)
        part = self.query.workpiece
        self.toolkit, self.tables = toolkit, [FixtureTable.empty(toolkit)]
        kinds = np.full((len(NAMES), len(NAMES)), -1, np.int64)
        for number, pair in enumerate(toolkit.distinct_pairs):
            kinds[NAMES.index(pair[0]), NAMES.index(pair[1])] = number
        columns, rows = (inf if count is None else count - 1.0 for count in (toolkit.columns, toolkit.rows))
        self.hardware = Hardware(kinds, 2 * toolkit.clamp_radius, columns, rows, toolkit.travel is not None)
        self.touched = Touched.of(part, toolkit, length=self.problem.wrench_length)
        self.rotations = rotations_of(part)
        self.found = np.zeros(len(toolkit.arrangements), np.int64)

    def __len__(self) -> int:
        return int(self.found.sum())

    def add(self, seats: Any) -> None:
        """Pair the clamps of further seats, such as :class:`listing.seats.Seats`."""
        self.seats_looked_at += len(seats)
        every, half = self.query.listing == "all", self.first_half(seats)
        rows = pairs_of(seats.spans, half, seats.clamps, self.hardware, every)
        if (rows[:, OPEN] != 0.0).any():
            seats = self.sharpened(seats, rows[rows[:, OPEN] != 0.0])
            rows = pairs_of(seats.spans, half, seats.clamps, self.hardware, every)
        is_open = rows[:, OPEN] != 0.0
        self.undecided += self.named(self.written_out(rows[is_open], seats))
        rows = rows[~is_open]
        table = self.written_out(rows, seats)
        self.pairs += int(rows[:, COUNT].sum())
        self.seats += len(np.unique(rows[:, SEAT] * len(self.found) + rows[:, KIND]))
        self.found += np.bincount(table.arrangement, minlength=len(self.found))
        if len(self.rotations) > 1:
            self.keys.append(self.smallest(table))
        self.keep(self.measured(table))

    def first_half(self, seats: Seats) -> IntArray:
        """1 for seats (S,) in the first half turn, else 0: of opposite directions half a turn makes one fixture another."""
        return (seats.theta < pi - SAME_POSE).astype(np.int64)

    def sharpened(self, seats: Seats, rows: Array) -> Seats:
        """Seats whose clamps of some pairs (N, 10) have their reactions to the last digit."""
        from workhold.proof.clamp_reactions import sharp_reactions

        reals = seats.clamps.reals.copy()
        with BALLS:
            for seat, clamp in sorted({(int(row[SEAT]), int(row[CLAMPS + k])) for row in rows for k in range(2)}):
                sharp = sharp_reactions(self.box(seats, seat, clamp), self.problem.limits)
                if sharp is not None:
                    reals[clamp, TAKEN : TAKEN + 3], reals[clamp, DOUBT] = sharp.taken, sharp.doubt
        return evolve(seats, clamps=seats.clamps._replace(reals=reals))

    def box(self, seats: Seats, seat: int, clamp: int) -> CandidateBox:
        """A seat and one of its clamps as contacts in the frame in which the clamp's travel is counted along x."""
        pitch, integers = np.array(self.toolkit.pitch), seats.clamps.integers[clamp]
        carrier = self.toolkit.carrier(f"clamp {NAMES[integers[DIRECTION]]}")
        assert carrier.travel is not None
        cosine, sine = carrier.travel.unit
        turn = np.array([[cosine, sine], [-sine, cosine]])
        holes = np.stack([seats.column[seat], seats.row[seat]], axis=1) * pitch
        places, tip = (holes - holes[0]) @ turn.T, turn @ (seats.clamps.reals[clamp, TIP : TIP + 2] - holes[0])
        x, y = seats.point[seat, 0].tolist()
        features = [*seats.feature[seat], seats.clamp_feature[clamp]]
        offsets = [*map(tuple, places.tolist()), (0.0, line_of(integers, holes[0], pitch, turn))]
        middle = carrier.travel.direction - float(seats.theta[seat]), x, y, float(tip[0])
        return box_beside(features, offsets, middle, self.problem)

    def written_out(self, rows: Array, seats: Seats) -> FixtureTable:
        """Pairs (N, 10) in holes of the plate; of their quality closure margin and clamp freedom are known."""
        pairs, pitch = ChosenPairs.of(rows, seats.clamps), np.array(self.toolkit.pitch)
        seat, upright, in_hole = pairs.seat, pairs.upright, self.toolkit.travel is not None
        column = np.where(upright, pairs.line, pairs.hole[..., 0] if in_hole else FAR)
        row = np.where(upright, pairs.hole[..., 1] if in_hole else FAR, pairs.line)
        column, row = np.hstack([seats.column[seat], column]), np.hstack([seats.row[seat], row])
        lowest = np.stack([column.min(axis=1, initial=FAR), row.min(axis=1, initial=FAR)], axis=1)
        column, row = column - lowest[:, :1], row - lowest[:, 1:]
        if not in_hole:
            column[:, 3:], row[:, 3:] = np.where(upright, column[:, 3:], 0), np.where(upright, 0, row[:, 3:])
        theta = seats.theta[seat]
        x, y = (seats.point[seat, 0] + np.array(self.problem.workpiece.center)).T
        features = np.hstack([seats.feature[seat], seats.clamp_feature[pairs.clamp]])
        return pairs.in_holes(
            column,
            row,
            self.toolkit.carriers[0],
            -lowest * pitch,
            face=self.problem.faces[features].astype(np.int32),
            theta=theta,
            position=np.stack([column[:, 0], row[:, 0]], axis=1) * pitch - np.stack(rotated(x, y, theta), axis=1),
        )

    def measured(self, table: FixtureTable) -> FixtureTable:
        """A table with all its figures of quality."""
        query = self.query
        asked = query.tolerance, query.loads
        quality = quality_of(
            table, query.workpiece, self.toolkit, *asked, touched=self.touched, jaw_force=query.jaw_force
        )
        quality[:, [CLOSURE_MARGIN, CLAMP_FREEDOM]] = table.quality[:, [CLOSURE_MARGIN, CLAMP_FREEDOM]]
        return evolve(table, quality=quality)

    def keep(self, table: FixtureTable) -> None:
        """Take measured fixtures; where only the best are asked for, those that may be among them."""
        self.tables.append(table)
        most, query = self.query.best, self.query
        if most is not None:
            together = self.together()
            chosen = best_marked(together.quality, query.ranking, query.tolerance, most, ties=True)
            self.tables = [together.take(chosen)]

    def together(self) -> FixtureTable:
        """What is kept, in the order of identities."""
        everything = FixtureTable.joined(self.tables)
        self.tables = [everything.take(identity_order(everything))]
        return self.tables[0]

    def so_far(self) -> Result:
        """A result, marked incomplete, of what is kept."""
        return self.result(Account(0, 0, 0, 0, ()), Work(False, {}))

    def result(self, account: Account, work: Work) -> Result:
        """The result of all."""
        query = self.query
        table = self.together()
        order = rank(table.quality, query.ranking, query.tolerance)[: query.best]
        names = [one.name for one in self.toolkit.arrangements]
        account = evolve(account, undecided=(*account.undecided, *self.undecided))
        notes = [undecided_note(len(account.undecided))] if account.undecided else []
        return Result(
            query=query,
            table=table.take(order),
            found=dict(zip(dict.fromkeys(names), [int(self.found.sum())], strict=True)),
            distinct=dict(zip(dict.fromkeys(names), [self.distinct()], strict=True)),
            complete=work.complete,
            notes=tuple(notes),
            statistics=work.statistics,
            proof=proof_of(account, work),
            pairs=self.pairs,
            seats=self.seats,
        )

    def named(self, table: FixtureTable) -> list[Undecided]:
        """Pairs of which it is not decided whether they close, for the account."""
        degrees = (np.degrees(table.theta) % 360.0).tolist()
        return [
            Undecided(
                self.toolkit.arrangements[kind].title, tuple(face), tuple(column), tuple(row), angle, AT_AN_EDGE, 0.0
            )
            for kind, face, column, row, angle in zip(
                table.arrangement.tolist(),
                table.face.tolist(),
                table.column.tolist(),
                table.row.tolist(),
                degrees,
                strict=True,
            )
        ]

    def smallest(self, table: FixtureTable) -> tuple[IntArray, Array]:
        """Of each fixture the first of the forms that the part's rotations give it: whole numbers (N, K), and orientations
        and places (N, P)."""
        every = self.query.listing == "all"
        return smallest_images(table, self.toolkit, self.query.workpiece, self.rotations, every)

    def distinct(self) -> int:
        """How many sets all fixtures form when those that a rotation of the part carries into each other count once."""
        if not self.keys:
            return len(self)
        key, pose = (np.concatenate(values) for values in zip(*self.keys, strict=True))
        return len(one_of_each_set(packed((key, int(key.max(initial=0)))), pose))


def line_of(integers: IntArray, first: Array, pitch: Array, turn: Array) -> float:
    """The height in mm of a clamp's line above the first locator (2,), in the frame that ``turn`` (2, 2) leads to."""
    upright = integers[DIRECTION] >= NAMES.index("-y")
    away = integers[LINE] * pitch[0 if upright else 1] - first[0 if upright else 1]
    return float(turn[1] @ ((away, 0.0) if upright else (0.0, away)))
