"""``workhold serve``: the page, on this machine or for others."""

from __future__ import annotations

from ipaddress import ip_address
from secrets import token_urlsafe
from threading import Event
from typing import Annotated, Any

import typer

from workhold.cli.values import positive_number, whole_number
from workhold.errors import InputError

__all__ = ["serve"]

LIMITS = "Limits"
HIGHEST_PORT = 65_535
TOKEN_BYTES = 16
OPEN_TO_ALL = (
    "workhold: everybody who reaches this machine can use the page, read what others search for if told its name, and keep "
    "the processors busy; --ask-token lets in only who has the address."
)
# Processes that search: each takes a hundred megabytes before it begins.
MOST_SEARCHES = 256
FIRST_RUN = "workhold: compiling for this machine, which takes half a minute or so the first time."


def limit(metavar: str, variable: str, help: str) -> typer.models.OptionInfo:
    """An option that is a limit and can come from the environment."""
    option: typer.models.OptionInfo = typer.Option(
        metavar=metavar, envvar=f"WORKHOLD_{variable}", help=help, rich_help_panel=LIMITS
    )
    return option


def serve(
    host: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Where to listen; 0.0.0.0 lets other machines in.")
    ] = "127.0.0.1",
    port: Annotated[str, typer.Option(metavar="PORT", help="Port to listen at; 0 takes a free one.")] = "8000",
    open_: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    allow_host: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Another name that the server may be called by. May be repeated."),
    ] = None,
    trust_proxy: Annotated[
        list[str] | None,
        typer.Option(metavar="ADDRESS", help="A reverse proxy that says for whom it asks. May be repeated."),
    ] = None,
    ask_token: Annotated[
        bool, typer.Option("--ask-token", help="Let in only who has the address that is printed.")
    ] = False,
    upload_size: Annotated[str, limit("MB", "UPLOAD_SIZE", "Largest file with a part.")] = "20",
    searches: Annotated[str, limit("N", "SEARCHES", "Searches at the same time.")] = "2",
    seconds: Annotated[str, limit("S", "SECONDS", "Longest search; what was found by then is shown.")] = "120",
    memory: Annotated[
        str | None, limit("MB", "MEMORY", "Most memory of each search: 4096, or less on a small machine.")
    ] = None,
    fixtures: Annotated[str, limit("N", "FIXTURES", "Most fixtures kept of a search, the best ones.")] = "300000",
    life: Annotated[str, limit("MINUTES", "LIFE", "How long a search is kept after its last use.")] = "60",
) -> None:
    """Serve the page: from a drawing to a setup sheet in the browser.

    It can be used from this machine only, unless --host says otherwise. The same is there for programs: see
    /api/openapi.json. Ctrl-C stops it.

    Example: workhold serve --open
    """
    at = whole_number("--port", port)
    if not 0 <= at <= HIGHEST_PORT:
        raise InputError(f"--port {port} is no port: give a number from 0 to {HIGHEST_PORT}.")
    figures: dict[str, Any] = {
        "upload_bytes": int(1e6 * limit_value("--upload-size", upload_size)),
        "searches": int(limit_value("--searches", searches)),
        "seconds": limit_value("--seconds", seconds),
        "fixtures": int(limit_value("--fixtures", fixtures)),
        "life_seconds": 60 * limit_value("--life", life),
    }
    if figures["searches"] < 1 or figures["fixtures"] < 1:
        raise InputError("--searches and --fixtures are counts: give 1 or more.")
    if figures["searches"] > MOST_SEARCHES:
        raise InputError(
            f"--searches {figures['searches']:,} is beyond {MOST_SEARCHES}: one for each processor is best."
        )
    for proxy in trust_proxy or ():
        refuse_no_address(proxy)
    from workhold.web.limits import Limits, usual_memory
    from workhold.web.serve import is_for_others, run_server

    most = usual_memory(figures["searches"]) if memory is None else int(limit_value("--memory", memory)) << 20

    def listening(address: str) -> None:
        typer.echo(f"workhold is at {address} (Ctrl-C stops it)")
        if is_for_others(host) and not ask_token:
            typer.echo(OPEN_TO_ALL, err=True)
        if open_:
            import webbrowser

            webbrowser.open(address)

    token = token_urlsafe(TOKEN_BYTES) if ask_token else None
    limits = Limits(memory_bytes=most, **figures)
    run_server(host, at, limits, allow_host or (), trust_proxy or (), token, listening, prepare)


def refuse_no_address(text: str) -> None:
    """Refuse what is not the numeric address of a proxy.

    Raises
    ------
    InputError
        Naming it.
    """
    try:
        ip_address(text)
    except ValueError:
        raise InputError(f"--trust-proxy {text!r} is no address: give a number such as 10.0.0.2.") from None


def limit_value(option: str, text: str) -> float:
    """A positive number.

    Raises
    ------
    InputError
        For anything else.
    """
    value = positive_number(option, text)
    if not value:
        raise InputError(f"{option} {text!r} leaves nothing: give a positive number.")
    return value


def prepare() -> None:
    """Compile the kernels on a first run, before workers would do so one after the other."""
    from workhold.cli.warming import compile_kernels, compile_seating, is_seating_compiled
    from workhold.kernels.base.compiling import is_first_run

    first_run = is_first_run()
    if first_run or not is_seating_compiled():
        typer.echo(FIRST_RUN, err=True)
    if first_run:
        compile_kernels(Event())
    compile_seating(Event())
