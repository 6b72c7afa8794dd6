"""Carriers of the contacts of a fixture: a lattice of holes, a clamp, or a straight wall.

A carrier is data; drawings, files and sheets take names and places from it. The name of a hole has the letter
of the carrier, the letters of the column, and the row from 1, such as ``L-B3``; a name without a row is a
whole column.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from math import cos, sin
from typing import Any, Literal

from attrs import frozen

from workhold.errors import InputError
from workhold.fixels.contacts import CLAMP_TIP, FLAT_JAW, FLAT_PIN, ROUND_PIN, TOWARDS, WALL_END, ContactKind
from workhold.fixels.pegs import PegFlat

__all__ = [
    "JAWS",
    "WALL",
    "Carrier",
    "Heights",
    "HoleSelection",
    "Measure",
    "Travel",
    "make_column_letters",
    "make_hole_name",
    "parse_hole_name",
    "find_carrier_letter",
]

# The carrier that is the only one with holes.
ALONE = "plate"
NAME = re.compile(r"([A-Z])-?([A-Z]{1,3})([1-9][0-9]{0,8})?")


@cache
def make_column_letters(column: int) -> str:
    """Return the letters of a column counted from 0: A to Z, then AA, AB and so on.

    >>> [make_column_letters(c) for c in (0, 25, 26, 51, 52)]
    ['A', 'Z', 'AA', 'AZ', 'BA']
    """
    letters = ""
    column += 1
    while column:
        column, rest = divmod(column - 1, 26)
        letters = chr(ord("A") + rest) + letters
    return letters


def make_hole_name(carrier: str, column: int, row: int | None) -> str:
    """Return the name of a hole on a carrier; for row None, the name of the whole column.

    Columns and rows are counted from 0.

    >>> make_hole_name("left", 1, 2), make_hole_name("right", 0, None), make_hole_name("plate", 1, 2)
    ('L-B3', 'R-A', 'B3')
    """
    letter = find_carrier_letter(carrier)
    return f"{letter and letter + '-'}{make_column_letters(column)}{'' if row is None else row + 1}"


def find_carrier_letter(carrier: str) -> str:
    """Return the capital letter with which the names of a carrier's holes begin.

    It is "" for the carrier "plate", whose hole names begin with the column.
    """
    return "" if carrier == ALONE else carrier[0].upper()


@frozen
class HoleSelection:
    """A hole of a carrier, or a whole column of holes.

    Parameters
    ----------
    carrier : name of the carrier, such as "left".
    column : counted from 0.
    row : counted from 0; None for the whole column.
    """

    carrier: str
    column: int
    row: int | None = None

    @property
    def name(self) -> str:
        """Name of the hole or column, see :func:`make_hole_name`."""
        return make_hole_name(self.carrier, self.column, self.row)


def parse_hole_name(name: str, carriers: Iterable[str], noun: str) -> HoleSelection:
    """Return the hole or column that a name such as "L-B3" or "L-B" denotes; the inverse of
    :func:`make_hole_name`.

    Parameters
    ----------
    name : in any mixture of capitals, with or without the hyphen.
    carriers : names of the carriers that it may be on.
    noun : word for a carrier in the error message.

    Raises
    ------
    InputError
        For anything else.

    Examples
    --------
    >>> parse_hole_name("R-A3", ("left", "right"), "jaw")
    HoleSelection(carrier='right', column=0, row=2)
    """
    match = NAME.fullmatch(name.strip().upper())
    carrier = (
        None
        if match is None
        else next((one for one in carriers if find_carrier_letter(one) == match[1]), None)
    )
    if match is None or carrier is None:
        raise InputError(
            f"{name!r} names no hole: give {noun}, column letter and row, such as L-B3, or L-B for a whole "
            "column."
        )
    column = 0
    for letter in match[2]:
        column = 26 * column + ord(letter) - ord("A") + 1
    return HoleSelection(carrier, column - 1, None if match[3] is None else int(match[3]) - 1)


# (lower, upper) in mm.
Heights = tuple[float, float]
# The name of the carrier that is a wall.
WALL = "wall"
# Names of the carriers of a vise.
JAWS = ("left", "right")

# The length that is set on a moving carrier: the opening of jaws, a clamp's stroke from its hole, or the
# place of its tip.
Measure = Literal["opening", "stroke", "tip"]


@frozen
class Travel:
    """The range and the direction in which a carrier slides along a line.

    Parameters
    ----------
    direction : angle in radians, from the x axis, of the direction in which the travel grows.
    least : smallest travel in mm; -inf where unbounded.
    most : largest travel in mm; None where unbounded.
    """

    direction: float
    least: float
    most: float | None

    @property
    def unit(self) -> tuple[float, float]:
        """The unit vector of the direction; without rounding errors along the axes."""
        return round(cos(self.direction), 15), round(sin(self.direction), 15)


@frozen
class Carrier:
    """An element that carries contacts: a lattice of holes for pegs, a clamp, a straight wall, or a flat jaw.

    Parameters
    ----------
    name : such as "left"; its first letter begins the names of its holes.
    pitch : distances in mm between neighbouring columns and rows.
    columns, rows : numbers of columns and rows of holes; None for as many as needed.
    peg_radius : radius of its pegs in mm.
    body_radius : radius in mm of the thickest part of its pegs, below the workpiece.
    offset : place (x, y) in mm of the hole in column 0 and row 0, at travel 0.
    blocked : holes and columns in which no peg can stand.
    travel : range and direction of its travel; None for a fixed carrier.
    noun : word for it, such as "jaw".
    peg : word for one of its pegs, such as "locator".
    on : for a clamp on a plate, the name of the carrier in whose holes it is bolted; None for a carrier with
        its own holes.
    is_wall : whether it is a straight wall along x that the part lies flush against, without holes.
    flat : the flat of its pegs, which lies on straight faces; None for round pegs.
    heights : lower and upper end of what stands on it, in mm above the plane on which the part lies; None for
        pegs from below that plane up to the peg height.
    width : of a wall or flat jaw in mm, centred on its columns; None for an endless one.
    is_jaw : whether it is a flat jaw, which holds by friction and has no holes.
    """

    name: str
    pitch: tuple[float, float]
    columns: int | None
    rows: int | None
    peg_radius: float
    body_radius: float
    offset: tuple[float, float] = (0.0, 0.0)
    blocked: tuple[HoleSelection, ...] = ()
    travel: Travel | None = None
    noun: str = "carrier"
    peg: str = "peg"
    on: str | None = None
    is_wall: bool = False
    flat: PegFlat | None = None
    heights: Heights | None = None
    width: float | None = None
    is_jaw: bool = False

    @property
    def reach(self) -> tuple[float, float] | None:
        """The x coordinates in mm of the left and the right end of a wall; None for an endless wall and for
        other carriers.
        """
        if self.width is None or self.is_jaw:
            return None
        middle = (self.column_count - 1) * self.pitch[0] / 2
        return middle - self.width / 2, middle + self.width / 2

    @property
    def role(self) -> str:
        """The name up to its first space, such as "clamp" for "clamp -x"; carriers of one role have the same
        heights.
        """
        return self.name.partition(" ")[0]

    @property
    def least_standoff(self) -> float:
        """Smallest distance in mm from a face to the centre of a peg that touches it."""
        return self.peg_radius if self.flat is None else self.flat.distance

    @property
    def title(self) -> str:
        """Its name in sentences, such as "left jaw"; for the plate, whose hole names have no letter, only its
        noun.
        """
        if not self.letter:
            return self.noun
        return self.name if self.noun in self.name else f"{self.name} {self.noun}"

    @property
    def elements(self) -> str:
        """The words for its contacts, such as "locators", "left jaw pegs", "clamp" or "fence"."""
        if not self.has_lattice:
            return self.noun
        return f"{self.title} {self.peg}s" if self.letter and self.name != self.noun else f"{self.peg}s"

    @property
    def column_count(self) -> int:
        """The number of columns; an error where it is None."""
        assert self.columns is not None
        return self.columns

    @property
    def contact(self) -> ContactKind:
        """The kind of the contacts that it makes."""
        if self.is_jaw:
            return FLAT_JAW
        if self.is_wall:
            return WALL_END
        if self.on is not None:
            return CLAMP_TIP
        return ROUND_PIN if self.flat is None else FLAT_PIN

    @property
    def stands_on(self) -> str:
        """The name of the carrier whose holes have its contacts: its own name, or that of the carrier it is
        bolted to.
        """
        return self.on or self.name

    @property
    def has_lattice(self) -> bool:
        """Whether it has holes of its own, unlike a wall, a flat jaw, or a clamp bolted to a plate."""
        return self.contact in (ROUND_PIN, FLAT_PIN)

    @property
    def is_along_x(self) -> bool:
        """Whether the carrier slides along x; False for a fixed one."""
        return self.travel is not None and self.travel.unit[0] != 0.0

    @property
    def line(self) -> Literal["row", "column"]:
        """The line of holes along which a clamp pushes: "row" for a clamp that slides along x, else
        "column".
        """
        return "row" if self.is_along_x else "column"

    @property
    def direction(self) -> str:
        """The direction in which a clamp pushes, such as "-x"; meaningless for other carriers."""
        return self.name.rpartition(" ")[2]

    @property
    def direction_words(self) -> str:
        """Direction in which a clamp pushes, in words on a plan with y up; empty for other carriers."""
        return TOWARDS.get(self.direction, "")

    @property
    def pushers(self) -> str:
        """The word for the elements that press on the part when the carrier moves: "jaws" for a jaw, "clamp"
        for a clamp.
        """
        return f"{self.noun}s" if self.has_lattice else self.noun

    @property
    def measure(self) -> Measure:
        """The kind of length that a user sets on it.

        A clamp has a "stroke" (from its hole to its tip) or, without a hole, the place of its "tip"; anything
        else has an "opening".
        """
        if self.contact is CLAMP_TIP:
            return "stroke" if self.has_a_hole else "tip"
        return "opening"

    @property
    def has_a_hole(self) -> bool:
        """Whether its contacts are in known holes.

        False for a clamp without a largest travel: only the row or column along which it pushes is known.
        """
        return self.on is None or self.travel is None or self.travel.most is not None

    @property
    def has_body_behind(self) -> bool:
        """Whether it is a clamp whose body extends from its tip back to the hole in which it is bolted."""
        return self.contact is CLAMP_TIP and self.has_a_hole

    @property
    def counted_axes(self) -> tuple[bool, bool]:
        """Two flags: whether a column and whether a row locates a contact on it.

        A clamp without a hole has only one of them: the row or column along which it pushes. A wall has
        neither.
        """
        if not self.contact.is_placed:
            return False, False
        return self.has_a_hole or not self.is_along_x, self.has_a_hole or self.is_along_x

    @property
    def file_entry(self) -> tuple[str, str]:
        """The key and the value by which files name the carrier of a contact, such as ("jaw", "left").

        For a toolkit with several lattices these are the carrier's noun and name, else "role" and the
        contact's role. The role of a single sliding lattice is its noun.
        """
        if self.has_lattice and self.letter and self.name != self.noun:
            return self.noun, self.name
        return "role", self.noun if self.has_lattice and self.travel is not None else self.contact.role

    def name_place(self, column: int, row: int) -> str:
        """Return the name of the place of a contact at a column and row, counted from 0.

        It is the hole, such as "L-B3"; for a clamp its noun with its hole or its line of holes; for a wall
        its noun.

        >>> from workhold import Plate
        >>> clamp = Plate(pitch=20, peg_radius=3).carriers[1]
        >>> clamp.name_place(0, 2)
        'clamp row 3'
        """
        if self.is_wall:
            return self.noun
        if self.on is None:
            return make_hole_name(self.name, column, row)
        if self.has_a_hole:
            return f"{self.noun} {make_hole_name(self.on, column, row)}"
        return (
            f"{self.noun} row {row + 1}"
            if self.is_along_x
            else f"{self.noun} column {make_column_letters(column)}"
        )

    @property
    def letter(self) -> str:
        """Letter with which the names of its holes begin; empty for the plate."""
        return find_carrier_letter(self.name)

    def is_blocked(self, column: int, row: int) -> bool:
        """Return whether the hole at a column and row, counted from 0, or its whole column is blocked for
        pegs.
        """
        return not {HoleSelection(self.name, column), HoleSelection(self.name, column, row)}.isdisjoint(
            self.blocked
        )

    def compute_hole_center(self, column: Any, row: Any, travelled: Any = 0.0) -> tuple[Any, Any]:
        """Return x and y in mm of the centre of a hole; arrays for arrays of columns, rows or travels.

        Parameters
        ----------
        column, row : of the hole, counted from 0.
        travelled : travel of the carrier in mm; ignored for one that stands still.

        Examples
        --------
        >>> from workhold import Vise
        >>> right = Vise(pitch=10, columns=2, peg_radius=3).carriers[1]
        >>> right.compute_hole_center(1, 2, travelled=14.5)
        (34.5, 20.0)
        """
        x, y = self.offset[0] + column * self.pitch[0], self.offset[1] + row * self.pitch[1]
        if self.travel is None:
            return x, y
        along, across = self.travel.unit
        return x + travelled * along, y + travelled * across
