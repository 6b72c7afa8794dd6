"""The forms of a result file, and writing one."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from workhold.cli.commands import option
from workhold.cli.ending import Interrupted, keep_what_is_found
from workhold.cli.values import choice
from workhold.errors import InputError

if TYPE_CHECKING:
    from workhold.model.result import Result

__all__ = ["FORMAT", "OUTPUT", "STANDARD_OUTPUT", "output_form", "write_found", "write_output"]

OUTPUT = "Results"
STANDARD_OUTPUT = "-"
FORMS = ("json", "csv", "npz")

FORMAT = option(
    OUTPUT,
    "json|csv|npz",
    "Form of the file: csv for a spreadsheet, npz in columns for a great many fixtures. If not given, the file's "
    "name decides.",
    "--format",
)


def output_form(out: str | None, asked: str | None) -> str:
    """The form of a result file: the one asked for, or the one that its name suggests.

    Raises
    ------
    InputError
        For a form that is not known, and for one that no terminal can take.
    """
    if asked is None:
        ending = "" if out is None else out.lower().rpartition(".")[2]
        return ending if ending in FORMS else "json"
    form = choice("--format", asked, FORMS)
    if form == "npz" and out == STANDARD_OUTPUT:
        raise InputError("--format npz needs a file: name one with --out.")
    return form


def write_output(result: Result, out: str, form: str) -> None:
    """Write a result to a file or to the terminal.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    if out != STANDARD_OUTPUT:
        from workhold.files.result.save import save

        save(result, out, form)
        return
    if form == "csv":
        from workhold.files.result.csv import write_result_csv_to as write_to
    else:
        from workhold.files.result.writer import write_result_to as write_to
    write_to(result, sys.stdout)
    sys.stdout.flush()


def write_found(result: Result, out: str, form: str) -> Result:
    """Write what a search found, or after a Ctrl-C the best of millions, which takes a moment only; what was written.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    try:
        write_output(result, out, form)
    except Interrupted:
        from workhold.listing.collector import LISTED_LATE

        if out == STANDARD_OUTPUT or len(result) <= LISTED_LATE:
            raise
        keep_what_is_found()
        result = result.part(slice(LISTED_LATE)).cut_short(LISTED_LATE)
        write_output(result, out, form)
    return result
