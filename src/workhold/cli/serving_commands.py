"""The commands that serve a browser, an agent or a shell: ``serve``, ``mcp`` and ``completion``.

``serve`` offers the page on this machine or to others. ``mcp`` offers tools to an agent over the Model
Context Protocol, on standard input and output.
"""

from __future__ import annotations

import json
import sys
from base64 import b64encode
from functools import partial
from ipaddress import ip_address
from pathlib import Path
from secrets import token_urlsafe
from tempfile import TemporaryDirectory
from threading import Event
from typing import TYPE_CHECKING, Annotated, Any

import typer
import typer.completion
from attrs import frozen

from workhold.cli.commands import make_flag, make_option, spread_option_groups
from workhold.cli.values import read_choice, read_positive_number, read_whole_number
from workhold.errors import InputError, lacks_memory
from workhold.version import __version__

if TYPE_CHECKING:
    from workhold.web.guard import ServerLimits

__all__ = ["completion", "mcp", "run_tool", "serve"]

LIMITS = "Limits"
HIGHEST_PORT = 65_535
TOKEN_BYTES = 16
OPEN_TO_ALL = (
    "workhold: everybody who reaches this machine can use the page, keep the processors "
    "busy, and read another person's search if given its name; --ask-token lets in only "
    "those who have the address."
)
# Processes that search: each takes a hundred megabytes before it begins.
MOST_SEARCHES = 256
FIRST_RUN = (
    "workhold: the kernels are being compiled for this machine, which takes a minute or two the first time."
)


def make_limit_option(default: str | None, metavar: str, variable: str, help: str) -> Any:
    """Return a Typer option of a limit whose value may also come from the environment variable
    WORKHOLD_<variable>.
    """
    return typer.Option(
        default, metavar=metavar, envvar=f"WORKHOLD_{variable}", help=help, rich_help_panel=LIMITS
    )


@frozen
class ServerOptions:
    """The options of the server's address and its trusted clients, as typed."""

    host: str = make_option(
        None, "ADDRESS", "Address to listen at; 0.0.0.0 lets other machines in.", default="127.0.0.1"
    )
    port: str = make_option(None, "PORT", "Port to listen at; 0 takes a free one.", default="8000")
    open_: bool = make_flag(None, "Open the page in the browser.", "--open")
    allow_host: list[str] | None = make_option(
        None, "NAME", "Another name by which clients may call the server. May be repeated."
    )
    trust_proxy: list[str] | None = make_option(
        None, "ADDRESS", "A reverse proxy whose word for the visitor's address is trusted. May be repeated."
    )
    allow_origin: list[str] | None = make_option(
        None,
        "ORIGIN",
        "A site whose pages may use the server, such as https://shop.example. May be repeated.",
    )
    ask_token: bool = make_flag(
        None, "Let in only those who have the address that is printed.", "--ask-token"
    )

    def read_port(self) -> int:
        """Return the port; raise InputError for what is not a port."""
        at = read_whole_number("--port", self.port)
        if not 0 <= at <= HIGHEST_PORT:
            raise InputError(f"--port {self.port} is not a port: give a number from 0 to {HIGHEST_PORT}.")
        return at

    def read_proxies(self) -> list[str]:
        """Return the addresses of trusted proxies; raise InputError for what is not an IP address."""
        for proxy in self.trust_proxy or ():
            try:
                ip_address(proxy)
            except ValueError:
                raise InputError(
                    f"--trust-proxy {proxy!r} is not an address: give a number such as 10.0.0.2."
                ) from None
        return self.trust_proxy or []

    def announce(self, address: str) -> None:
        """Print where the page is, and open it in the browser if asked."""
        from workhold.web.serve import is_for_others

        typer.echo(f"workhold is at {address} (Ctrl-C stops it)")
        if is_for_others(self.host) and not self.ask_token:
            typer.echo(OPEN_TO_ALL, err=True)
        if self.open_:
            import webbrowser

            webbrowser.open(address)


