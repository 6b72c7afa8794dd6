"""``--json``: what a command says as one JSON object on standard output, for other programs.

Lengths are in mm, angles in degrees and forces in N whatever ``--unit`` says. What is said beside, remarks and errors,
goes to standard error as always, and the exit codes are the same.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from workhold.cli.result_forms import STANDARD_OUTPUT
from workhold.errors import InputError

__all__ = ["JsonOption", "print_json", "print_written", "refuse_both"]

JsonOption = Annotated[
    bool, typer.Option("--json", help="Print one JSON object instead of tables; lengths in mm whatever --unit says.")
]


def refuse_both(as_json: bool, out: str | None) -> None:
    """Refuse two things on standard output.

    Raises
    ------
    InputError
        Where the file goes there too.
    """
    if as_json and out == STANDARD_OUTPUT:
        raise InputError("--json and a file on the terminal (-) are two things in one place: leave one of them out.")


def print_json(**content: Any) -> None:
    """Print an object in a line of ASCII."""
    sys.stdout.write(json.dumps(content, allow_nan=False) + "\n")
    sys.stdout.flush()


def print_written(as_json: bool, sentence: str, *paths: str | Path) -> None:
    """Tell which files were written, in a sentence or as JSON."""
    if as_json:
        print_json(written=[str(path) for path in paths])
        return
    from workhold.cli.tables import print_tables

    print_tables(sentence)
