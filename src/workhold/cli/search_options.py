"""Options of a search: restrictions, loads, the ranking, and seating.

A load is typed as ``--load "force=200 at=10,5 direction=30..60"``.
"""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Any

from attrs import evolve, frozen

from workhold.asking.declaring import list_declarations
from workhold.asking.search import LOADS, RANKING, RULING_OUT, SEATING, RestrictionQuestion, SearchQuestion
from workhold.asking.sheet import SheetQuestion
from workhold.cli.commands import make_option
from workhold.cli.declared import (
    make_field_option,
    make_list_attribute,
    make_option_attributes,
    make_word_attribute,
    read_words,
)
from workhold.cli.values import read_length
from workhold.errors import InputError
from workhold.units import Unit

if TYPE_CHECKING:
    from workhold.model.requirements import Load, Restrictions, Tolerance
    from workhold.model.workpiece import Workpiece

__all__ = [
    "FRICTION",
    "JAW_FORCE",
    "LOAD",
    "LOADS_FILE",
    "LoadOptions",
    "QueryOptions",
    "SeatingOptions",
    "read_asked_loads",
    "parse_load",
    "add_dowel_fit",
]

LOAD_HELP = (
    "A load on the part, such as 'force=200 at=10,5 direction=30..60', in N, degrees and part coordinates; "
    "path=X,Y;X,Y for a cutter's path, any direction if none is given, moment=5000 in N mm. May be repeated."
)


