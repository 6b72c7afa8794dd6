"""Fixtures shown while a search runs are fixtures it finds, and showing them changes nothing."""

from __future__ import annotations

from functools import cache
from io import StringIO
from typing import Any

import pytest

from workhold import Result, Vise, design, load
from workhold.files.result.writer import write_result_text
from workhold.search import shares


def identity(fixture: Any) -> tuple[Any, ...]:
    """What tells fixtures apart."""
    return (
        tuple(peg.hole for peg in fixture.pegs),
        tuple(peg.face for peg in fixture.pegs),
        round(fixture.pose.theta_deg, 6),
    )


def text(result: Result) -> str:
    """The result file."""
    stream = StringIO()
    stream.writelines(write_result_text(result))
    return stream.getvalue()


WIDGET, VISE = load("widget"), Vise(pitch=8, columns=1, peg_radius=3)


@cache
def everything() -> Result:
    """All fixtures, searched once."""
    return design(WIDGET, VISE)


@pytest.mark.thorough
@pytest.mark.parametrize("best", [None, 20])
def test_previews_are_some_of_the_fixtures(monkeypatch: pytest.MonkeyPatch, best: int | None) -> None:
    monkeypatch.setattr(shares, "PAUSE", 0.0)
    monkeypatch.setattr(shares, "SHARE", 0.0)
    shown: list[Result] = []
    result = design(WIDGET, VISE, best=best, preview=shown.append, threads=1)
    found = {identity(fixture) for fixture in everything()}
    assert len(shown) > 3
    before: set[Any] = set()
    for some in shown:
        now = {identity(fixture) for fixture in some}
        assert before <= now <= found and len(now) == len(some)
        assert not some.complete and some.query == result.query
        before = now
    assert text(result) == text(everything() if best is None else design(WIDGET, VISE, best=best))


def test_a_short_search_shows_nothing_ahead(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shares, "PAUSE", 1000.0)
    shown: list[Result] = []
    design(WIDGET, VISE, preview=shown.append)
    assert shown == []
