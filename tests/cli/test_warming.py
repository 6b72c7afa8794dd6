"""Compiling on a first run moves a bar by the kernel, shared with a second process or not, and stops when told to; a second
process that is killed costs time only."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event

import pytest

import workhold
from workhold.cli import warming
from workhold.kernels import preparing
from workhold.kernels.base import compiling

pytestmark = pytest.mark.thorough

SOURCES = str(Path(workhold.__file__).parents[1])
COUNTS = {
    warming.WORDS: sum(map(preparing.kernel_count, preparing.SEARCH)),
    warming.SEATING_WORDS: sum(map(preparing.kernel_count, preparing.SEATING)),
}
COUNT, SEATING = COUNTS.values()
SECOND = preparing.kernel_count(preparing.SEARCH[1])
# Two small kernels for each process; the second one's is replaced by the program's own.
SMALL = """
from workhold.kernels import preparing
few = {kernel.__name__: (kernel, given) for kernel, given in preparing.distances()}
preparing.PARTS = {name: lambda name=name: iter([few[name]]) for name in few}
preparing.SEARCH = ("turns_around",), ("is_inside", "are_concentric")
"""
FIRST = """
import sys
from threading import Event
from workhold.cli import warming
warming.os.cpu_count = lambda: 2
warming.PROGRAM = open("second.py").read()
second = warming.begin_compiling()
warming.compile_kernels(Event(), second)
print(second.process.returncode, second.done, *(sum(few[name][0].stats.cache_hits.values()) for (name,) in zip(few)))
print(*few)
"""


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, int]]:
    """What the bar is told; nothing is compiled."""
    told: list[tuple[float, int]] = []

    @contextmanager
    def bar(*words: str) -> Iterator[Callable[[float, int], None]]:
        assert words == (words[0], f"of {COUNTS[words[0]]} kernels", words[0])
        yield lambda fraction, count: told.append((fraction, count))

    def prepared(*parts: str) -> Iterator[Callable[..., None]]:
        return (kernel for part in parts for kernel, _ in preparing.PARTS[part]())

    monkeypatch.setattr(warming, "progress_bar", bar)
    monkeypatch.setattr(preparing, "prepared", prepared)
    return told


def whole(count: int) -> list[tuple[float, int]]:
    """What the bar is told where each kernel counts once."""
    return [(k / count, k) for k in range(1, count + 1)]


@pytest.mark.parametrize("processors", [1, 2])
def test_the_bar_moves_by_the_kernel(processors, shown, monkeypatch, tmp_path):
    """Every kernel counts once, also those that the second process has compiled."""
    monkeypatch.setattr("os.cpu_count", lambda: processors)
    monkeypatch.setattr(warming, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(warming, "PROGRAM", f"for _ in range({SECOND}): print(flush=True)")
    second = warming.begin_compiling()
    assert (second is None) == (processors == 1)
    warming.compile_kernels(Event(), second)
    assert shown == whole(COUNT)


def test_what_a_killed_process_leaves_is_compiled_here(shown, monkeypatch, tmp_path):
    """Each kernel still counts once, and the killed process is buried."""
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    monkeypatch.setattr(warming, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(warming, "PROGRAM", "import os; print(flush=True); os.kill(os.getpid(), 9)")
    second = warming.begin_compiling()
    assert second is not None
    warming.compile_kernels(Event(), second)
    assert shown == whole(COUNT)
    assert second.process.returncode == -9 and second.done == 1


def test_without_a_cache_one_process_compiles_all(shown, monkeypatch):
    """What a second process compiles would be lost."""
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    monkeypatch.setattr(warming, "cache_folder", lambda: None)
    assert warming.begin_compiling() is None
    warming.compile_kernels(Event())
    assert shown == whole(COUNT)


def test_an_interruption_leaves_the_rest_to_the_search(shown, monkeypatch, tmp_path):
    """The second process is ended, and nothing of its share is begun."""
    cancel = Event()
    cancel.set()
    for processors in (1, 2):
        monkeypatch.setattr("os.cpu_count", lambda number=processors: number)
        monkeypatch.setattr(warming, "cache_folder", lambda: tmp_path)
        monkeypatch.setattr(warming, "PROGRAM", "import time; time.sleep(600)")
        second = warming.begin_compiling()
        warming.compile_kernels(cancel, second)
        assert len(shown) == processors
        assert second is None or second.process.returncode is not None


def test_the_kernels_of_seating_are_compiled_once(shown, monkeypatch, tmp_path):
    """The last of each share that is kept tells that all are; and when told to stop, the rest is left."""
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    monkeypatch.setattr(compiling, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(compiling, "LIBRARY", None)
    cancel = Event()
    warming.compile_seating(cancel)
    assert shown == whole(SEATING)
    cancel.set()
    warming.compile_seating(cancel)
    assert len(shown) == SEATING + 1
    (tmp_path / "seating_0").mkdir()
    for name in warming.LAST_OF_SEATING:
        assert not warming.is_seating_compiled()
        (tmp_path / "seating_0" / f"{name}-41.py311.nbi").touch()
    warming.compile_seating(Event())
    assert warming.is_seating_compiled() and len(shown) == SEATING + 1


@pytest.mark.parametrize(
    ("shares", "told"),
    [(preparing.SEARCH, compiling.LAST_OF_SEARCH), (preparing.SEATING, warming.LAST_OF_SEATING)],
    ids=["search", "seating"],
)
def test_what_tells_that_all_is_stored_is_compiled_last(shares, told):
    """By each of the two processes; and what one of them compiles the other does not."""
    compiled = [[kernel for part in share for kernel, _ in preparing.PARTS[part]()] for share in shares]
    last = {f"{kernels[-1].__module__.rpartition('.')[2]}.{kernels[-1].__name__}" for kernels in compiled}
    assert last == set(told)
    assert not {kernel.__name__ for kernel in compiled[0]} & {kernel.__name__ for kernel in compiled[1]}


def test_where_kernels_were_built_in_no_cache_is_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its name is asked of a library that need not be there."""

    def absent() -> None:
        raise ModuleNotFoundError

    monkeypatch.setattr(compiling, "LIBRARY", object())
    monkeypatch.setattr(compiling, "cache_folder", absent)
    assert warming.is_seating_compiled() and not compiling.is_first_run()


