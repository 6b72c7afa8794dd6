"""Routes about parts, toolkits and figures of quality."""

from __future__ import annotations

from typing import Annotated, Any
from urllib.parse import unquote

from fastapi import APIRouter, Depends, Query, Request
from pydantic import Field
from starlette.exceptions import HTTPException

from workhold.asking.declaring import list_declarations
from workhold.asking.reading import ReadingQuestion
from workhold.files.declared_forms import add_declared_fields
from workhold.limits import MOST_LENGTH
from workhold.version import __version__
from workhold.web.answers import describe_figures
from workhold.web.fixture_tasks import has_step
from workhold.web.job_routes import find_job
from workhold.web.part_tasks import ShapeOrder, UploadedPart
from workhold.web.program_forms import ReadProgramForm
from workhold.web.request_forms import AddressForm, WorkpieceForm, read_heights_in_address
from workhold.web.state import CheckedRoute, get_state, run_at_desk, run_at_desk_while_connected

__all__ = ["router"]

router = APIRouter(route_class=CheckedRoute)
LONGEST_NAME = 120
# Limits that clients are given.
LIMITS = (
    "upload_bytes",
    "request_bytes",
    "segments",
    "searches",
    "jobs",
    "seconds",
    "fixtures",
    "life_seconds",
)


@router.get("/about", summary="Version and limits")
async def about(request: Request) -> dict[str, Any]:
    """Return the version of this server and its limits."""
    limits = get_state(request).limits
    return {
        "version": __version__,
        "limits": {name: getattr(limits, name) for name in LIMITS},
        "step": has_step(),
    }


@router.get("/parts", summary="The parts that come with the program")
async def parts() -> list[dict[str, str]]:
    """Return names and descriptions of the built-in parts."""
    from workhold.files.part.finding import list_builtin_parts

    return [{"name": part.name, "title": part.description} for part in list_builtin_parts()]


@router.get("/parts/{name}", summary="A part that comes with the program")
async def part(request: Request, name: str) -> dict[str, Any]:
    """Return loops, segments and faces of a built-in part."""
    from workhold.files.part.finding import list_builtin_parts

    state = get_state(request)
    known = {part.name.lower(): part.name for part in list_builtin_parts()}.get(name.lower())
    if known is None:
        raise HTTPException(404, "No part of that name comes with the program.")
    if known not in state.builtin:
        state.builtin[known] = await run_at_desk(request, "builtin_part", known)
    return state.builtin[known]


FILE = {
    "requestBody": {
        "required": True,
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    },
    "parameters": [{"in": "header", "name": "X-Filename", "required": False, "schema": {"type": "string"}}],
}
OF_READING = list_declarations(ReadingQuestion)


@add_declared_fields(OF_READING, MOST_LENGTH)
class UploadForm(AddressForm):
    """Options for reading a file that is sent; lengths in mm."""

    part_number: str | None = Field(
        default=None, max_length=200, description="number of a part, or number or name of a solid"
    )
    layers: Annotated[list[Annotated[str, Field(max_length=300)]], Field(max_length=500)] | None = None
    fit: float | None = Field(
        default=None,
        ge=0.0001,
        le=100,
        description="how far arcs may be from true curves that they stand for, in mm",
    )
    heights: str | None = Field(
        default=None,
        max_length=2_000,
        description="JSON: by role between which heights carriers with their own touch, in mm",
    )
    peg_diameter: float | None = Field(
        default=None,
        gt=0,
        le=MOST_LENGTH,
        description="of the pegs in mm, which then are no higher than they must be where no height is given",
    )


# What is said of other files too.
OF_ALL_FILES = ("unit", "part_number", "layers", "join_tolerance")


async def collect_upload(request: Request, asked: Annotated[UploadForm, Query()]) -> UploadedPart:
    """Return the file that is sent, with its name and the reading options for its kind."""
    content = await request.body()
    name = clean_file_name(request.headers.get("x-filename", ""))
    given = asked.model_dump(exclude_none=True, exclude={"heights"})
    if not name.lower().endswith((".step", ".stp")):
        given = {key: value for key, value in given.items() if key in (*OF_ALL_FILES, "fit")}
    elif asked.heights is not None:
        given["heights"] = read_heights_in_address(asked.heights)
    if name.lower().endswith(".json"):
        given.pop("fit", None)
    return UploadedPart(content, name, get_state(request).limits.segments, given)


Sent = Annotated[UploadedPart, Depends(collect_upload)]


