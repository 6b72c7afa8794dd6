"""Forms of the arguments of ``workhold mcp``'s tools, with what an agent reads about each.

Lengths are in mm, angles in degrees, forces in N.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from workhold.asking.declaring import list_declarations
from workhold.asking.program import CuttingQuestion, ProgramQuestion, StockQuestion
from workhold.asking.reading import ReadingQuestion
from workhold.asking.search import LOADS, RANKING, RULING_OUT, SEARCH, SEATING, SearchQuestion
from workhold.asking.sheet import SheetQuestion
from workhold.errors import InputError
from workhold.files.declared_forms import add_declared_fields, collect_given_values
from workhold.files.input_forms import LoadTable

__all__ = [
    "DesignArguments",
    "OF_SEARCH",
    "LoadArguments",
    "ProgramArguments",
    "SheetArguments",
    "ShowArguments",
    "ToolArguments",
    "check_arguments",
]

# What a search asks but heights, which stand with the reading of the part and with the program.
OF_SEARCH = list_declarations(SearchQuestion, (RULING_OUT, LOADS, RANKING, SEATING, SEARCH))
OF_SHEET = list_declarations(SheetQuestion)
OF_READING = list_declarations(ReadingQuestion)
Arguments = TypeVar("Arguments", bound="ToolArguments")
Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
Positive = Annotated[float, Field(gt=0)]
Rank = Annotated[int, Field(ge=1, description="which fixture; 1 is the best")]
ResultPath = Annotated[str, Field(description="path of a result file, as design reports it")]
MayReplace = Annotated[bool, Field(description="replace a file that workhold has not written")]
ClosingForce = Annotated[float | None, Field(ge=0, description="force that closes the vise, in N")]


class ToolArguments(BaseModel):
    """Arguments of a tool; unknown names are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


@add_declared_fields(OF_READING)
class LoadArguments(ToolArguments):
    """A part and how it is read."""

    part: str = Field(description="path of a DXF, SVG, JSON or STEP file, or a built-in name such as widget")
    layers: list[str] | None = Field(
        default=None, description="DXF layers to read; all visible ones if not given"
    )
    part_number: int | str | None = Field(
        default=None,
        description="number of the part if the file has several, from 1 by decreasing area, or the name of a "
        "STEP file's solid",
    )
    picture: bool = Field(default=False, description="show a picture, too")

    def to_load_arguments(self) -> dict[str, Any]:
        """Return the keyword arguments of :func:`workhold.load` that were given, without the part."""
        return collect_given_values(self, OF_READING)


class Circle(ToolArguments):
    """A round place that no peg may stand over, in the part's coordinates."""

    circle: Annotated[list[float], Field(min_length=3, max_length=3, description="x, y, radius")]


class Polygon(ToolArguments):
    """A place with corners that no peg may stand over, in the part's coordinates."""

    polygon: list[Pair] = Field(min_length=3)


@add_declared_fields(list_declarations(CuttingQuestion))
class CuttingArguments(ToolArguments):
    """How tools cut that the table does not describe; give one of force, power and material."""


@add_declared_fields(list_declarations(StockQuestion))
class StockArguments(ToolArguments):
    """The stock that the part is cut from. Tools press only where they meet it."""


@add_declared_fields(list_declarations(ProgramQuestion))
class ProgramArguments(ToolArguments):
    """The program of the mill. The fixtures keep clear of its tools."""

    path: str = Field(description="path of the program (G-code)")
    tools: str | None = Field(
        default=None, description="path of the program's table of tools; the program's comments if not given"
    )
    z_zero: Literal["top", "bottom"] | float = Field(
        default="top",
        description="height at which the program has Z0: top or bottom of the part, or a height above its "
        "lower side in mm",
    )
    thickness: Positive | None = Field(
        default=None, description="thickness of the part, in mm; that of its solid if not given"
    )
    peg_height: Positive | None = Field(
        default=None, description="height of the pegs, in mm; as high as the part if not given"
    )
    cutting: CuttingArguments | None = Field(
        default=None, description="how the tools cut, which gives their forces on the part"
    )
    stock: StockArguments | None = Field(
        default=None, description="raw stock of the part; 5 mm around the outline and on top if not given"
    )

    def to_read_arguments(self, height: float | None) -> dict[str, Any]:
        """Return the keyword arguments of :meth:`workhold.Program.read`, without the path.

        Parameters
        ----------
        height : height of the part's solid in mm; None where it has none.
        """
        left_out = {"path", "peg_height", "thickness"}
        given = self.model_dump(exclude=left_out)
        return given | {"thickness": self.thickness or height}


@add_declared_fields(OF_SEARCH)
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
    types: list[str] | None = Field(default=None, description="for a vise: type I, II or both")
    avoid: list[int] = Field(
        default=[], description="faces not to touch, by number, such as those to be machined"
    )
    touch: list[int] = Field(
        default=[], description="faces that every fixture must touch, by number; not with two clamps"
    )
    max_location_error: Positive | None = Field(
        default=None, description="list only fixtures whose location error is at most this, in mm"
    )
    keep_out: list[Circle | Polygon] = Field(default=[], description="places that no peg may stand over")
    angles: list[Pair] = Field(default=[], description="ranges of angles that the part may lie at")
    prefer: Literal["square", "strong", "precise", "roomy"] | None = Field(
        default=None, description="what comes first"
    )
    loads: list[LoadTable] = Field(default=[], description="loads on the part while it is held")
    program: ProgramArguments | None = Field(
        default=None, description="list only fixtures that the tools of this program keep clear of"
    )
    count: int = Field(default=5, ge=0, le=100, description="how many fixtures to report")
    out: str | None = Field(
        default=None, description="path of the result file, .json or .npz; a temporary file if not given"
    )
    force: MayReplace = False
    seconds: Positive = Field(
        default=120.0,
        description="longest time of the search; the fixtures found by then are reported, marked as "
        "incomplete",
    )


class ShowArguments(ToolArguments):
    """One fixture of a result."""

    result_file: ResultPath
    rank: Rank = 1
    loads: list[LoadTable] = Field(default=[], description="loads to use instead of the loads of the result")
    jaw_force: ClosingForce = None
    seating: bool = Field(
        default=False, description="find whether the part settles in its place, and where else it can rest"
    )
    picture: bool = Field(default=True, description="show a picture, too")


@add_declared_fields(OF_SHEET)
class SheetArguments(ToolArguments):
    """A setup sheet, or a set-up for a CAM system."""

    result_file: ResultPath
    rank: Rank = 1
    path: str = Field(description="the file to write: .pdf, .svg, .png, .dxf, .step or .csv (a list of pins)")
    force: MayReplace = False
    unit: Literal["mm", "inch"] = "mm"
    jaw: Literal["screw", "constant"] | Annotated[float, Field(ge=0)] = "screw"
    zero: str | Pair | None = Field(
        default=None, description='part zero: "corner", "centre", "hole 2", or x and y'
    )


def check_arguments(form: type[Arguments], given: dict[str, Any] | None) -> Arguments:
    """Return the arguments of a tool checked by its form; raise InputError, which names the first fault."""
    try:
        return form.model_validate(given or {})
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        place = ".".join(str(part) for part in first["loc"])[:120] or "what is given"
        message = str(first["msg"]).strip().rstrip(".")
        raise InputError(f"{place} is not as it should be: {message[:1].lower()}{message[1:200]}.") from error
