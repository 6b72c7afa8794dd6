"""Options that say what is ruled out, what loads act and what makes a fixture good, shared by the commands that search."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import frozen

from workhold.cli.load_option import LOAD_HELP, parse_load
from workhold.cli.values import length, number, whole_number
from workhold.errors import InputError
from workhold.model.units import Unit

if TYPE_CHECKING:
    from workhold.model.load import Load
    from workhold.model.restrictions import Zone
    from workhold.model.tolerance import Tolerance

__all__ = [
    "AngleOption",
    "AvoidOption",
    "ContactMarginOption",
    "FrictionOption",
    "JawForceOption",
    "KeepOutOption",
    "LoadOption",
    "LoadsOption",
    "RankByOption",
    "QueryWords",
    "ToleranceOption",
    "asked_loads",
]

RULING_OUT, LOADS, RANKING = "Ruling out", "Loads", "Ranking"


def option(panel: str, *names: str, metavar: str, help: str) -> Any:
    """An option of a section of the help."""
    return typer.Option(*names, metavar=metavar, help=help, rich_help_panel=panel)


AvoidOption = Annotated[
    list[str] | None,
    option(RULING_OUT, metavar="FACES", help="Faces that no peg may touch, such as 3,7 (see workhold features)."),
]
KeepOutOption = Annotated[
    list[str] | None,
    option(
        RULING_OUT,
        metavar="ZONE",
        help="Where no peg may stand, in the drawing's coordinates: circle=X,Y,RADIUS or polygon=X,Y;X,Y;X,Y. May be "
        "repeated.",
    ),
]
AngleOption = Annotated[
    list[str] | None,
    option(RULING_OUT, metavar="FROM..TO", help="Angles the part may lie at, in degrees: -10..10. May be repeated."),
]
ContactMarginOption = Annotated[
    str,
    option(RULING_OUT, metavar="LENGTH", help="Smallest distance from a contact to the end of its face."),
]
LoadOption = Annotated[
    list[str] | None,
    option(
        LOADS,
        metavar="LOAD",
        help=LOAD_HELP,
    ),
]
LoadsOption = Annotated[str | None, option(LOADS, metavar="FILE", help="Loads from a TOML file.")]
JawForceOption = Annotated[
    str | None,
    option(
        LOADS,
        metavar="N",
        help="Force in N that closes the vise; the one needed so that no peg lets go if not given.",
    ),
]
FrictionOption = Annotated[
    str | None,
    option(
        LOADS, metavar="MU", help="Coefficient of friction, to tell what friction could add; none counts elsewhere."
    ),
]
RankByOption = Annotated[
    str | None,
    option(
        RANKING,
        metavar="FIGURES",
        help="What makes a fixture good, the first counting most: location-error,clamp-amplification,closure-margin if not "
        "given, with load-reaction in second place if there are loads; also wrench-radius, end-distance.",
    ),
]
ToleranceOption = Annotated[
    str | None,
    option(
        RANKING,
        metavar="PEG[,FACE]",
        help="How far pegs and faces may be off, for the location error; 0.01mm if neither this nor --vise says.",
    ),
]


@frozen
class QueryWords:
    """What was typed about what is asked for; None for options not given."""

    avoid: list[str] | None
    keep_out: list[str] | None
    angle: list[str] | None
    contact_margin: str
    load: list[str] | None
    loads: str | None
    rank_by: str | None
    tolerance: str | None

    def asked(self, unit: Unit) -> dict[str, Any]:
        """Keyword arguments of a query; the tolerance is None where none was typed.

        Raises
        ------
        InputError
            For words that mean nothing, figures that are not known, and a file that cannot be used.
        """
        from workhold.model.query import chosen_ranking
        from workhold.model.restrictions import Restrictions

        loads = asked_loads(self.load, self.loads, unit)
        names = None if self.rank_by is None else [word for word in self.rank_by.split(",") if word.strip()]
        return {
            "contact_margin": asked_contact_margin(self.contact_margin, unit),
            "restrictions": Restrictions(
                avoid=tuple(whole_number("--avoid", word) for words in self.avoid or () for word in words.split(",")),
                zones=tuple(zone(text, unit) for text in self.keep_out or ()),
                angles=tuple(angles(text) for text in self.angle or ()),
            ),
            "ranking": chosen_ranking(names, loads),
            "tolerance": asked_tolerance(self.tolerance, unit),
            "loads": loads,
        }


def zone(text: str, unit: Unit) -> Zone:
    """A keep-out zone from words such as ``circle=10,5,8`` or ``polygon=0,0;10,0;10,8``.

    Raises
    ------
    InputError
        For anything else.
    """
    from workhold.model.restrictions import circle_zone, polygon_zone

    kind, _, rest = text.partition("=")
    points = [
        [length("--keep-out", word, unit) for word in words.split(",")] for words in rest.split(";") if words.strip()
    ]
    kind = kind.strip().lower()
    if kind == "circle" and len(points) == 1 and len(points[0]) == 3:
        return circle_zone(*points[0])
    if kind == "polygon" and all(len(point) == 2 for point in points):
        return polygon_zone(points)
    raise InputError(f"--keep-out {text!r} is no zone: give circle=X,Y,RADIUS or polygon=X,Y;X,Y;X,Y.")


def angles(text: str) -> tuple[float, float]:
    """A range of angles in degrees from words such as ``-10..10``; a single number is that angle alone.

    Raises
    ------
    InputError
        For anything else.
    """
    low, dots, high = text.partition("..")
    least, most = (number(word.strip()) for word in ((low, high) if dots else (low, low)))
    if not (isfinite(least) and isfinite(most)):
        raise InputError(f"--angle {text!r} is no range of angles: give it in degrees, such as -10..10.")
    return least, most


def asked_contact_margin(text: str, unit: Unit) -> float:
    """The contact margin in mm.

    Raises
    ------
    InputError
        For words that are no length, and below zero.
    """
    margin = length("--contact-margin", text, unit)
    if margin < 0:
        raise InputError(f"--contact-margin {text} is negative: give 0 or more.")
    return margin


def asked_tolerance(text: str | None, unit: Unit) -> Tolerance | None:
    """The tolerance asked for; None where none was typed.

    Raises
    ------
    InputError
        For words that are no lengths.
    """
    from workhold.model.tolerance import Tolerance

    if text is None:
        return None
    words = text.split(",")
    if len(words) > 2:
        raise InputError(f"--tolerance {text!r} has {len(words)} numbers: give one for pegs and faces, or PEG,FACE.")
    lengths = [length("--tolerance", word, unit) for word in words]
    return Tolerance(lengths[0], lengths[-1])


def asked_loads(loads: list[str] | None, file: str | None, unit: Unit) -> tuple[Load, ...]:
    """The loads typed and those of a file.

    Raises
    ------
    InputError
        For words that are no load, and a file that cannot be used.
    """
    if not loads and file is None:
        return ()
    from workhold.files.loads_file import read_loads

    typed = tuple(parse_load(text, unit.millimetres) for text in loads or ())
    return typed + (() if file is None else read_loads(file, unit.millimetres))
