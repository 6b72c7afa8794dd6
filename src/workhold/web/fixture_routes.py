"""Routes of one fixture of a job: its row, loads, cautions, papers and seating, and closings of the jaws."""

from __future__ import annotations

import asyncio
from datetime import date
from typing import Annotated, Any, Literal

from attrs import evolve
from fastapi import APIRouter, Path, Query, Request
from pydantic import Field
from starlette.exceptions import HTTPException
from starlette.responses import Response

from workhold.asking.declaring import Declaration, list_declarations
from workhold.asking.sheet import SheetQuestion
from workhold.errors import InputError
from workhold.files.declared_forms import add_declared_fields, collect_given_values
from workhold.limits import MOST_LENGTH
from workhold.model.result import Result
from workhold.model.seating import Seating
from workhold.presenting.zoomed_picture import draw_small_picture
from workhold.seating.clamping import HandLoading
from workhold.units import Unit, find_unit
from workhold.web.answers import USUAL_SIZE, describe_fixture
from workhold.web.fixture_tasks import (
    AT_ONCE,
    KINDS,
    OF_BODIES,
    Before,
    ClosingForm,
    ClosingOrder,
    Held,
    PaperOrder,
    describe_seating,
)
from workhold.web.forms import LoadsForm, read_loads_in_address
from workhold.web.job_routes import find_job, get_job_result, make_attachment_header
from workhold.web.program_forms import describe_clearance, describe_forces, describe_vise_clearance
from workhold.web.request_forms import (
    AddressForm,
    ChosenSupportsForm,
    FirstSideForm,
    SupportsForm,
    read_form_in_address,
)
from workhold.web.state import CheckedRoute, get_state, run_at_desk, run_at_desk_while_connected
from workhold.web.support_tasks import SupportsOrder

__all__ = ["router"]

router = APIRouter(prefix="/jobs/{name}/fixtures/{rank}", route_class=CheckedRoute)

Rank = Annotated[int, Path(ge=1, le=10**9)]
UnitName = Literal["mm", "inch"]
JawForce = Annotated[float | None, Query(gt=0, le=1e9, description="in N")]
Jaw = Annotated[
    str,
    Query(
        max_length=20,
        description="what the closed jaw does under load: screw, constant, or how many times as stiff as a "
        "contact it is",
    ),
]
Loads = Annotated[
    str | None,
    Query(max_length=20_000, description="loads to use instead of the search's, JSON as in a search"),
]
Across = Annotated[float, Query(ge=100, le=10_000, description="of the picture, in its own units")]
Revision = Annotated[
    int | None, Query(ge=0, description="what the caller has seen; 409 when it is another by now")
]


@add_declared_fields(list_declarations(SheetQuestion), MOST_LENGTH)
class PaperForm(AddressForm):
    """The contents of a paper; lengths in the unit of the request."""

    unit: UnitName = "mm"
    loads: Loads = None
    supports: str | None = Field(
        default=None, max_length=20_000, description="JSON: as in a request for them, with the set ``chosen``"
    )
    first_side: str | None = Field(
        default=None,
        max_length=20_000,
        description="JSON: the first set-up as its ``job``, ``rank`` and ``cut`` faces",
    )
    revision: Revision = None

    def to_sheet_question(self) -> SheetQuestion:
        """Return the contents of the sheet as a question, lengths in mm; without a date it has today's."""
        rows, unit = list_declarations(SheetQuestion), find_unit(self.unit)
        given = {
            row.name: convert_field_to_mm(row, value, unit)
            for row, value in zip(rows, collect_given_values(self, rows).values(), strict=True)
        }
        return SheetQuestion(**given | {"day": given["day"] or date.today()})


def convert_field_to_mm(row: Declaration, value: Any, unit: Unit) -> Any:
    """Return the value of a sheet's field in mm where it is a length or a place, else unchanged."""
    if row.form == "length" and value is not None:
        return unit.to_mm(value)
    return tuple(map(unit.to_mm, value)) if row.form == "place" and value is not None else value


def find_ranked_fixture(result: Result, rank: int) -> int:
    """Return the index, rank - 1, of a fixture; answer 404 where the result lists fewer."""
    if rank > len(result):
        raise HTTPException(404, f"There is no fixture {rank}: {len(result)} are listed.")
    return rank - 1


