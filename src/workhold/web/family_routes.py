"""Routes of families of parts: which set-ups hold many of them."""

from __future__ import annotations

from datetime import date
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request
from starlette.exceptions import HTTPException
from starlette.responses import Response

from workhold.web.families import PAPERS, FamilyForm, FamilyFound, FamilyPaper
from workhold.web.job_routes import attachment, begin, found_job
from workhold.web.state import at_desk

__all__ = ["router"]

router = APIRouter(prefix="/api")

Setups = Annotated[
    int | None, Query(ge=1, le=1000, description="at most so many; the fewest there can be if not given")
]


def family_of_job(request: Request, name: str) -> FamilyFound:
    """What a job has found of a family.

    Raises
    ------
    HTTPException
        409 when it is of something else, or there is nothing (yet).
    """
    job = found_job(request, name)
    if job.kind != "family":
        raise HTTPException(409, "This search is not of several parts: ask for a family.")
    if job.family is None:
        words = "ended without a result" if job.is_over else "is not over yet"
        raise HTTPException(409, f"The search {words}.")
    return job.family


@router.post("/families", status_code=202, summary="Search for the set-ups that hold many parts")
async def submit(request: Request, form: FamilyForm) -> Response:
    """Begins the search; its state is at the address in the answer, and the curve below it at ``family``."""
    return await begin(request, form)


@router.get("/jobs/{name}/family", summary="The curve of a family")
async def family(request: Request, name: str) -> dict[str, Any]:
    """The least worst loss for each number of set-ups, and the parts that nothing holds."""
    return family_of_job(request, name).answer()


@router.get("/jobs/{name}/family/{kind}", summary="The plan of a family on paper", response_class=Response)
async def paper(
    request: Request,
    name: str,
    kind: Literal["curve.svg", "sheets.svg", "sheets.pdf", "plans.json"],
    setups: Setups = None,
    unit: Literal["mm", "inch"] = "mm",
    day: Annotated[date | None, Query(alias="date")] = None,
) -> Response:
    """The curve with a point marked, the sheets of its plan, or the family's file."""
    found = family_of_job(request, name)
    if not found.plans and kind != "plans.json":
        raise HTTPException(409, "No pattern of pegs holds any of the parts.")
    content = await at_desk(request, "family_paper", FamilyPaper(kind, found, setups, unit, day or date.today()))
    what, ending = kind.split(".")
    headers = {} if ending == "svg" else {"Content-Disposition": attachment(f"family-{what}", ending)}
    return Response(content, media_type=PAPERS[kind], headers=headers)
