"""Routes that begin, watch and end jobs, those of all fixtures of a job, and those of families of parts."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Callable, Iterator
from datetime import date
from time import monotonic
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Header, Query, Request
from starlette.exceptions import HTTPException
from starlette.responses import JSONResponse, Response, StreamingResponse

from workhold.model.fixture_table import FixtureTable
from workhold.model.result import Result
from workhold.model.seating import round_length
from workhold.statics.judging import are_unfit as unfit_of
from workhold.web.answers import describe_explanation, describe_rows
from workhold.web.description import JobAddress, JobAnswer
from workhold.web.families import PAPERS, FamilyForm, FamilyPaper, FoundFamily
from workhold.web.forms import ExploreForm, JobForm, LoadsForm
from workhold.web.guard import BASES
from workhold.web.jobs import ServerJob
from workhold.web.selection import ListSelection, read_angle_range
from workhold.web.state import CheckedRoute, ServerState, get_client_address, get_state, run_at_desk

__all__ = ["make_attachment_header", "find_job", "get_job_result", "router"]

router = APIRouter(route_class=CheckedRoute)

# Seconds between two events of a stream at least, and at most.
PAUSE, SILENCE = 0.1, 15.0
MOST_ROWS = 1_000
EMPTY = FixtureTable.make_empty()


def find_job(request: Request, name: str) -> ServerJob:
    """Return the job with a name, and note that it was used; answer 404 where there is none."""
    job = get_state(request).jobs.get(name)
    if job is None:
        raise HTTPException(404, "There is no such search (any more): search again.")
    return job


def get_job_result(job: ServerJob, revision: int | None = None, when_over: bool = False) -> Result:
    """Return the result of a search's job.

    ``revision`` is the revision that the caller has seen, None for any; ``when_over`` refuses the result of a
    search that still runs. Answers 409 where there is no result (yet) or the revision has changed.
    """
    if job.compares:
        raise HTTPException(409, "A comparison of toolkits has no fixtures: search in one of the toolkits.")
    if job.kind == "family":
        raise HTTPException(409, "A family has plans and no list of fixtures: search for one of its parts.")
    if revision is not None and revision != job.revision:
        raise HTTPException(409, "The list of fixtures has changed meanwhile: load it again.")
    if job.result is None or (when_over and not job.is_over):
        words = "ended without a result" if job.is_over else "is not over yet"
        raise HTTPException(409, f"The search {words}.")
    return job.result


WhenLeft = Annotated[
    Literal["keep", "cancel"],
    Query(
        description="whether the job goes on, or is cancelled, when for ten seconds no client has followed "
        "its events or asked for it"
    ),
]


async def begin_job(
    request: Request, form: JobForm | ExploreForm | FamilyForm, when_left: str
) -> JSONResponse:
    """Begin the job that a form asks for; return its name and address with status 202."""
    state = get_state(request)
    address = get_client_address(request)
    state.jobs.refuse_more(address)
    queries = await run_at_desk(request, "check_job", (form, state.limits.segments))
    kind = {ExploreForm: "explore", FamilyForm: "family"}.get(type(form), "design")
    # A program's text is not kept with every job.
    asked = form.model_dump(exclude={"program": {"text": True, "tools": True}})
    sent = len(await request.body())
    job = state.jobs.submit(asked, queries, address, kind, sent, when_left == "cancel")
    url = f"{get_base_address(request)}/jobs/{job.name}"
    return JSONResponse({"job": job.name, "url": url}, 202, {"Location": url})


def get_base_address(request: Request) -> str:
    """Return "/api/v1" or "/api", whichever the request was sent to."""
    return next(base for base in BASES if request.scope["path"].startswith(f"{base}/"))


BEGUN: dict[int | str, dict[str, Any]] = {202: {"model": JobAddress}}
STATE: dict[int | str, dict[str, Any]] = {200: {"model": JobAnswer}}
STATE_SO_FAR: dict[int | str, dict[str, Any]] = {202: {"model": JobAnswer}}


@router.post("/jobs", status_code=202, summary="Search for every fixture", responses=BEGUN)
async def submit(request: Request, form: JobForm, when_left: WhenLeft = "keep") -> Response:
    """Begin a search; its state and fixtures are at the address in the answer."""
    return await begin_job(request, form, when_left)


@router.post("/explore", status_code=202, summary="Compare toolkits", responses=BEGUN)
async def explore(request: Request, form: ExploreForm, when_left: WhenLeft = "keep") -> Response:
    """Begin a comparison of toolkits; its rows appear in the job's ``table``."""
    return await begin_job(request, form, when_left)


@router.get("/jobs/{name}", summary="State of a job", responses=STATE)
async def state(request: Request, name: str) -> dict[str, Any]:
    """Return the state of a job, its findings so far, and its request without the text of a program."""
    job = find_job(request, name)
    return {**job.answer(), "request": job.request}


@router.delete("/jobs/{name}", status_code=204, summary="Stop and forget a job")
async def delete(request: Request, name: str) -> Response:
    """Stop a job and forget it; a name without a job is not an error."""
    get_state(request).jobs.delete(name)
    return Response(status_code=204)


