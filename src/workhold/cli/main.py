"""The command ``workhold``: its subcommands, and what happens when something goes wrong.

Exit codes are 0 when it is done (even if no fixture exists), 1 for a fault of workhold, and 2 for bad input
or a refuted result. They are 130 when it was interrupted, 141 when nobody reads the output any more, and 143
when it was terminated.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import Annotated, Any, NoReturn

import typer
from typer.main import get_command

from workhold import __version__
from workhold.cli.commands import PlainCommand, PlainGroup, print_remark, redirect_to_null
from workhold.cli.ending import INTERRUPTED, end_on_signals, exit_with_code, report_interrupted_once
from workhold.errors import NO_ROOM, InputError, lacks_memory
from workhold.limits import refuse_little_space

__all__ = ["COMMANDS", "app", "run"]

DONE, FAULT, BAD_INPUT, NO_READER = 0, 1, 2, 141
# Bytes of address space: with less, what NumPy brings along ends the process with a complaint of its own.
LEAST_SPACE = 160_000_000

# Typer has no public name for the base of its complaints about the command line itself.
UsageError: type[Exception] = typer.BadParameter.__mro__[1]

EXAMPLES = f"""
{typer.style("Examples:", bold=True)}
  workhold design part.dxf --pitch 10 --columns 2 --peg-radius 3 --out part.json
      every way to hold the part between two jaws with two columns of holes
      each, 10 mm apart, and pegs of 6 mm diameter
  workhold show part.json 1 --draw setup.png
      how to set up the best of them, with a picture for the wall
  workhold sheet part.json 1 -o setup.pdf
      the same to scale on paper, with all there is to know at the machine
  workhold features part.dxf --draw faces.svg
      the numbers of the part's faces, to talk about them

Lengths are in millimetres, or in the unit of --unit; a length may carry a unit
of its own, such as 0.5in. workhold COMMAND --help explains a command.
"""

# The commands, each with the first paragraph of its help.
COMMANDS = {
    "design": "Find every way to hold PART in a vise, or on a plate with a clamp or two.",
    "show": (
        "Show how to set up fixture N of a result: the holes for the pegs, the opening and the part's pose."
    ),
    "seat": (
        "Report whether the part ends up in the pose of fixture N when you tighten the vise or the clamp."
    ),
    "supports": (
        "Report where three supports hold the part up under fixture N, and where a clamp presses it down."
    ),
    "straps": (
        "Report where strap clamps hold the part of fixture N down against its three locators, with the least force."
    ),
    "bend": (
        "Report how far clamps bend the part of fixture N, or of the best fixtures, and how far the part moves "
        "at the cutter."
    ),
    "sheet": (
        "Write the setup sheet of fixture N of a result: plan to scale, pegs, opening, part zero, quality, "
        "loads, cautions."
    ),
    "convert": (
        "Write a result file in another form: JSON, columns (npz) for a great many fixtures, or CSV for a "
        "spreadsheet."
    ),
    "explore": "Try PART in many toolkits: how many fixtures each has, and the figures of its first choice.",
    "copies": "Report how many copies of fixture N a plate holds at once, and the place of each.",
    "family": "Report which peg patterns hold many of PARTS, and how much quality is lost with fewer set-ups.",
    "batch": (
        "Try many parts in many toolkits: every part with every toolkit, into tables, a report and result "
        "files."
    ),
    "benchmark": (
        "List the sets of the benchmark, make their complete lists, or compare another program's with them."
    ),
    "features": "List the numbered faces of PART, as pictures and result files name them.",
    "parts": "List the built-in parts.",
    "program": (
        "Report how workhold reads a program for the mill: tools, lengths, heights, time, lines left out."
    ),
    "toolkits": "List the vises, plates and fences that come with workhold, or show all figures of one.",
    "drill": "Write drawings of a vise's jaw plates with their dowel holes and bolt holes, to drill them by.",
    "verify": "Prove or refute every fixture of a result, and every number written with it.",
    "schema": "Print the JSON Schema of a part, a toolkit, loads, a query or a result, or list them.",
    "serve": "Serve the page: from a drawing to a setup sheet in the browser.",
    "mcp": (
        "Offer load, design, show, sheet and explain as tools to an agent, over the Model Context Protocol."
    ),
    "workbench": (
        "Answer FreeCAD's workbench: design, and give the bodies and pictures of the chosen fixture."
    ),
    "doctor": "Report what is installed, what is missing, and what each missing library would be good for.",
    "completion": "Print a script with which a shell completes the commands and options of workhold.",
}

# The modules of several commands; every other command stands in a module of its own. A command is the
# function of its name, and its module is imported when it is asked for: nobody waits for the others.
SHARED_MODULES = {
    "catalogue_commands": ("features", "parts", "toolkits"),
    "installed_commands": ("doctor", "schema"),
    "result_commands": ("convert", "verify"),
    "serving_commands": ("completion", "mcp", "serve"),
    "workshop_commands": ("copies", "drill"),
}
MODULES = {name: f"{name}_command" for name in COMMANDS} | {
    name: module for module, names in SHARED_MODULES.items() for name in names
}


def import_command(name: str) -> Callable[..., None]:
    """Return the function of a command, importing its module."""
    command: Callable[..., None] = getattr(import_module(f"workhold.cli.{MODULES[name]}"), name)
    return command


@contextmanager
def handle_exits() -> Iterator[None]:
    """Raise typer.Exit with workhold's exit codes for Ctrl-C and a broken pipe within the block."""
    try:
        yield
    except KeyboardInterrupt as error:
        report_interrupted_once()
        raise typer.Exit(INTERRUPTED) from error
    except BrokenPipeError as error:
        redirect_to_null(sys.stdout)
        raise typer.Exit(NO_READER) from error


