"""The shapes of requests, checked by pydantic: those of a result file, with limits and without unknown keys."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from attrs import evolve
from pydantic import Field, TypeAdapter

from workhold.asking.declaring import list_declarations
from workhold.asking.search import LOADS, RANKING, RULING_OUT, SEARCH, SEATING, SearchQuestion
from workhold.files.declared_forms import add_declared_fields, collect_given_values
from workhold.files.input_forms import join_forms, make_forms_by_noun, make_optional_entry
from workhold.files.result.forms import LoadPart, RestrictionsPart, TolerancePart
from workhold.fixels.contacts import DIRECTIONS
from workhold.fixels.kinds import USUAL, find_table, make_toolkit
from workhold.fixels.support_hardware import HARDWARE
from workhold.fixels.table import ToolkitField
from workhold.fixels.toolkit import Toolkit
from workhold.limits import MOST_LENGTHS
from workhold.model.quality import read_asked_ranking
from workhold.model.query import Query
from workhold.model.requirements import Load, Tolerance
from workhold.web.program_forms import ProgramForm
from workhold.web.request_forms import (
    LARGEST,
    MOST_LOADS,
    MOST_POINTS,
    MOST_RANGES,
    MOST_VERTICES,
    Form,
    LoopForm,
    Name,
    Number,
    Point,
    WorkpieceForm,
    parse_from_address,
)

__all__ = [
    "ExploreForm",
    "JobForm",
    "LoadsForm",
    "read_loads_in_address",
]


MOST_NAMES, MOST_TOOLKITS = 500, 60
# What a comparison of toolkits asks as well, and what a search in one asks besides.
EVERYWHERE = (RULING_OUT, LOADS, RANKING)
OF_SEARCHES = tuple(
    row for row in list_declarations(SearchQuestion) if row.section in EVERYWHERE or row.name == "listing"
)
OF_ONE = tuple(row for row in list_declarations(SearchQuestion, (SEARCH, SEATING)) if row not in OF_SEARCHES)

DirectionPair = Annotated[list[Name], Field(min_length=2, max_length=2)]


class ToolkitRequest(Form):
    """The fields of a toolkit; lengths in mm."""

    if TYPE_CHECKING:
        kind: str

    def to_toolkit(self) -> Toolkit:
        """Return the toolkit; raise InputError for fields that do not make one."""
        return make_toolkit(self.kind, self.model_dump(exclude={"kind", "title"}))

    def __reduce__(self) -> Any:
        # The forms of kinds are made from their tables, so that another process does not find them by name.
        return restore_form, (isinstance(self, NamedToolkitRequest), self.model_dump())


def restore_form(is_named: bool, said: Mapping[str, Any]) -> ToolkitRequest:
    """Return the form of a toolkit with these fields; called by pickle.

    ``is_named`` says that the form has a title.
    """
    forms = NAMED_FORMS if is_named else FORMS
    form: ToolkitRequest = forms[find_table(said["kind"]).noun](**said)
    return form


class NamedToolkitRequest(ToolkitRequest):
    """A toolkit to compare, with a name for the table."""

    title: Name = ""


TYPES: Mapping[str, Any] = {
    "length": Number,
    "pitch": Point,
    "span": Point,
    "flat": Number | Point,
    "heights": Point,
    "holes": Annotated[list[Name], Field(max_length=MOST_NAMES)],
    "directions": Annotated[list[Name] | list[DirectionPair], Field(max_length=len(DIRECTIONS) ** 2)],
    "lengths": Annotated[list[Number], Field(max_length=MOST_LENGTHS)],
    "choice": Name,
    "force": Number,
}


def make_field_entry(row: ToolkitField) -> tuple[Any, Any]:
    """Return (type, default) of a toolkit's field in a request."""
    return make_optional_entry(
        Annotated[int, Field(ge=1, le=row.most)] if row.form == "count" else TYPES[row.form], row
    )


def make_kind_entry(kinds: tuple[str, ...]) -> tuple[Any, Any]:
    """Return (type, default) of the field "kind", which may be left out where the usual kind is among
    ``kinds``.
    """
    return (Name, USUAL) if USUAL in kinds else (Literal[kinds], ...)


# Figures of supports and of a clamp on top.
RINGS = Annotated[
    list[Annotated[list[Number], Field(min_length=4, max_length=4)]], Field(max_length=MOST_RANGES)
]
FIGURES = Annotated[dict[Name, Number | RINGS | None], Field(max_length=MOST_RANGES)]
HARDWARE_FORMS = dict.fromkeys(HARDWARE, (FIGURES | None, None))
# By the noun of their tables.
FORMS = make_forms_by_noun(
    ToolkitRequest, "{}Form", make_field_entry, make_kind_entry, "{}; lengths in mm.", HARDWARE_FORMS
)
NAMED_FORMS = make_forms_by_noun(
    NamedToolkitRequest,
    "Named{}Form",
    make_field_entry,
    make_kind_entry,
    "{} to compare, with what to call it.",
    HARDWARE_FORMS,
)
if TYPE_CHECKING:
    HeldIn = ToolkitRequest
    NamedHeldIn = NamedToolkitRequest
else:
    HeldIn, NamedHeldIn = join_forms(FORMS), join_forms(NAMED_FORMS)


