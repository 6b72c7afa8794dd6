"""What the page knows of each kind of toolkit: what it is called, and a field of the page for each of its fields.

The page draws its fields from this alone. A further kind needs an entry in :data:`DESCRIBED` and a form in ``web.forms``.

Glossary
--------
said : fields that a kind's name says by itself, such as the one column of a gripper.
start : fields to begin with, in mm, where nobody has given any.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations_with_replacement
from typing import Any, Literal

from attrs import asdict, frozen

from workhold.drawing.panel import arrangement_words
from workhold.files.toolkit.reader import LoadedToolkit
from workhold.model.kinds import kind_of, toolkit_of
from workhold.model.plate import DIRECTIONS
from workhold.model.toolkit import TOWARDS

__all__ = ["DESCRIBED", "Choice", "Described", "Field", "kinds_answer", "page_kind"]


@frozen
class Choice:
    """One of several values of a field, and what the page calls it."""

    value: Any
    words: str


@frozen
class Field:
    """A field of the page.

    Parameters
    ----------
    name : of the toolkit's field.
    label : what the page calls it.
    form : "length" (mm), "count" (from 1), "pitch" (two lengths, x and y), "span" (two lengths, the least and the most),
        "holes" (names), "several" (some of the choices) or "one" (one of them).
    hint : what stands in it while it is empty, which it may be then; None where it must be filled in.
    is_usual : whether it is seen without being asked for.
    least : what a length must be: "above 0", "0" or "any".
    choices : of "several" and "one".
    when : values of other fields with which there is this one.
    """

    name: str
    label: str
    form: Literal["length", "count", "pitch", "span", "holes", "several", "one"]
    hint: str | None = None
    is_usual: bool = False
    least: Literal["above 0", "0", "any"] = "above 0"
    choices: tuple[Choice, ...] = ()
    when: Mapping[str, Any] = {}


@frozen
class Described:
    """A kind of toolkit as the page shows it.

    Parameters
    ----------
    name : of the kind, or an alias of ``model.kinds``.
    title : in a few words, to choose it by.
    closes : what the button says that shows how it closes.
    fields : in the order of the page.
    start : see the glossary.
    """

    name: str
    title: str
    closes: str
    fields: tuple[Field, ...]
    start: Mapping[str, Any]

    @property
    def said(self) -> Mapping[str, Any]:
        """See the glossary."""
        return kind_of(self.name)[1]

    def answer(self) -> dict[str, Any]:
        """As the page is told."""
        toolkit = toolkit_of(self.name, self.start)
        types = {one.name: arrangement_words(one, toolkit) for one in toolkit.arrangements}
        return {
            "name": self.name,
            "kind": toolkit.kind,
            "title": self.title,
            "noun": self.name if self.said else toolkit.noun,
            "mover": toolkit.moving.noun,
            "locked": toolkit.locked,
            "closes": self.closes,
            "said": dict(self.said),
            "start": dict(self.start),
            "types": [{"name": name, "words": words} for name, words in types.items()],
            "fields": [asdict(field) for field in self.fields],
        }


def pair_words(one: str, other: str) -> str:
    """What a pair of directions is called.

    >>> pair_words("-x", "-y"), pair_words("-x", "-x"), pair_words("-x", "+x")
    ('to the left and downward', 'both to the left', 'against each other, to the left and right')
    """
    if one == other:
        return f"both {TOWARDS[one]}"
    against = "against each other, " if one[1] == other[1] else ""
    return f"{against}{TOWARDS[one]} and {TOWARDS[other].removeprefix('to the ') if against else TOWARDS[other]}"


PITCH = Field("pitch", "Pitch", "pitch", is_usual=True)
PEG = Field("peg_radius", "Peg radius", "length", is_usual=True, least="0")
ROWS = Field("rows", "Rows a jaw", "count", "as needed")
FLAT = Field("flat", "Centre to flat", "length", "round, no flat", least="0")
VISE = (
    PITCH,
    Field("columns", "Columns a jaw", "count", is_usual=True),
    PEG,
    ROWS,
    Field("row_offset", "Row offset", "length", "0", least="any"),
    Field("min_gap", "Smallest gap", "length", "pitch x", least="0"),
    Field("max_opening", "Largest opening", "length", "no limit"),
    Field("body_radius", "Shoulder radius", "length", "peg radius", least="0"),
    Field("blocked", "Blocked holes", "holes", "L-B3, R-A"),
    FLAT,
)
GRIPPER = tuple(field for field in VISE if field.name != "columns")
TRAVEL = Field("travel", "Stroke", "span", "any", least="0")
TIP = Field("clamp_radius", "Clamp tip radius", "length", "as a locator", least="0")
WAYS = tuple(Choice(way, TOWARDS[way]) for way in DIRECTIONS)
# Half a turn of the plate makes the others of these.
DISTINCT = (("-x", "-y"), ("-x", "+y"), ("-x", "-x"), ("-y", "-y"), ("-x", "+x"), ("-y", "+y"))
CLAMPS = Field(
    "clamps", "Clamps", "one", "1", is_usual=True, choices=(Choice(1, "one"), Choice(2, "two, needed together"))
)
# On a fence, which turns with the plate, all pairs differ.
ALL_PAIRS = tuple(Choice([*two], pair_words(*two)) for two in combinations_with_replacement(DIRECTIONS, 2))
PAIRS = tuple(Choice([one, other], pair_words(one, other)) for one, other in DISTINCT)
PLATE = (
    PITCH,
    Field("columns", "Columns", "count", "as needed", is_usual=True),
    Field("rows", "Rows", "count", "as needed", is_usual=True),
    Field("peg_radius", "Locator radius", "length", is_usual=True, least="0"),
    TIP,
    TRAVEL,
    CLAMPS,
    Field("directions", "The clamp pushes", "several", "all that differ", choices=WAYS, when={"clamps": 1}),
    Field("directions", "The clamps push", "several", "across each other", choices=PAIRS, when={"clamps": 2}),
    FLAT,
)
FENCE = (
    *PLATE[:4],
    Field("wall_offset", "Fence to row 1", "length", is_usual=True),
    TIP,
    TRAVEL,
    CLAMPS,
    Field("directions", "The clamp pushes", "several", "any way", choices=WAYS, when={"clamps": 1}),
    Field("directions", "The clamps push", "several", "down and aside", choices=ALL_PAIRS, when={"clamps": 2}),
    FLAT,
)
IN_JAWS = {"pitch": [10.0, 10.0], "columns": 2, "peg_radius": 3.0}

DESCRIBED = (
    Described(
        "translating-clamp",
        "Plate with one clamp or two",
        "Close clamp",
        PLATE,
        {"pitch": [20.0, 20.0], "peg_radius": 3.0, "clamps": 1},
    ),
    Described(
        "edge",
        "Fence with a stop, one clamp or two",
        "Close clamp",
        FENCE,
        {"pitch": [20.0, 20.0], "peg_radius": 3.0, "wall_offset": 10.0, "clamps": 1},
    ),
    Described("vise", "Vise, pegs on both jaws", "Close vise", VISE, IN_JAWS),
    Described("opening-vise", "Vise that holds by opening", "Open vise", VISE, IN_JAWS),
    Described("gripper", "Gripper, one column a jaw", "Close gripper", GRIPPER, {**IN_JAWS, "columns": 1}),
)


def kinds_answer() -> list[dict[str, Any]]:
    """All kinds, as the page is told."""
    return [one.answer() for one in DESCRIBED]


def page_kind(loaded: LoadedToolkit) -> str:
    """The name under which the page shows a toolkit: of those that say some of its fields, the one that says most."""
    fits = [
        one for one in DESCRIBED if kind_of(one.name)[0] == loaded.kind and one.said.items() <= loaded.fields.items()
    ]
    return max(fits, key=lambda one: len(one.said)).name
