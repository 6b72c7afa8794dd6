"""Texts for setting up a toolkit on sheets, pictures and pages, and the origin of its places.

Each kind of toolkit has its own texts; drawings and tables combine them with its numbers and do not depend on
the kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from attrs import frozen

from workhold.fixels.carrier import Carrier, make_column_letters, make_hole_name

__all__ = ["Datum", "PageWords", "SetupWords"]


@frozen
class SetupWords:
    """Texts about setting up a kind of toolkit.

    Words in braces are placeholders: ``{holes}`` for the holes of the pegs and ``{count}`` for their number,
    ``{peg}`` and ``{plate}`` for the nouns of pegs and plate, ``{edge}`` for the distance of row 1 from the
    datum.

    Parameters
    ----------
    standing : heading of the list of the pegs' places, such as "Locators".
    put : the first step, a sentence.
    touching : position of the part when it is held, in two words.
    located_by : the elements against which a clamp pushes the part, such as "Three locators".
    against : position of the part before a clamp pushes it.
    resting : position of the part in a false seat that looks like the right one.
    """

    standing: str
    put: str
    touching: str
    located_by: str = ""
    against: str = ""
    resting: str = "all four pegs on faces"


@frozen
class PageWords:
    """Texts and initial values for a kind of toolkit on the web page.

    Parameters
    ----------
    title : in a few words, to choose it by.
    closes : label of the button that animates its closing.
    start : initial values of fields, in mm.
    """

    title: str
    closes: str
    start: Mapping[str, Any]


@frozen
class Datum:
    """The origin from which places on a toolkit are measured, and the words for it.

    Parameters
    ----------
    name : short name of the origin, such as "A1".
    point : the origin in words, such as "the centre of hole A1".
    full : the origin in words with its carrier, such as "the plate's hole A1".
    mark : label beside the origin on a plan.
    x, y : words for the origins of x and of y, such as "hole A1".
    lines : words for the column and the row through the origin; for a wall, the wall instead of the row.
    rows_from : words for the side from which rows are counted, such as "below".
    substitute : words for the new origin when the whole set-up is moved to other holes.
    edge : distance in mm from the wall to the centres of row 1; None without a wall, or if the plate slides.
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
        """Return the datum at the centre of hole A1 of a plate."""
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
        """Return the datum at the point where the first column of a plate meets a wall."""
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
        """Whether x and y are measured from the same hole."""
        return self.x == self.y

    @property
    def fixes_rows(self) -> bool:
        """Whether there is a wall, so that a set-up can be moved along the rows only."""
        return not self.is_hole

    @property
    def origin_words(self) -> str:
        """Words for the origin of x and y, such as "hole A1" or "column A and the fence"."""
        return self.x if self.is_hole else f"{self.x} and {self.y}"

    def describe_peg_centres(self, pegs: str) -> str:
        """Return a note for a table of peg centres that names the origin of x and y.

        ``pegs`` is the word for the pegs.
        """
        if self.is_hole:
            return f"x, y: {pegs} centre, from {self.point}."
        return f"x from {self.x}, y from {self.y}, to centres."
