"""How the contacts of a fixture are shared out among the carriers of a toolkit, and which motions leave that as it is."""

from __future__ import annotations

from attrs import frozen

from workhold.fixels.directions import TOWARDS

__all__ = ["Arrangement", "Symmetry"]


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
        """In which its clamps push, one for each; none where no clamp pushes."""
        return tuple((self.direction or "").split())

    @property
    def title(self) -> str:
        """Its name, and the direction where it has one."""
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
        """Its direction, or those of two clamps, in words, on a plan whose y runs up."""
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
