"""Fixtures as arrays, and the :class:`Fixture` objects made of their rows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from attrs import define, evolve, field, fields
from numpy.typing import NDArray

from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.geometry.segment import Line
from workhold.model.clamps import compute_force_ratios, compute_working_forces
from workhold.model.fixture import ClampPair, Fixture, ListPlace, Peg
from workhold.model.pose import ENDS, Pose
from workhold.model.quality import BEFORE_PINS, CLOSURE_MARGIN, TILT, WARNINGS, list_known_figures
from workhold.model.wall_ends import find_wall_ends
from workhold.model.workpiece import Workpiece

__all__ = [
    "BLOCK",
    "FixtureTable",
    "make_fixture_of_row",
    "make_fixtures",
    "list_flat_angles",
    "compute_peg_places",
    "make_flat_jaw_table",
    "make_unknown_quality",
]

# Fixtures looked at together when all are gone through.
BLOCK = 4096


@define(frozen=True, eq=False)
class FixtureTable:
    """N fixtures as arrays; in every row pegs stand in the order of the arrangement.

    The arrays of a large result file are read in parts, on access: use ``take`` to go through them. Tables
    are equal if they have the same fixtures in the same order.

    Parameters
    ----------
    arrangement : (N,) int8, index into the toolkit's arrangements.
    column, row : (N, P) int32, the peg's hole, counted from 0; P is 4, and 5 with two clamps.
    face : (N, P) int32, number of the face touched.
    theta : (N,) orientation of the workpiece in radians, in [0, 2 pi).
    position : (N, 2) translation of the pose in mm.
    jaw_separation : (N,) in mm; with two clamps (N, 2), the travel of each clamp.
    force : (N, P) contact force per unit of clamping force; with two clamps (N, P, 2), per unit of each
        clamp's force.
    quality : (N, Q) figures of quality in the order of ``model.quality.FIGURES``, NaN where unknown; with a
        program, one more column has the program clearance.
    pairs : (N,) int32, number of pairs of clamps with the locators, pose and directions that the row stands
        for; 1 where each pair is listed.
    """

    arrangement: NDArray[np.int8]
    column: NDArray[np.int32]
    row: NDArray[np.int32]
    face: NDArray[np.int32]
    theta: NDArray[np.float64]
    position: NDArray[np.float64]
    jaw_separation: NDArray[np.float64]
    force: NDArray[np.float64]
    quality: NDArray[np.float64]
    pairs: NDArray[np.int32] = field()

    @pairs.default
    def count_each_once(self) -> NDArray[np.int32]:
        """Return ones (N,), the default of :attr:`pairs`."""
        return np.ones(len(self.arrangement), np.int32)

    def __attrs_post_init__(self) -> None:
        for column in self.columns:
            column.setflags(write=False)

    def __reduce__(self) -> tuple[Any, ...]:
        # So that the arrays are read-only again on the other side.
        return FixtureTable, self.columns

    def __len__(self) -> int:
        return len(self.arrangement)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, FixtureTable):
            return NotImplemented
        return len(self) == len(other) and all(
            np.array_equal(mine, theirs, equal_nan=True)
            for block in (slice(start, start + BLOCK) for start in range(0, len(self), BLOCK))
            for mine, theirs in zip(self.take(block).columns, other.take(block).columns, strict=True)
        )

    def __hash__(self) -> int:
        return hash(len(self))

    @property
    def columns(self) -> tuple[NDArray[Any], ...]:
        """All arrays, in the order of the parameters."""
        return tuple(getattr(self, column.name) for column in fields(FixtureTable))

    @property
    def contact_force_ratios(self) -> NDArray[np.float64]:
        """Contact forces (N, P) per unit of clamping force;
        for two clamps, per unit of the sum of both at the working ratio.
        """
        return self.force if self.force.ndim == 2 else compute_working_forces(self.force)

    @property
    def null_vector(self) -> NDArray[np.float64]:
        """Positive null vectors (N, P) of the contact wrenches,
        scaled to sum 1: the contact forces over their sum.

        The forces of two clamps are taken at their working ratio.
        """
        forces = self.contact_force_ratios
        return np.asarray(forces / forces.sum(axis=1, keepdims=True))

    def take(self, order: NDArray[Any] | slice) -> FixtureTable:
        """Return the table of the rows that an index array, a mask or a slice selects, in that order."""
        return FixtureTable(*(column[order] for column in self.columns))

    def count_in_same_holes(self, index: int) -> int:
        """Return the number of other rows with the arrangement and the holes of row ``index``; 0 for fixtures
        without pegs.
        """
        if self.column.shape[1] == 0:
            return 0
        same = self.arrangement == self.arrangement[index]
        for holes in (self.column, self.row):
            same &= (holes == holes[index]).all(axis=1)
        return int(same.sum()) - 1

    @classmethod
    def concatenate(cls, tables: Sequence[FixtureTable]) -> FixtureTable:
        """Return the rows of one or more tables as one table; figures that a table lacks become NaN."""
        most = max(table.quality.shape[1] for table in tables)
        return cls(
            *map(
                np.concatenate,
                zip(*(table.with_figure_columns(most).columns for table in tables), strict=True),
            )
        )

    def with_figure_columns(self, columns: int) -> FixtureTable:
        """Return a table whose ``quality`` has at least ``columns`` columns, new ones filled with NaN.

        A table that has as many is returned itself.
        """
        missing = columns - self.quality.shape[1]
        if missing <= 0:
            return self
        return evolve(self, quality=np.pad(self.quality, ((0, 0), (0, missing)), constant_values=np.nan))

    @classmethod
    def make_empty(cls, toolkit: Toolkit | None = None) -> FixtureTable:
        """Return a table without rows, for a toolkit's numbers of pegs and of travels; for None, four pegs
        and one travel.
        """
        count, travels = (4, 1) if toolkit is None else (toolkit.peg_count, toolkit.travel_count)
        several = (travels,) if travels > 1 else ()
        ints, floats = np.zeros((0, count), np.int32), np.zeros((0, count, *several))
        return cls(
            arrangement=np.zeros(0, np.int8),
            column=ints,
            row=ints.copy(),
            face=ints.copy(),
            theta=np.zeros(0),
            position=np.zeros((0, 2)),
            jaw_separation=np.zeros((0, *several)),
            force=floats,
            quality=make_unknown_quality(np.zeros(0)),
        )


def make_unknown_quality(closure_margin: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``quality`` (N, Q) with the given closure margins (N,) and with NaN in all other columns."""
    quality = np.full((len(closure_margin), BEFORE_PINS), np.nan)
    quality[:, CLOSURE_MARGIN] = closure_margin
    return quality


