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
    """A kind of contact.

    Parameters
    ----------
    name : in a few words.
    role : whether it locates or clamps the part.
    is_placed : True for an element that is placed by itself; False for an end of a contact with a wall.
    is_turned : whether the element's angle in its hole matters.
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
    """The number of contacts of a fixture on each carrier.

    Parameters
    ----------
    name : such as "I", as in the paper by Brost and Goldberg.
    pegs : the number of contacts on each carrier, in the order of the carriers.
    direction : directions in which the moving carriers clamp, such as "-x" or "-x -y"; None if a toolkit has
        only one direction.
    """

    name: str
    pegs: tuple[int, ...]
    direction: str | None = None

    @property
    def directions(self) -> tuple[str, ...]:
        """The direction in which each clamp pushes, such as ("-x", "-y"); empty where ``direction`` is
        None.
        """
        return tuple((self.direction or "").split())

    @property
    def title(self) -> str:
        """The name followed by the directions, such as "clamp -x" or "I"."""
        return " ".join((self.name, *self.directions))

    @property
    def short_title(self) -> str:
        """The title of fixtures of this arrangement on a small picture, such as "Type I" or "clamp −x"."""
        return self.title.replace("-", "\N{MINUS SIGN}") if self.directions else f"Type {self.name}"

    @property
    def heading(self) -> str:
        """The title of fixtures of this arrangement in a line of text.

        >>> Arrangement("II", (3, 1)).heading, Arrangement("clamp", (3, 1), "-x").heading
        ('Type II', 'Clamp −x')
        """
        if not self.directions:
            return f"Type {self.title}"
        clamps = " ".join(self.directions).replace("-", "\N{MINUS SIGN}")
        return f"Clamp{'s' * (len(self.directions) > 1)} {clamps}"

    @property
    def direction_words(self) -> str:
        """The directions of the clamps in words on a plan with y up, such as "to the left"; empty without
        any.
        """
        return " and ".join(dict.fromkeys(TOWARDS[name] for name in self.directions))

    @property
    def carriers(self) -> tuple[int, ...]:
        """For each contact of a fixture, in the order in which contacts are listed, the index of its carrier.

        >>> Arrangement("II", (3, 1)).carriers
        (0, 0, 0, 1)
        """
        return tuple(number for number, count in enumerate(self.pegs) for _ in range(count))


@frozen
class Symmetry:
    """A rotation that carries a toolkit onto itself, so that a fixture and the rotated fixture count as the
    same.

    Parameters
    ----------
    half_turns : number of turns by 180 degrees of the rotation.
    carriers : for each carrier, the index of the carrier onto which it is carried.
    """

    half_turns: int
    carriers: tuple[int, ...]
