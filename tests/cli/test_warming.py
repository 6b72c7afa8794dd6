"""Compiling on a first run moves a bar by the kernel, shared with a second process or not, and stops when told to."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event

import pytest

from workhold.cli import warming
from workhold.kernels import preparing

SEATING = sum(1 for part in preparing.LATER for _ in preparing.PARTS[part]())
LONGEST = sum(1 for _ in preparing.PARTS[warming.LONGEST]())


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, int]]:
    """What the bar is told; nothing is compiled."""
    told: list[tuple[float, int]] = []

    @contextmanager
    def bar(*words: str) -> Iterator[Callable[[float, int], None]]:
        said = {warming.WORDS: preparing.KERNEL_COUNT, warming.SEATING_WORDS: SEATING}[words[0]]
        assert words == (words[0], f"of {said} kernels", words[0])
        yield lambda fraction, count: told.append((fraction, count))

    monkeypatch.setattr(warming, "progress_bar", bar)
    monkeypatch.setattr(preparing, "prepared", lambda part: (kernel for kernel, _ in preparing.PARTS[part]()))
    return told


@pytest.mark.parametrize("processors", [1, 2])
def test_the_bar_moves_by_the_kernel(processors, shown, monkeypatch, tmp_path):
    """Every kernel counts once, also those that the second process has compiled."""
    monkeypatch.setattr("os.cpu_count", lambda: processors)
    monkeypatch.setattr(warming, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(warming, "SECOND_PROCESS", f"for _ in range({LONGEST}): print(flush=True)")
    warming.compile_kernels(Event())
    count = preparing.KERNEL_COUNT
    assert shown == [(k / count, k) for k in range(1, count + 1)]


def test_without_a_cache_one_process_compiles_all(shown, monkeypatch):
    """What a second process compiles would be lost."""
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    monkeypatch.setattr(warming, "cache_folder", lambda: None)
    monkeypatch.setattr(warming, "SECOND_PROCESS", "raise SystemExit(3)")
    warming.compile_kernels(Event())
    assert shown[-1] == (1.0, preparing.KERNEL_COUNT)


def test_an_interruption_leaves_the_rest_to_the_search(shown, monkeypatch):
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    cancel = Event()
    cancel.set()
    warming.compile_kernels(cancel)
    assert len(shown) == 1


def test_the_kernels_of_seating_are_compiled_once(shown, monkeypatch, tmp_path):
    """The last of them that is kept tells that all are; and when told to stop, the rest is left."""
    monkeypatch.setattr(warming, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(warming, "LIBRARY", None)
    cancel = Event()
    warming.compile_seating(cancel)
    assert shown == [(k / SEATING, k) for k in range(1, SEATING + 1)]
    *_, (last, _) = preparing.PARTS[preparing.LATER[-1]]()
    assert f"{last.__module__.rpartition('.')[2]}.{last.__name__}" == warming.LAST_OF_SEATING
    cancel.set()
    warming.compile_seating(cancel)
    assert len(shown) == SEATING + 1
    (tmp_path / "seating_0").mkdir()
    (tmp_path / "seating_0" / f"{warming.LAST_OF_SEATING}-41.py311.nbi").touch()
    warming.compile_seating(Event())
    assert warming.is_seating_compiled() and len(shown) == SEATING + 1


def test_where_kernels_were_built_in_no_cache_is_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its name is asked of a library that need not be there."""

    def absent() -> None:
        raise ModuleNotFoundError

    monkeypatch.setattr(warming, "LIBRARY", object())
    monkeypatch.setattr(warming, "cache_folder", absent)
    assert warming.is_seating_compiled()
