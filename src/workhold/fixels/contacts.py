"""The contacts that hold a part: their kinds, how they are arranged on carriers, and symmetries.

The kinds are round pins, pins with a flat, a straight wall, flat jaws, and the tips of clamps. The directions
in which clamps push have names in files.

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
    """A kind of contact, with what drawings, files and set-ups need to know of it.

    Parameters
    ----------
    name : in a few words.
    role : whether it locates or clamps the part.
    is_placed : whether it is an element put in a place of its own; the end of a contact with a wall is not.
    is_turned : whether its angle in the hole matters.
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


# Directions of clamping in the order in which fixtures are listed, each with the angle of the opposite
# direction, in which travel is counted.
DIRECTIONS = {"-x": 0.0, "+x": pi, "-y": pi / 2, "+y": -pi / 2}
# Directions in words, on a plan with y up.
TOWARDS = {"-x": "to the left", "+x": "to the right", "-y": "downward", "+y": "upward"}


@frozen
class Arrangement:
    """The number of pegs on each carrier.

    Parameters
    ----------
    name : as in the paper, such as "I".
    pegs : how many on each carrier, in the order of the carriers.
    direction : in which the moving carriers clamp, such as "-x" or "-x -y"; None where a toolkit has only one
        direction.
    """

    name: str
    pegs: tuple[int, ...]
    direction: str | None = None

    @property
    def directions(self) -> tuple[str, ...]:
        """Direction in which each of its clamps pushes, such
        as ("-x", "-y"); empty where ``direction`` is None.
        """
        return tuple((self.direction or "").split())

    @property
    def title(self) -> str:
        """Name, followed by the directions if any."""
        return " ".join((self.name, *self.directions))

    @property
    def short_title(self) -> str:
        """Title of its fixtures on a small picture, such as "Type I"."""
        return self.title.replace("-", "\N{MINUS SIGN}") if self.directions else f"Type {self.name}"

    @property
    def heading(self) -> str:
        """Title of its fixtures in a line of text.

        >>> Arrangement("II", (3, 1)).heading, Arrangement("clamp", (3, 1), "-x").heading
        ('Type II', 'Clamp −x')
        """
        if not self.directions:
            return f"Type {self.title}"
        clamps = " ".join(self.directions).replace("-", "\N{MINUS SIGN}")
        return f"Clamp{'s' * (len(self.directions) > 1)} {clamps}"

    @property
    def direction_words(self) -> str:
        """Directions of its clamps in words, on a plan with y up; empty without any."""
        return " and ".join(dict.fromkeys(TOWARDS[name] for name in self.directions))

    @property
    def carriers(self) -> tuple[int, ...]:
        """Index of each peg's carrier, in the order in which pegs are listed.

        >>> Arrangement("II", (3, 1)).carriers
        (0, 0, 0, 1)
        """
        return tuple(number for number, count in enumerate(self.pegs) for _ in range(count))


@frozen
class Symmetry:
    """A motion of the plane that maps a toolkit onto itself, so that two fixtures count as the same.

    Parameters
    ----------
    half_turns : by how many turns of 180 degrees everything is turned.
    carriers : for each carrier, the index of the one whose place it takes.
    """

    half_turns: int
    carriers: tuple[int, ...]
