"""``workhold copies``: what it tells, draws and refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from workhold import Plate, Query, Workpiece, answer
from workhold.family.copies import packing_of
from workhold.files.result.save import save

pytest.importorskip("scipy", reason="the extra [batch] is not installed")

BAR = Workpiece.from_loops("bar", [[[0, 0, 0], [50, 0, 0], [50, 28, 0], [0, 28, 0]]])


def test_copies_are_told_and_drawn_or_refused(run: Any, tmp_path: Path) -> None:
    result = answer(Query(BAR, Plate(pitch=20, peg_radius=3, clamps=2, travel=(10, 35)), best=3), threads=1)
    file, picture = tmp_path / "r.json", tmp_path / "p.png"
    save(result, file, "json")
    outcome = run("copies", file, 1, "--columns", 12, "--rows", 9, "--draw", picture)
    assert outcome.exit_code == 0, outcome.stderr
    packing = packing_of(result[0], result.workpiece, result.toolkit, 12, 9)
    count = len(packing.shifts)
    assert f"{count} copies on a plate of 12 columns and 9 rows; no more fit" in outcome.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    lines = outcome.stdout.splitlines()
    assert [line.split()[0] for line in lines[2 : 2 + count]] == [str(k + 1) for k in range(count)]
    data = json.loads(run("copies", file, 1, "--columns", 12, "--rows", 9, "--json").stdout)
    assert data["copies"] == data["at_most"] == count
    assert [(one["columns"], one["rows"]) for one in data["shifts"]] == list(packing.shifts)
    fewer = json.loads(run("copies", file, 1, "--columns", 12, "--rows", 9, "--gap", "19mm", "--json").stdout)
    assert fewer["copies"] < count
    for arguments, message in (
        ((file, 1, "--columns", 12), "how large the plate is, is not known: give --rows"),
        ((file, 1, "--columns", 12, "--rows", 9, "--gap", "-1"), "is negative"),
        ((file, 1, "--columns", 2, "--rows", 9), "does not hold this fixture once"),
        ((file, 9, "--columns", 12, "--rows", 9), "there is no fixture 9"),
        ((file, 1, "--columns", 12, "--rows", 9, "--draw", "p.pdf"), "let the name end in .svg or .png"),
        ((file, 1, "--columns", 99999, "--rows", 99999), "holes"),
    ):
        outcome = run("copies", *arguments)
        assert outcome.exit_code == 2 and message in outcome.stderr, outcome.stderr
