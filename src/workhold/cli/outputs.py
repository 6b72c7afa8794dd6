"""Outputs of a command: files that it may overwrite, the forms of a result file, and the object of
``--json``.

A command may overwrite its own earlier outputs, but never its inputs. What ``--json`` prints on standard
output is for other programs: lengths in mm, angles in degrees and forces in N whatever ``--unit`` says.
Remarks and errors go to standard error as always, and the exit codes are the same.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workhold.cli.commands import make_flag, make_option
from workhold.cli.ending import Interrupted, note_results_to_keep
from workhold.cli.table import print_tables
from workhold.cli.values import read_choice, read_picture_ending
from workhold.errors import InputError
from workhold.files import replacing

if TYPE_CHECKING:
    from workhold.model.result import Result

__all__ = [
    "FORCE",
    "FORMAT",
    "JSON",
    "OUTPUT",
    "STANDARD_OUTPUT",
    "read_picture_path",
    "choose_output_form",
    "print_json",
    "print_written",
    "refuse_both",
    "refuse_output",
    "refuse_output_folder",
    "refuse_result_file",
    "write_found",
    "write_output",
    "write_picture",
]

FORCE = make_flag(None, "Replace files of these names even if workhold has not written them.", "--force")

# What the permission to replace a file is called here.
CALLED = "--force"


def refuse_output(
    path: str | Path, inputs: Iterable[str | Path | None], force: bool, called: str = CALLED
) -> None:
    """Raise InputError for an output file that must not be written, see
    :func:`workhold.files.replacing.refuse_output`.
    """
    replacing.refuse_output(path, inputs, force, called)


def refuse_output_folder(
    folder: Path, names: Iterable[str], inputs: Iterable[str | Path | None], force: bool
) -> None:
    """Raise InputError for an output folder with files that must not be replaced, see
    :func:`workhold.files.replacing.refuse_output_folder`.
    """
    replacing.refuse_output_folder(folder, names, inputs, force, CALLED)


def read_picture_path(draw: str | None, inputs: Iterable[str | Path | None], force: bool) -> Path | None:
    """Return the path of the picture asked for; None where none is.

    Raises InputError for another ending than .svg and .png, and for a file that must not be replaced.
    """
    if draw is None:
        return None
    path = Path(draw)
    read_picture_ending(path)
    refuse_output(path, inputs, force)
    return path


def write_picture(path: Path, svg: str) -> None:
    """Write SVG text as SVG or PNG, by the ending of the path."""
    from workhold.drawing.render import render
    from workhold.files.atomic import write_bytes

    write_bytes(path, render(svg, path.suffix))


OUTPUT = "Results"
STANDARD_OUTPUT = "-"
FORMS = ("json", "csv", "npz")

FORMAT = make_option(
    OUTPUT,
    "json|csv|npz",
    "Form of the file: csv for a spreadsheet, npz in columns for a great many fixtures. If not given, the "
    "file's name decides.",
    "--format",
)


def choose_output_form(out: str | None, asked: str | None) -> str:
    """Return "json", "csv" or "npz": the form asked for, else that of the file's ending, else "json".

    Raises InputError for npz on stdout.
    """
    ending = "" if out is None else out.lower().rpartition(".")[2]
    form = (ending if ending in FORMS else "json") if asked is None else read_choice("--format", asked, FORMS)
    if form == "npz" and out == STANDARD_OUTPUT:
        raise InputError("--format npz needs a file: name one with --out.")
    return form


def refuse_result_file(out: str, form: str, inputs: Iterable[str | Path | None], force: bool) -> None:
    """Raise InputError for a result file that cannot be written or whose ending belongs to another form."""
    refuse_output(out, inputs, force)
    replacing.refuse_other_ending(out, [f".{form}"], "such a result file")


def write_output(result: Result, out: str, form: str) -> None:
    """Write a result in a form to a file, or to stdout for "-"."""
    if out != STANDARD_OUTPUT:
        from workhold.files.result.save import save

        save(result, out, form, overwrite=True)
        return
    if form == "csv":
        from workhold.files.result.fixture_text import write_result_csv as write_text
    else:
        from workhold.files.result.writer import write_result_text as write_text
    sys.stdout.writelines(write_text(result))
    sys.stdout.flush()


def write_found(result: Result, out: str, form: str) -> Result:
    """Write the result of a search, and return the result that was written.

    After Ctrl-C during the writing of millions of fixtures, only the best are written and returned.
    """
    try:
        write_output(result, out, form)
    except Interrupted:
        from workhold.listing.collector import LISTED_LATE

        if out == STANDARD_OUTPUT or len(result) <= LISTED_LATE:
            raise
        note_results_to_keep()
        result = result.slice_rows(slice(LISTED_LATE)).mark_cut_short(LISTED_LATE)
        write_output(result, out, form)
    return result


JSON = make_flag(
    None, "Print one JSON object instead of tables; lengths in mm whatever --unit says.", "--json"
)


def refuse_both(as_json: bool, out: str | None) -> None:
    """Raise InputError where both --json and the result file would go to stdout."""
    if as_json and out == STANDARD_OUTPUT:
        raise InputError(
            "--json and the result file would both go to the terminal (-): leave one of them out."
        )


def print_json(**content: Any) -> None:
    """Print the keyword arguments as one JSON object, in one line of ASCII."""
    sys.stdout.write(json.dumps(content, allow_nan=False) + "\n")
    sys.stdout.flush()


def print_written(as_json: bool, sentence: str, *paths: str | Path) -> None:
    """Print the sentence on the files written or, if ``as_json``, their paths as JSON."""
    if as_json:
        print_json(written=[str(path) for path in paths])
        return

    print_tables(sentence)
