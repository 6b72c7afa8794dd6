"""Requests that send a part or ask for supports, checked by pydantic, and the base of all requests.

A part is sent as an outline or a solid, with outlines of carriers' own heights. Lengths are in mm.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from workhold.errors import InputError
from workhold.files.declared_forms import add_declared_fields
from workhold.files.input_forms import TAGS
from workhold.fixels.support_hardware import CLAMP, PADS
from workhold.model.own_outlines import add_own_outlines
from workhold.model.solid import SolidOutline
from workhold.model.support_request import SpatialLoad
from workhold.model.workpiece import Workpiece

if TYPE_CHECKING:
    from workhold.web.worker import TaskContext

__all__ = [
    "LARGEST",
    "AddressForm",
    "MOST_LOADS",
    "MOST_POINTS",
    "MOST_RANGES",
    "MOST_VERTICES",
    "OF_HARDWARE",
    "BandForm",
    "ChosenSupportsForm",
    "FirstSideForm",
    "Form",
    "LoopForm",
    "Name",
    "Number",
    "Point",
    "SpatialLoadForm",
    "SupportsForm",
    "WorkpieceForm",
    "read_heights_in_address",
    "read_form_in_address",
    "check_body",
    "make_checked_part",
    "parse_from_address",
    "explain_request_error",
]

Asked = TypeVar("Asked")

# Beyond this, in mm, degrees, N or N mm, a number is a mistake.
LARGEST = 1e9
MOST_VERTICES, MOST_LOADS, MOST_POINTS, MOST_RANGES = 20_000, 50, 500, 50

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Point = Annotated[list[Number], Field(min_length=2, max_length=2)]
Vertex = Annotated[list[Number], Field(min_length=3, max_length=3)]
LoopForm = Annotated[list[Vertex], Field(min_length=1, max_length=MOST_VERTICES)]
BandForm = Annotated[list[Annotated[float, Field(ge=0, le=LARGEST)]], Field(min_length=2, max_length=2)]
Name = Annotated[str, Field(max_length=200)]
RunForm = Annotated[
    list[Annotated[list[Number], Field(min_length=3, max_length=3)]], Field(max_length=10_000)
]
FacesForm = Annotated[list[Annotated[int, Field(ge=0, le=1_000_000)]], Field(max_length=10_000)]
AskedForm = TypeVar("AskedForm", bound="Form")

# Values and lists of values in a request: twice what the largest solid that the server takes has.
MOST_VALUES = 100_000
# What is asked of supports and of the clamp on top, as toolkits have it.
OF_HARDWARE = [row for table in (PADS, CLAMP) for row in table.fields if row.name != "height"]
# Sets of three supports that are listed at most.
MOST_SETS = 50

Length = Annotated[float, Field(ge=0, le=LARGEST)]
Ring = Annotated[list[Number], Field(min_length=4, max_length=4)]
Zones = Annotated[list[LoopForm], Field(max_length=MOST_RANGES)]

EXAMPLE: dict[str, Any] = {
    "thickness": 12,
    "pad_radius": 4,
    "tip_radius": 5,
    "loads": [{"points": [[20, 15]], "force": 150, "heights": [8, 12], "axial": [-20, 60]}],
    "best": 3,
}


class Form(BaseModel):
    """The base of all requests.

    It refuses unknown keys, numbers written as text, and numbers that are not finite. It refuses text that is
    too long and lists with too many entries; the sentence then names the limit.
    """

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)


class AddressForm(BaseModel):
    """The base of values in the query of an address, where numbers are text."""

    model_config = ConfigDict(allow_inf_nan=False)


def parse_from_address(adapter: TypeAdapter[Asked], name: str, text: str) -> Asked:
    """Return a value that an address gives as JSON, checked by ``adapter``.

    Raises InputError, which calls the value ``name``, where it is wrong.
    """
    try:
        return adapter.validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        raise InputError(
            explain_request_error({**first, "loc": ("query", name, *map(str, first["loc"]))})
        ) from error


def explain_request_error(error: dict[str, Any]) -> str:
    """Return a sentence on one error that pydantic reports of a request."""
    loc = [str(part) for part in error.get("loc", ()) if part not in TAGS]
    if error.get("type") == "json_invalid":
        return "The request is not valid JSON: send one object."
    where, rest = (loc[0], loc[1:]) if loc else ("body", [])
    place = ".".join(rest)[:120]
    message = str(error.get("msg", "not what it should be")).strip().rstrip(".")
    message = message[:1].lower() + message[1:200]
    if where == "body":
        return f"The request is not as it should be{f' at {place}' if place else ''}: {message}."
    return f"The {where} value {place} of the address is not as it should be: {message}."


def check_body(payload: tuple[type[Form], bytes, int], order: TaskContext) -> None:
    """Raise InputError for a request with too many values or segments, or one that does not fit its form.

    The payload is (form, body, most segments allowed).
    """
    form, body, most_segments = payload
    try:
        data = json.loads(body)
    except (ValueError, RecursionError) as error:
        raise InputError("The request is not valid JSON: send one object.") from error
    refuse_many(count_most_vertices(data), most_segments)
    if count_values(data) > MOST_VALUES:
        raise InputError(
            f"The request has more than {MOST_VALUES:,} values: send only what is described, and parts of "
            "fewer segments."
        )
    try:
        form.model_validate(data)
    except ValidationError as error:
        first = next(iter(error.errors(include_url=False, include_context=False, include_input=False)))
        raise InputError(explain_request_error({**first, "loc": ("body", *first["loc"])})) from error


def count_values(data: Any) -> int:
    """Return the number of values in a request; lists and objects count as values too."""
    count, waiting = 0, [data]
    while waiting:
        one = waiting.pop()
        count += 1
        if isinstance(one, dict):
            waiting += one.values()
        elif isinstance(one, list):
            waiting += one
    return count


def count_most_vertices(data: Any) -> int:
    """Return the largest number of vertices of a part in a request; 0 where nothing is shaped like a part."""
    if not isinstance(data, dict):
        return 0
    several = data.get("workpieces")
    parts = [data, data.get("workpiece"), *(several if isinstance(several, list) else ())]
    loops = [part.get("loops") for part in parts if isinstance(part, dict)]
    counts = [
        sum(len(loop) for loop in own if isinstance(loop, list)) for own in loops if isinstance(own, list)
    ]
    return max(counts, default=0)


class SolidForm(Form):
    """The position of an outline's solid, and the heights at which each segment is touched; lengths in mm."""

    axis: Literal["x", "y", "z", "-x", "-y", "-z"]
    height: Annotated[float, Field(gt=0, le=LARGEST)]
    peg_height: Annotated[float, Field(gt=0, le=LARGEST)]
    head_room: Annotated[float, Field(ge=0, le=LARGEST)]
    least_band: Annotated[float, Field(ge=0, le=LARGEST)]
    bands: Annotated[list[BandForm | None], Field(max_length=MOST_VERTICES)]
    faces: Annotated[list[FacesForm], Field(max_length=MOST_VERTICES)] = Field(default=[])
    bottom: Annotated[list[LoopForm], Field(max_length=MOST_VERTICES)] | None = None
    top: Annotated[list[LoopForm], Field(max_length=MOST_VERTICES)] | None = None
    top_heights: Annotated[list[Number], Field(max_length=MOST_VERTICES)] = Field(default=[])
    runs: Annotated[list[RunForm], Field(max_length=MOST_VERTICES)] = Field(default=[])
    rising: Annotated[list[LoopForm], Field(max_length=MOST_VERTICES)] = Field(default=[])
    rising_heights: Annotated[list[Number], Field(max_length=MOST_VERTICES)] = Field(default=[])
    hanging: Annotated[list[LoopForm], Field(max_length=MOST_VERTICES)] = Field(default=[])
    hanging_heights: Annotated[list[Number], Field(max_length=MOST_VERTICES)] = Field(default=[])
    unclear_heights: Annotated[list[Number], Field(max_length=MOST_VERTICES)] = Field(default=[])