def first_process(folder: Path, program: str, **further: str) -> str:
    """What a first run writes, kernels kept in a folder of its own."""
    environment = {
        **os.environ,
        "PYTHONPATH": SOURCES,
        "WORKHOLD_KERNELS": "numba",
        "WORKHOLD_CACHE_DIR": str(folder),
    }
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, env={**environment, **further}, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_process_killed_half_way_leaves_a_first_run_that_works(tmp_path):
    """What it had stored is read, and the rest compiled."""
    (tmp_path / "second.py").write_text(
        warming.PROGRAM.replace("print(flush=True)", KILLED).replace("for _", SMALL + "for _")
    )
    numbers, names = first_process(tmp_path, SMALL + FIRST).splitlines()
    code, done, *read = map(int, numbers.split())
    assert (code, done) == (-9, 1)
    assert dict(zip(names.split(), read, strict=True))["is_inside"] == 1
    stored = {path.name.partition("-")[0] for path in tmp_path.rglob("*.nbi")}
    assert stored == {"distance.turns_around", "distance.is_inside", "coincidences.are_concentric"}


# As the second process's step, after its first kernel.
KILLED = "print(flush=True); import os; os.kill(os.getpid(), 9)"
DESIGN = "import sys; from workhold.__main__ import run; sys.argv[1:] = {words!r}.split(); run()"
KILLING = """
from workhold.cli import warming
warming.PROGRAM = warming.PROGRAM.replace("print(flush=True)", "print(flush=True); import os; os.kill(os.getpid(), 9)")
"""


@pytest.mark.prove
def test_two_processes_store_all_kernels_and_the_result_is_the_same(tmp_path):
    """Byte for byte, whether they share the work, one is killed, or there is only one."""
    words = "design widget --pitch 10 --columns 1 --peg-radius 3 --threads 1 --out r.json"
    results = []
    for name, before in (
        ("both", ""),
        ("killed", KILLING),
        ("alone", "import os; os.cpu_count = lambda: 1\n"),
    ):
        folder = tmp_path / name
        folder.mkdir()
        first_process(folder, before + DESIGN.format(words=words))
        results.append((folder / "r.json").read_bytes())
        stored = {path.name.partition("-")[0].partition(".")[2] for path in folder.rglob("*.nbi")}
        parts = [part for share in preparing.SEARCH for part in share]
        assert stored >= {kernel.__name__ for part in parts for kernel, _ in preparing.PARTS[part]()}
    assert len(results[0]) > 1000 and results[0] == results[1] == results[2]