@frozen
class LimitOptions:
    """The options that limit the server's resources, as typed or from the environment."""

    upload_size: str = make_limit_option("20", "MB", "UPLOAD_SIZE", "Largest file with a part.")
    searches: str = make_limit_option("2", "N", "SEARCHES", "Number of searches that run at the same time.")
    seconds: str = make_limit_option(
        "120", "S", "SECONDS", "Longest time of a search; the fixtures found by then are shown."
    )
    memory: str | None = make_limit_option(
        None, "MB", "MEMORY", "Most memory of each search: 4096, or less on a small machine."
    )
    fixtures: str = make_limit_option(
        "300000", "N", "FIXTURES", "Most fixtures kept of a search, the best ones."
    )
    life: str = make_limit_option("60", "MINUTES", "LIFE", "Time that a search is kept after its last use.")

    def read_limits(self) -> ServerLimits:
        """Return the server's limits in bytes, seconds and counts;
        raise InputError for what is too small or too large.
        """
        upload_size = int(1e6 * read_positive_number("--upload-size", self.upload_size))
        searches = int(read_positive_number("--searches", self.searches))
        seconds = read_positive_number("--seconds", self.seconds)
        fixtures = int(read_positive_number("--fixtures", self.fixtures))
        life = 60 * read_positive_number("--life", self.life)
        if searches < 1 or fixtures < 1:
            raise InputError("--searches and --fixtures are numbers: give 1 or more.")
        if searches > MOST_SEARCHES:
            raise InputError(
                f"--searches {searches:,} is beyond {MOST_SEARCHES}: one for each processor is best."
            )
        from workhold.web.guard import ServerLimits, compute_usual_memory

        return ServerLimits(
            upload_bytes=upload_size,
            searches=searches,
            seconds=seconds,
            fixtures=fixtures,
            life_seconds=life,
            memory_bytes=compute_usual_memory(searches)
            if self.memory is None
            else int(read_positive_number("--memory", self.memory)) << 20,
        )


@spread_option_groups
def serve(*, words: ServerOptions, limits: LimitOptions) -> None:
    """Serve the page: from a drawing to a setup sheet in the browser.

    Only this machine can use the page, unless --host names another address. Other programs can use the same
    server: see /api/openapi.json. Ctrl-C stops it.

    Example: workhold serve --open
    """
    port, most, proxies = words.read_port(), limits.read_limits(), words.read_proxies()
    from workhold.web.origins import check_origin
    from workhold.web.serve import run_server

    origins = [check_origin(one) for one in words.allow_origin or ()]
    token = token_urlsafe(TOKEN_BYTES) if words.ask_token else None
    names = words.allow_host or ()
    run_server(words.host, port, most, names, proxies, token, words.announce, prepare, origins)


def prepare() -> None:
    """Compile the kernels if that is not done yet, so that workers do not compile them one after the other."""
    from workhold.cli.warming import compile_kernels, compile_seating
    from workhold.kernels.base.libraries import ROOMS, is_built

    if not is_built(ROOMS):
        typer.echo(FIRST_RUN, err=True)
    compile_kernels(Event())
    compile_seating(Event())


# What the extra asks for.
REQUIREMENT = "mcp>=2"
# Of a picture, in pixels.
WIDTH = 1000
INSTRUCTIONS = (
    "workhold finds every way to hold a flat part with round pegs: in a vise whose jaws "
    "carry a lattice of holes, on a plate with locators and a clamp or two, or on a fence. "
    "Use load to read a part and see the numbers of its faces, design to find all fixtures "
    "(avoid the faces that will be machined), show for one of them, sheet to write its setup "
    "sheet, and explain if there is none. Lengths are in mm, angles in degrees, forces in N."
)


def mcp() -> None:
    """Offer load, design, show, sheet and explain as tools to an agent, over the Model Context Protocol.

    The agent's program starts this command and speaks with it on standard input and output; people do not
    type it. It reads and writes the files that the agent names, with the rights of the user who starts it.

    Example: workhold mcp
    """
    try:
        from mcp.server.stdio import stdio_server
    except ImportError as error:
        raise InputError(
            f"this needs a library that is not installed: pip install '{REQUIREMENT}'."
        ) from error
    import anyio

    async def serve(folder: Path) -> None:
        """Serve the tools on stdin and stdout until the client closes them."""
        server = make_tool_server(folder)
        async with stdio_server() as (incoming, outgoing):
            await server.run(incoming, outgoing, server.create_initialization_options())

    with TemporaryDirectory(prefix="workhold-") as folder:
        anyio.run(serve, Path(folder))