class OwnOutlineForm(Form):
    """The outline met by a carrier that touches between two heights of its own, in the form of a result file."""

    heights: Point
    loops: Annotated[list[LoopForm], Field(min_length=1, max_length=MOST_VERTICES)]
    bands: Annotated[list[BandForm | None], Field(max_length=MOST_VERTICES)]
    runs: Annotated[list[RunForm], Field(max_length=MOST_VERTICES)] = Field(default=[])
    solid_faces: Annotated[list[FacesForm], Field(max_length=MOST_VERTICES)] = Field(default=[])


class WorkpieceForm(Form):
    """A part; lengths in mm. ``outlines`` of a solid are, by role, those met by carriers with heights of
    their own.
    """

    name: Name = "part"
    loops: Annotated[list[LoopForm], Field(min_length=1, max_length=MOST_VERTICES)]
    departure: Annotated[float, Field(ge=0, le=LARGEST)] = 0.0
    solid: SolidForm | None = None
    outlines: Annotated[dict[Name, OwnOutlineForm], Field(max_length=MOST_RANGES)] = Field(default={})

    def to_workpiece(self, most_segments: int) -> Workpiece:
        """Return the part; raise InputError for loops that cannot be used,
        and for more segments than ``most_segments``.
        """
        solid = None if self.solid is None else SolidOutline(**self.solid.model_dump())
        workpiece = make_checked_part(self.name, self.loops, most_segments, self.departure, solid)
        if not self.outlines:
            return workpiece
        refuse_many(sum(len(loop) for one in self.outlines.values() for loop in one.loops), most_segments)
        entries = {role: one.model_dump() for role, one in self.outlines.items()}
        heights = {role: (one.heights[0], one.heights[1]) for role, one in self.outlines.items()}
        with explain_number_errors():
            return add_own_outlines(workpiece, entries, heights)


