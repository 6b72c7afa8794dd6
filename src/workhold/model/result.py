"""The outcome of a design: all fixtures as arrays, with :class:`Fixture` objects made on demand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, overload

import numpy as np
from attrs import astuple, define, evolve, field
from numpy.typing import NDArray

from workhold.model.fixture import Fixture, Peg, Pose
from workhold.model.proof import Proof
from workhold.model.quality import CLOSURE_MARGIN, FIGURES
from workhold.model.query import Query
from workhold.model.toolkit import Toolkit
from workhold.model.vise import Vise
from workhold.model.workpiece import Workpiece

__all__ = ["FixtureTable", "Result", "fixture_at", "unknown_quality"]


@define(frozen=True, eq=False)
class FixtureTable:
    """N fixtures as arrays; pegs stand in every row in the order of their arrangement.

    Parameters
    ----------
    arrangement : (N,) int8, index into the toolkit's arrangements.
    column, row : (N, 4) int32, the hole.
    face : (N, 4) int32, number of the face touched.
    theta : (N,) orientation of the workpiece in radians, in [0, 2 pi).
    position : (N, 2) translation of the pose in mm.
    jaw_separation : (N,) in mm.
    null_vector : (N, 4) the positive null vector of the wrenches, scaled to sum 1.
    force : (N, 4) contact force per unit of clamping force.
    quality : (N, 6) figures of quality in the order of ``model.quality.FIGURES``, NaN where one is not known.
    """

    arrangement: NDArray[np.int8]
    column: NDArray[np.int32]
    row: NDArray[np.int32]
    face: NDArray[np.int32]
    theta: NDArray[np.float64]
    position: NDArray[np.float64]
    jaw_separation: NDArray[np.float64]
    null_vector: NDArray[np.float64]
    force: NDArray[np.float64]
    quality: NDArray[np.float64]

    def __attrs_post_init__(self) -> None:
        for name in self.__attrs_attrs__:
            getattr(self, name.name).setflags(write=False)

    def __reduce__(self) -> tuple[Any, ...]:
        # So that the arrays are read-only again on the other side.
        return FixtureTable, astuple(self, recurse=False)

    def __len__(self) -> int:
        return len(self.arrangement)

    def take(self, order: NDArray[Any] | slice) -> FixtureTable:
        """The fixtures of an index array or slice, in its order."""
        return evolve(self, **{a.name: getattr(self, a.name)[order] for a in self.__attrs_attrs__})

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
            null_vector=floats,
            force=floats.copy(),
            quality=unknown_quality(floats),
        )


def unknown_quality(null_vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Figures of quality (N, 6) of which only the closure margin is known, from null vectors (N, 4) of sum 1."""
    quality = np.full((len(null_vector), len(FIGURES)), np.nan)
    quality[:, CLOSURE_MARGIN] = null_vector.min(axis=1, initial=1.0)
    return quality


@define(frozen=True, eq=False)
class Result:
    """All fixtures that a query asks for, best first, or the best of them.

    A result is a sequence: ``len(result)``, ``result[0]``, ``for fixture in result``. ``Fixture`` objects are made when
    asked for; the arrays behind them are in ``table``.

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
    found: Mapping[str, int]
    distinct: Mapping[str, int]
    complete: bool = True
    notes: tuple[str, ...] = ()
    statistics: Mapping[str, int] = field(factory=dict)
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
    def vise(self) -> Vise:
        """The toolkit, which is a vise."""
        assert isinstance(self.query.toolkit, Vise)
        return self.query.toolkit

    @property
    def counts(self) -> dict[str, int]:
        """How many fixtures of each arrangement are listed."""
        return self.toolkit.arrangements_counted(self.table.arrangement)

    def __len__(self) -> int:
        return len(self.table)

    def __iter__(self) -> Iterator[Fixture]:
        for index in range(len(self)):
            yield self[index]

    @overload
    def __getitem__(self, index: int) -> Fixture: ...

    @overload
    def __getitem__(self, index: slice) -> list[Fixture]: ...

    def __getitem__(self, index: int | slice) -> Fixture | list[Fixture]:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"fixture {index} of {len(self)}")
        return fixture_at(self.table, self.toolkit, index)


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
        pegs.append(Peg(carrier.name, column, row, x, y, int(table.face[index, k]), float(table.force[index, k])))
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
    )
