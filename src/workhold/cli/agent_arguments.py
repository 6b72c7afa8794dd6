"""Forms of the arguments of ``workhold mcp``'s tools, with what an agent reads about each.

Lengths are in mm, angles in degrees, forces in N.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from workhold.errors import InputError
from workhold.files.input_forms import LoadTable

__all__ = [
    "DesignArguments",
    "LoadArguments",
    "SheetArguments",
    "ShowArguments",
    "ToolArguments",
    "checked_arguments",
]

Arguments = TypeVar("Arguments", bound="ToolArguments")
Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
Positive = Annotated[float, Field(gt=0)]
Rank = Annotated[int, Field(ge=1, description="which fixture; 1 is the best")]
ResultPath = Annotated[str, Field(description="path of a result file, as design reports it")]
MayReplace = Annotated[bool, Field(description="replace a file that workhold has not written")]
ClosingForce = Annotated[float | None, Field(ge=0, description="with which the vise is closed, in N")]


class ToolArguments(BaseModel):
    """Arguments of a tool; unknown names are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class LoadArguments(ToolArguments):
    """A part and how it is read."""

    part: str = Field(description="path of a DXF, SVG, JSON or STEP file, or a built-in name such as widget")
    unit: Literal["mm", "cm", "m", "inch", "px72", "px90", "px96"] | None = Field(
        default=None,
        description="of a drawing that does not say its own; of an SVG drawing how many pixels make an inch",
    )
    layers: list[str] | None = Field(
        default=None, description="DXF layers to read; all visible ones if not given"
    )
    part_number: int | str | None = Field(
        default=None,
        description="which part of several, from 1 by decreasing area, or the name of a STEP file's solid",
    )
    join_tolerance: float = Field(
        default=1e-3, ge=0, description="largest gap between loose ends to close, in mm"
    )
    fit: Positive | None = Field(
        default=None, description="how far lines and arcs may be from true curves that they stand for, in mm"
    )
    axis: Literal["x", "y", "z", "-x", "-y", "-z"] | None = Field(
        default=None, description="STEP: the direction that points up, to which the pegs are parallel"
    )
    section: float | None = Field(default=None, description="STEP: take the section at this height, in mm")
    peg_height: Positive | None = Field(
        default=None,
        description="STEP: how far pegs reach above the plane on which the part lies, in mm; the outline "
        "is what they meet there, and only upright faces are touched",
    )
    head_room: float | None = Field(
        default=None,
        ge=0,
        description="with peg_height: what is kept free above the pegs, in mm; usually 0.5",
    )
    least_band: float | None = Field(
        default=None,
        ge=0,
        description="with peg_height: how high an upright face must be to be touched, in mm; usually 1",
    )
    picture: bool = Field(default=False, description="show a picture, too")

    def reading(self) -> dict[str, Any]:
        """Returns the arguments of :func:`workhold.load` but the part."""
        return self.model_dump(include=set(LoadArguments.model_fields) - {"part", "picture"})


class Circle(ToolArguments):
    """A round place that no peg may stand over, in the part's coordinates."""

    circle: Annotated[list[float], Field(min_length=3, max_length=3, description="x, y, radius")]


class Polygon(ToolArguments):
    """A place with corners that no peg may stand over, in the part's coordinates."""

    polygon: list[Pair] = Field(min_length=3)


class DesignArguments(LoadArguments):
    """A search for every way to hold a part."""

    toolkit: str = Field(
        description="a preset such as plate-20mm, clamp-plate-20mm, two-clamp-plate-20mm or fence-20mm, the "
        "path of a toolkit's TOML file, or a kind (vise, opening-vise, plate, fence) with fields"
    )
    fields: dict[str, Any] = Field(
        default_factory=dict,
        description="fields of the toolkit that are given or changed, such as pitch, columns, rows, "
        "peg_radius, min_gap, max_opening, travel, clamps, wall_offset",
    )
    types: list[str] | None = Field(default=None, description="of a vise I, II or both")
    best: int | None = Field(default=None, ge=1, description="seek only so many, the best")
    avoid: list[int] = Field(
        default=[], description="faces not to touch, by number, such as those to be machined"
    )
    keep_out: list[Circle | Polygon] = Field(default=[], description="places that no peg may stand over")
    angles: list[Pair] = Field(default=[], description="ranges of angles that the part may lie at")
    contact_margin: float = Field(
        default=0.0, ge=0, description="smallest distance of a contact from a face's end"
    )
    prefer: Literal["square", "strong", "precise", "roomy"] | None = Field(
        default=None, description="what comes first"
    )
    jaw_force: ClosingForce = None
    loads: list[LoadTable] = Field(default=[], description="what acts on the part while it is held")
    seating: int | None = Field(
        default=None,
        ge=1,
        description="of the first so many fixtures report from how far open, or drawn back, the part is "
        "caught and where else it can rest, and order them by that too",
    )
    opening: Positive | None = Field(
        default=None,
        description="with seating, list only those that catch the part when opened by so many mm",
    )
    foolproof: bool = Field(
        default=False,
        description="with seating, list only those of which a caliper shows every wrong place to rest",
    )
    count: int = Field(default=5, ge=0, le=100, description="how many fixtures to report")
    out: str | None = Field(
        default=None, description="path of the result file, .json or .npz; else a temporary one"
    )
    force: MayReplace = False
    seconds: Positive = Field(
        default=120.0, description="longest search; what was found by then is reported as incomplete"
    )


class ShowArguments(ToolArguments):
    """One fixture of a result."""

    result_file: ResultPath
    rank: Rank = 1
    loads: list[LoadTable] = Field(default=[], description="instead of those of the result")
    jaw_force: ClosingForce = None
    seating: bool = Field(
        default=False, description="work out whether the part ends up there, and where else it can rest"
    )
    picture: bool = Field(default=True, description="show a picture, too")


class SheetArguments(ToolArguments):
    """A setup sheet, or a set-up for a CAM system."""

    result_file: ResultPath
    rank: Rank = 1
    path: str = Field(description="the file to write: .pdf, .svg, .png, .dxf, .step or .csv (a list of pins)")
    force: MayReplace = False
    paper: Literal["a4", "letter"] = "a4"
    unit: Literal["mm", "inch"] = "mm"
    part_name: str | None = None
    jaw_force: ClosingForce = None
    seating: bool | None = Field(
        default=None, description="whether it says if the part ends up there; if known when null"
    )
    jaw: Literal["screw", "constant"] | Annotated[float, Field(ge=0)] = "screw"
    friction: Positive | None = None
    zero: str | Pair | None = Field(
        default=None, description='part zero: "corner", "centre", "hole 2", or x and y'
    )
    machine_position: Pair | None = Field(default=None, description="of hole A1 in the machine's coordinates")
    thickness: Positive | None = None
    peg_length: Positive | None = None
    peg_height: Positive | None = None
    dowel: str | None = Field(
        default=None, description="what the pegs are and how they fit, such as 6 mm m6 in H7"
    )
    clearance: float = Field(
        default=1.0, ge=0, description="how far the cutter is to keep off the pegs of a .dxf"
    )


def checked_arguments(form: type[Arguments], given: dict[str, Any] | None) -> Arguments:
    """Checks the arguments of a tool.

    Raises
    ------
    InputError
        Naming the first that is not as it should be.
    """
    try:
        return form.model_validate(given or {})
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        place = ".".join(str(part) for part in first["loc"])[:120] or "what is given"
        message = str(first["msg"]).strip().rstrip(".")
        raise InputError(f"{place} is not as it should be: {message[:1].lower()}{message[1:200]}.") from error