def make_flat_jaw_table(
    theta: Sequence[float],
    position: Sequence[tuple[float, float]],
    opening: Sequence[float],
    warnings: Sequence[int],
) -> FixtureTable:
    """Return a table of fixtures between two flat jaws, which have no pegs (P = 0).

    ``theta`` is in radians, ``position`` and ``opening`` are in mm, ``warnings`` are counts; each has N
    entries.
    """
    count = len(theta)
    nothing = np.zeros((count, 0), np.int32)
    quality = make_unknown_quality(np.full(count, np.nan))
    quality[:, TILT] = 0.0
    quality[:, WARNINGS] = warnings
    return FixtureTable(
        arrangement=np.zeros(count, np.int8),
        column=nothing,
        row=nothing.copy(),
        face=nothing.copy(),
        theta=np.array(theta, np.float64),
        position=np.array(position, np.float64).reshape(-1, 2),
        jaw_separation=np.array(opening, np.float64),
        force=np.zeros((count, 0)),
        quality=quality,
    )


def convert_to_whole_turn_degrees(theta: float) -> float:
    """Return an angle in radians as degrees in [0, 360); a result less than 1e-10 degrees below 360 becomes
    0.
    """
    degrees = float(np.degrees(theta)) % 360.0
    return 0.0 if degrees > 360.0 - 1e-10 else degrees


