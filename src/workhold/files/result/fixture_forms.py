"""The forms of a fixture and of its seating in a result file, as models of pydantic.

A seating is checked by its form, and then made an object of the model. The form of a whole file, fixtures
included, serves its JSON Schema only: a million fixtures are collected into arrays (``files.result.reader``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Annotated, Any, Literal

from attrs import evolve
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from workhold.errors import InputError
from workhold.files.result.bending_forms import BendingPart
from workhold.files.result.forms import FormPart, Head, Pair, describe_first_fault
from workhold.files.result.holds import HoldPart
from workhold.files.result.strapped import StrappedSeatPart
from workhold.model.pose import Pose
from workhold.model.quality import SEATING_FIGURES
from workhold.model.result import Result
from workhold.model.seating import Seating

__all__ = [
    "FixturePart",
    "ResultFile",
    "SeatingPart",
    "check_seating",
    "collect_seating_figures",
    "read_head_seatings",
    "add_seatings",
]

SeatingPair = Annotated[list[float], Field(min_length=2, max_length=2)]
Length = Annotated[float, Field(ge=0)]
Peg = Annotated[int, Field(ge=0, le=3)]


class SeatingKeys(BaseModel):
    """The base of the forms of a seating: required keys; further keys are allowed."""

    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class SeatPosePart(SeatingKeys):
    """Pose of the part, as drawn or turned over; lengths in mm."""

    theta_deg: float
    x: float
    y: float


class SeatContactPart(SeatingKeys):
    """A peg, counted from 0, on a face, or on the corner where a face begins."""

    peg: Peg
    face: Annotated[int, Field(ge=0)] | None = None
    corner: Annotated[int, Field(ge=0)] | None = None

    @model_validator(mode="after")
    def one_of_both(self) -> SeatContactPart:
        """Return the contact; raise ValueError unless it has either a face or a corner."""
        if (self.face is None) == (self.corner is None):
            raise ValueError("a contact is on a face or on a corner")
        return self


class SeatPart(SeatingKeys):
    """A pose in which the part comes to rest when the vise is closed."""

    kind: Literal["fixture", "corner", "pocket", "curved", "loose", "unsettled"]
    pose: SeatPosePart
    jaw_separation: float
    difference: float = Field(description="of the jaw separation from the fixture's")
    mirrored: bool = Field(description="turned over: x to -x in the part's own frame")
    same_place: bool = Field(description="whether the silhouette is that of the fixture's pose")
    contacts: list[SeatContactPart] = Field(max_length=4)
    forces: list[float] = Field(max_length=4)
    depth: Length | None = Field(
        default=None, description="how far the jaws open before the part gets elsewhere"
    )


class PassPart(SeatingKeys):
    """The pose through which the part first gets out when the cage opens."""

    pose: SeatPosePart
    jaw_separation: float
    contacts: list[SeatContactPart] = Field(min_length=2, max_length=4)


class CagePart(SeatingKeys):
    """Extremes of the poses in the cage, relative to the fixture's pose."""

    theta_deg: SeatingPair
    x: SeatingPair
    y: SeatingPair


class CageShortPart(SeatingKeys):
    """Upper bounds of how far the true extremes of a cage exceed the computed ones."""

    theta_deg: Length
    share: Length = Field(description="of shifts, of their whole range")


class SeatingPart(SeatingKeys):
    """Figures and seats of a fixture's seating; see docs/seating.md."""

    capture_opening: Length | None
    drop_room: Length | None
    room_factor: Annotated[float, Field(gt=0)]
    pass_: PassPart | None = Field(alias="pass")
    way_out: Length | None
    cage: CagePart | None
    cage_short: CageShortPart | None = None
    placing: Length | None
    sticking_friction: Length | None
    stop: float | None
    seats: list[SeatPart]
    wrong_seats: Annotated[int, Field(ge=0)]
    reading: Length | None
    unsettled: list[str]


def check_seating(data: Any, pose: Pose, path: Path, number: int) -> Seating:
    """Return the seating of a fixture from its JSON object, after checking it.

    Parameters
    ----------
    pose : pose of the fixture.
    number : number of the fixture, counted from 1, for messages.

    Raises
    ------
    InputError
        Naming the first key that is missing or cannot be used.
    """
    try:
        part = SeatingPart.model_validate(data)
    except ValidationError as error:
        key, reason = describe_first_fault(error)
        key = ".".join(filter(None, ("seating", key)))
        raise InputError(f"{path}: fixture {number} cannot be used: {key}: {reason}.") from error
    # What the form lets be left out has its default there.
    return Seating.from_fields(part.model_dump(by_alias=True), pose)


