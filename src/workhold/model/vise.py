"""The fixture vise: two jaws with a lattice of peg holes each (paper, sections 1 and 2)."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, isfinite, isnan, nan
from typing import Any, ClassVar

from attrs import evolve, field, frozen
from attrs.converters import optional

from workhold.errors import InputError
from workhold.limits import MOST_BLOCKED, MOST_HOLES, refuse_long
from workhold.model.holes import Holes, holes_named
from workhold.model.real import real
from workhold.model.toolkit import Arrangement, Carrier, Symmetry, Toolkit, Travel

__all__ = ["OpeningVise", "Vise"]


def pair(value: float | Iterable[float]) -> tuple[float, float]:
    """One pitch for both directions, or one for x and one for y."""
    numbers = tuple(value) if isinstance(value, Iterable) else (value, value)
    if len(numbers) != 2:
        raise InputError(f"pitch {value} is not one number or two: give one pitch, or X,Y.")
    return real(numbers[0]), real(numbers[1])


def whole(value: Any) -> Any:
    """A whole number as an int; None and anything else as it is, to be looked at later."""
    return int(value) if isfinite(real(value)) and value == int(value) else value


def optional_length(value: float | None) -> float:
    """A length, or NaN (which the vise resolves) for None."""
    return nan if value is None else inf if isnan(real(value)) else real(value)


def all_holes(holes: Iterable[Holes | str]) -> tuple[Holes, ...]:
    """Holes as a tuple, where they may be given by name."""
    return tuple(holes_named(one) if isinstance(one, str) else one for one in holes)


@frozen
class Vise(Toolkit):
    """Two jaws, the left one fixed, the right one sliding along x, each with a lattice of holes.

    Parameters
    ----------
    pitch : distance between neighbouring columns and rows in mm, one number or (x, y).
    columns : columns of holes on each jaw.
    peg_radius : in mm; 0 is allowed.
    rows : rows of holes on each jaw, or None for as many as needed.
    min_gap : smallest distance in x from the centre of a left peg to the centre of a right one, in mm; None means the
        x pitch.
    max_opening : largest jaw separation in mm, or None for no limit.
    row_offset : height in mm of the right jaw's row 0 above the left jaw's.
    body_radius : radius in mm of the thickest part of a peg, its shoulder, which lies below the workpiece; None means the
        peg radius. Bodies may neither overlap nor stand over a keep-out zone.
    blocked : holes and columns that no peg can stand in, or their names, such as "L-B3" and "R-A".

    Raises
    ------
    InputError
        For values that are not finite and positive, and for pegs too fat for neighbouring holes.

    Examples
    --------
    >>> from workhold import Vise
    >>> Vise(pitch=10, columns=2, peg_radius=3).min_gap
    10.0
    """

    kind: ClassVar[str] = "vise"
    arrangements: ClassVar[tuple[Arrangement, ...]] = (Arrangement("I", (2, 2)), Arrangement("II", (3, 1)))
    clamping: ClassVar[int] = 1
    symmetries: ClassVar[tuple[Symmetry, ...]] = (Symmetry(1, (1, 0)),)

    pitch: tuple[float, float] = field(converter=pair)
    columns: int = field(converter=whole)
    peg_radius: float = field(converter=real)
    rows: int | None = field(default=None, converter=whole)
    min_gap: float = field(default=None, converter=optional_length)
    max_opening: float | None = field(default=None, converter=optional(real))
    row_offset: float = field(default=0.0, converter=real)
    body_radius: float = field(default=None, converter=optional_length)
    blocked: tuple[Holes, ...] = field(default=(), converter=all_holes)

    def __attrs_post_init__(self) -> None:
        if isnan(self.min_gap):
            object.__setattr__(self, "min_gap", self.pitch[0])
        if isnan(self.body_radius):
            object.__setattr__(self, "body_radius", self.peg_radius)
        for name, value in (("pitch", self.pitch[0]), ("pitch", self.pitch[1])):
            if not (isfinite(value) and value > 0):
                raise InputError(f"{name} {value} is not a positive length: give the distance between holes in mm.")
        for name, count in (("columns", self.columns), ("rows", self.rows)):
            if count is not None and (not isinstance(count, int) or count < 1):
                raise InputError(f"{name} {count} is not a positive whole number: a jaw needs at least one.")
        if not (isfinite(self.peg_radius) and self.peg_radius >= 0):
            raise InputError(f"peg radius {self.peg_radius} is not a length: give 0 or more, in mm.")
        if 2 * self.peg_radius > min(self.pitch):
            raise InputError(
                f"pegs of radius {self.peg_radius:g} overlap in neighbouring holes {min(self.pitch):g} apart: "
                "use a smaller peg or a larger pitch."
            )
        if not (isfinite(self.min_gap) and self.min_gap >= 0):
            raise InputError(f"min gap {self.min_gap} is not a length: give 0 or more, in mm.")
        if self.max_opening is not None:
            if not (isfinite(self.max_opening) and self.max_opening > 0):
                raise InputError(f"max opening {self.max_opening} is not a positive length: give it in mm.")
            if self.max_opening < self.min_gap:
                raise InputError(
                    f"max opening {self.max_opening:g} is below the min gap {self.min_gap:g}: no jaw separation is left."
                )
        if not isfinite(self.row_offset):
            raise InputError(f"row offset {self.row_offset} is not a length: give it in mm.")
        if not (isfinite(self.body_radius) and self.body_radius >= self.peg_radius):
            raise InputError(
                f"body radius {self.body_radius:g} is not one of a peg of radius {self.peg_radius:g}: give that or more, "
                "in mm."
            )
        refuse_boundless(self)
        refuse_blocked(self)

    @property
    def carriers(self) -> tuple[Carrier, Carrier]:
        """The left jaw, and the right jaw, whose travel is the jaw separation."""
        left = Carrier(
            "left",
            self.pitch,
            self.columns,
            self.rows,
            self.peg_radius,
            self.body_radius,
            blocked=tuple(holes for holes in self.blocked if holes.jaw == "left"),
        )
        right = evolve(
            left,
            name="right",
            offset=((self.columns - 1) * self.pitch[0], self.row_offset),
            blocked=tuple(holes for holes in self.blocked if holes.jaw == "right"),
            travel=Travel(0.0, self.min_gap, self.max_opening),
        )
        return left, right

    @property
    def gap(self) -> float:
        """The smallest gap in mm."""
        return self.min_gap


@frozen
class OpeningVise(Vise):
    """The vise that clamps by opening: its pegs hold the part from inside its holes, or around a waist.

    Parameters, errors and all rules are those of :class:`Vise`; only the sign of clamping differs.
    """

    kind: ClassVar[str] = "opening-vise"
    clamping: ClassVar[int] = -1


def refuse_boundless(vise: Vise) -> None:
    """Refuse lengths too large to reckon with, and more holes than can be looked through.

    Raises
    ------
    InputError
        Naming the value and the limit.
    """
    lengths = {"pitch": max(vise.pitch), "peg radius": vise.peg_radius, "body radius": vise.body_radius}
    lengths |= {"min gap": vise.min_gap, "max opening": vise.max_opening or 0.0, "row offset": vise.row_offset}
    for name, value in lengths.items():
        refuse_long(name, value)
    holes = vise.columns * (vise.rows or 1)
    if holes > MOST_HOLES:
        raise InputError(
            f"a jaw of {holes:,} holes is beyond the {MOST_HOLES:,} this program takes: give fewer columns or rows, as "
            "many as the part can reach."
        )
    if len(vise.blocked) > MOST_BLOCKED:
        raise InputError(
            f"{len(vise.blocked):,} blocked holes are more than the {MOST_BLOCKED:,} this program takes: block whole "
            "columns, such as L-B."
        )


def refuse_blocked(vise: Vise) -> None:
    """Refuse blocked holes that the vise does not have, and a jaw without a free hole.

    Raises
    ------
    InputError
        Naming the hole or the jaw.
    """
    for holes in vise.blocked:
        if holes.column >= vise.columns:
            raise InputError(f"hole {holes.name} is blocked, but each jaw has only {vise.columns} columns.")
        if vise.rows is not None and holes.row is not None and holes.row >= vise.rows:
            raise InputError(f"hole {holes.name} is blocked, but each jaw has only {vise.rows} rows.")
    for jaw in ("left", "right"):
        if len({holes.column for holes in vise.blocked if holes.jaw == jaw and holes.row is None}) == vise.columns:
            raise InputError(f"every column of the {jaw} jaw is blocked: leave at least one.")
