"""A batch of parts under straps and in plain vises: its words, and what its tables and report say of friction."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

import workhold
from workhold.batch import tables

EXAMPLES = Path(__file__).parents[2] / "examples"
LOADED = ("--thickness", "20", "--load", "force=200 at=20,15", "--jaw-force", "3kN", "--best", "2")


@pytest.fixture
def rows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tables that are read here are comma-separated values."""
    monkeypatch.setattr(tables, "has_parquet", lambda: False)


def read_table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


@pytest.mark.thorough
@pytest.mark.usefixtures("rows")
def test_tables_have_forces_bolts_and_parallels(run: Any, tmp_path: Path) -> None:
    out, plate = tmp_path / "out", str(EXAMPLES / "plate.json")
    own = tmp_path / "straps.toml"
    own.write_text('unit = "mm"\nkind = "strapped"\npitch = 20\npeg_radius = 3\nmax_force = 4000\n')
    outcome = run(
        "batch", plate, "--toolkit", f"{own},plain-vise-6-inch", *LOADED, "--out", str(out), "--workers", "1"
    )
    assert outcome.exit_code == 0, outcome.stderr
    straps, vise = read_table(out / "results.csv")
    for row in (straps, vise):
        result = workhold.open(row["record"] if Path(row["record"]).exists() else out / row["record"])
        hold = result[0].hold
        assert float(row["clamp_needed"]) == pytest.approx(hold.clamp_needed, rel=1e-9)
        assert float(row["safety_reached"]) == pytest.approx(6000 / hold.clamp_needed, rel=1e-9)
    best = read_table(out / "best.csv")
    first = next(row for row in best if "straps" in row["toolkit"])
    assert len(first["bolts"].split()) == 2 and first["supports"] == first["parallels"] == ""
    assert float(first["slip_reserve"]) == pytest.approx(4000 / float(first["clamp_needed"]))
    other = next(row for row in best if row["toolkit"] == "plain-vise-6-inch")
    assert float(other["parallels"]) >= 0 and other["bolts"] == ""
    report = (out / "report.html").read_text()
    assert "clamp needed N" in report and "safety reached" in report


@pytest.mark.thorough
@pytest.mark.usefixtures("rows")
def test_pegs_alone_have_no_such_columns(run: Any, tmp_path: Path) -> None:
    out, plate = tmp_path / "out", str(EXAMPLES / "plate.json")
    assert run("batch", plate, "--toolkit", "plate-20mm", "--out", str(out), "--workers", "1").exit_code == 0
    for name in ("results.csv", "best.csv"):
        assert "clamp_needed" not in read_table(out / name)[0]
    assert "clamp needed" not in (out / "report.html").read_text()


@pytest.mark.thorough
@pytest.mark.usefixtures("rows")
def test_as_many_seats_are_looked_at_as_asked(run: Any, tmp_path: Path) -> None:
    """Of all parts, and by a file of jobs of one of them."""
    out = tmp_path / "out"
    (tmp_path / "jobs.toml").write_text(
        'toolkit = "strap-plate-20mm"\nthickness = 20\nload = ["force=200 at=20,15"]\n'
        f"[[job]]\npart = {json.dumps(str(EXAMPLES / 'plate.json'))}\nstrapped = 1\n"
        f"[[job]]\npart = {json.dumps(str(EXAMPLES / 'rectangle.dxf'))}\n"
    )
    asked = ("--strapped", "3", "--out", str(out), "--workers", "1", "--best", "5")
    assert run("batch", str(tmp_path / "jobs.toml"), *asked).exit_code == 0
    looked_at = []
    for row in read_table(out / "results.csv"):
        result = workhold.open(row["record"] if Path(row["record"]).exists() else out / row["record"])
        looked_at.append(sum(hold.is_looked_at for hold in result.holds))
    assert looked_at == [1, 3]
