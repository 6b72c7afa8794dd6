"""Parts and results of plates and fences, and what the independent checker says of them."""

from __future__ import annotations

import copy
import json
import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any
from warnings import catch_warnings, simplefilter

from pytest import MonkeyPatch, raises

import check_toolkit
import workhold
from workhold import Result, Workpiece
from workhold.completeness import verify as verify_completely
from workhold.verification import Verification, verify_file

TESTS = Path(__file__).parent
# A mouth wide enough for the clamp and a locator behind it.
MOUTH = [(0, 0, 0), (70, 4, 0), (70, 14, 0), (24, 10, 0), (20, 44, 0), (66, 48, 0), (66, 58, 0), (0, 62, 0)]
NOTCHED = [(0, 0, 0), (58, 0, 0), (58, 26, 0), (44, 40, 0), (20, 40, 0.3), (0, 40, 0)]


def part(loop: list[tuple[float, ...]], *holes: list[tuple[float, ...]]) -> Workpiece:
    """A part of loops."""
    return Workpiece.from_loops("part", [loop, *holes])


def rectangle(width: float, height: float) -> Workpiece:
    """A rectangle."""
    return part([(0, 0, 0), (width, 0, 0), (width, height, 0), (0, height, 0)])


def checked(result: Result, path: Path, truth: Path | None = None) -> str:
    """What the independent checker says of a result; it fails the test for any fault."""
    workhold.save(result, path)
    words = ["check_toolkit.py", str(path), *(["--truth", str(truth)] if truth else [])]
    said = StringIO()
    with MonkeyPatch.context() as patch, catch_warnings(), redirect_stdout(said), raises(SystemExit) as ended:
        patch.setattr(sys, "argv", words)
        # It divides by nothing and goes on.
        simplefilter("ignore")
        check_toolkit.main()
    assert ended.value.code == 0, said.getvalue()[-2000:]
    return said.getvalue()


def check_and_read_back(result: Result, folder: Path) -> None:
    """Every fixture stands before the checker, and the file says the same in JSON and in columns, however often."""
    checked(result, folder / "result.json")
    again = workhold.open(folder / "result.json")
    assert again.query == result.query and (again.pairs, again.seats) == (result.pairs, result.seats)
    workhold.save(again, folder / "again.json")
    workhold.save(result, folder / "result.npz")
    workhold.save(workhold.open(folder / "result.npz"), folder / "columns.json")
    text = (folder / "result.json").read_bytes()
    assert (folder / "again.json").read_bytes() == text == (folder / "columns.json").read_bytes()


def assert_all_proven(result: Result, folder: Path, search_files: bool = False) -> None:
    """Everything that a search lists is proven, as a result and in a file, of which that in columns says the same; and so it
    is when it is searched again, for the files if asked for."""
    of_files = [folder / "r.json", folder / "r.npz"]
    for path in of_files:
        workhold.save(result, path)
    workhold.save(workhold.open(of_files[1]), folder / "columns.json")
    assert (folder / "columns.json").read_bytes() == of_files[0].read_bytes()
    for source in (result, *(of_files if search_files else of_files[:1])):
        searched = search_files or isinstance(source, Result)
        outcome = verify_completely(source, complete=searched)
        assert (outcome.proven, outcome.undecided, outcome.refuted) == (len(result), 0, 0), outcome.unproven
        assert outcome.faults == () and outcome.bits == 128 and outcome.is_compared == searched


def verify_edited(
    data: dict[str, Any], edit: Callable[[dict[str, Any]], object], folder: Path
) -> Verification:
    """Verify a result file of some JSON after an edit of it."""
    content = copy.deepcopy(data)
    edit(content)
    path = folder / "edited.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    return verify_file(path)
