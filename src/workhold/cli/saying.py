"""What is said beside the result of a command."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import TextIO

import typer

from workhold.limits import NO_ROOM
from workhold.plain import plain, shortened

__all__ = ["forget", "tell"]


def tell(message: str) -> None:
    """One line on stderr, whatever the message quotes; a full disk, as of a log, loses it and changes nothing else."""
    try:
        typer.echo(f"workhold: {plain(shortened(message))}", err=True)
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        forget(sys.stderr)


def forget(stream: TextIO) -> None:
    """Nobody reads a stream any more, or it has no room: send the rest nowhere, so that the interpreter ends in peace."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