def make_checked_part(
    name: str,
    loops: Sequence[Sequence[Sequence[float]]],
    most_segments: int,
    departure: float = 0.0,
    solid: SolidOutline | None = None,
) -> Workpiece:
    """Return a part made of loops in mm; ``departure`` in mm bounds how far they are from the drawn curves.

    Raises InputError for more segments than ``most_segments``.
    """
    refuse_many(sum(map(len, loops)), most_segments)
    with explain_number_errors():
        return Workpiece.from_loops(name, loops, departure=departure, solid=solid)


def refuse_many(count: int, most: int) -> None:
    """Raise InputError where a part has more segments (``count``) than this server takes (``most``)."""
    if count > most:
        raise InputError(
            f"The part has {count} segments, more than the {most} this server takes: draw its outline with "
            "lines and arcs instead of many short pieces."
        )


@contextmanager
def explain_number_errors() -> Iterator[None]:
    """Turn arithmetic and value errors within the block into an InputError that says that numbers are too
    large or too small.
    """
    try:
        yield
    except (ArithmeticError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            "The part's numbers are too large or too small to compute with: check its units."
        ) from error


SeveralHeights = TypeAdapter(Annotated[dict[Name, Point], Field(max_length=MOST_RANGES)])


def read_heights_in_address(text: str | None) -> dict[str, tuple[float, float]] | None:
    """Return (low, high) in mm of carriers by role, from JSON in an address; None for None.

    Raises InputError where low is not below high.
    """
    if text is None:
        return None
    found = {
        role: (low, high) for role, (low, high) in parse_from_address(SeveralHeights, "heights", text).items()
    }
    for role, (low, high) in found.items():
        if not (low < high and high > 0.0):
            raise InputError(
                f"the heights {low:g} and {high:g} of the {role} cannot be used: give the lower end "
                "first, and the upper one above 0 mm."
            )
    return found


class SpatialLoadForm(Form):
    """A load in space, in N, mm, degrees and N mm; without heights it acts at the part's upper side.

    ``axial`` is the force downward, negative for a tool that pulls; ``tilt`` are the moments about x and y.
    """

    name: Name = ""
    points: list[Point] = Field(default=[], max_length=MOST_POINTS)
    force: Number = 0.0
    directions: Point = Field(default=[0.0, 360.0])
    heights: BandForm | None = None
    axial: Point = Field(default=[0.0, 0.0])
    moment: Number = 0.0
    tilt: Point = Field(default=[0.0, 0.0])

    def to_load(self) -> SpatialLoad:
        """Return the load in space."""
        return SpatialLoad(**self.model_dump())


@add_declared_fields(OF_HARDWARE, LARGEST)
class SupportsForm(Form):
    """The sizes of supports and of the clamp on top, and the loads on the part.

    The thickness, the level faces and the heights of the walls are known for a solid. Missing fields have
    their usual values. ``bottom_zones`` keep pads off, ``top_zones`` the clamp. Without loads here, those of
    the search are used.
    """

    model_config = ConfigDict(json_schema_extra={"examples": [EXAMPLE]})

    thickness: Annotated[float, Field(gt=0, le=LARGEST)] | None = None
    band: BandForm | None = None
    bottom_zones: Zones = Field(default=[])
    top_zones: Zones = Field(default=[])
    reach: Annotated[list[Ring], Field(max_length=MOST_RANGES)] | None = None
    point: Point | None = None
    loads: Annotated[list[SpatialLoadForm], Field(max_length=MOST_LOADS)] | None = None
    jaw_force: Length | None = None
    best: Annotated[int, Field(ge=1, le=MOST_SETS)] = 3
    unit: Literal["mm", "inch"] = "mm"


class ChosenSupportsForm(SupportsForm):
    """The number, from 1, of a set of three among the answers to the same request."""

    chosen: Annotated[int, Field(ge=1, le=MOST_SETS)] = 1


class FirstSideForm(Form):
    """The previous set-up: a fixture of another job, and the faces that it cuts."""

    job: Name
    rank: Annotated[int, Field(ge=1, le=10**9)]
    cut: list[Annotated[int, Field(ge=0, le=MOST_VERTICES)]] = Field(default=[], max_length=MOST_VERTICES)


def read_form_in_address(form: type[AskedForm], name: str, text: str | None) -> AskedForm | None:
    """Return a form from JSON in an address; None for None."""
    return None if text is None else parse_from_address(TypeAdapter(form), name, text)