def parse_load(text: str, unit_scale: float = 1.0) -> Load:
    """Return a load from the text of ``--load``.

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
    from workhold.files.loads_file import parse_load

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
    return parse_load(values, place, unit_scale)


LOAD = make_option(LOADS, "LOAD", LOAD_HELP)
LOADS_FILE = make_option(LOADS, "FILE", "TOML file with loads.")
# Of loads on a fixture that is known, as its sheet has them.
OF_LOADS = list_declarations(SheetQuestion, [LOADS])
JAW_FORCE, FRICTION = (make_field_option(row) for row in OF_LOADS if row.name in ("jaw_force", "friction"))
LOADS_TYPED = {"load": make_list_attribute(LOAD), "loads": make_word_attribute(LOADS_FILE)}


@frozen(these=make_option_attributes(OF_LOADS, jaw_force=LOADS_TYPED))
class LoadOptions:
    """The options of loads on a given fixture, as typed; None for those not given."""

    if TYPE_CHECKING:
        load: list[str] | None
        loads: str | None

    def read_arguments(self, unit: Unit) -> dict[str, Any]:
        """Return "jaw_force" in N, "jaw" (its stiffness), "friction" and "loads" as keyword arguments.

        Force and friction are None where not given.
        """
        from workhold.statics.loads import read_jaw_stiffness

        asked = read_words(OF_LOADS, self, unit)
        asked["jaw"] = read_jaw_stiffness(asked["jaw"])
        return asked | {"loads": read_asked_loads(self.load, self.loads, unit)}


# What a search in one toolkit and a comparison of several both ask; beside these fields stand options that are not fields.
OF_RESTRICTIONS = list_declarations(RestrictionQuestion)
OF_SEARCHES = list_declarations(SearchQuestion, (RULING_OUT, LOADS, RANKING))
OF_SEATING = list_declarations(SearchQuestion, (SEATING,))
BESIDE = {
    "zones": {
        "not_on_faces_cut_in": make_word_attribute(
            make_option(
                RULING_OUT,
                "FILE",
                "For a solid's second side: the result of the first. Faces that the first set-up avoids, "
                "because it cuts them, are avoided here too.",
            )
        )
    },
    "jaw_force": LOADS_TYPED,
    "rank_by": make_word_attribute(
        make_option(
            RANKING,
            "FIGURES",
            "Figures that order the fixtures, the first counting most, such as penalty,tilt, instead "
            "of the usual order: no warning; location error in steps of a tenth, more where the part "
            "is turned, hangs over or is held from inside a hole; as drawn; then warnings, penalty, "
            "clamp-amplification (or load-reaction), closure-margin, edge-distance. Further figures "
            "are location-error, tilt, smallest-face, wrench-radius, end-distance, jaw-force-needed, "
            "with a program program-clearance, and for two clamps clamp-freedom.",
        )
    ),
    "prefer": make_word_attribute(
        make_option(
            RANKING,
            "square|strong|precise|roomy",
            "What you want most, instead of --rank-by: the part square to the jaws, gentle pegs, the "
            "best location, or contacts far from edges and from the program's tools.",
        )
    ),
    "tolerance": make_word_attribute(
        make_option(
            RANKING,
            "PEG[,FACE]",
            "Largest errors of pegs and faces, for the location error; 0.01mm if neither this nor "
            "--vise gives one.",
        )
    ),
}


@frozen(these=make_option_attributes((*OF_RESTRICTIONS, *OF_SEARCHES), **BESIDE))
class QueryOptions:
    """The options that describe the wanted fixtures, as typed; None for those not given."""

    if TYPE_CHECKING:
        not_on_faces_cut_in: str | None
        load: list[str] | None
        loads: str | None
        rank_by: str | None
        prefer: str | None
        tolerance: str | None

    def read_arguments(
        self, unit: Unit, has_program: bool = False, has_forces: bool = False
    ) -> dict[str, Any]:
        """Return keyword arguments of a query, with lengths in mm; the tolerance is None where none was
        typed.

        Parameters
        ----------
        has_program : whether the tools of a program must clear the fixtures.
        has_forces : whether forces of its tools on the part are known.

        Raises
        ------
        InputError
            For words that cannot be read, figures that are not known, and a file that cannot be used.
        """
        from workhold.model.quality import read_asked_ranking
        from workhold.model.requirements import Restrictions

        loads = read_asked_loads(self.load, self.loads, unit)
        names = None if self.rank_by is None else [word for word in self.rank_by.split(",") if word.strip()]
        return read_words(OF_SEARCHES, self, unit) | {
            "restrictions": Restrictions(**read_words(OF_RESTRICTIONS, self, unit)),
            "rank_by": read_asked_ranking(names, self.prefer, bool(loads) or has_forces, has_program),
            "tolerance": read_tolerance(self.tolerance, unit),
            "loads": loads,
        }


def avoid_faces_cut_before(
    restrictions: Restrictions, workpiece: Workpiece, before: str | None
) -> Restrictions:
    """Return restrictions that also avoid the solid's faces that the previous set-up cut (and so had to
    avoid).

    ``before`` is the result file of the previous set-up; for None the restrictions are returned unchanged.
    Raises InputError for parts without a solid's face numbers.
    """
    if before is None:
        return restrictions
    from workhold.files.result.reader import read_result

    query = read_result(before).query
    own, other = workpiece.solid, query.workpiece.solid
    if own is None or other is None or not (own.faces and other.faces):
        lacking = "PART" if own is None else before
        raise InputError(
            f"--not-on-faces-cut-in needs the faces of the same solid in both set-ups, and {lacking} "
            "has none: read both from the STEP file, with --peg-height."
        )
    cut = query.workpiece.numbered.list_faces_over(query.restrictions.avoid)
    avoid = workpiece.numbered.list_segments_under(cut)
    return evolve(restrictions, avoid=(*restrictions.avoid, *avoid))


def read_tolerance(text: str | None, unit: Unit) -> Tolerance | None:
    """Return the tolerance in ``unit`` from "PEG" (for pegs and faces) or "PEG,FACE"; None for None."""
    from workhold.model.requirements import Tolerance

    if text is None:
        return None
    words = text.split(",")
    if len(words) > 2:
        raise InputError(
            f"--tolerance {text!r} has {len(words)} numbers: give one for pegs and faces, or PEG,FACE."
        )
    lengths = [read_length("--tolerance", word, unit) for word in words]
    return Tolerance(lengths[0], lengths[-1])


def add_dowel_fit(asked: Tolerance | None, named: Tolerance | None) -> Tolerance | None:
    """Return the tolerance asked for, with the dowels' fit of the named toolkit's tolerance.

    Where one of the two is None, the other is returned.
    """
    if asked is None or named is None:
        return asked or named
    return evolve(asked, fit=named.fit)


def read_asked_loads(loads: list[str] | None, file: str | None, unit: Unit) -> tuple[Load, ...]:
    """Return the loads typed, then the loads in the file; lengths that carry no unit are in ``unit``."""
    if not loads and file is None:
        return ()
    from workhold.files.loads_file import read_loads

    typed = tuple(parse_load(text, unit.millimetres) for text in loads or ())
    return typed + (() if file is None else read_loads(file, unit.millimetres))


@frozen(these=make_option_attributes(OF_SEATING))
class SeatingOptions:
    """The options of seating, as typed; None for those not given."""

    def read_arguments(self, unit: Unit) -> dict[str, Any]:
        """Return the keyword arguments of a query that ask for seating, lengths in mm.

        Raises
        ------
        InputError
            For words that are not a number or length, and for rules of seating where seating is not asked for.
        """
        asked = read_words(OF_SEATING, self, unit)
        if asked["seating"] is None and any(asked.values()):
            raise InputError(
                "--opening and --foolproof need --seating K: the number of first fixtures to check."
            )
        return asked
