"""Options of a search: what is ruled out, loads, what makes a fixture good, and whether the part seats.

A load is typed as ``--load "force=200 at=10,5 direction=30..60"``.
"""

from __future__ import annotations

import shlex
from math import isfinite
from typing import TYPE_CHECKING, Any

from attrs import evolve, frozen

from workhold.cli.commands import flag, option
from workhold.cli.values import (
    length,
    length_from_zero,
    number,
    optional_count,
    optional_force,
    optional_length,
    optional_positive_length,
    whole_number,
)
from workhold.errors import InputError
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.requirements import Load, Restrictions, Tolerance, Zone
    from workhold.model.workpiece import Workpiece

__all__ = [
    "FRICTION",
    "JAW",
    "JAW_FORCE",
    "LOAD",
    "LOADS_FILE",
    "QueryWords",
    "SeatingWords",
    "asked_loads",
    "parse_load",
    "with_fit_of",
]

LOAD_HELP = (
    "A load on the part, such as 'force=200 at=10,5 direction=30..60', in N, degrees and part coordinates; "
    "path=X,Y;X,Y for a cutter's path, any direction if none is given, moment=5000 in N mm. May be repeated."
)


def parse_load(text: str, unit_scale: float = 1.0) -> Load:
    """A load from the text of ``--load``.

    Parameters
    ----------
    text : words key=value, see ``files.loads_file``; a value with spaces stands in quotes.
    unit_scale : millimetres in one unit of length.

    Examples
    --------
    >>> parse_load("force=150 path=0,0;40,0;40,20").points
    ((0.0, 0.0), (40.0, 0.0), (40.0, 20.0))
    """
    place = f'--load "{text}"'
    from workhold.files.loads_file import load_from_words

    try:
        words = shlex.split(text)
    except ValueError:
        raise InputError(f"{place} has a quote that is not closed: close it.") from None
    values: dict[str, str] = {}
    for word in words:
        key, equals, value = word.partition("=")
        if not equals:
            raise InputError(
                f"{place} cannot be used at '{word}': give words like force=200 at=10,5 direction=30..60, "
                "without spaces inside a value."
            )
        if key in values:
            raise InputError(f"{place} has {key} twice: give it once, and another --load for another load.")
        values[key] = value
    return load_from_words(values, place, unit_scale)


RULING_OUT, LOADS, RANKING = "Ruling out", "Loads", "Ranking"


LOAD = option(LOADS, "LOAD", LOAD_HELP)
LOADS_FILE = option(LOADS, "FILE", "Loads from a TOML file.")
JAW_FORCE = option(
    LOADS,
    "FORCE",
    "Force that closes the vise, or of the clamp, in N or with its unit (3kN, 700lbf), of two clamps the "
    "sum of theirs; the one needed so that no peg lets go if not given.",
)
JAW = option(
    LOADS,
    "KIND",
    "screw: the closed jaw is locked, as a vise's is; constant: it keeps its force (hydraulic, pneumatic); "
    "or how many times as stiff as one contact the locked jaw is.",
    default="screw",
)
FRICTION = option(
    LOADS, "MU", "Coefficient of friction, to report what friction could add; none counts elsewhere."
)