class WorkholdGroup(PlainGroup):
    """The commands, each of which ends with an exit code and at most one sentence about what went wrong."""

    def __init__(self, **about: Any) -> None:
        super().__init__(**about)
        self.commands = {name: PlainCommand(name, help=words) for name, words in COMMANDS.items()}

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command, importing its module; None for a word that names none."""
        if cmd_name not in COMMANDS:
            return None
        alone = typer.Typer(add_completion=False, rich_markup_mode=None)
        alone.command(cmd_name, cls=PlainCommand)(import_command(cmd_name))
        return get_command(alone)

    def make_context(self, *args: Any, **extra: Any) -> Any:
        """Return the context with the parsed arguments; print the help and exit where the help is asked for."""
        with handle_exits():
            return super().make_context(*args, **extra)

    def _main_shell_completion(self, ctx_args: Any, prog_name: str, complete_var: str | None = None) -> None:
        """Complete words for a shell where the environment asks for it;
        Typer knows the shells only after its set-up.
        """
        if any(name.endswith("_COMPLETE") for name in os.environ):
            import typer.completion

            typer.completion.completion_init()  # type: ignore[attr-defined]
        super()._main_shell_completion(ctx_args, prog_name, complete_var)

    def invoke(self, ctx: Any) -> Any:
        """Return what the command returns.

        Refuses to run where the process has too little address space.
        """
        refuse_little_space(LEAST_SPACE, "workhold", "raise the limit")
        with handle_exits():
            return super().invoke(ctx)

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        """Run the command of the arguments and exit the process.

        Where ``standalone_mode`` is off, return the exit code instead of exiting.
        """
        command = super().main
        code = exit_code(lambda: command(args, prog_name, complete_var, False, windows_expand_args, **extra))
        if standalone_mode:
            sys.exit(code)
        return code


app = typer.Typer(
    name="workhold",
    cls=WorkholdGroup,
    help="Finds every way to hold a flat part: pegs in a vise, dowels and clamps on a plate, a fence and a "
    "stop.",
    epilog=EXAMPLES,
    add_completion=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def show_version(wanted: bool) -> None:
    """Print the version and exit, if wanted."""
    if wanted:
        typer.echo(f"workhold {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=show_version, is_eager=True, help="Print the version and stop."),
    ] = False,
) -> None:
    """Options of workhold itself; the help above is the app's."""


def run() -> NoReturn:
    """Run workhold on the arguments of the process, and end the process."""
    for stream in (sys.stdout, sys.stderr):
        # A part's name must not end the program on a terminal that lacks a letter.
        with suppress(AttributeError, ValueError):
            stream.reconfigure(errors="replace")  # type: ignore[union-attr]
    end_on_signals()
    # Every matrix here is small; threads to multiply large ones would only be started and never used.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    code = int(app(standalone_mode=False))
    exit_with_code(exit_code(sys.stdout.flush) or code)


def exit_code(command: Callable[[], Any]) -> int:
    """Run a command here and return its exit code; print one sentence on stderr if it failed."""
    try:
        return int(command() or DONE)
    except InputError as error:
        print_message(f"error: {error}")
        return BAD_INPUT
    except UsageError as error:
        return print_usage_error(error)
    except (KeyboardInterrupt, typer.Abort):
        report_interrupted_once()
        return INTERRUPTED
    except BrokenPipeError:
        redirect_to_null(sys.stdout)
        return NO_READER
    except Exception as error:
        if lacks_memory(error):
            print_message(
                "error: this needs more memory than there is: close other programs, use fewer threads, or "
                "raise the limit."
            )
            return BAD_INPUT
        if isinstance(error, OSError) and error.errno in NO_ROOM:
            redirect_to_null(sys.stdout)
            print_message(f"error: the output cannot be written: {error.strerror}.")
            return BAD_INPUT
        report_fault(error)
        return FAULT


def print_usage_error(error: Exception) -> int:
    """Print what is wrong with the command line and how to get help; return BAD_INPUT."""
    message = str(getattr(error, "message", "") or error)
    with suppress(Exception):
        message = error.format_message()  # type: ignore[attr-defined]
    context = getattr(error, "ctx", None)
    command = getattr(context, "command_path", "workhold")
    print_message(f"error: {message.rstrip('.')}; see {command} --help.")
    return BAD_INPUT


def print_message(message: str) -> None:
    """Print a message on stderr as one remark, line breaks replaced by spaces."""
    print_remark(" ".join(message.split()))


def report_fault(error: Exception) -> None:
    """Print that the program has a mistake.

    The traceback goes to a temporary file, or to stderr where the environment says so.
    """
    import tempfile
    import traceback

    what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    text = "".join(traceback.format_exception(error))
    if os.environ.get("WORKHOLD_TRACEBACK"):
        typer.echo(text, err=True)
        place = "above"
    else:
        try:
            with tempfile.NamedTemporaryFile(
                "w", encoding="utf-8", prefix="workhold-fault-", suffix=".txt", delete=False
            ) as file:
                file.write(text)
            place = f"in {file.name}"
        except OSError:
            place = "shown with WORKHOLD_TRACEBACK=1"
    print_message(
        f"fault: workhold has a mistake, which is not yours ({what}); please report it with the "
        f"traceback {place}."
    )
