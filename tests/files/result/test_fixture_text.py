"""The table for a spreadsheet says what the result says."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from fakes import fake_result
from workhold import save


def test_every_row_is_a_fixture(tmp_path: Path) -> None:
    result = fake_result(5000)
    save(result, tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == len(result)
    for number in (1, 2, 4096, 4097, 5000):
        row, fixture = rows[number - 1], result[number - 1]
        assert int(row["number"]) == number
        assert row["type"] == fixture.type
        assert float(row["theta_deg"]) == pytest.approx(fixture.pose.theta_deg)
        assert (float(row["x"]), float(row["y"])) == pytest.approx((fixture.pose.x, fixture.pose.y))
        assert float(row["jaw_separation"]) == pytest.approx(fixture.travel)
        assert float(row["closure_margin"]) == pytest.approx(fixture.quality["closure_margin"])
        for k, peg in enumerate(fixture.pegs, 1):
            assert (row[f"peg{k}_hole"], row[f"peg{k}_jaw"]) == (peg.hole, peg.carrier)
            assert (int(row[f"peg{k}_column"]), int(row[f"peg{k}_row"])) == (peg.column, peg.row)
            assert (float(row[f"peg{k}_x"]), float(row[f"peg{k}_y"])) == pytest.approx((peg.x, peg.y))
            assert int(row[f"peg{k}_face"]) == peg.face
            assert float(row[f"peg{k}_force"]) == pytest.approx(peg.force)


def test_no_fixtures_leave_the_line_of_names(tmp_path: Path) -> None:
    save(fake_result(0), tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_text().startswith("number,type,theta_deg,x,y,")
    assert (tmp_path / "a.csv").read_text().count("\n") == 1