@frozen
class QueryWords:
    """The options of what is asked for, as typed; None for those not given."""

    avoid: list[str] | None = option(
        RULING_OUT, "FACES", "Faces that no peg may touch, such as 3,7 (see workhold features)."
    )
    not_on_faces_cut_in: str | None = option(
        RULING_OUT,
        "FILE",
        "Of a solid's second side: the result of the first, whose faces to avoid were cut there; they are "
        "avoided here, too.",
    )
    touch: list[str] | None = option(
        RULING_OUT, "FACES", "Faces that every fixture must touch, such as 3,7; not with two clamps."
    )
    max_location_error: str | None = option(
        RULING_OUT, "LENGTH", "List only fixtures whose location error is at most this."
    )
    keep_out: list[str] | None = option(
        RULING_OUT,
        "ZONE",
        "Where no peg may stand, in the drawing's coordinates: circle=X,Y,RADIUS or polygon=X,Y;X,Y;X,Y. "
        "May be repeated.",
    )
    angle: list[str] | None = option(
        RULING_OUT, "FROM..TO", "Angles the part may lie at, in degrees: -10..10. May be repeated."
    )
    contact_margin: str = option(
        RULING_OUT, "LENGTH", "Smallest distance from a contact to the end of its face.", default="0"
    )
    load: list[str] | None = LOAD
    loads: str | None = LOADS_FILE
    jaw_force: str | None = option(
        LOADS,
        "FORCE",
        "Force that closes the vise, or of the clamp, in N or with its unit (3kN, 700lbf), of two clamps "
        "the sum of theirs, to warn of pegs that let go under the loads.",
    )
    rank_by: str | None = option(
        RANKING,
        "FIGURES",
        "What makes a fixture good, the first counting most, such as penalty,tilt, instead of the usual "
        "order: no warning; location error in steps of a tenth, more where the part is turned, hangs over or "
        "is held from inside a hole; as drawn; then warnings, penalty, clamp-amplification (or "
        "load-reaction), closure-margin, edge-distance. Also location-error, tilt, smallest-face, "
        "wrench-radius, end-distance, jaw-force-needed, with a program program-clearance, and of two clamps "
        "clamp-freedom.",
    )
    prefer: str | None = option(
        RANKING,
        "square|strong|precise|roomy",
        "Instead of --rank-by, what you want most: the part square to the jaws, gentle pegs, the best "
        "location, or contacts far from edges and from the program's tools.",
    )
    tolerance: str | None = option(
        RANKING,
        "PEG[,FACE]",
        "How far pegs and faces may be off, for the location error; 0.01mm if neither this nor --vise says.",
    )

    def asked(self, unit: Unit, has_program: bool = False, has_forces: bool = False) -> dict[str, Any]:
        """Keyword arguments of a query; the tolerance is None where none was typed.

        Parameters
        ----------
        has_program : whether fixtures are to let a program pass.
        has_forces : whether its tools press on the part.

        Raises
        ------
        InputError
            For words that mean nothing, figures that are not known, and a file that cannot be used.
        """
        from workhold.model.quality import asked_ranking
        from workhold.model.requirements import Restrictions

        loads = asked_loads(self.load, self.loads, unit)
        names = None if self.rank_by is None else [word for word in self.rank_by.split(",") if word.strip()]
        return {
            "contact_margin": length_from_zero("--contact-margin", self.contact_margin, unit),
            "restrictions": Restrictions(
                avoid=tuple(
                    whole_number("--avoid", word) for words in self.avoid or () for word in words.split(",")
                ),
                zones=tuple(zone(text, unit) for text in self.keep_out or ()),
                angles=tuple(angles(text) for text in self.angle or ()),
                touch=tuple(
                    whole_number("--touch", word) for words in self.touch or () for word in words.split(",")
                ),
            ),
            "max_location_error": optional_length("--max-location-error", self.max_location_error, unit),
            "rank_by": asked_ranking(names, self.prefer, bool(loads) or has_forces, has_program),
            "tolerance": asked_tolerance(self.tolerance, unit),
            "loads": loads,
            "jaw_force": optional_force("--jaw-force", self.jaw_force),
        }


def without_faces_cut(restrictions: Restrictions, workpiece: Workpiece, before: str | None) -> Restrictions:
    """Restrictions that also avoid what another set-up of the same solid avoided, because it was cut there.

    ``before`` is the result file of the other set-up. Refuses parts whose faces have no numbers of a solid.
    """
    if before is None:
        return restrictions
    from workhold.files.result.reader import read_result

    query = read_result(before).query
    own, other = workpiece.solid, query.workpiece.solid
    if own is None or other is None or not (own.faces and other.faces):
        lacking = "PART" if own is None else before
        raise InputError(
            f"--not-on-faces-cut-in needs the faces of one solid in both, and {lacking} has none: read both "
            "from the STEP file, with --peg-height."
        )
    cut = query.workpiece.numbered.faces_over(query.restrictions.avoid)
    avoid = workpiece.numbered.segments_under(cut)
    return evolve(restrictions, avoid=(*restrictions.avoid, *avoid))


