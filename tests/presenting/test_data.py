"""Fixtures as tables of pandas and Arrow have the columns and the numbers of the CSV form."""

from __future__ import annotations

import csv
import io
import sys
from typing import Any

import pytest

import workhold
from fakes import fake_result
from workhold.errors import InputError
from workhold.files.result.fixture_text import list_column_names, write_result_csv
from workhold.presenting import data
from workhold.presenting.data import make_columns

RECTANGLE = workhold.Workpiece.from_loops("bar", [[[0, 0, 0], [70, 0, 0], [70, 40, 0], [0, 40, 0]]])


def two_clamps() -> workhold.Result:
    """Fixtures with five pegs and two travels."""
    plate = workhold.Plate(pitch=20, peg_radius=3, columns=5, rows=4, clamps=2)
    return workhold.design(RECTANGLE, plate, best=5)


@pytest.mark.parametrize("result", [fake_result(7), two_clamps()], ids=["vise", "two clamps"])
def test_columns_are_those_of_the_csv_form(result: workhold.Result, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names and values, also over several blocks."""
    monkeypatch.setattr("workhold.files.result.fixture_text.BLOCK", 3)
    rows = list(csv.DictReader(io.StringIO("".join(write_result_csv(result)))))
    columns = make_columns(result)
    assert list(columns) == list(rows[0]) and len(rows) == len(result)
    for name, values in columns.items():
        for row, value in zip(rows, values, strict=True):
            assert (
                row[name] == value
                if isinstance(value, str)
                else float(row[name]) == pytest.approx(value, rel=1e-11)
            )


def test_no_fixture_makes_an_empty_table() -> None:
    """With all its columns."""
    result = fake_result(0)
    assert {name: len(column) for name, column in make_columns(result).items()} == dict.fromkeys(
        list_column_names(result), 0
    )


@pytest.mark.parametrize(("name", "method"), [("pandas", "to_pandas"), ("pyarrow", "to_arrow")])
def test_a_table_of_the_library_is_made(name: str, method: str) -> None:
    """Whole numbers stay whole."""
    pytest.importorskip(name, reason="the extra 'tables' is not installed")
    result = fake_result(3)
    table = getattr(result, method)()
    count, column = (
        table.shape[0],
        table["peg1_hole"].to_list() if name == "pandas" else table["peg1_hole"].to_pylist(),
    )
    assert count == 3 and column == [fixture.pegs[0].hole for fixture in result]
    kind = str(table.dtypes["peg1_face"] if name == "pandas" else table.schema.field("peg1_face").type)
    assert kind == "int64"


@pytest.mark.parametrize(("name", "method"), [("pandas", "to_pandas"), ("pyarrow", "to_arrow")])
def test_a_library_that_is_missing_is_told_in_a_sentence(name: str, method: str, monkeypatch: Any) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(InputError) as told:
        getattr(fake_result(1), method)()
    requirement = data.REQUIREMENTS[name]
    assert str(told.value) == f"this needs a library that is not installed: pip install '{requirement}'."