# Before what takes any last word for a paper.
async def find_seating(
    request: Request, name: str, rank: int, revision: int | None
) -> tuple[Held, Seating | HandLoading]:
    """Return the fixture with part and toolkit, and its seating; for two clamps the steps of putting the part
    in by hand instead.

    The seating is computed at the first call and kept with the job.
    """
    job = find_job(request, name)
    result = get_job_result(job, revision)
    held = result[find_ranked_fixture(result, rank)], result.workpiece, result.toolkit
    key = (job.revision, rank)
    if key not in job.seatings:
        # On a first run kernels are compiled for it, which takes as long as a search may.
        found = await run_at_desk(request, "seating", held, get_state(request).limits.seconds)
        job.keep_seating(key, found)
        return held, found
    return held, job.seatings[key]


@router.get("/seating", summary="Whether the part ends up in its place")
async def seating(
    request: Request, name: str, rank: Rank, unit: UnitName = "mm", revision: Revision = None
) -> dict[str, Any]:
    """Return how far the jaws may be open so that the part still settles in its place, and all seats on the
    same pegs, also in sentences.
    """
    held, found = await find_seating(request, name, rank, revision)
    return {"rank": rank, **describe_seating(held, found, unit)}


@router.post("/closing", summary="Close the jaws on a part that was put in by hand")
async def closing(
    request: Request, name: str, rank: Rank, form: ClosingForm, revision: Revision = None
) -> dict[str, Any] | None:
    """Return the path of part and jaws as they close without friction:
    degrees, x and y of the pose, opening; in mm.

    The opening is 0 where the jaws hold the part. The ending is one of ``right``, ``same place``, ``wrong``,
    ``elsewhere``, ``stop``, ``outside`` and ``lost``. The simulation stops when the client hangs up.
    """
    held, found = await find_seating(request, name, rank, revision)
    if isinstance(found, HandLoading):
        raise InputError(
            "with two clamps no closing can be shown: you push the part against its locators by hand."
        )
    order = ClosingOrder(held, found, form)
    answer: dict[str, Any] | None = await run_at_desk_while_connected(request, "closing", order)
    return answer


@router.get("", summary="One fixture")
async def fixture(
    request: Request,
    name: str,
    rank: Rank,
    width: Across = USUAL_SIZE[0],
    height: Across = USUAL_SIZE[1],
    revision: Revision = None,
) -> dict[str, Any]:
    """Return the row of a fixture, its geometry in mm in the vise's frame,
    and a picture of the size asked for.

    With a program, ``passing`` is the move that comes nearest to the fixture, with line, tool and distance in
    mm; its path is that of the tool's axis, in the part's coordinates. Between flat jaws ``vise_clearance``
    has sentences on what the tools come nearest to. With cutting forces, ``program_forces`` has the clamping
    force that they need and the line that needs most.
    """
    result = get_job_result(find_job(request, name), revision)
    index = find_ranked_fixture(result, rank)
    told = await asyncio.to_thread(
        describe_fixture, result[index], result.workpiece, result.toolkit, (width, height)
    )
    passing, forces = describe_clearance(result, index), describe_forces(result, index)
    return {
        "rank": rank,
        **told,
        "passing": passing,
        "vise_clearance": describe_vise_clearance(result, index),
        "program_forces": forces,
    }


CHANGED: dict[int | str, dict[str, Any]] = {204: {"description": "The list has changed meanwhile"}}


@router.get(
    "/small.svg", summary="A small picture to choose a fixture by", response_class=Response, responses=CHANGED
)
async def small(request: Request, name: str, rank: Rank, revision: Revision = None) -> Response:
    """Return an SVG picture of the part in its pose, with the touched faces and the pegs.

    The answer is 204 without a picture if the list has changed to another revision.
    """
    job = find_job(request, name)
    if revision is not None and revision != job.revision:
        return Response(status_code=204)
    result = get_job_result(job)
    chosen = result[find_ranked_fixture(result, rank)]
    content = await asyncio.to_thread(draw_small_picture, chosen, result.workpiece, result.toolkit)
    return Response(content, media_type="image/svg+xml")


