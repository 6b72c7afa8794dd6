"""The contacts that hold a part: their kinds, how carriers share them, and the symmetries of that.

The kinds are round pins, pins with a flat, a straight wall, and the tips of clamps. Clamps push in directions
that have names in files.

Reference: R. C. Brost and K. Y. Goldberg, *A complete algorithm for designing planar fixtures using modular
components*, IEEE Transactions on Robotics and Automation 12 (1996), who call such elements of a fixture
fixels.
"""

from __future__ import annotations

from math import pi
from typing import Literal

from attrs import frozen

__all__ = [
    "CLAMP_TIP",
    "DIRECTIONS",
    "FLAT_JAW",
    "FLAT_PIN",
    "ROUND_PIN",
    "TOWARDS",
    "WALL_END",
    "Arrangement",
    "ContactKind",
    "Symmetry",
]


@frozen
class ContactKind:
    """What a contact is to whoever draws it, writes it, or sets it up.

    Parameters
    ----------
    name : in a few words.
    role : what it does for the part: it locates it, or it clamps it.
    is_placed : whether it is a thing by itself that somebody puts in a place; the end of a contact with a
        wall is not.
    is_turned : whether it matters which way it is turned in its hole.
    """

    name: str
    role: Literal["locator", "clamp"]
    is_placed: bool = True
    is_turned: bool = False


ROUND_PIN = ContactKind("round pin", "locator")
FLAT_PIN = ContactKind("flat pin", "locator", is_turned=True)
WALL_END = ContactKind("wall", "locator", is_placed=False)
CLAMP_TIP = ContactKind("clamp tip", "clamp")
FLAT_JAW = ContactKind("flat jaw", "clamp", is_placed=False)


# In the order in which fixtures are listed. Each has the angle of the line along which the clamp's travel is
# counted, which is the other way.
DIRECTIONS = {"-x": 0.0, "+x": pi, "-y": pi / 2, "+y": -pi / 2}
# In words, on a plan whose y runs up.
TOWARDS = {"-x": "to the left", "+x": "to the right", "-y": "downward", "+y": "upward"}


@frozen
class Arrangement:
    """How many pegs stand on each carrier.

    Parameters
    ----------
    name : the paper's, such as "I".
    pegs : for each carrier, those that stand still first.
    direction : in which the carrier that moves clamps, such as "-x", where a toolkit has several.
    """

    name: str
    pegs: tuple[int, ...]
    direction: str | None = None

    @property
    def directions(self) -> tuple[str, ...]:
        """The direction in which each of its clamps pushes; none where no clamp pushes."""
        return tuple((self.direction or "").split())

    @property
    def title(self) -> str:
        """The name, and the directions where there are some."""
        return " ".join((self.name, *self.directions))

    @property
    def short_title(self) -> str:
        """What a fixture of it is called on a small picture, such as "Type I"."""
        return self.title.replace("-", "\N{MINUS SIGN}") if self.directions else f"Type {self.name}"

    @property
    def heading(self) -> str:
        """What a fixture of it is called in a line.

        >>> Arrangement("II", (3, 1)).heading, Arrangement("clamp", (3, 1), "-x").heading
        ('Type II', 'Clamp \u2212x')
        """
        if not self.directions:
            return f"Type {self.title}"
        clamps = " ".join(self.directions).replace("-", "\N{MINUS SIGN}")
        return f"Clamp{'s' * (len(self.directions) > 1)} {clamps}"

    @property
    def towards(self) -> str:
        """The direction in words, or those of two clamps, on a plan whose y runs up."""
        return " and ".join(dict.fromkeys(TOWARDS[name] for name in self.directions))

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
