"""Writing a result in any form."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path

from workhold.errors import InputError
from workhold.model.result import Result

__all__ = ["save"]

WRITERS: Mapping[str, tuple[str, str]] = {
    "json": ("workhold.files.result.writer", "write_result"),
    "csv": ("workhold.files.result.fixture_text", "write_result_csv"),
    "npz": ("workhold.files.result.columns", "write_columns"),
}


def save(result: Result, path: str | Path, form: str | None = None) -> None:
    """Write a result file; an earlier file of that name is replaced only when all went well.

    Parameters
    ----------
    form : "json" for exchange, "npz" for columns, "csv" for a spreadsheet; None lets the name's ending decide.

    Raises
    ------
    InputError
        When the form is not known, or the file cannot be written.
    """
    form = Path(path).suffix[1:].lower() if form is None else form
    if form not in WRITERS:
        raise InputError(f"{path}: {form!r} is no form of a result file: choose one of {', '.join(WRITERS)}.")
    module, name = WRITERS[form]
    write: Callable[[Result, str | Path], None] = getattr(import_module(module), name)
    write(result, path)