@router.post(
    "/jobs/{name}/cancel",
    status_code=202,
    summary="Stop a job and keep what it found",
    responses=STATE_SO_FAR,
)
async def cancel(request: Request, name: str) -> dict[str, Any]:
    """Stop a job, whose state becomes ``cancelled`` within about two seconds."""
    job = find_job(request, name)
    get_state(request).jobs.cancel(job)
    return job.answer()


@router.get(
    "/jobs/{name}/events",
    summary="Follow a job",
    responses={
        200: {
            "description": "Server-sent events",
            "content": {"text/event-stream": {"schema": {"type": "string"}}},
        },
        204: {"description": "The caller has seen the last event: do not connect again"},
    },
)
async def events(
    request: Request,
    name: str,
    last_event_id: Annotated[
        str | None, Header(max_length=40, description="the ``id`` of the last event that the caller has seen")
    ] = None,
) -> Response:
    """Return server-sent events named ``state``,
    whose data is the state without the request, until the job ends.

    Each has an ``id``. A caller who connects again with the last one in the header Last-Event-ID, as browsers
    do by themselves, receives the state only if it has changed meanwhile. A comment is sent after every 15
    seconds without an event.
    """
    server, job = get_state(request), find_job(request, name)
    seen = read_seen_version(last_event_id)
    if job.is_over and seen == job.version:
        return Response(status_code=204)
    if server.streams >= server.limits.streams:
        raise HTTPException(
            503, "Too many streams of events are open: ask for the state now and then instead."
        )
    return StreamingResponse(yield_events(server, job, seen), media_type="text/event-stream")


def read_seen_version(text: str | None) -> int | None:
    """Return the version of a job from the id of an event; None for text that is not such an id, and for
    None.

    >>> read_seen_version("12"), read_seen_version("-1"), read_seen_version(None)
    (12, None, None)
    """
    return int(text) if text is not None and text.isascii() and text.isdigit() else None


async def yield_events(server: ServerState, job: ServerJob, sent: int | None) -> AsyncIterator[str]:
    """Yield the events of a job until it is over or the server closes.

    The version ``sent``, which the client has already, is skipped.
    """
    watcher = asyncio.Event()
    job.watchers.add(watcher)
    server.streams += 1
    try:
        while not server.is_closing.is_set():
            watcher.clear()
            if sent != job.version:
                sent = job.version
                data = json.dumps(job.answer(), allow_nan=False)
                yield f"id: {sent}\nevent: state\ndata: {data}\n\n"
            if job.is_over:
                return
            await asyncio.sleep(PAUSE)
            try:
                async with asyncio.timeout(SILENCE):
                    await watcher.wait()
            except TimeoutError:
                yield ": still here\n\n"
    finally:
        server.streams -= 1
        job.used = monotonic()
        job.watchers.discard(watcher)


@router.get("/jobs/{name}/fixtures", summary="Fixtures of a job")
async def fixtures(
    request: Request,
    name: str,
    offset: Annotated[int, Query(ge=0, le=10**9)] = 0,
    limit: Annotated[int, Query(ge=1, le=MOST_ROWS)] = 200,
    sort: Annotated[str, Query(max_length=40)] = "rank",
    descending: bool = False,
    type: Annotated[str | None, Query(max_length=40)] = None,
    face: Annotated[int | None, Query(ge=0, le=10**6)] = None,
    angle: Annotated[str | None, Query(max_length=60, description="from..to in degrees")] = None,
    together: Annotated[bool, Query(description="list only the first of fixtures that are alike")] = False,
    unfit: Annotated[bool, Query(description="also fixtures that no workshop can use")] = True,
) -> dict[str, Any]:
    """Return a page of the fixtures, even while the search runs; ranks count all fixtures, the best is 1."""
    job = find_job(request, name)
    selection = ListSelection(
        sort, descending, type, face, None if angle is None else read_angle_range(angle), together, unfit
    )
    revision, result = job.revision, job.result
    if result is None:
        # So that what cannot be sorted by is refused even then.
        selection.choose_indices(EMPTY, job.asked.toolkit)
        return {"total": 0, "unfit": 0, "revision": revision, "rows": []}
    found = await asyncio.to_thread(job.choose_entries, selection, result)
    page = found.index[offset : offset + limit]
    table, like = result.table.take(page), found.like[offset : offset + limit].tolist()
    holds = [result.holds[index] for index in page.tolist()] if result.holds else []
    held = result.workpiece, result.toolkit, (page + 1).tolist(), holds
    rows = await asyncio.to_thread(describe_rows, table, *held)
    bad = unfit_of(table.quality, result.query.tolerance).tolist()
    if holds:
        bad = [hold.is_unfit for hold in holds]
    rows = [
        row | {"like": more, "unfit": none, "caught": get_capture_range(result, row["rank"])}
        for row, more, none in zip(rows, like, bad, strict=True)
    ]
    return {"total": len(found.index), "unfit": found.unfit, "revision": revision, "rows": rows}


