"""The outcome of a design: all fixtures as arrays, with :class:`Fixture` objects made on demand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, overload

import numpy as np
from attrs import define, field, fields
from numpy.typing import NDArray

from workhold.model.fixture import Fixture, Peg, Pose
from workhold.model.proof import Proof
from workhold.model.quality import CLOSURE_MARGIN, FIGURES
from workhold.model.query import Query
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece

__all__ = ["FixtureTable", "Result", "fixture_at", "unknown_quality"]

# Fixtures looked at together when all are gone through.
BLOCK = 4096


@define(frozen=True, eq=False)
class FixtureTable:
    """N fixtures as arrays; pegs stand in every row in the order of their arrangement.

    Of a large result file the arrays are parts, read only where they are looked at: go through them by ``take``. Tables of
    the same fixtures in the same order are equal.

    Parameters
    ----------
    arrangement : (N,) int8, index into the toolkit's arrangements.
    column, row : (N, 4) int32, the hole.
    face : (N, 4) int32, number of the face touched.
    theta : (N,) orientation of the workpiece in radians, in [0, 2 pi).
    position : (N, 2) translation of the pose in mm.
    jaw_separation : (N,) in mm.
    force : (N, 4) contact force per unit of clamping force.
    quality : (N, 12) figures of quality in the order of ``model.quality.FIGURES``, NaN where one is not known.
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
        """All the arrays, in the order above."""
        return tuple(getattr(self, column.name) for column in fields(FixtureTable))

    @property
    def null_vector(self) -> NDArray[np.float64]:
        """The positive null vectors (N, 4) of the wrenches, scaled to sum 1; forces are proportional to them."""
        return np.asarray(self.force / self.force.sum(axis=1, keepdims=True))

    def take(self, order: NDArray[Any] | slice) -> FixtureTable:
        """The fixtures of an index array or slice, in its order."""
        return FixtureTable(*(column[order] for column in self.columns))

    @classmethod
    def joined(cls, tables: Sequence[FixtureTable]) -> FixtureTable:
        """Several tables, at least one, as one."""
        return cls(*map(np.concatenate, zip(*(table.columns for table in tables), strict=True)))

    @classmethod
    def empty(cls) -> FixtureTable:
        """A table of no fixtures."""
        ints, floats = np.zeros((0, 4), np.int32), np.zeros((0, 4))
        return cls(
            arrangement=np.zeros(0, np.int8),
            column=ints,
            row=ints.copy(),
            face=ints.copy(),
            theta=np.zeros(0),
            position=np.zeros((0, 2)),
            jaw_separation=np.zeros(0),
            force=floats,
            quality=unknown_quality(floats),
        )


def unknown_quality(null_vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Figures of quality (N, 12) of which only the closure margin is known, from null vectors (N, 4) of sum 1."""
    quality = np.full((len(null_vector), len(FIGURES)), np.nan)
    quality[:, CLOSURE_MARGIN] = null_vector.min(axis=1, initial=1.0)
    return quality


@define(frozen=True)
class Result:
    """All fixtures that a query asks for, best first, or the best of them.

    A result is a sequence: ``len(result)``, ``result[0]``, ``for fixture in result``. ``Fixture`` objects are made when
    asked for; the arrays behind them are in ``table``. Results that say the same are equal.

    Parameters
    ----------
    query : what was asked.
    table : the fixtures listed, ranked.
    found : how many fixtures of each arrangement were found, by its name; more than are listed when an engine found all
        and only the best were kept.
    distinct : how many sets they form when fixtures that a rotation of the part onto itself carries into each other
        count once.
    complete : False when the search was interrupted; the fixtures listed are valid all the same.
    notes : remarks a user should read, one sentence each.
    statistics : how much work the search was: numbers of contact features, chord curves, sliding pairs, pairs of curves
        compared, pairs whose crossings were sought, and simultaneous contacts examined (all four inside their features).
    proof : the account of the search, see :class:`workhold.model.proof.Proof`; None for a result that came without.
    """

    query: Query
    table: FixtureTable
    found: Mapping[str, int] = field(hash=False)
    distinct: Mapping[str, int] = field(hash=False)
    complete: bool = True
    notes: tuple[str, ...] = ()
    statistics: Mapping[str, int] = field(factory=dict, hash=False)
    proof: Proof | None = None

    @property
    def workpiece(self) -> Workpiece:
        """What is held."""
        return self.query.workpiece

    @property
    def toolkit(self) -> Toolkit:
        """What it is held in."""
        return self.query.toolkit

    @property
    def counts(self) -> dict[str, int]:
        """How many fixtures of each arrangement are listed."""
        return self.toolkit.arrangements_counted(self.table.arrangement)

    def __len__(self) -> int:
        return len(self.table)

    def __iter__(self) -> Iterator[Fixture]:
        for start in range(0, len(self), BLOCK):
            block = self.table.take(slice(start, start + BLOCK))
            yield from (fixture_at(block, self.toolkit, index) for index in range(len(block)))

    @overload
    def __getitem__(self, index: int) -> Fixture: ...

    @overload
    def __getitem__(self, index: slice) -> list[Fixture]: ...

    def __getitem__(self, index: int | slice) -> Fixture | list[Fixture]:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"fixture {index} of {len(self)}")
        index %= len(self)
        return fixture_at(self.table.take(slice(index, index + 1)), self.toolkit, 0)


def whole_turn_degrees(theta: float) -> float:
    """An angle in radians as degrees in [0, 360); what is within 1e-10 degrees below a whole turn is 0."""
    degrees = float(np.degrees(theta)) % 360.0
    return 0.0 if degrees > 360.0 - 1e-10 else degrees


def fixture_at(table: FixtureTable, toolkit: Toolkit, index: int) -> Fixture:
    """Make the :class:`Fixture` of one row of a table."""
    separation = float(table.jaw_separation[index])
    arrangement, carriers = toolkit.arrangements[table.arrangement[index]], toolkit.carriers
    pegs = []
    for k, number in enumerate(arrangement.carriers):
        carrier, column, row = carriers[number], int(table.column[index, k]), int(table.row[index, k])
        x, y = carrier.place(column, row, separation)
        place = None if carrier.on is None else carrier.place_name(column, row)
        pegs.append(
            Peg(carrier.name, column, row, x, y, int(table.face[index, k]), float(table.force[index, k]), place)
        )
    x, y = (float(v) for v in table.position[index])
    return Fixture(
        type=arrangement.name,
        pegs=tuple(pegs),
        pose=Pose(whole_turn_degrees(float(table.theta[index])), x, y),
        jaw_separation=separation,
        quality={
            figure.key: float(value)
            for figure, value in zip(FIGURES, table.quality[index], strict=True)
            if not np.isnan(value)
        },
        direction=arrangement.direction,
    )
