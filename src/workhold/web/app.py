"""The application: routes, errors as plain sentences, and the guard before them."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import JSONResponse, Response

from workhold.errors import InputError
from workhold.version import __version__
from workhold.web import fixture_routes, job_routes, part_routes
from workhold.web.answers import find_first_place
from workhold.web.description import describe_app
from workhold.web.guard import BASES, AllowedHosts, Guard, ServerLimits
from workhold.web.jobs import TooManyError
from workhold.web.origins import AllowedOrigins
from workhold.web.pool import BusyError, FailedError, StoppedError
from workhold.web.request_forms import explain_request_error
from workhold.web.state import ServerState, get_state

__all__ = ["create_app"]

VERSIONED = BASES[0]
ABOUT = """Lengths are in mm, angles in degrees, forces in N.

Addresses begin with `/api/v1`. Within this version keys and values may be added, and none goes or changes
its meaning. The same is at `/api`, which is always the newest version.
"""
# What the libraries below say, in the words of this server.
SENTENCES = {
    "Not Found": "There is nothing at this address.",
    "Method Not Allowed": "This cannot be done at this address.",
    "There was an error parsing the body": "The request is not valid JSON: send one object.",
}


def create_app(
    limits: ServerLimits | None = None,
    hosts: AllowedHosts | None = None,
    token: str | None = None,
    origins: AllowedOrigins | None = None,
) -> FastAPI:
    """Return the application.

    Parameters
    ----------
    limits : sizes, counts, times and memory that the server allows.
    hosts : host names under which the server may be addressed; by default only those of this machine.
    token : secret that every request must contain; None for none.
    origins : origins of other sites' pages that may use the server; none by default.
    """
    limits = limits or ServerLimits()

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        """Run the workers while the application runs."""
        app.state.server = ServerState(limits)
        async with app.state.server.open():
            yield

    app = FastAPI(
        title="workhold",
        version=__version__,
        summary="Finds every way to hold a flat part: pegs in a vise, dowels and clamps on a plate, a fence "
        "and a stop.",
        description=ABOUT,
        lifespan=lifespan,
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        separate_input_output_schemas=False,
    )
    for base in BASES:
        for room in (part_routes, job_routes, fixture_routes):
            app.include_router(room.router, prefix=base, include_in_schema=base == VERSIONED)
        app.add_api_route(f"{base}/openapi.json", send_description, include_in_schema=False)
    app.add_api_route("/", send_page, methods=["GET", "HEAD"], include_in_schema=False)
    app.add_api_route("/method", redirect_to_method_page, methods=["GET", "HEAD"], include_in_schema=False)
    app.add_api_route(
        "/static/{path:path}", send_static_file, methods=["GET", "HEAD"], include_in_schema=False
    )
    add_error_handlers(app)
    app.add_middleware(
        Guard, hosts=hosts or AllowedHosts(), limits=limits, token=token, origins=origins or AllowedOrigins()
    )
    app.openapi = lambda: describe_app(app)  # type: ignore[method-assign]
    return app


async def send_description(request: Request) -> dict[str, Any]:
    """Return the description of the interface."""
    server: FastAPI = request.app
    return server.openapi()


async def send_page(request: Request) -> Response:
    """Return the page."""
    return await send_static_file(request, "index.html")


async def redirect_to_method_page(request: Request) -> Response:
    """Return a redirect to the page that explains the method."""
    return Response(status_code=307, headers={"Location": "static/method/index.html"})


async def send_static_file(request: Request, path: str) -> Response:
    """Return a file of the page; status 304 if the client has it already, 404 if there is no such file."""
    file = get_state(request).files.get(path)
    if file is None:
        raise HTTPException(404, "There is no such page.")
    headers = {"ETag": file.tag, "Cache-Control": "no-cache", "Content-Type": file.type}
    if request.headers.get("if-none-match") == file.tag:
        return Response(status_code=304, headers=headers)
    return Response(file.content, headers=headers)


def make_error_response(status: int, sentence: str, headers: dict[str, str] | None = None) -> JSONResponse:
    """Return an error as JSON: the sentence and, for status 400, the place in the drawing that the sentence
    names.
    """
    more = {"Retry-After": "1"} if status in (429, 503) else {}
    if status in (408, 413):
        more["Connection"] = "close"
    place = find_first_place(sentence) if status == 400 else None
    return JSONResponse({"error": sentence, "place": place}, status, {**more, **(headers or {})})


def add_error_handlers(app: FastAPI) -> None:
    """Make the application answer every error with a status and one sentence."""

    def add_handler(error_class: type[Exception], status: int) -> None:
        """Make the application answer errors of this class with ``status`` and the error's own sentence."""

        async def handle_error(request: Request, error: Exception) -> Response:
            return make_error_response(status, str(error) or "The search was stopped.")

        app.add_exception_handler(error_class, handle_error)

    add_handler(InputError, 400)
    add_handler(TooManyError, 429)
    add_handler(BusyError, 503)
    add_handler(FailedError, 503)
    add_handler(StoppedError, 409)

    async def handle_faulty_request(request: Request, error: Exception) -> Response:
        """Return 400 with the first fault that pydantic finds in a request."""
        assert isinstance(error, RequestValidationError)
        return make_error_response(400, explain_request_error(dict(error.errors()[0])))

    async def handle_http_error(request: Request, error: Exception) -> Response:
        """Return the status of an HTTPException with its sentence."""
        assert isinstance(error, HTTPException)
        sentence = SENTENCES.get(str(error.detail), str(error.detail))
        return make_error_response(error.status_code, sentence, dict(error.headers or {}))

    async def handle_early_end(request: Request, error: Exception) -> Response:
        """Return 400 for a request that ended early."""
        return make_error_response(400, "The request ended before it was complete.")

    async def handle_other_error(request: Request, error: Exception) -> Response:
        """Return 500 for an error that nothing else handles."""
        return make_error_response(500, "The program has a mistake, which is not yours; please report it.")

    app.add_exception_handler(RequestValidationError, handle_faulty_request)
    app.add_exception_handler(HTTPException, handle_http_error)
    app.add_exception_handler(ClientDisconnect, handle_early_end)
    # The server's log says what it was.
    app.add_exception_handler(Exception, handle_other_error)
