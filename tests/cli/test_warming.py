"""Kernels are compiled once, on the first run, with a bar."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from threading import Event
from typing import Any

import pytest

from workhold.cli import warming
from workhold.kernels.base import libraries


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[Sequence[str]]:
    """A machine on which nothing is compiled, and what is asked to be."""
    asked: list[Sequence[str]] = []

    def build(rooms: Sequence[str], report: Callable[[float], None], cancel: Event) -> None:
        asked.append(rooms)
        report(0.5)
        report(1.0)

    monkeypatch.setattr(libraries, "build_libraries", build)
    monkeypatch.setattr(libraries, "is_built", lambda rooms: rooms in asked)
    return asked


def test_what_is_missing_is_compiled_once(built: list[Sequence[str]]) -> None:
    """Searches do without the kernels of seating."""
    assert warming.compile_kernels(Event())
    assert built == [libraries.SEARCH_ROOMS] and "seating" not in libraries.SEARCH_ROOMS
    assert not warming.compile_kernels(Event())
    assert warming.compile_seating(Event()) and not warming.compile_seating(Event())
    assert set(libraries.ROOMS) == {*libraries.SEARCH_ROOMS, *libraries.SEATING_ROOMS}


def test_the_bar_tells_how_much_is_done(built: list[Sequence[str]], monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[Any] = []

    class Bar:
        def __init__(self, *words: str) -> None:
            told.append(words)

        def __enter__(self) -> Callable[[float, int], None]:
            return lambda fraction, count: told.append((fraction, count))

        def __exit__(self, *error: object) -> None:
            told.append("end")

    monkeypatch.setattr(warming, "show_progress", Bar)
    warming.compile_kernels(Event())
    (words, *steps) = told
    assert words[0] == words[2] == warming.WORDS and steps == [(0.5, 50), (1.0, 100), "end"]