@router.post("/loads", summary="What loads do to a fixture")
async def loads(
    request: Request, name: str, rank: Rank, form: LoadsForm, revision: Revision = None
) -> dict[str, Any]:
    """Return peg forces in N at the worst point and direction of each load,
    and the jaw force that is needed.
    """
    result = get_job_result(find_job(request, name), revision)
    chosen = result[find_ranked_fixture(result, rank)]
    cases = await run_at_desk(request, "loads", (chosen, result.workpiece, result.toolkit, form))
    return {"rank": rank, "cases": cases}


@router.post("/supports", summary="Three supports under the part, and a clamp on top")
async def supports(
    request: Request, name: str, rank: Rank, form: SupportsForm, revision: Revision = None
) -> dict[str, Any]:
    """Return the best sets of three supports, with the clamp's best point,
    its force in N and the tipping arm in mm.

    The search for them stops when the client hangs up.
    """
    result = get_job_result(find_job(request, name), revision)
    asked = SupportsOrder(result[find_ranked_fixture(result, rank)], result.query, form)
    return {"rank": rank, **await run_at_desk_while_connected(request, "supports", asked)}


@router.get("/warnings", summary="The warnings of a fixture")
async def warnings(
    request: Request,
    name: str,
    rank: Rank,
    unit: UnitName = "mm",
    jaw_force: JawForce = None,
    jaw: Jaw = "screw",
    loads: Loads = None,
    revision: Revision = None,
) -> dict[str, Any]:
    """Return the warnings of the fixture's setup sheet,
    under the loads of its search or those given as JSON.
    """
    result = get_job_result(find_job(request, name), revision)
    index = find_ranked_fixture(result, rank)
    others = result.table.count_in_same_holes(index)
    small = result.slice_rows(slice(index, index + 1))
    asked = {
        "unit": find_unit(unit),
        "jaw_force": jaw_force,
        "jaw": jaw,
        "loads": read_loads_in_address(loads),
        "others": others,
    }
    return {"rank": rank, **await run_at_desk(request, "warnings", (small, index == 0, asked))}


def make_set_up_before(request: Request, form: FirstSideForm | None) -> Before | None:
    """Return query and fixture of the previous set-up, on the other side of the part; None for None.

    The faces that it cuts are among the query's faces to avoid.
    """
    if form is None:
        return None
    result = get_job_result(find_job(request, form.job))
    fixture = result[find_ranked_fixture(result, form.rank)]
    ruled_out = evolve(result.query.restrictions, avoid=tuple(form.cut))
    return evolve(result.query, restrictions=ruled_out), fixture


@router.get("/{kind}", summary="A setup sheet, a drawing or a picture", response_class=Response)
async def paper(
    request: Request,
    name: str,
    rank: Rank,
    kind: Literal[
        "sheet.pdf", "sheet.svg", "setup.dxf", "setup.step", "picture.svg", "pins.csv", "assembly.glb"
    ],
    asked: Annotated[PaperForm, Query()],
) -> Response:
    """Return a paper of a fixture; all but pictures and bodies are ready only when the search is over.

    Lengths are in the unit asked for, loads are JSON as in a search, and the date is today's if not given.
    """
    job = find_job(request, name)
    result = get_job_result(job, asked.revision, when_over=kind not in AT_ONCE)
    find_ranked_fixture(result, rank)
    chosen = read_form_in_address(ChosenSupportsForm, "supports", asked.supports)
    before = make_set_up_before(request, read_form_in_address(FirstSideForm, "first_side", asked.first_side))
    order = PaperOrder(
        kind,
        # Only a sheet names the other fixtures.
        result if kind.startswith("sheet") else result.slice_rows(slice(rank - 1, rank)),
        rank,
        len(result),
        asked.to_sheet_question(),
        find_unit(asked.unit),
        read_loads_in_address(asked.loads),
        job.result_hash,
        chosen,
        before,
        job.shape if kind in OF_BODIES or asked.to_sheet_question().material is not None else None,
    )
    content, result_hash = await run_at_desk(request, "paper", order)
    if result_hash is not None and job.result is result:
        job.result_hash = result_hash
    headers = {}
    if kind != "picture.svg":
        what, ending = kind.split(".")
        headers["Content-Disposition"] = make_attachment_header(
            f"{result.workpiece.name}-{what}-{rank}", ending
        )
    return Response(content, media_type=KINDS[kind][0], headers=headers)
