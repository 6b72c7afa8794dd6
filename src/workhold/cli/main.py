"""The command ``workhold``: its subcommands, and what happens when something goes wrong.

Exit codes: 0 done (also when no fixture exists), 1 a fault of workhold, 2 bad input or a refuted result, 130
interrupted, 141 nobody reads the output any more.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from types import FrameType
from typing import Annotated, Any, NoReturn

import typer

from workhold import __version__
from workhold.cli.commands import PlainCommand, PlainGroup
from workhold.cli.design_command import design
from workhold.cli.explore_command import explore
from workhold.cli.features_command import features
from workhold.cli.parts_command import parts
from workhold.cli.saying import tell
from workhold.cli.serve_command import serve
from workhold.cli.sheet_command import sheet
from workhold.cli.show_command import show
from workhold.cli.verify_command import verify
from workhold.cli.vises_command import vises
from workhold.errors import InputError

__all__ = ["app", "run"]

DONE, FAULT, BAD_INPUT, INTERRUPTED, TERMINATED, NO_READER = 0, 1, 2, 130, 143, 141

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


class Workhold(PlainGroup):
    """The commands, with every outcome told in one plain sentence and an exit code."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command; Typer would handle these two outcomes in words of its own."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as error:
            say("interrupted; no unfinished file was left behind.")
            raise typer.Exit(INTERRUPTED) from error
        except BrokenPipeError as error:
            forget_output()
            raise typer.Exit(NO_READER) from error

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        """Parse the arguments and run the command; ends the process unless ``standalone_mode`` is off."""
        command = super().main
        code = exit_code(lambda: command(args, prog_name, complete_var, False, windows_expand_args, **extra))
        if standalone_mode:
            sys.exit(code)
        return code


app = typer.Typer(
    name="workhold",
    cls=Workhold,
    help="Finds every way to hold a part in a fixture vise with four pegs.",
    epilog=EXAMPLES,
    add_completion=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.command(cls=PlainCommand)(design)
app.command(cls=PlainCommand)(show)
app.command(cls=PlainCommand)(sheet)
app.command(cls=PlainCommand)(explore)
app.command(cls=PlainCommand)(features)
app.command(cls=PlainCommand)(parts)
app.command(cls=PlainCommand)(vises)
app.command(cls=PlainCommand)(verify)
app.command(cls=PlainCommand)(serve)


def show_version(wanted: bool) -> None:
    """Print the version and stop."""
    if wanted:
        typer.echo(f"workhold {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=show_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Options of workhold itself; the help above is the app's."""


def run() -> NoReturn:
    """The console command."""
    for stream in (sys.stdout, sys.stderr):
        # A part's name must not end the program on a terminal that lacks a letter.
        with suppress(AttributeError, ValueError):
            stream.reconfigure(errors="replace")  # type: ignore[union-attr]
    signal.signal(signal.SIGTERM, terminate)
    # Every matrix here is small; threads to multiply large ones would only be started and never used.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    code = int(app(standalone_mode=False))
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        forget_output()
        code = NO_READER
    sys.exit(code)


def exit_code(command: Callable[[], Any]) -> int:
    """Run a command and turn its outcome into an exit code, with one sentence on stderr where there is news."""
    try:
        return int(command() or DONE)
    except InputError as error:
        say(f"error: {error}")
        return BAD_INPUT
    except UsageError as error:
        return complain(error)
    except (KeyboardInterrupt, typer.Abort):
        say("interrupted; no unfinished file was left behind.")
        return INTERRUPTED
    except BrokenPipeError:
        forget_output()
        return NO_READER
    except Exception as error:
        if lacks_memory(error):
            say("error: this needs more memory than there is: close other programs, or raise the limit.")
            return BAD_INPUT
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
            say(f"error: the output cannot be written: {error.strerror}.")
            return BAD_INPUT
        report_fault(error)
        return FAULT


def lacks_memory(error: BaseException | None) -> bool:
    """Whether an error comes of too little memory, which libraries that cannot be loaded tell in words of their own."""
    while error is not None:
        if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
            return True
        if "failed to map segment" in str(error) or "annot allocate memory" in str(error):
            return True
        error = error.__cause__ or error.__context__
    return False


def complain(error: Exception) -> int:
    """Say what is wrong with the command line, and where the help is."""
    message = str(getattr(error, "message", "") or error)
    with suppress(Exception):
        message = error.format_message()  # type: ignore[attr-defined]
    context = getattr(error, "ctx", None)
    command = getattr(context, "command_path", "workhold")
    say(f"error: {message.rstrip('.')}; see {command} --help.")
    return BAD_INPUT


def say(message: str) -> None:
    """One line on stderr, whatever the message holds."""
    tell(" ".join(message.split()))


def report_fault(error: Exception) -> None:
    """Own up to a mistake of the program, and keep the traceback for the report."""
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
    say(f"fault: a mistake of workhold, not of yours ({what}); please report it with the traceback {place}.")


def forget_output() -> None:
    """Nobody reads the output any more: send the rest nowhere, so that the interpreter ends in peace."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())


def terminate(number: int, frame: FrameType | None) -> None:
    """End on SIGTERM through the interpreter, so that temporary files are removed."""
    raise SystemExit(TERMINATED)
