"""What setting up a toolkit is called on sheets, pictures and pages, and where its places are measured from.

Each kind of toolkit gives its words; drawings and tables put them beside its numbers and know of no kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from attrs import frozen

from workhold.fixels.carrier import Carrier, make_column_letters, make_hole_name

__all__ = ["Datum", "PageWords", "SetupWords"]


@frozen
class SetupWords:
    """The words of a kind of toolkit.

    Words in braces stand for what a fixture has. ``{holes}`` are the holes of its pegs and ``{count}`` their
    number. ``{peg}`` and ``{plate}`` are the nouns of the pegs and the plate. ``{edge}`` is the distance of
    row 1 from the datum.

    Parameters
    ----------
    standing : heading of the places of the pegs, such as "Locators".
    put : the first thing to do, a sentence.
    touching : how the part lies where it is held, in two words.
    located_by : what a clamp pushes the part against, such as "Three locators".
    against : where the part lies before a clamp pushes it.
    resting : the same of a seat that looks like a fixture.
    """

    standing: str
    put: str
    touching: str
    located_by: str = ""
    against: str = ""
    resting: str = "all four pegs on faces"


@frozen
class PageWords:
    """What the page calls a kind of toolkit, and what it begins with.

    Parameters
    ----------
    title : in a few words, to choose it by.
    closes : what the button says that shows how it closes.
    start : fields to begin with, in mm, where nobody has given any.
    """

    title: str
    closes: str
    start: Mapping[str, Any]


@frozen
class Datum:
    """Where zero lies, and what places are measured from.

    Parameters
    ----------
    name : the zero point in short, such as "A1".
    point : the same in words, such as "the centre of hole A1".
    full : the same with what the hole is in, such as "the plate's hole A1".
    mark : what stands beside it on a plan.
    x, y : what x and y are measured from, such as "hole A1".
    lines : the column and the row, or what stands for a row, of the zero point.
    rows_from : where rows are counted from, such as "below".
    substitute : what takes the place of the datum where all of a set-up is moved.
    edge : distance in mm from what stands for a row to the centres of row 1; None where nothing does, or the
        plate slides.
    """

    name: str
    point: str
    full: str
    mark: str
    x: str
    y: str
    lines: tuple[str, str]
    rows_from: str
    substitute: str
    edge: float | None = None

    @classmethod
    def from_hole(cls, plate: Carrier) -> Datum:
        name, hole = make_hole_name(plate.name, 0, 0), f"hole {make_hole_name(plate.name, 0, 0)}"
        return cls(
            name=name,
            point=f"the centre of {hole}",
            full=f"the {plate.title}'s {hole}",
            mark=f"{name} (0, 0)",
            x=hole,
            y=hole,
            lines=(f"column {make_column_letters(0)}", "row 1"),
            rows_from="below",
            substitute=f"the hole that takes the place of {name}",
        )

    @classmethod
    def from_wall(cls, wall: Carrier, plate: Carrier) -> Datum:
        """Return where the first column of a plate meets a wall, whose line counts as a row."""
        letter, line = make_column_letters(0), f"the {wall.noun}"
        name = f"column {letter} at {line}"
        return cls(
            name=name,
            point=name,
            full=name,
            mark="(0, 0)",
            x=f"column {letter}",
            y=line,
            lines=(f"column {letter}", line),
            rows_from=line,
            substitute=f"the column that takes the place of {letter}",
            edge=plate.offset[1] if plate.travel is None else None,
        )

    @property
    def is_hole(self) -> bool:
        """Whether x and y are measured from one hole."""
        return self.x == self.y

    @property
    def fixes_rows(self) -> bool:
        """Whether rows have their places, so that a set-up can be moved along them only."""
        return not self.is_hole

    @property
    def start(self) -> str:
        """What x and y are measured from, in one phrase."""
        return self.x if self.is_hole else f"{self.x} and {self.y}"

    def describe_peg_centres(self, pegs: str) -> str:
        """Return what x and y of pegs of a name are, a sentence."""
        if self.is_hole:
            return f"x, y: {pegs} centre, from {self.point}."
        return f"x from {self.x}, y from {self.y}, to centres."
