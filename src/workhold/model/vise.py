"""The fixture vise: two jaws with a lattice of peg holes each (paper, sections 1 and 2)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import isfinite, isnan
from typing import ClassVar

from attrs import evolve, field, frozen
from attrs.converters import optional

from workhold.errors import InputError
from workhold.limits import MOST_BLOCKED, refuse_long
from workhold.model.flat import Flat, flat_of, resolved_flat
from workhold.model.holes import Holes, holes_named
from workhold.model.lattice import optional_length, pair, refuse_lattice, refuse_many_holes, whole
from workhold.model.real import real
from workhold.model.setup_words import SetupWords
from workhold.model.toolkit import Arrangement, Carrier, Change, Limit, Symmetry, Toolkit, Travel, Wording
from workhold.model.units import Unit

__all__ = ["OpeningVise", "Vise"]


# The jaws, the one that stands still first, and what each is called.
JAWS, NOUN = ("left", "right"), "jaw"
WORDING = Wording(
    two="two pegs of one jaw",
    four="four pegs of the two jaws",
    inside="in this vise",
    within="the jaws as asked: with the rows, opening, angles, shoulders and blocked holes given",
    rules="keeps the smallest gap, closes and clamps",
    backwards="the jaws are pressed apart, not when they close",
    holes="holes that the jaws do not have, or too near for the bodies",
)
SETUP = SetupWords(
    standing="Pegs",
    put="Put {peg}s in {holes}.",
    touching="four pegs",
)


def all_holes(holes: Iterable[Holes | str]) -> tuple[Holes, ...]:
    """Holes as a tuple, where they may be given by name."""
    return tuple(holes_named(one, JAWS, NOUN) if isinstance(one, str) else one for one in holes)


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
    max_opening : largest opening in mm, or None for no limit.
    row_offset : height in mm of the right jaw's row 0 above the left jaw's.
    body_radius : radius in mm of the thickest part of a peg, its shoulder, which lies below the workpiece; None means the
        peg radius. Bodies may neither overlap nor stand over a keep-out zone.
    blocked : holes and columns that no peg can stand in, or their names, such as "L-B3" and "R-A".
    flat : of the pegs, which lies on straight faces: its distance from a peg's centre, and half its width, in mm; None for
        round ones.

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
    noun: ClassVar[str] = "vise"
    locked: ClassVar[str] = "a screw vise, its jaw"
    arrangements: ClassVar[tuple[Arrangement, ...]] = (Arrangement("I", (2, 2)), Arrangement("II", (3, 1)))
    clamping: ClassVar[int] = 1
    symmetries: ClassVar[tuple[Symmetry, ...]] = (Symmetry(1, (1, 0)),)
    wording: ClassVar[Wording] = WORDING
    setup_words: ClassVar[SetupWords] = SETUP

    pitch: tuple[float, float] = field(converter=pair)
    columns: int = field(converter=whole)
    peg_radius: float = field(converter=real)
    rows: int | None = field(default=None, converter=whole)
    min_gap: float = field(default=None, converter=optional_length)
    max_opening: float | None = field(default=None, converter=optional(real))
    row_offset: float = field(default=0.0, converter=real)
    body_radius: float = field(default=None, converter=optional_length)
    blocked: tuple[Holes, ...] = field(default=(), converter=all_holes)
    flat: Flat | None = field(default=None, converter=flat_of, kw_only=True)

    def __attrs_post_init__(self) -> None:
        if isnan(self.min_gap):
            object.__setattr__(self, "min_gap", self.pitch[0])
        if isnan(self.body_radius):
            object.__setattr__(self, "body_radius", self.peg_radius)
        refuse_lattice(self.pitch, self.columns, self.rows, self.peg_radius, NOUN, "peg")
        if not (isfinite(self.min_gap) and self.min_gap >= 0):
            raise InputError(f"min gap {self.min_gap} is not a length: give 0 or more, in mm.")
        if self.max_opening is not None:
            if not (isfinite(self.max_opening) and self.max_opening > 0):
                raise InputError(f"max opening {self.max_opening} is not a positive length: give it in mm.")
            if self.max_opening < self.min_gap:
                raise InputError(
                    f"max opening {self.max_opening:g} is below the min gap {self.min_gap:g}: no opening is left."
                )
        if not isfinite(self.row_offset):
            raise InputError(f"row offset {self.row_offset} is not a length: give it in mm.")
        if not (isfinite(self.body_radius) and self.body_radius >= self.peg_radius):
            raise InputError(
                f"body radius {self.body_radius:g} is not one of a peg of radius {self.peg_radius:g}: give that or more, "
                "in mm."
            )
        object.__setattr__(self, "flat", resolved_flat(self.flat, self.peg_radius))
        refuse_boundless(self)
        refuse_blocked(self)

    @property
    def carriers(self) -> tuple[Carrier, Carrier]:
        """The left jaw, and the right jaw, whose travel is the jaw separation."""
        left = Carrier(
            JAWS[0],
            self.pitch,
            self.columns,
            self.rows,
            self.peg_radius,
            self.body_radius,
            blocked=tuple(holes for holes in self.blocked if holes.carrier == JAWS[0]),
            noun=NOUN,
            flat=self.flat,
        )
        right = evolve(
            left,
            name=JAWS[1],
            offset=((self.columns - 1) * self.pitch[0], self.row_offset),
            blocked=tuple(holes for holes in self.blocked if holes.carrier == JAWS[1]),
            travel=Travel(0.0, self.min_gap, self.max_opening),
        )
        return left, right

    @property
    def law(self) -> str:
        """That of two jaws."""
        return "vise"

    @property
    def gap(self) -> float:
        """The smallest gap in mm."""
        return self.min_gap

    @property
    def limits(self) -> tuple[Limit, ...]:
        """Shoulders, largest opening, rows and blocked holes, where there are any."""
        shoulder = Change("with pegs without a shoulder", {"body_radius": self.peg_radius})
        opening = Change("with a larger opening", {"max_opening": None})
        rows = Change("with as many rows as needed", {"rows": None})
        blocked = Change("with no hole blocked", {"blocked": ()})
        known = (
            (self.body_radius > self.peg_radius, Limit("bodies that would overlap", "bodies", shoulder)),
            (self.max_opening is not None, Limit("largest opening", "travel", opening)),
            (self.rows is not None, Limit("rows of holes", "holes", rows)),
            (bool(self.blocked), Limit("blocked holes", "holes", blocked)),
        )
        return tuple(limit for there, limit in known if there)

    def further_changes(self, unit: Unit) -> Iterator[Change]:
        """A smaller gap, a column more, rows offset and half the pitch."""

        def words(length: float) -> str:
            return f"{unit.figure(length)} {unit.abbreviation}"

        narrow, offset = 2 * self.peg_radius, self.pitch[1] / 2
        if self.min_gap > narrow > 0:
            yield Change(f"with a smallest gap of {words(narrow)}", {"min_gap": narrow})
        yield Change("with one more column on each jaw", {"columns": self.columns + 1})
        if self.row_offset == 0.0:
            yield Change(f"with the right jaw's rows offset by {words(offset)}", {"row_offset": offset})
        if min(self.pitch) >= 4 * self.peg_radius:
            half = (self.pitch[0] / 2, self.pitch[1] / 2)
            yield Change("with half the pitch", {"pitch": half, "min_gap": min(self.min_gap, half[0]), "blocked": ()})


@frozen
class OpeningVise(Vise):
    """The vise that clamps by opening: its pegs hold the part from inside its holes, or around a waist.

    Parameters, errors and all rules are those of :class:`Vise`; only the sign of clamping differs.
    """

    kind: ClassVar[str] = "opening-vise"
    clamping: ClassVar[int] = -1
    wording: ClassVar[Wording] = evolve(WORDING, backwards="the jaws close, not when they are pressed apart")


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
    refuse_many_holes(vise.columns, vise.rows, NOUN)
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
    for jaw in JAWS:
        if len({holes.column for holes in vise.blocked if holes.carrier == jaw and holes.row is None}) == vise.columns:
            raise InputError(f"every column of the {jaw} jaw is blocked: leave at least one.")
