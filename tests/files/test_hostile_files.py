"""Whatever a file holds, it is read as what it says or refused in one sentence, within limits of time and memory; seeded, so
that every run is the same."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import hostile_batch
import pytest
from fuzzed import ALL_MAKERS

from workhold import Workpiece
from workhold.files.part.load import read_workpiece

# Of each kind; of all together 10,000.
FEW, CASES, CHUNK = 30, 480, 150
# A STEP file takes a process of its own for seconds, and damaged ones have a test of their own.
SLOW = {"part.step": (4, 104, 50)}
TESTS = Path(__file__).parents[1]


def check(name: str, first: int, last: int) -> None:
    """Try the files of some seeds in a process of its own."""
    program = f"import sys; sys.path[:0] = {[str(TESTS), str(TESTS / 'files')]!r}; import hostile_batch; "
    program += f"hostile_batch.run_batch({name!r}, {first}, {last})"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stdout[-60:]} {done.stderr[-3000:]}"


@pytest.mark.thorough
@pytest.mark.parametrize("name", ALL_MAKERS)
def test_hostile_files_are_read_right_or_refused(name: str) -> None:
    """Thirty of each kind."""
    check(name, 0, SLOW.get(name, (FEW,))[0])


def chunks(name: str) -> list[tuple[str, int, int]]:
    """The further seeds of a kind in ranges."""
    few, cases, chunk = SLOW.get(name, (FEW, CASES, CHUNK))
    return [(name, first, min(first + chunk, cases)) for first in range(few, cases, chunk)]


@pytest.mark.prove
@pytest.mark.parametrize(("name", "first", "last"), [chunk for name in ALL_MAKERS for chunk in chunks(name)])
def test_ten_thousand_hostile_files_are_read_right_or_refused(name: str, first: int, last: int) -> None:
    """As above."""
    check(name, first, last)


def test_there_are_ten_thousand_of_all_kinds_together() -> None:
    """Without STEP files too, whose library may be missing; each seed of a kind is tried once."""
    ranges = [(name, 0, SLOW.get(name, (FEW,))[0]) for name in ALL_MAKERS]
    ranges += [chunk for name in ALL_MAKERS for chunk in chunks(name)]
    tried = [(name, seed) for name, first, last in ranges for seed in range(first, last)]
    assert len(tried) == len(set(tried)) and 10_000 <= len(tried) <= 10_500
    assert {name for name, _ in tried} == set(hostile_batch.CHECKS) & set(ALL_MAKERS) == set(ALL_MAKERS)


@pytest.mark.parametrize("name", ["result.npz", "made.svg", "lines.json"])
def test_a_seed_always_makes_the_same_file(name: str) -> None:
    """So that a failure can be repeated by kind and seed."""
    assert len({ALL_MAKERS[name](random.Random(7)) for _ in range(2)}) == 1


def test_the_fuzzer_finds_a_misreading(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A part that is read a little too large is told, and a reader that fails."""
    read = read_workpiece
    path = tmp_path / "part.json"
    path.write_text('{"units": "mm", "loops": [[[0, 0, 0], [60, 0, 0.2], [60, 40, 0], [0, 40, 0]]]}')

    def wrong(path: Path) -> Any:
        loaded = read(path)
        loops = [loop * [1.001, 1.001, 1.0] for loop in loaded.workpiece.loops]
        return type(loaded)(Workpiece.from_loops("p", loops), (), loaded.parts)

    assert hostile_batch.check_one(path, with_commands=True)
    monkeypatch.setattr(hostile_batch, "read_workpiece", wrong)
    with pytest.raises(AssertionError):
        hostile_batch.check_one(path, with_commands=False)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("work", "told"),
    [
        ("while True: pass", "check_one"),
        ("bytearray(3 << 30)", "MemoryError"),
        ("import os; os.abort()", "part.json of seed 7"),
    ],
)
def test_the_fuzzer_tells_of_a_file_that_takes_too_much(work: str, told: str) -> None:
    """Of time, of memory, or brings the interpreter down."""
    program = f"""
import sys; sys.path[:0] = {[str(TESTS), str(TESTS / "files")]!r}
import hostile_batch
def slow(path):
    {work}
hostile_batch.SECONDS = 1
hostile_batch.warm_up = lambda name, path: hostile_batch.CHECKS.update({{name: slow}})
hostile_batch.run_batch("part.json", 7, 8)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert told in done.stdout + done.stderr and done.stdout.endswith("part.json of seed 7\n")
