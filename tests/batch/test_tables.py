"""The tables: the same rows in either form, and everything in them as the records say."""

from __future__ import annotations

import csv
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from batch_helpers import COARSE, IMPOSSIBLE, InlineQueue, reported, rows_of, run_in

import workhold
from workhold import Fence, Load, PlainVise, Plate, Query, StrapPlate
from workhold.batch import tables
from workhold.batch.run import ANY_PART, BatchState, ToolkitQuery
from workhold.batch.tables import (
    BEST,
    FRICTION_FIGURES,
    FRICTION_SETTINGS,
    RESULTS,
    JobRow,
    list_table_names,
    write_tables,
)
from workhold.files.replacing import is_own
from workhold.statics.judging import are_unfit

PLATE = ToolkitQuery("plate", Query(ANY_PART, Plate(pitch=20, peg_radius=3)))
FENCE = ToolkitQuery("fence", Query(ANY_PART, Fence(pitch=20, peg_radius=3, wall_offset=20)))
PAIR = ToolkitQuery("pair", Query(ANY_PART, Plate(pitch=20, peg_radius=3, clamps=2)))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a part that can be read, and one that cannot."""
    path = tmp_path_factory.mktemp("tables")
    (path / "bad.json").write_text("{")
    loop = [[0, 0, 0], [70, 0, 0], [61, 44, 0], [25, 49, 0], [4, 38, 0]]
    (path / "good.json").write_text(json.dumps({"units": "mm", "loops": [loop]}))
    return path


@pytest.fixture(scope="module")
def batch(folder: Path) -> BatchState:
    """A part in every kind of toolkit, and one that cannot be read."""
    parts = folder / "good.json", folder / "bad.json"
    return run_in(folder, *parts, queue=InlineQueue(), held_in=(COARSE, PLATE, FENCE, PAIR, IMPOSSIBLE))


@pytest.fixture
def rows(batch: BatchState, folder: Path) -> Iterator[JobRow]:
    return rows_of(batch, folder)


def test_rows_say_what_the_records_do(rows: Iterator[JobRow]) -> None:
    held_in, fit = set(), set()
    for one in rows:
        assert list(one.row) == list(RESULTS)
        if one.row["state"] != "held":
            assert not one.best and one.row["reason"]
            continue
        result = workhold.open(Path(one.row["record"]))
        held_in.add(one.row["toolkit"])
        assert one.row["fixtures"] == sum(result.found.values())
        assert one.row["fit"] is not bool(are_unfit(result.table.quality[:1], result.query.tolerance)[0])
        fit.add(one.row["fit"])
        assert 1 <= len(one.best) == len(result) <= 3
        for rank, (row, fixture) in enumerate(zip(one.best, result, strict=True), 1):
            assert list(row) == list(BEST) and row["rank"] == rank
            held = [peg for peg in fixture.pegs if not peg.is_on_wall]
            assert row["holes"] == " ".join(peg.hole for peg in held)
            assert row["faces"] == " ".join(str(peg.face) for peg in held)
            assert row["theta_deg"] == pytest.approx(fixture.pose.theta_deg)
            for key, value in fixture.quality.items():
                assert row[key] == pytest.approx(value)
        assert one.row["location_error"] == one.best[0]["location_error"]
    assert held_in == {"coarse", "plate", "fence", "pair"} and True in fit


@pytest.mark.parametrize(
    ("straps", "fit"), [(StrapPlate(20, 3), True), (StrapPlate(20, 3, tip_radius=60), None)]
)
def test_rows_of_what_friction_holds_say_whether_it_does(
    folder: Path, straps: StrapPlate, fit: bool | None
) -> None:
    """Where no straps find places, seats that nobody looked at come first, of which it is not known."""
    load = Load(points=(30, 20), force=200, directions=0)
    vise = PlainVise(jaw_width=100, jaw_height=40, max_opening=80)
    asked = {"thickness": 20, "loads": [load], "strapped": 2}
    held_in = (
        ToolkitQuery("straps", Query(ANY_PART, straps, **asked)),
        ToolkitQuery("jaws", Query(ANY_PART, vise, thickness=20, loads=[load])),
    )
    place = folder / f"straps-{straps.tip_radius:g}"
    place.mkdir()
    batch = run_in(place, folder / "good.json", queue=InlineQueue(), held_in=held_in)
    under, between = (one for one in rows_of(batch, place))
    assert under.row["state"] == "held" and under.row["fit"] is fit
    assert between.row["fit"] is not None
    of_best = {*BEST, *FRICTION_FIGURES, *FRICTION_SETTINGS}
    assert all(len(row["holes"].split()) == 3 and set(row) == of_best for row in under.best)
    assert set(under.row) == {*RESULTS, *FRICTION_FIGURES}


def test_both_forms_have_the_same_rows(
    batch: BatchState, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="needs pyarrow")

    def written() -> list[JobRow]:
        return list(write_tables(rows_of(batch, folder), tmp_path))

    rows = written()
    monkeypatch.setattr(tables, "has_parquet", lambda: False)
    assert list_table_names() == ("results.csv", "best.csv")
    written()
    for name, wanted in (
        ("results", [one.row for one in rows]),
        ("best", [row for one in rows for row in one.best]),
    ):
        table = parquet.read_table(tmp_path / f"{name}.parquet").to_pylist()
        assert table == wanted
        with (tmp_path / f"{name}.csv").open(newline="") as stream:
            for plain, row in zip(csv.DictReader(stream), wanted, strict=True):
                assert {key: tables.convert_cell(value) for key, value in row.items()} == {
                    key: type(tables.convert_cell(row[key]))(value) if row[key] is not None else None
                    for key, value in plain.items()
                }
        for ending in ("csv", "parquet"):
            assert is_own(tmp_path / f"{name}.{ending}")


@pytest.mark.parametrize("parquet", [False, True])
def test_names_that_are_no_utf_8_are_rows_in_either_form(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, parquet: bool
) -> None:
    """Each can be told from the others, in a run that makes records and in one that finds them."""
    if parquet:
        pytest.importorskip("pyarrow", reason="needs pyarrow")
    monkeypatch.setattr(tables, "has_parquet", lambda: parquet)
    (tmp_path / "shop").mkdir()
    loop = [[0, 0, 0], [70, 0, 0], [61, 44, 0], [4, 38, 0]]
    for letter in (b"\xfc", b"\xe4"):
        name = os.fsencode(tmp_path) + b"/shop/Fl" + letter + b"gel.json"
        Path(os.fsdecode(name)).write_text(json.dumps({"units": "mm", "loops": [loop]}))
    for queue in (InlineQueue(), InlineQueue(0)):
        batch = run_in(tmp_path, tmp_path / "shop", queue=queue)
        out = tmp_path / "out"
        reported(batch, tmp_path, out, sheets=out / "sheets")
        assert {"Fl\\xe4gel.json", "Fl\\xfcgel.json"} <= set(
            re.findall(r"Fl[^<>]*json", read(out / "r.html"))
        )
        if not parquet:
            with (out / "results.csv").open(newline="") as stream:
                named = [(row["part"], Path(row["file"]).name) for row in csv.DictReader(stream)]
            assert named == [("Fl\\xe4gel.json",) * 2, ("Fl\\xfcgel.json",) * 2]
    assert len(list((out / "sheets").iterdir())) >= 1


def read(path: Path) -> str:
    """The text of a file, which has to be UTF-8."""
    return path.read_text(encoding="utf-8")


def test_tables_appear_whole_or_not_at_all(rows: Iterator[JobRow], tmp_path: Path) -> None:
    taken = write_tables(rows, tmp_path)
    next(taken)
    taken.close()
    assert list(tmp_path.iterdir()) == []