def get_capture_range(result: Result, rank: int) -> dict[str, float | None] | None:
    """Return {"opening": capture opening in mm} of the fixture of a rank; None where its seating is not
    known.

    The opening is None if the part returns to its place from every opening of the jaws.
    """
    if rank > len(result.seating):
        return None
    return {"opening": round_length(result.seating[rank - 1].capture_opening)}


@router.get("/jobs/{name}/explanation", summary="Why there is no fixture")
async def explanation(request: Request, name: str) -> dict[str, Any]:
    """Return why a finished search found no fixture.

    This is computed once and takes about as long as the search.
    """
    job = find_job(request, name)
    result = get_job_result(job, when_over=True)
    if len(result) or not result.complete:
        raise HTTPException(
            409, "There is nothing to explain: fixtures were found, or the search was not complete."
        )
    return describe_explanation(await get_state(request).jobs.explain(job), result.workpiece, result.toolkit)


@router.post("/jobs/{name}/resist", summary="The fixtures that resist loads best")
async def resist(request: Request, name: str, form: LoadsForm) -> dict[str, Any]:
    """Return the ten fixtures with the least load reaction, in N."""
    job = find_job(request, name)
    result, revision = get_job_result(job), job.revision
    best = await run_at_desk(request, "resist", (result, form))
    rows = [{"rank": rank, "load_reaction": reaction} for rank, reaction in best]
    return {"revision": revision, "best": rows}


@router.get("/jobs/{name}/result.json", summary="The result file", response_class=Response)
async def result_json(request: Request, name: str) -> Response:
    """Return the result file that ``workhold design --out`` would write."""
    from workhold.files.result.writer import write_result_text

    return download(find_job(request, name), write_result_text, "json", "application/json")


@router.get("/jobs/{name}/result.csv", summary="The fixtures as a table", response_class=Response)
async def result_csv(request: Request, name: str) -> Response:
    """Return the fixtures as comma-separated values, one line each."""
    from workhold.files.result.fixture_text import write_result_csv

    return download(find_job(request, name), write_result_csv, "csv", "text/csv; charset=utf-8")


def download(
    job: ServerJob, text: Callable[[Result], Iterator[str]], ending: str, content_type: str
) -> Response:
    """Return a file of a finished search's result, streamed and to be saved by the browser; ``text`` yields
    its parts.
    """
    result = get_job_result(job, when_over=True)
    headers = {"Content-Disposition": make_attachment_header(result.workpiece.name, ending)}
    return StreamingResponse(text(result), media_type=content_type, headers=headers)


def make_attachment_header(name: str, ending: str) -> str:
    """Return the Content-Disposition value with which a browser saves a file, its name reduced to ASCII."""
    plain = (
        "".join(c if c.isascii() and (c.isalnum() or c in "-_.") else "_" for c in name)[:80].strip(".")
        or "part"
    )
    return f'attachment; filename="{plain}.{ending}"'


Setups = Annotated[
    int | None, Query(ge=1, le=1000, description="the most set-ups; if not given, the fewest that can be")
]


def get_job_family(request: Request, name: str) -> FoundFamily:
    """Return the family that a job has found;
    answer 409 for another kind of job, and where there is none (yet).
    """
    job = find_job(request, name)
    if job.kind != "family":
        raise HTTPException(409, "This search is not of several parts: ask for a family.")
    if job.family is None:
        words = "ended without a result" if job.is_over else "is not over yet"
        raise HTTPException(409, f"The search {words}.")
    return job.family


@router.post(
    "/families", status_code=202, summary="Search for the set-ups that hold many parts", responses=BEGUN
)
async def submit_family(request: Request, form: FamilyForm, when_left: WhenLeft = "keep") -> Response:
    """Begin a search for the set-ups of a family.

    Its state is at the address in the answer, its curve at the same address with ``/family`` added.
    """
    return await begin_job(request, form, when_left)


@router.get("/jobs/{name}/family", summary="The curve of a family")
async def family(request: Request, name: str) -> dict[str, Any]:
    """Return the least worst loss for each number of set-ups, and the parts that no set-up holds."""
    return get_job_family(request, name).answer()


@router.get("/jobs/{name}/family/{kind}", summary="The plan of a family on paper", response_class=Response)
async def paper(
    request: Request,
    name: str,
    kind: Literal["curve.svg", "sheets.svg", "sheets.pdf", "plans.json"],
    setups: Setups = None,
    unit: Literal["mm", "inch"] = "mm",
    day: Annotated[date | None, Query(alias="date")] = None,
) -> Response:
    """Return the curve with a point marked, the sheets of its plan, or the family's file."""
    found = get_job_family(request, name)
    if not found.plans and kind != "plans.json":
        raise HTTPException(409, "No pattern of pegs holds any of the parts.")
    content = await run_at_desk(
        request, "family_paper", FamilyPaper(kind, found, setups, unit, day or date.today())
    )
    what, ending = kind.split(".")
    headers = (
        {} if ending == "svg" else {"Content-Disposition": make_attachment_header(f"family-{what}", ending)}
    )
    return Response(content, media_type=PAPERS[kind], headers=headers)
