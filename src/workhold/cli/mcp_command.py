"""``workhold mcp``: tools for agents over the Model Context Protocol, on standard input and output."""

from __future__ import annotations

import json
from base64 import b64encode
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event
from typing import Any

from workhold.errors import InputError
from workhold.limits import lacks_memory
from workhold.version import __version__

__all__ = ["mcp", "outcome"]

# What the extra asks for.
REQUIREMENT = "mcp>=2"
# Of a picture, in pixels.
WIDTH = 1000
INSTRUCTIONS = (
    "workhold finds every way to hold a flat part with round pegs: in a vise whose jaws carry a lattice of holes, on a "
    "plate with locators and a clamp or two, or on a fence. load a part to see the numbers of its faces, design to find all "
    "fixtures (avoid the faces that will be machined), show one of them, write its sheet; explain where there is none. "
    "Lengths are in mm, angles in degrees, forces in N."
)


def mcp() -> None:
    """Offer load, design, show, sheet and explain as tools to an agent, over the Model Context Protocol.

    The agent's program starts this command and speaks with it on standard input and output; it is no command for people. It
    reads and writes the files that the agent names, with the rights of whoever starts it.

    Example: workhold mcp
    """
    try:
        from mcp.server.stdio import stdio_server
    except ImportError as error:
        raise InputError(f"this needs a library that is not installed: pip install '{REQUIREMENT}'.") from error
    import anyio

    async def serve(folder: Path) -> None:
        server = tool_server(folder)
        async with stdio_server() as (incoming, outgoing):
            await server.run(incoming, outgoing, server.create_initialization_options())

    with TemporaryDirectory(prefix="workhold-") as folder:
        anyio.run(serve, Path(folder))


def tool_server(folder: Path) -> Any:
    """The server of the tools; results that nobody names a file for are in a folder."""
    import mcp_types as types
    from anyio import get_cancelled_exc_class
    from anyio.to_thread import run_sync
    from mcp.server import Server

    from workhold.cli.agent_tools import TOOLS

    async def list_tools(context: Any, asked: Any) -> types.ListToolsResult:
        return types.ListToolsResult(
            tools=[
                types.Tool(name=name, description=tool.words, input_schema=tool.arguments.model_json_schema())
                for name, tool in TOOLS.items()
            ]
        )

    async def call_tool(context: Any, asked: types.CallToolRequestParams) -> types.CallToolResult:
        cancel = Event()
        try:
            work = partial(outcome, asked.name, asked.arguments, folder, cancel)
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


def outcome(
    name: str, arguments: dict[str, Any] | None, folder: Path, cancel: Event
) -> tuple[dict[str, Any] | str, str | None, bool]:
    """What a tool says, its picture as PNG in base 64 where there is one, and whether it failed: then it is a sentence."""
    from workhold.cli.agent_tools import TOOLS
    from workhold.cli.tool_forms import checked_arguments

    try:
        if name not in TOOLS:
            raise InputError(f"there is no tool {name[:40]!r}: the tools are {', '.join(TOOLS)}.")
        tool = TOOLS[name]
        answer = tool.run(checked_arguments(tool.arguments, arguments), folder, cancel)
        if answer.picture is None:
            return answer.data, None, False
        from workhold.drawing.render import svg_to_png

        return answer.data, b64encode(svg_to_png(answer.picture, WIDTH)).decode("ascii"), False
    except InputError as error:
        return str(error), None, True
    except Exception as error:
        if lacks_memory(error):
            return "This needs more memory than there is: ask for the best few only.", None, True
        what = " ".join(f"{type(error).__name__}: {error}".split())[:300].rstrip(".")
        return f"This is a mistake of workhold, not of yours ({what}); please report it.", None, True
