"""The form of a result file's head, checked by pydantic, and its parts as objects of the model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from attrs import evolve
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from workhold.asking.declaring import list_declarations
from workhold.asking.search import SearchQuestion
from workhold.errors import InputError
from workhold.files.declared_forms import add_declared_fields, collect_given_values
from workhold.files.input_forms import LONGEST_NAME, TAGS, join_forms, make_forms_by_noun, make_optional_entry
from workhold.fixels.kinds import USUAL, find_table, make_toolkit
from workhold.fixels.table import Form, ToolkitField
from workhold.fixels.toolkit import Toolkit
from workhold.model.dowels import DowelFit
from workhold.model.own_outlines import add_own_outlines
from workhold.model.program import Program
from workhold.model.query import Query
from workhold.model.requirements import ANY_DIRECTION, Load, Restrictions, Tolerance, make_zone
from workhold.model.search_report import ProofReport, UndecidedCandidate
from workhold.model.solid import SolidOutline
from workhold.model.workpiece import Workpiece

__all__ = [
    "MISSING",
    "Head",
    "LoadPart",
    "ProofPart",
    "RestrictionsPart",
    "TolerancePart",
    "describe_first_fault",
]

LONGEST_STANDARD = 40
OF_SEARCH = list_declarations(SearchQuestion)
# What is wrong with a key that is not there.
MISSING = "it is missing"
Pair = Annotated[list[float], Field(min_length=2, max_length=2)]


def describe_first_fault(error: ValidationError) -> tuple[str, str]:
    """Return the first wrong key of a file, with points between nested keys, and the fault in words.

    The words have no capital and no full stop; for a missing key they are ``MISSING``.
    """
    first = error.errors()[0]
    key = ".".join(str(part) for part in first["loc"] if part not in TAGS)
    return key, MISSING if first["type"] == "missing" else first["msg"][:1].lower() + first["msg"][1:]


class FormPart(BaseModel):
    """Base of the forms of a head's keys; further keys are allowed."""

    model_config = ConfigDict(strict=True, allow_inf_nan=False)

    def list_keys_not_given(self, place: str = "") -> Iterator[str]:
        """Yield the names of the keys that the file leaves out, of this part and
        of the parts inside it, such as ``vise.rows``.

        ``place`` is put in front of each name.
        """
        for name in type(self).model_fields:
            value: Any = getattr(self, name)
            if name not in self.model_fields_set:
                yield place + name
                continue
            several = value if isinstance(value, list) else [value]
            for number, part in enumerate(several):
                if isinstance(part, FormPart):
                    yield from part.list_keys_not_given(
                        f"{place}{name}." + (f"{number}." if several is value else "")
                    )


class WorkpiecePart(FormPart):
    """Keys of the workpiece."""

    name: str = Field(max_length=LONGEST_NAME)
    units: Literal["mm"]
    loops: list[list[list[float]]]
    departure: float = 0.0
    bands: list[Pair | None] | None = Field(
        None, description="heights at which each segment may be touched; none where it may not"
    )
    runs: list[list[list[float]]] | None = Field(
        None, description="heights that a peg can press on along each segment; empty where they are the band"
    )
    solid_faces: list[list[int]] | None = Field(None, description="faces of the solid over each segment")
    bottom: list[list[list[float]]] | None = Field(
        None, description="loops on which the solid lies; empty where on none"
    )
    top: list[list[list[float]]] | None = Field(
        None, description="loops of what of its upper faces has nothing above; empty of none"
    )
    top_heights: list[float] | None = Field(None, description="height in mm of the face of each of these")
    rising: list[list[list[float]]] | None = Field(
        None, description="loops around what rises above heights of upper faces"
    )
    rising_heights: list[float] | None = Field(None, description="these heights in mm, one for each loop")
    hanging: list[list[list[float]]] | None = Field(
        None, description="loops of what of the upper faces has air between itself and the lying plane"
    )
    hanging_heights: list[float] | None = Field(None, description="height in mm of the face of each of these")
    unclear_heights: list[float] | None = Field(
        None, description="heights in mm of upper faces of which it is not known what is free"
    )
    finished: WorkpiecePart | None = Field(
        None, description="of a raw block, the finished part inside it, in the same coordinates"
    )

    def to_finished(self) -> Workpiece | None:
        """Return the finished part inside a raw block; None if the workpiece is not a raw block."""
        part = self.finished
        if part is None:
            return None
        return Workpiece.from_loops(part.name, part.loops, departure=part.departure)