def compute_peg_places(
    table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return x and y, each (N, P) in mm, of all pegs of a table, in the toolkit's frame.

    An entry for the end of a wall's contact has the point where the workpiece touches the wall, at y = 0.
    """
    x, y = toolkit.compute_hole_places(table.arrangement, table.column, table.row, table.jaw_separation)
    for ends in toolkit.ends_on_walls:
        x[:, ends] = find_wall_ends(workpiece, toolkit, table.theta, table.position).x
        y[:, ends] = 0.0
    return x, y


def list_flat_angles(table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> list[list[float | None]]:
    """Return, for each row and peg, the direction that the peg's flat faces.

    It is in degrees counter-clockwise from the toolkit's x axis; None for a peg that touches with its round
    side.
    """
    if not toolkit.has_flats:
        return [[None] * table.face.shape[1] for _ in range(len(table))]
    straight = {
        face.number: np.degrees(np.arctan2(*face.segment.compute_normal()[::-1])) + 180.0
        for face in workpiece.numbered.faces
        if isinstance(face.segment, Line)
    }
    flatted = [[toolkit.carriers[k].flat is not None for k in one.carriers] for one in toolkit.arrangements]
    return [
        [
            round((straight[face] + turn) % 360.0, 9) % 360.0 if has_flat and face in straight else None
            for has_flat, face in zip(flatted[kind], faces, strict=True)
        ]
        for kind, faces, turn in zip(
            table.arrangement.tolist(), table.face.tolist(), np.degrees(table.theta).tolist(), strict=True
        )
    ]


def make_fixture_of_row(
    table: FixtureTable, toolkit: Toolkit, index: int, workpiece: Workpiece, listed: ListPlace | None = None
) -> Fixture:
    """Return the :class:`Fixture` of the row ``index`` of a table;
    ``listed`` becomes its place in a result.
    """
    return next(make_fixtures(table.take(slice(index, index + 1)), toolkit, workpiece, [listed]))


def make_fixtures(
    table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece, listed: Iterable[ListPlace | None]
) -> Iterator[Fixture]:
    """Yield the fixtures of the table's first rows in order, one for each entry of ``listed``.

    ``listed[n]`` becomes the place of row n in a result, or None. The table has at least one row, and at
    least as many as ``listed`` has entries. Arrays are converted once for all rows.
    """
    across, along = (places.tolist() for places in compute_peg_places(table, toolkit, workpiece))
    columns, rows, faces = table.column.tolist(), table.row.tolist(), table.face.tolist()
    forces, flats = table.contact_force_ratios.tolist(), list_flat_angles(table, toolkit, workpiece)
    theta, travels = table.theta.tolist(), table.jaw_separation.reshape(len(table), -1).tolist()
    pairs = list_clamp_pairs(table) if table.force.ndim == 3 else [None] * len(table)
    on_wall = (
        find_wall_ends(workpiece, toolkit, table.theta, table.position) if toolkit.ends_on_walls else None
    )
    for n, where in enumerate(listed):
        arrangement = toolkit.arrangements[table.arrangement[n]]
        pegs = []
        for k, number in enumerate(arrangement.carriers):
            carrier, column, row = toolkit.carriers[number], columns[n][k], rows[n][k]
            place, beside = None if carrier.has_lattice else carrier.name_place(column, row), None
            if on_wall is not None and carrier.contact is WALL_END:
                end = k - arrangement.carriers.index(number)
                place, touched = f"{carrier.noun} {ENDS[end]}", on_wall.list_touching_faces(n)[end]
                beside = touched[1] if len(touched) > 1 else None
            at = across[n][k], along[n][k]
            pegs.append(
                Peg(carrier.name, column, row, *at, faces[n][k], forces[n][k], place, beside, flats[n][k])
            )
        yield Fixture(
            type=arrangement.name,
            pegs=tuple(pegs),
            pose=Pose(convert_to_whole_turn_degrees(theta[n]), *table.position[n].tolist()),
            travel=travels[n][0],
            quality=list_known_figures(table.quality[n].tolist()),
            direction=arrangement.direction,
            pair=pairs[n],
            listed=where,
        )


def list_clamp_pairs(table: FixtureTable) -> list[ClampPair]:
    """Return the :class:`ClampPair` of each row of a table whose ``force`` is (N, P, 2)."""
    ends, travels = (
        zip(*(one.tolist() for one in compute_force_ratios(table.force)), strict=True),
        table.jaw_separation,
    )
    reactions = (tuple((a, b) for a, b in pegs) for pegs in table.force.tolist())
    return [
        ClampPair((first, second), interval, given, count)
        for (first, second), interval, given, count in zip(
            travels.tolist(), ends, reactions, table.pairs.tolist(), strict=True
        )
    ]