@router.post("/parts", summary="Read a part from a file", openapi_extra=FILE)
async def read_part(request: Request, upload: Sent) -> dict[str, Any]:
    """Return the part read from the body, which is a file: DXF, SVG, JSON, or STEP where installed.

    Its name is in the header X-Filename.
    """
    answer: dict[str, Any] = await run_at_desk(request, "read_part", upload)
    return answer


@router.post("/parts/survey", summary="See what a file holds and leaves open", openapi_extra=FILE)
async def survey_part(request: Request, upload: Sent) -> dict[str, Any]:
    """Return the part if it can be read, else the reason and the questions to ask; and all drawn lines.

    The file is sent as to read a part.
    """
    answer: dict[str, Any] = await run_at_desk(request, "survey_part", upload)
    return answer


@router.post("/parts/shape", summary="Show the shape of a job's part", openapi_extra=FILE)
async def shape_part(
    request: Request, job: Annotated[str, Query(max_length=100, description="its name")]
) -> dict[str, int]:
    """Make bodies of a job show the part's own shape instead of a prism, from the STEP file that is sent.

    The answer is the number of triangles of the shape. The job keeps the shape, not the file.
    """
    content, name = await request.body(), clean_file_name(request.headers.get("x-filename", ""))
    held = find_job(request, job)
    if held.kind != "design":
        raise HTTPException(409, "Only a search for fixtures shows the shape of its part: begin one.")
    part = held.asked.query.workpiece
    held.shape = await run_at_desk(request, "shape", ShapeOrder(content, name, part))
    get_state(request).jobs.make_room()
    return {"triangles": len(held.shape.triangles)}


def clean_file_name(header: str) -> str:
    """Return a file's name from a header, for display.

    It is unquoted and shortened; folders and unprintable characters are removed.
    """
    name = unquote(header, errors="replace").replace("\\", "/").rpartition("/")[2]
    return "".join(letter for letter in name if letter.isprintable())[-LONGEST_NAME:].strip()


@router.post("/parts/check", summary="Check a part that was drawn by hand")
async def check_part(request: Request, form: WorkpieceForm) -> dict[str, Any]:
    """Return the part, or a sentence on its fault and the place of the fault."""
    state = get_state(request)
    answer: dict[str, Any] = await run_at_desk(request, "check_part", (form, state.limits.segments))
    return answer


@router.post("/lesson", summary="What the page that explains the method shows of a part")
async def lesson(request: Request, form: WorkpieceForm) -> dict[str, Any]:
    """Return the part's contact features, and its Type I fixtures in a vise chosen for it, with their chords.

    Lengths are in mm, angles in radians.
    """
    payload = form, get_state(request).limits.segments
    answer: dict[str, Any] = await run_at_desk_while_connected(request, "make_lesson", payload)
    return answer


@router.post("/programs", summary="See what a program of the machine does")
async def program(request: Request, form: ReadProgramForm) -> dict[str, Any]:
    """Return the tools with their lines, the bounding box of their tips, notes on how the program was read,
    and its paths to draw.

    Paths are SVG path data in tenths of mm, y downward, by tool, kind and level of height. ``height`` and
    ``peg_height`` beside the program are those of the part's solid.
    """
    answer: dict[str, Any] = await run_at_desk(request, "look_at_program", form)
    return answer


@router.get("/toolkits", summary="The kinds of toolkits")
async def toolkits() -> list[dict[str, Any]]:
    """Return the name of each kind of toolkit, its fields, and usual values to begin with; lengths in mm."""
    from workhold.web.toolkits import describe_kinds

    return describe_kinds()


@router.get("/questions", summary="What is asked of a search and of a sheet")
async def questions() -> dict[str, list[dict[str, Any]]]:
    """Return the fields of a search and of a sheet that the page shows, in mm and N, with their meanings."""
    from workhold.web.toolkits import describe_questions

    return describe_questions()


@router.get("/presets", summary="The toolkits that come with the program")
async def presets() -> list[dict[str, Any]]:
    """Return the preset toolkits by name; lengths in mm."""
    from workhold.files.toolkit_file import list_preset_names, load_preset
    from workhold.web.toolkits import describe_toolkit

    return [describe_toolkit(one) for one in map(load_preset, list_preset_names())]


@router.get("/figures", summary="The figures of quality")
async def figures() -> list[dict[str, Any]]:
    """Return the name of each figure, its unit, and whether more is better."""
    return describe_figures()