class SolidPart(FormPart):
    """The position and heights of an outline's solid."""

    axis: str
    height: float
    peg_height: float
    head_room: float
    least_band: float

    def to_outline(self, workpiece: WorkpiecePart) -> SolidOutline:
        """Return the solid with the bands of its outline; raise
        InputError without bands, and for impossible heights.
        """
        if workpiece.bands is None:
            raise InputError("it has a solid, but the workpiece has no bands.")
        return SolidOutline.from_entries(self.model_dump(), workpiece.model_dump())


class OutlinePart(FormPart):
    """The outline of the solid that carriers with heights of their own meet."""

    loops: list[list[list[float]]]
    bands: list[Pair | None]
    runs: list[list[list[float]]] | None = None
    solid_faces: list[list[int]] | None = None


class FlatPart(FormPart):
    """The keys of a flat."""

    distance: float
    half_width: float


TYPES: Mapping[Form, Any] = {
    "count": int,
    "length": float,
    "pitch": Pair,
    "span": Pair,
    "flat": FlatPart,
    "heights": Pair,
    "holes": list[str],
    "directions": list[str | list[str]],
    "lengths": list[float],
    "choice": str,
    "force": float,
}


def make_form_key(row: ToolkitField) -> tuple[Any, Any]:
    """Return (type, default) of a toolkit's field for pydantic."""
    return make_optional_entry(TYPES[row.form], row)


# The usual vise stands in a file without its kind.
PARTS = make_forms_by_noun(FormPart, "{}Part", make_form_key, summary="{}'s keys.")
NAMED = make_forms_by_noun(
    FormPart, "Named{}Part", make_form_key, lambda kinds: (str, ...), "{}'s keys, with its kind."
)
if TYPE_CHECKING:
    from typing import TypeAlias

    VisePart: TypeAlias = Any
    ToolkitPart: TypeAlias = Any
else:
    VisePart, ToolkitPart = PARTS[find_table(USUAL).noun], join_forms(NAMED)


class RestrictionsPart(FormPart):
    """The query's restrictions."""

    avoid: list[int] = []
    zones: list[list[list[float]]] = []
    angles: list[Pair] = []
    touch: list[int] = []

    def to_restrictions(self) -> Restrictions:
        """Return the restrictions as an object of the model."""
        return Restrictions(self.avoid, [*map(make_zone, self.zones)], self.angles, self.touch)


class FitPart(FormPart):
    """The fit of the dowels that are the pegs."""

    pin: Pair
    hole: Pair
    position: float = Field(ge=0)
    position_assumed: bool = False
    standard: str = Field(default="", max_length=LONGEST_STANDARD)

    def to_fit(self) -> DowelFit:
        """Return the fit as an object of the model."""
        (low, high), hole = self.pin, self.hole
        return DowelFit((low, high), (hole[0], hole[1]), self.position, self.position_assumed, self.standard)


class TolerancePart(FormPart):
    """The tolerance: by how much pegs and faces may be out of place, in mm."""

    peg: float
    face: float
    fit: FitPart | None = None
    departure: float = 0.0

    def to_tolerance(self) -> Tolerance:
        """Return the tolerance as an object of the model."""
        return Tolerance(self.peg, self.face, None if self.fit is None else self.fit.to_fit(), self.departure)


class LoadPart(FormPart):
    """A load."""

    name: str = Field("", max_length=LONGEST_NAME)
    points: list[Pair] = []
    force: float = 0.0
    directions: Pair = list(ANY_DIRECTION)
    moment: float = 0.0
    upward: float = 0.0
    height: float | None = None

    def to_load(self) -> Load:
        """Return the load as an object of the model."""
        return Load(
            self.points, self.force, self.directions, self.moment, self.name, self.upward, self.height
        )


Counts = dict[str, Annotated[int, Field(ge=0)]]


class UndecidedPart(FormPart):
    """One entry of the list of candidates that the proof leaves
    undecided; columns and rows may be negative.
    """

    type: str
    segments: list[int] = Field(min_length=3, max_length=5)
    columns: list[int] = Field(min_length=3, max_length=5)
    rows: list[int] = Field(min_length=3, max_length=5)
    theta_deg: float = Field(ge=0, lt=360)
    reach_deg: float | None = Field(default=None, ge=0)
    reason: str = Field(min_length=1)

    def to_undecided(self) -> UndecidedCandidate:
        """Return the candidate as an object of the model."""
        faces, columns, rows = (tuple(v) for v in (self.segments, self.columns, self.rows))
        return UndecidedCandidate(
            self.type, faces, columns, rows, self.theta_deg, self.reason, self.reach_deg
        )


