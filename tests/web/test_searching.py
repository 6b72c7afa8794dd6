"""The task of a search: the best fixtures first, then all of them."""

from __future__ import annotations

from collections.abc import Iterator
from threading import Event
from typing import Any

import pytest
from attrs import evolve

import workhold.search.design as designing
from workhold import Query, Result, Vise, load
from workhold.search import estimate
from workhold.web.searching import FIRST, AskedQueries, make_fixture_mark, put_best_first, search
from workhold.web.worker import TaskContext

SECONDS = 600.0


@pytest.fixture(scope="module")
def query() -> Query:
    """A search that finds many more than are sought first."""
    return Query(load("widget"), Vise(pitch=8, columns=2, peg_radius=3))


@pytest.fixture(scope="module")
def whole(query: Query) -> Result:
    """All that the program finds."""
    return designing.answer(query)


@pytest.fixture
def previews() -> list[bool]:
    """Whether each search shows fixtures before its end."""
    return []


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, previews: list[bool]) -> Iterator[list[int | None]]:
    """How many of the best each search was for, None for all."""
    real, asked = designing.answer, []

    def answer(query: Query, **watching: Any) -> Result:
        asked.append(query.best)
        previews.append(watching.get("preview") is not None)
        return real(query, **watching)

    monkeypatch.setattr(designing, "answer", answer)
    yield asked


def run(
    query: Query, most: int = 10_000, cancel: Event | None = None, every: bool = False
) -> tuple[Any, list[Any]]:
    """The outcome of the task, and what it reports."""
    reports: list[Any] = []
    return search(
        (AskedQueries.from_queries((("", query),)), most, every),
        TaskContext(reports.append, cancel or Event(), SECONDS),
    ), reports


def marks(result: Result) -> list[Any]:
    return [make_fixture_mark(result.table, k) for k in range(len(result))]


@pytest.mark.thorough
def test_the_best_of_all_come_first(
    query: Query, whole: Result, asked: list[int | None], previews: list[bool]
) -> None:
    """In the order that they have in the end; progress never goes back, and no fixture is forgotten."""
    found, reports = run(query)
    assert asked == [FIRST, None]
    kinds = [kind for kind, *_ in reports]
    (first,) = (value for kind, value, *_ in reports if kind == "first")
    assert marks(first) == marks(whole)[:FIRST]
    assert first.query == query and not first.complete
    assert marks(found.result) == marks(whole) and found.result.found == whole.found
    assert found.result.query.best is None and found.result.notes == whole.notes
    after = [value for value in reports[kinds.index("first") :] if value[0] == "progress"]
    assert all(count >= FIRST for _, _, count in after)
    fractions = [value[1] for value in reports if value[0] == "progress"]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    # What is shown then stays: nothing worse comes in its place while the rest is searched.
    assert previews == [True, False]


def test_where_nothing_holds_it_is_searched_once(asked: list[int | None]) -> None:
    """And the answer is that of a search for all."""
    query = Query(load("widget"), Vise(pitch=200, columns=1, peg_radius=3))
    found, _ = run(query)
    assert asked == [FIRST]
    whole = designing.answer(query)
    assert (len(found.result), found.result.complete, found.result.notes) == (0, True, whole.notes)
    assert found.result.query == query


def test_only_the_best_are_sought_where_only_they_are_asked_for(
    query: Query, asked: list[int | None]
) -> None:
    found, reports = run(evolve(query, best=3))
    assert asked == [3] and len(found.result) == 3
    assert not any(kind == "first" for kind, *_ in reports)


def test_a_search_that_is_stopped_among_the_best_keeps_those_found(
    query: Query, asked: list[int | None]
) -> None:
    """No search for all begins, which would find nothing in no time."""
    cancel = Event()
    reports: list[Any] = []

    def report(value: Any) -> None:
        reports.append(value)
        if value[0] == "progress" and value[2] > FIRST:
            cancel.set()

    found = search(
        (AskedQueries.from_queries((("", query),)), 10_000, False), TaskContext(report, cancel, SECONDS)
    )
    assert asked == [FIRST] and not found.result.complete
    assert 0 < len(found.result) <= FIRST and found.result.query == query


def test_a_search_that_is_stopped_keeps_the_best_first(whole: Result) -> None:
    """Before what else was found, each once, and it is not whole all the same."""
    best = evolve(whole.slice_rows(slice(0, 5)), distinct=dict.fromkeys(whole.distinct, 1))
    later = evolve(whole.slice_rows(slice(3, 9)), complete=False, found=dict.fromkeys(whole.found, 0))
    joined = put_best_first(later, best)
    assert marks(joined) == marks(whole)[:9] and not joined.complete
    assert sum(joined.found.values()) == 9


@pytest.mark.thorough
def test_of_very_many_fixtures_the_best_are_sought(
    query: Query, whole: Result, asked: list[int | None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A remark says how many there are; who wants every one gets them."""
    monkeypatch.setattr(estimate, "estimate_fixtures", lambda *_: 4_240_000)
    monkeypatch.setattr(estimate, "LISTED", 30)
    found, _ = run(query)
    assert asked == [FIRST, 30] and found.result.query.best == 30 and marks(found.result) == marks(whole)[:30]
    assert tuple(map(str, found.notes)) == ("There are about 4,200,000 fixtures: these are the best 30.",)
    found, _ = run(query, every=True)
    assert asked[2:] == [FIRST, None] and marks(found.result) == marks(whole) and found.notes == ()
