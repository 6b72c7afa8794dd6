"""The shape of a result file's head, checked by pydantic, and what its parts are in the model."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from workhold.errors import InputError
from workhold.model.kinds import USUAL, toolkit_of
from workhold.model.load import ANY_DIRECTION, Load
from workhold.model.proof import Proof, Undecided
from workhold.model.query import Query
from workhold.model.restrictions import Restrictions, zone_of
from workhold.model.tolerance import Tolerance
from workhold.model.toolkit import Toolkit
from workhold.model.workpiece import Workpiece

__all__ = ["Head", "ProofPart"]


class Part(BaseModel):
    """What a key of the head must look like; further keys are allowed."""

    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class WorkpiecePart(Part):
    """The workpiece's keys."""

    name: str
    units: Literal["mm"]
    loops: list[list[list[float]]]


class VisePart(Part):
    """The vise's keys."""

    pitch: list[float] = Field(min_length=2, max_length=2)
    columns: int
    peg_radius: float
    rows: int | None = None
    min_gap: float | None = None
    max_opening: float | None = None
    row_offset: float = 0.0
    body_radius: float | None = None
    blocked: list[str] = []


class ToolkitPart(VisePart):
    """The keys of a toolkit that is no vise: its kind, and for now those of the vise."""

    kind: str


class RestrictionsPart(Part):
    """What was ruled out."""

    avoid: list[int] = []
    zones: list[list[list[float]]] = []
    angles: list[list[float]] = []

    def restrictions(self) -> Restrictions:
        """The restrictions.

        Raises
        ------
        InputError
            When a zone or a range of angles is none.
        """
        zones = tuple(zone_of(loop) for loop in self.zones)
        if any(len(pair) != 2 for pair in self.angles):
            raise InputError("a range of angles is not two numbers.")
        return Restrictions(tuple(self.avoid), zones, tuple((pair[0], pair[1]) for pair in self.angles))


class TolerancePart(Part):
    """How far pegs and faces may be off."""

    peg: float
    face: float


class LoadPart(Part):
    """A load."""

    name: str = ""
    points: list[tuple[float, float]] = []
    force: float = 0.0
    directions: tuple[float, float] = ANY_DIRECTION
    moment: float = 0.0

    # JSON has no tuples.
    model_config = ConfigDict(strict=False, allow_inf_nan=False)

    def load(self) -> Load:
        """The load.

        Raises
        ------
        InputError
            When it is none.
        """
        return Load(tuple(self.points), self.force, self.directions, self.moment, self.name)


Counts = dict[str, Annotated[int, Field(ge=0)]]


class UndecidedPart(Part):
    """One entry of the proof's list of what is not decided; columns and rows may be negative."""

    type: str
    segments: list[int] = Field(min_length=4, max_length=4)
    columns: list[int] = Field(min_length=4, max_length=4)
    rows: list[int] = Field(min_length=4, max_length=4)
    theta_deg: float = Field(ge=0, lt=360)
    reason: str = Field(min_length=1)

    def undecided(self) -> Undecided:
        """The entry as the model has it."""
        faces, columns, rows = ((v[0], v[1], v[2], v[3]) for v in (self.segments, self.columns, self.rows))
        return Undecided(self.type, faces, columns, rows, self.theta_deg, self.reason)


class ProofPart(Part):
    """The account of the search."""

    cells: int = Field(ge=0)
    candidates: int = Field(ge=0)
    discarded_by_bound: int = Field(ge=0)
    verified: int = Field(ge=0)
    escalated: int = Field(ge=0)
    undecided: list[UndecidedPart]

    def proof(self) -> Proof:
        """The account as the model has it."""
        counts = (self.cells, self.candidates, self.discarded_by_bound, self.verified, self.escalated)
        return Proof(*counts, tuple(item.undecided() for item in self.undecided))


class Head(Part):
    """Everything in the file but the fixtures."""

    format: Literal["workhold-result/1"]
    workpiece: WorkpiecePart
    vise: VisePart | None = None
    toolkit: ToolkitPart | None = None
    counts: Counts
    contact_margin: float = 0.0
    found: Counts | None = None
    distinct: Counts | None = None
    complete: bool = True
    notes: list[str] = []
    statistics: dict[str, int] = {}
    proof: ProofPart | None = None
    restrictions: RestrictionsPart = RestrictionsPart()
    ranking: list[str] | None = None
    tolerance: TolerancePart | None = None
    loads: list[LoadPart] = []

    def asked_toolkit(self) -> Toolkit:
        """The toolkit.

        Raises
        ------
        InputError
            When there is no such toolkit, none at all, or two.
        """
        if self.vise is not None and self.toolkit is not None:
            raise InputError("it has the keys vise and toolkit, of which only one can be.")
        if self.vise is not None:
            return toolkit_of(USUAL, self.vise.model_dump())
        if self.toolkit is None:
            raise InputError("it is not complete: the key vise is missing.")
        return toolkit_of(self.toolkit.kind, self.toolkit.model_dump(exclude={"kind"}))

    def query(self) -> Query:
        """What was asked.

        Raises
        ------
        InputError
            When a part of it cannot be.
        """
        return Query(
            Workpiece.from_loops(self.workpiece.name, self.workpiece.loops),
            self.asked_toolkit(),
            contact_margin=self.contact_margin,
            restrictions=self.restrictions.restrictions(),
            ranking=["closure_margin"] if self.ranking is None else self.ranking,
            tolerance=None if self.tolerance is None else Tolerance(self.tolerance.peg, self.tolerance.face),
            loads=(part.load() for part in self.loads),
        )
