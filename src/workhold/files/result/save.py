"""Result files in any of their forms, chosen by name or by a file's ending."""

from __future__ import annotations

from pathlib import Path

from workhold.errors import InputError, refuse_kind
from workhold.files.atomic import write_text_file
from workhold.files.replacing import refuse_other_ending, refuse_output
from workhold.model.result import Result

__all__ = ["save"]

FORMS = ("json", "csv", "npz")


def save(result: Result, path: str | Path, form: str | None = None, *, overwrite: bool = False) -> None:
    """Write a result file; an earlier one of that name is replaced only after success.

    Angles are rounded to 1e-10 degrees and lengths to 1e-9 mm, so a result that is opened again differs from the
    one saved in the last digits.

    Parameters
    ----------
    path : of the file.
    form : "json" for exchange, "npz" for columns, "csv" for a spreadsheet; None lets the name's ending
        decide.
    overwrite : whether a file that workhold has not written may be replaced.

    Raises
    ------
    InputError
        When the form is not known or contradicts the name's ending, and when the file cannot be written or
        replaced.
    """
    refuse_kind(result, Result, "the result", "give a Result, as workhold.design and workhold.open make")
    form = Path(path).suffix[1:].lower() if form is None else form
    if form not in FORMS:
        raise InputError(
            f"{path}: {form!r} is not a form of a result file: choose one of {', '.join(FORMS)}."
        )
    refuse_other_ending(path, [f".{form}"], f"a result file in the form {form}")
    refuse_output(path, force=overwrite)
    # Each writer is imported when it is needed, because some take long.
    if form == "json":
        from workhold.files.result.writer import write_result

        write_result(result, path)
    elif form == "csv":
        from workhold.files.result.fixture_text import write_result_csv

        with write_text_file(path) as stream:
            stream.writelines(write_result_csv(result))
    else:
        from workhold.files.result.columns import write_columns

        write_columns(result, path)
