"""Supports and the clamp on top of a toolkit, from a result file to what the commands make of it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import Result as Outcome

import workhold
from workhold import Plate, Workpiece
from workhold.drawing.sheet_writing import find_part_lift
from workhold.fixels.support_hardware import SupportPads, TopClamp
from workhold.model.support_bodies import size_supported_bodies
from workhold.model.support_triples import ChosenSupports

Run = Callable[..., Outcome]
KITE = Workpiece.from_loops("kite", [[[0, 0, 0], [70, -8, 0.1], [88, 40, 0], [22, 66, 0]]])
PADS = SupportPads(pad_radius=3, pad_margin=1, height=12)
CLAMP = TopClamp(tip_radius=4, inside=6, reach=[[0, -30, 5, 290]])
EQUIPPED = Plate(pitch=15, peg_radius=3, supports=PADS, top_clamp=CLAMP)


@pytest.fixture(scope="module")
def result_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The result of a part on a plate with supports and a clamp of its own."""
    path = tmp_path_factory.mktemp("hardware") / "kite.json"
    workhold.save(workhold.design(KITE, EQUIPPED, best=2), path)
    return path


@pytest.mark.thorough
def test_a_result_keeps_them_and_supports_sheet_and_bodies_use_them(
    result_file: Path, tmp_path: Path, run: Run
) -> None:
    """Also with one of them asked for otherwise; ``verify`` accepts both files."""
    result = workhold.open(result_file)
    assert result.toolkit == EQUIPPED and run("verify", result_file).exit_code == 0
    out = tmp_path / "supports.json"
    assert (
        run("supports", result_file, "1", "--thickness", "12", "--inside", "5mm", "--out", out).exit_code == 0
    )
    written = json.loads(out.read_text())
    assert (written["supports"]["pad_radius"], written["supports"]["pad_margin"]) == (3, 1)
    clamp = written["clamp"]
    assert (clamp["tip_radius"], clamp["inside"], clamp["reach"]) == (4, 5, [[0, -30, 5, 290]])
    assert run("verify", out).exit_code == 0
    found = result[0].supports(12)
    assert (found.request.pad_radius, found.request.inside, found.request.reach) == (3, 6, CLAMP.reach)
    assert (
        size_supported_bodies(found).floor == -12
        and size_supported_bodies(found, support_height=7).floor == -7
    )
    chosen = ChosenSupports.from_supports(found)
    assert (find_part_lift(chosen, None), find_part_lift(chosen, 7.0), find_part_lift(None, None)) == (
        12,
        7,
        0,
    )
    sheet = tmp_path / "sheet.svg"
    made = run("sheet", result_file, "1", "--supports", "--thickness", "12", "-o", sheet)
    assert made.exit_code == 0, made.stderr


def test_a_file_without_them_is_complete(tmp_path: Path, run: Run) -> None:
    """``verify`` misses no key of a toolkit that says nothing of them, or of one alone."""
    for pads in (None, SupportPads(height=8)):
        path = tmp_path / "kite.json"
        workhold.save(workhold.design(KITE, Plate(pitch=15, peg_radius=3, supports=pads), best=1), path)
        outcome = run("verify", path)
        assert outcome.exit_code == 0, outcome.stdout
        path.unlink()
