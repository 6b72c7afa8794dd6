"""``workhold convert``: a result file in another form."""

from __future__ import annotations

from typing import Annotated

import typer

from workhold.cli.json_output import JsonOption, print_written, refuse_both
from workhold.cli.outputs import ForceOption, refuse_output
from workhold.cli.ranked import ResultArgument
from workhold.cli.result_forms import FORMAT, STANDARD_OUTPUT, output_form, write_output

__all__ = ["convert"]


def convert(
    result_file: ResultArgument,
    out: Annotated[str, typer.Argument(metavar="FILE", help="The file to write; - is the terminal.")],
    format_: str | None = FORMAT,
    force: ForceOption = False,
    json_: JsonOption = False,
) -> None:
    """Write a result file in another form: JSON, columns (npz) for a great many fixtures, or CSV for a spreadsheet.

    From JSON to columns and back the same bytes come out.

    Example: workhold convert part.npz part.json
    """
    form = output_form(out, format_)
    refuse_both(json_, out)
    if out != STANDARD_OUTPUT:
        refuse_output(out, (result_file,), force)

    from workhold.cli.tables import plural
    from workhold.files.result.reader import read_result

    result = read_result(result_file)
    write_output(result, out, form)
    if out != STANDARD_OUTPUT:
        print_written(json_, f"{plural(len(result), 'fixture')} written to {out}.", out)