def make_tool_server(folder: Path) -> Any:
    """Return the MCP server of the tools; a result whose file is not named is written into ``folder``."""
    import mcp_types as types
    from anyio import get_cancelled_exc_class
    from anyio.to_thread import run_sync
    from mcp.server import Server

    from workhold.cli.agent_tools import TOOLS

    async def list_tools(context: Any, asked: Any) -> types.ListToolsResult:
        """Return all tools with descriptions and schemas of arguments."""
        return types.ListToolsResult(
            tools=[
                types.Tool(name=name, description=tool.words, input_schema=tool.arguments.model_json_schema())
                for name, tool in TOOLS.items()
            ]
        )

    async def call_tool(context: Any, asked: types.CallToolRequestParams) -> types.CallToolResult:
        """Return what a tool says, with its picture; a cancelled call stops the tool's search."""
        cancel = Event()
        try:
            work = partial(run_tool, asked.name, asked.arguments, folder, cancel)
            data, picture, failed = await run_sync(work, abandon_on_cancel=True)
        except get_cancelled_exc_class():
            cancel.set()
            raise
        if isinstance(data, str):
            return types.CallToolResult(content=[types.TextContent(type="text", text=data)], is_error=failed)
        content: list[Any] = [types.TextContent(type="text", text=json.dumps(data, allow_nan=False))]
        if picture is not None:
            content.append(types.ImageContent(type="image", data=picture, mime_type="image/png"))
        return types.CallToolResult(content=content, structured_content=data)

    tools = {"on_list_tools": list_tools, "on_call_tool": call_tool}
    return Server("workhold", version=__version__, instructions=INSTRUCTIONS, **tools)


def run_tool(
    name: str, arguments: dict[str, Any] | None, folder: Path, cancel: Event
) -> tuple[dict[str, Any] | str, str | None, bool]:
    """Return (data, picture, failed) of a tool: the picture is a PNG in base 64, or None.

    If the tool failed, the data are a sentence that says why.
    """
    from workhold.cli.agent_arguments import check_arguments
    from workhold.cli.agent_tools import TOOLS

    try:
        if name not in TOOLS:
            raise InputError(f"there is no tool {name[:40]!r}: the tools are {', '.join(TOOLS)}.")
        tool = TOOLS[name]
        answer = tool.run(check_arguments(tool.arguments, arguments), folder, cancel)
        if answer.picture is None:
            return answer.data, None, False
        from workhold.drawing.render import convert_svg_to_png

        return answer.data, b64encode(convert_svg_to_png(answer.picture, WIDTH)).decode("ascii"), False
    except InputError as error:
        return str(error), None, True
    except Exception as error:
        if lacks_memory(error):
            return "This needs more memory than there is: ask for the best few fixtures only.", None, True
        what = " ".join(f"{type(error).__name__}: {error}".split())[:300].rstrip(".")
        return f"workhold has a mistake, which is not yours ({what}); please report it.", None, True


SHELLS = ("bash", "zsh", "fish")
# What the shell sets when it asks for words; see ``WorkholdGroup`` in ``cli.main``.
VARIABLE = "_WORKHOLD_COMPLETE"


def completion(shell: Annotated[str, typer.Argument(metavar="SHELL", help="bash, zsh or fish.")]) -> None:
    """Print a script with which a shell completes the commands and options of workhold.

    In ~/.bashrc: eval "$(workhold completion bash)"; in ~/.zshrc, after compinit: eval "$(workhold completion
    zsh)"; for fish write it to ~/.config/fish/completions/workhold.fish.

    Example: workhold completion bash
    """
    name = read_choice("the shell", shell, SHELLS)
    script = typer.completion.get_completion_script(  # type: ignore[attr-defined]
        prog_name="workhold", complete_var=VARIABLE, shell=name
    )
    sys.stdout.write(script + "\n")
    sys.stdout.flush()