def zone(text: str, unit: Unit) -> Zone:
    """A keep-out zone from words such as ``circle=10,5,8`` or ``polygon=0,0;10,0;10,8``."""
    from workhold.model.requirements import circle_zone, polygon_zone

    kind, _, rest = text.partition("=")
    points = [
        [length("--keep-out", word, unit) for word in words.split(",")]
        for words in rest.split(";")
        if words.strip()
    ]
    kind = kind.strip().lower()
    if kind == "circle" and len(points) == 1 and len(points[0]) == 3:
        return circle_zone(*points[0])
    if kind == "polygon" and all(len(point) == 2 for point in points):
        return polygon_zone(points)
    raise InputError(f"--keep-out {text!r} is no zone: give circle=X,Y,RADIUS or polygon=X,Y;X,Y;X,Y.")


def angles(text: str) -> tuple[float, float]:
    """A range of angles in degrees from words such as ``-10..10``; a single number is that angle alone."""
    low, dots, high = text.partition("..")
    least, most = (number(word.strip()) for word in ((low, high) if dots else (low, low)))
    if not (isfinite(least) and isfinite(most)):
        raise InputError(f"--angle {text!r} is no range of angles: give it in degrees, such as -10..10.")
    return least, most


def asked_tolerance(text: str | None, unit: Unit) -> Tolerance | None:
    from workhold.model.requirements import Tolerance

    if text is None:
        return None
    words = text.split(",")
    if len(words) > 2:
        raise InputError(
            f"--tolerance {text!r} has {len(words)} numbers: give one for pegs and faces, or PEG,FACE."
        )
    lengths = [length("--tolerance", word, unit) for word in words]
    return Tolerance(lengths[0], lengths[-1])


def with_fit_of(asked: Tolerance | None, named: Tolerance | None) -> Tolerance | None:
    """Returns the tolerance asked for, or that of a named vise; keeps the fit of the named vise's dowels."""
    if asked is None or named is None:
        return asked or named
    return evolve(asked, fit=named.fit)


def asked_loads(loads: list[str] | None, file: str | None, unit: Unit) -> tuple[Load, ...]:
    if not loads and file is None:
        return ()
    from workhold.files.loads_file import read_loads

    typed = tuple(parse_load(text, unit.millimetres) for text in loads or ())
    return typed + (() if file is None else read_loads(file, unit.millimetres))


SEATING = "Seating"


@frozen
class SeatingWords:
    """The options of seating, as typed; None for those not given."""

    seating: str | None = option(
        SEATING,
        "K",
        "Of the first K fixtures report from how far open, or with the clamp how far drawn back, the part is "
        "caught and where else it can rest, and order them by that too (see workhold seat).",
    )
    opening: str | None = option(
        SEATING,
        "LENGTH",
        "List only those of them that catch the part with the jaws open, or the clamp drawn back, by so "
        "much more than where they hold it; places beyond it do not count.",
    )
    foolproof: bool = flag(
        SEATING,
        "List only those of them that have no wrong place to rest in, or a caliper shows each.",
        "--foolproof",
    )

    def asked(self, unit: Unit) -> dict[str, Any]:
        """Keyword arguments of a query.

        Raises
        ------
        InputError
            For words that are no number or length, and for rules of seating where that is not asked for.
        """
        count = optional_count("--seating", self.seating)
        opening = optional_positive_length("--opening", self.opening, unit)
        if count is None and (opening is not None or self.foolproof):
            raise InputError(
                "--opening and --foolproof need --seating K: of how many fixtures, the first, to look at it."
            )
        return {"seating": count, "opening": opening, "foolproof": self.foolproof}
