"""All fixtures of a result as a table of pandas or Arrow: the columns of the CSV form, a row for each fixture.

Neither library is needed for anything else; each is imported here only.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from workhold.errors import InputError
from workhold.files.result.csv import column_names, seating_values
from workhold.files.result.fixture_lines import fixture_rows
from workhold.fixels.contact_kind import FLAT_PIN
from workhold.model.quality import SEATING_FIGURES

if TYPE_CHECKING:
    from workhold.model.result import Result

__all__ = ["to_arrow", "to_pandas"]

# What the extra ``tables`` asks for.
REQUIREMENTS = {"pandas": "pandas>=2.2", "pyarrow": "pyarrow>=17"}


def to_pandas(result: Result) -> Any:
    """A DataFrame, see :meth:`workhold.Result.to_pandas`."""
    return library("pandas").DataFrame(columns_of(result))


def to_arrow(result: Result) -> Any:
    """A table of Arrow, see :meth:`workhold.Result.to_arrow`."""
    return library("pyarrow").table(columns_of(result))


def library(name: str) -> Any:
    """A library of an extra.

    Raises
    ------
    InputError
        When it is not installed.
    """
    try:
        return import_module(name)
    except ImportError as error:
        raise InputError(f"this needs a library that is not installed: pip install '{REQUIREMENTS[name]}'.") from error


def columns_of(result: Result) -> dict[str, Any]:
    """The columns by name: numbers as arrays (N,), words as lists; lengths in mm, angles in degrees."""
    toolkit = result.toolkit
    names, count = column_names(result), 6 * toolkit.peg_count
    titles = np.array([one.title for one in toolkit.arrangements])
    carriers = [[toolkit.carriers[k] for k in one.carriers] for one in toolkit.arrangements]
    blocks: list[list[Any]] = []
    for kinds, rows in fixture_rows(result.table, toolkit, result.workpiece):
        looks: list[Any] = []
        if FLAT_PIN in toolkit.contacts:
            *before, flats = zip(*rows, strict=True)
            rows, looks = zip(*before, strict=True), list(np.array(flats, np.float64).T)
        numbers = [np.array(column) for column in zip(*rows, strict=True)]
        block: list[Any] = [titles[kinds], *numbers[count:]]
        for peg in range(toolkit.peg_count):
            column, row, *others = numbers[6 * peg : 6 * peg + 6]
            jaws = [carriers[kind][peg] for kind in kinds]
            holes = [jaw.place_name(a, b) for jaw, a, b in zip(jaws, column.tolist(), row.tolist(), strict=True)]
            block += [np.array(holes), np.array([jaw.name for jaw in jaws]), column, row, *others]
        block += looks
        blocks.append(block)
    told = len(SEATING_FIGURES) if result.seating else 0
    joined = [np.concatenate(parts) for parts in zip(*blocks, strict=True)] or [np.zeros(0)] * (len(names) - 1 - told)
    columns = [np.arange(1, len(result) + 1), *joined]
    if result.seating:
        columns += list(np.array(seating_values(result)).T)
    return {
        name: column.tolist() if column.dtype.kind == "U" else column
        for name, column in zip(names, columns, strict=True)
    }