class ProofPart(FormPart):
    """The account of the search: its counts of candidates."""

    cells: int = Field(ge=0)
    candidates: int = Field(ge=0)
    discarded_by_bound: int = Field(ge=0)
    verified: int = Field(ge=0)
    escalated: int = Field(ge=0)
    undecided: list[UndecidedPart]

    def to_proof(self) -> ProofReport:
        """Return the account as an object of the model."""
        counts = (self.cells, self.candidates, self.discarded_by_bound, self.verified, self.escalated)
        return ProofReport(*counts, tuple(item.to_undecided() for item in self.undecided))


class NotePart(FormPart):
    """The data of a note: its kind, and the further keys of that kind."""

    model_config = ConfigDict(extra="allow")

    kind: str


@add_declared_fields(OF_SEARCH, bounded=False)
class Head(FormPart):
    """Everything in the file but the fixtures."""

    format: Literal["workhold-result/1"]
    solid: SolidPart | None = None
    workpiece: WorkpiecePart
    outlines: dict[str, OutlinePart] | None = Field(
        None, description="what carriers with heights of their own meet, numbered on after the workpiece"
    )
    vise: VisePart | None = None
    toolkit: ToolkitPart | None = None
    counts: Counts
    types: list[str] | None = None
    found: Counts | None = None
    distinct: Counts | None = None
    complete: bool = True
    notes: list[str] = []
    note_data: list[NotePart] | None = Field(
        None, description="of each note, in the same order, what it says"
    )
    statistics: dict[str, int] = {}
    proof: ProofPart | None = None
    restrictions: RestrictionsPart = RestrictionsPart()
    ranking: list[str] | None = None
    tolerance: TolerancePart | None = None
    loads: list[LoadPart] = []
    program: dict[str, Any] | None = None
    pairs: Annotated[int, Field(ge=0)] | None = None
    seats: Annotated[int, Field(ge=0)] | None = None
    least_effective_error: Annotated[float, Field(ge=0)] | None = Field(
        None, description="mm, of all that is fit and without warning; from it the steps of the order count"
    )
    bent_by: Literal["clamp_distortion", "give"] | None = Field(
        None, description="the figure of bending by which the fixtures that have it are listed first"
    )

    def to_toolkit(self) -> Toolkit:
        """Return the toolkit; raise InputError for a head with no toolkit, or with two."""
        if self.vise is not None and self.toolkit is not None:
            raise InputError("it has the keys vise and toolkit, of which only one can be.")
        if self.vise is not None:
            return make_toolkit(USUAL, self.vise.model_dump())
        if self.toolkit is None:
            raise InputError("it is not complete: the key vise is missing.")
        return make_toolkit(self.toolkit.kind, self.toolkit.model_dump(exclude={"kind"}))

    def to_query(self) -> Query:
        """Return the query with workpiece and toolkit; raise InputError for an impossible one."""
        toolkit, asked = self.to_toolkit(), collect_given_values(self, OF_SEARCH)
        workpiece = Workpiece.from_loops(
            self.workpiece.name,
            self.workpiece.loops,
            departure=self.workpiece.departure,
            solid=None if self.solid is None else self.solid.to_outline(self.workpiece),
        )
        finished = self.workpiece.to_finished()
        if finished is None and asked["raw"] is not None:
            raise InputError("it has a raw block, but the workpiece has no finished part.")
        workpiece = evolve(workpiece, finished=finished)
        if self.outlines is not None:
            entries = {role: one.model_dump() for role, one in self.outlines.items()}
            workpiece = add_own_outlines(workpiece, entries, toolkit.heights)
        return Query(
            workpiece,
            toolkit,
            self.types,
            restrictions=self.restrictions.to_restrictions(),
            rank_by=["closure_margin"] if self.ranking is None else self.ranking,
            tolerance=None if self.tolerance is None else self.tolerance.to_tolerance(),
            loads=(part.to_load() for part in self.loads),
            program=self.to_program(),
            **asked,
        )

    def to_program(self) -> Program | None:
        """Return the program with which fixtures must not collide,
        None without one; raise InputError for a wrong one.
        """
        if self.program is None:
            return None
        try:
            return Program.from_entries(self.program)
        except (LookupError, TypeError, ValueError, AttributeError) as error:
            raise InputError(f"its program cannot be used: {error}.") from error
