"""Toolkits: what holds the pegs, where they may stand, what moves, and when that clamps.

A toolkit is data plus the freedom it has. Everything that seeks, proves, lists, draws and writes fixtures asks a toolkit
for the data below and knows no vise; a further toolkit is a small module that fills them in, such as ``model.vise``.

Glossary
--------
carrier : what pegs stand on, a lattice of holes; it stands still or slides along a line. A vise's jaws are two carriers.
travel : how far a carrier has slid along its direction, in mm; of a vise the jaw separation.
arrangement : how many pegs stand on each carrier. The paper's Type I is two and two, its Type II three and one.
gap rule : the smallest distance along the direction of travel from a peg of the carrier that stands still to one of the
    carrier that moves.
"""

from __future__ import annotations

from math import cos, sin
from typing import Any, ClassVar

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from workhold.model.holes import Holes

__all__ = ["Arrangement", "Carrier", "Symmetry", "Toolkit", "Travel"]


@frozen
class Travel:
    """The freedom of a carrier that slides along a line.

    Parameters
    ----------
    direction : angle in radians of the line along which travel is counted, from the x axis.
    least, most : smallest and largest travel in mm; None for no largest.
    """

    direction: float
    least: float
    most: float | None

    @property
    def unit(self) -> tuple[float, float]:
        """The unit vector of the direction; exact along the axes."""
        return round(cos(self.direction), 15), round(sin(self.direction), 15)


@frozen
class Carrier:
    """A lattice of holes for pegs.

    Parameters
    ----------
    name : such as "left"; its first letter names its holes.
    pitch : distance in mm between neighbouring columns and rows.
    columns : of holes.
    rows : of holes, or None for as many as needed.
    peg_radius : of its pegs in mm.
    body_radius : of the thickest part of its pegs in mm, below the workpiece.
    offset : place in mm of the hole in column 0 and row 0 without any travel.
    blocked : holes and columns that no peg can stand in.
    travel : how it slides; None when it stands still.
    noun : what it is, such as "jaw".
    """

    name: str
    pitch: tuple[float, float]
    columns: int
    rows: int | None
    peg_radius: float
    body_radius: float
    offset: tuple[float, float] = (0.0, 0.0)
    blocked: tuple[Holes, ...] = ()
    travel: Travel | None = None
    noun: str = "jaw"

    @property
    def title(self) -> str:
        """What it is called, such as "left jaw"."""
        return f"{self.name} {self.noun}"

    @property
    def letter(self) -> str:
        """What the names of its holes begin with."""
        return self.name[0].upper()

    def is_blocked(self, column: int, row: int) -> bool:
        """Whether no peg can stand in a hole."""
        return not {Holes(self.name, column), Holes(self.name, column, row)}.isdisjoint(self.blocked)

    def place(self, column: Any, row: Any, travelled: Any = 0.0) -> tuple[Any, Any]:
        """Centre of a hole in mm, or of many: numbers or arrays of them.

        Parameters
        ----------
        column, row : of the hole, counted from 0.
        travelled : how far the carrier has slid, in mm; of no account for one that stands still.

        Examples
        --------
        >>> from workhold import Vise
        >>> right = Vise(pitch=10, columns=2, peg_radius=3).carriers[1]
        >>> right.place(1, 2, travelled=14.5)
        (34.5, 20.0)
        """
        x, y = self.offset[0] + column * self.pitch[0], self.offset[1] + row * self.pitch[1]
        if self.travel is None:
            return x, y
        along, across = self.travel.unit
        return x + travelled * along, y + travelled * across


@frozen
class Arrangement:
    """How many pegs stand on each carrier.

    Parameters
    ----------
    name : the paper's, such as "I".
    pegs : for each carrier, those that stand still first.
    """

    name: str
    pegs: tuple[int, ...]

    @property
    def carriers(self) -> tuple[int, ...]:
        """The number of each peg's carrier, in the order in which pegs are listed.

        >>> Arrangement("II", (3, 1)).carriers
        (0, 0, 0, 1)
        """
        return tuple(number for number, count in enumerate(self.pegs) for _ in range(count))


@frozen
class Symmetry:
    """A motion of the plane after which a toolkit is itself again, so that two fixtures are the same.

    Parameters
    ----------
    half_turns : how often everything turns by 180 degrees.
    carriers : for each carrier the number of the one whose place it takes.
    """

    half_turns: int
    carriers: tuple[int, ...]


class Toolkit:
    """What every toolkit tells; ``model.vise.Vise`` is one.

    Attributes
    ----------
    kind : the name of its kind in files.
    arrangements : what may stand on its carriers.
    clamping : 1 when the moving carrier clamps as its travel gets less (a vise that closes), -1 when it clamps as its
        travel gets more.
    symmetries : motions besides the identity that make two fixtures the same.
    carriers : those that stand still first; at most one moves while a pose is sought.
    gap : the gap rule in mm, or None when there is none.
    """

    __slots__ = ()

    kind: ClassVar[str]
    arrangements: ClassVar[tuple[Arrangement, ...]]
    clamping: ClassVar[int]
    symmetries: ClassVar[tuple[Symmetry, ...]]

    @property
    def carriers(self) -> tuple[Carrier, ...]:
        """Those that stand still first."""
        raise NotImplementedError

    @property
    def gap(self) -> float | None:
        """The gap rule in mm."""
        raise NotImplementedError

    @property
    def moving(self) -> Carrier:
        """The carrier that moves."""
        return next(carrier for carrier in self.carriers if carrier.travel is not None)

    @property
    def moving_axis(self) -> tuple[float, float]:
        """The unit vector along which travel is counted."""
        travel = self.moving.travel
        assert travel is not None
        return travel.unit

    def arrangement(self, name: str) -> Arrangement:
        """The arrangement of a name."""
        return next(a for a in self.arrangements if a.name == name)

    def arrangements_counted(self, arrangement: NDArray[Any]) -> dict[str, int]:
        """How many fixtures there are of each arrangement, from the indices (N,) of theirs."""
        counts = np.bincount(arrangement, minlength=len(self.arrangements)).tolist()
        return {one.name: count for one, count in zip(self.arrangements, counts, strict=True)}

    def peg_carriers(self, arrangement: NDArray[Any]) -> NDArray[np.int8]:
        """The carrier (N, K) of each peg of N fixtures, from the indices (N,) of their arrangements."""
        return np.asarray(np.array([one.carriers for one in self.arrangements], np.int8)[arrangement])

    def carrier_names(self, arrangement: Arrangement) -> tuple[str, ...]:
        """The name of each peg's carrier, in the order in which pegs are listed."""
        return tuple(self.carriers[number].name for number in arrangement.carriers)

    def arrangement_numbers(self, standing: NDArray[Any]) -> NDArray[np.int64]:
        """The indices (N,) of the arrangements with so many pegs (N,) on the carrier that stands still."""
        pegs = [one.pegs[0] for one in self.arrangements]
        return np.asarray(np.array([pegs.index(k) if k in pegs else -1 for k in range(max(pegs) + 1)])[standing])

    def places(
        self, arrangement: NDArray[Any], column: NDArray[Any], row: NDArray[Any], travelled: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """x and y (N, K) in mm of the holes of N fixtures; column and row are (N, K), arrangement and travelled (N,)."""
        carrier = self.peg_carriers(arrangement)
        x, y = np.zeros(column.shape), np.zeros(column.shape)
        for number, one in enumerate(self.carriers):
            across, along = one.place(column, row, travelled[:, None])
            x, y = np.where(carrier == number, across, x), np.where(carrier == number, along, y)
        return x, y