class RestrictionsForm(Form, RestrictionsPart):
    """Restrictions on the fixtures."""

    avoid: list[Annotated[int, Field(ge=0, le=MOST_VERTICES)]] = Field(default=[], max_length=MOST_VERTICES)
    zones: list[LoopForm] = Field(default=[], max_length=MOST_RANGES)
    angles: list[Point] = Field(default=[], max_length=MOST_RANGES)
    touch: list[Annotated[int, Field(ge=0, le=MOST_VERTICES)]] = Field(default=[], max_length=MOST_VERTICES)


class ToleranceForm(Form, TolerancePart):
    """Tolerances of the positions of pegs and faces, in mm."""

    peg: Number
    face: Number


class LoadForm(Form, LoadPart):
    """A load, in N, mm, degrees and N mm."""

    name: Name = ""
    points: list[Point] = Field(default=[], max_length=MOST_POINTS)
    force: Number = 0.0
    directions: Point = Field(default=[0.0, 360.0])
    moment: Number = 0.0
    upward: Number = 0.0
    height: Number | None = None


class LoadsForm(Form):
    """Loads on a fixture."""

    loads: list[LoadForm] = Field(min_length=1, max_length=MOST_LOADS)
    jaw_force: Annotated[float, Field(ge=0, le=LARGEST)] | None = None
    friction: Annotated[float, Field(ge=0, le=100)] | None = None
    jaw: Literal["screw", "constant"] | Annotated[float, Field(ge=0, le=LARGEST)] = "screw"


SeveralLoads = TypeAdapter(Annotated[list[LoadForm], Field(max_length=MOST_LOADS)])


def read_loads_in_address(text: str | None) -> tuple[Load, ...] | None:
    """Return the loads given as JSON in the query of an address; None for None."""
    if text is None:
        return None
    return tuple(form.to_load() for form in parse_from_address(SeveralLoads, "loads", text))


@add_declared_fields(OF_SEARCHES, LARGEST)
class SearchForm(Form):
    """The common fields of a search in one toolkit and of a comparison of several."""

    workpiece: WorkpieceForm
    types: list[Name] | None = Field(default=None, max_length=10)
    restrictions: RestrictionsForm = RestrictionsForm()
    max_location_error: Annotated[float, Field(gt=0, le=LARGEST)] | None = None
    ranking: list[Name] | None = Field(default=None, max_length=10)
    prefer: Name | None = None
    tolerance: ToleranceForm | None = None
    loads: list[LoadForm] = Field(default=[], max_length=MOST_LOADS)
    program: ProgramForm | None = None
    thickness: Annotated[float, Field(gt=0, le=LARGEST)] | None = Field(
        default=None, description="of a drawn part in mm, for what flat jaws grip"
    )

    def to_query(self, toolkit: Toolkit, most_segments: int) -> Query:
        """Return the query for a toolkit.

        Raises InputError for a part with more than ``most_segments`` segments, and for requirements that the
        toolkit does not support.
        """
        loads = tuple(form.to_load() for form in self.loads)
        workpiece = self.workpiece.to_workpiece(most_segments)
        program, height = (None, None) if self.program is None else self.program.to_program(workpiece.solid)
        is_loaded = bool(loads) or (program is not None and program.forces is not None)
        return Query(
            workpiece,
            toolkit,
            self.types,
            self.restrictions.to_restrictions(),
            read_asked_ranking(self.ranking, self.prefer, is_loaded, program is not None),
            None if self.tolerance is None else self.tolerance.to_tolerance(),
            loads,
            program,
            peg_height=height,
            thickness=self.thickness,
            **collect_given_values(self, OF_SEARCHES) | ({"listing": None} if toolkit.closes_at_once else {}),
        )


@add_declared_fields(OF_ONE, LARGEST)
class JobForm(SearchForm):
    """A search for every fixture or only the best.

    It also has the number of first fixtures whose seating is computed, and the rules of seating.
    """

    toolkit: HeldIn
    every: bool = Field(default=False, description="find all fixtures, even where there are over 200,000")

    def to_queries(self, most_segments: int) -> tuple[tuple[str, Query], ...]:
        """Return a single pair ("", query)."""
        query = self.to_query(self.toolkit.to_toolkit(), most_segments)
        return (("", evolve(query, **collect_given_values(self, OF_ONE))),)


class ExploreForm(SearchForm):
    """A comparison of toolkits; if none are given, of all that come with the program."""

    toolkits: list[NamedHeldIn] | None = Field(default=None, min_length=1, max_length=MOST_TOOLKITS)

    def to_queries(self, most_segments: int) -> tuple[tuple[str, Query], ...]:
        """Return (name of the toolkit, query) for each toolkit, all presets where none are given."""
        from workhold.files.toolkit_file import list_preset_names, load_preset

        if self.toolkits is not None:
            named: list[tuple[str, Toolkit, Tolerance | None]] = [
                (form.title, form.to_toolkit(), None) for form in self.toolkits
            ]
        else:
            named = [(one.name, one.toolkit, one.tolerance) for one in map(load_preset, list_preset_names())]
        asked = self.to_query(named[0][1], most_segments)
        return tuple(
            (
                title,
                evolve(
                    asked,
                    toolkit=toolkit,
                    types=self.types,
                    tolerance=asked.tolerance if self.tolerance else tolerance,
                ),
            )
            for title, toolkit, tolerance in named
        )