def add_seatings(result: Result, seating: Sequence[Seating], path: Path) -> Result:
    """Return a result with the seating of its first fixtures.

    Raises InputError if there are more seatings than the query asks for, or than there are fixtures.
    """
    query = result.query
    if len(seating) > (query.seating or 0) or len(seating) > len(result):
        raise InputError(
            f"{path}: the seating of {len(seating)} fixtures is stated, but it is asked of "
            f"{query.seating or 0} and {len(result)} are listed."
        )
    return evolve(result, seating=tuple(one.with_toolkit(query.toolkit, query.opening) for one in seating))


def collect_seating_figures(data: Mapping[str, Any]) -> dict[str, float]:
    """Return the figures of a seating by key, from its JSON object in a file of this program.

    A figure that is null in the file is inf here (unbounded).
    """
    figures = {figure.key: data[figure.key] for figure in SEATING_FIGURES}
    # Without a pass it is not known how near a part must be put.
    figures["placing"] = (
        0.0 if data["pass"] is None and data["capture_opening"] is not None else figures["placing"]
    )
    return {key: inf if value is None else float(value) for key, value in figures.items()}


def read_head_seatings(data: dict[str, Any], path: Path) -> list[Any]:
    """Return the seatings of the first fixtures, as JSON
    objects, from the head of a file in columns; [] without any.

    Raises
    ------
    InputError
        When it is not a list.
    """
    seatings = data.get("seatings", [])
    if not isinstance(seatings, list):
        raise InputError(f"{path}: seatings cannot be used: it is not a list.")
    return seatings


Whole = Annotated[int, Field(ge=0)]


class ContactPart(FormPart):
    """A peg's centre in mm, the face it touches, and its force per unit of each clamping force."""

    x: float
    y: float
    segment: Whole = Field(description="number of the face that is touched")
    force: float | Pair
    band: Pair | None = Field(None, description="heights at which it may press on the face")


class JawPegPart(ContactPart):
    """A peg in a hole of a vise's jaw."""

    jaw: Literal["left", "right"]
    column: Whole
    row: Whole


class LocatorPart(ContactPart):
    """A peg in a hole of a plate; the plate stands still or slides with a jaw."""

    role: Literal["locator", "jaw"]
    column: Whole
    row: Whole


class ClampPart(ContactPart):
    """The tip of a clamp, its hole if known, and the row or column along which it pushes."""

    role: Literal["clamp"]
    hole: Annotated[list[Whole], Field(min_length=2, max_length=2)] | None
    row: Whole | None = None
    column: Whole | None = None
    direction: str | None = None


class WallPart(FormPart):
    """The contact with a fence, from one end to the other."""

    from_: Pair = Field(alias="from")
    to: Pair
    segments: Annotated[list[Whole], Field(min_length=2, max_length=2)]
    forces: list[float | Pair]


class PosePart(FormPart):
    """Pose of the workpiece; lengths in mm."""

    theta_deg: float
    x: float
    y: float


class NearestMovePart(FormPart):
    """Nearest approach of the program's tools to the fixture, in mm."""

    distance: float
    line: Whole
    tool: Whole
    element: str


class AskedForcePart(FormPart):
    """A force in N that a program needs, and the contact that limits it."""

    force: float
    line: Whole | None
    tool: Whole | None
    element: str | None


class CuttingNeedPart(FormPart):
    """The jaw force that keeps all contacts pressed throughout the program, and the largest force on one
    contact.
    """

    jaw: AskedForcePart
    contact: AskedForcePart
    jaw_force: float
    room: float | None


class FixturePart(FormPart):
    """One fixture of a list; the best comes first."""

    type: str
    direction: str | None = None
    directions: list[str] | None = None
    wall: WallPart | None = None
    ratio: list[float | None] | None = None
    pegs: list[JawPegPart | LocatorPart | ClampPart] = Field(min_length=2, max_length=5)
    pose: PosePart
    jaw_separation: float | None = None
    flats: list[float | None] | None = Field(
        None, description="which way the flat of each peg looks, in degrees"
    )
    pairs: Whole | None = None
    quality: dict[str, float] = Field(default_factory=dict)
    seating: SeatingPart | None = None
    bending: BendingPart | None = None
    program_clearance: NearestMovePart | None = None
    program_forces: CuttingNeedPart | None = None


class ResultFile(Head):
    """A result file; lengths in mm, angles in degrees."""

    fixtures: list[FixturePart] | list[HoldPart] | list[StrappedSeatPart]
