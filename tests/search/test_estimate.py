"""An estimate tells how many fixtures there are, within a factor of two, before they are sought."""

from __future__ import annotations

from threading import Event
from typing import Any

import pytest
from attrs import evolve

from cad_parts import cad_part
from workhold import Fence, OpeningVise, Plate, Query, Vise, answer, load
from workhold.fixels.toolkit import Toolkit
from workhold.search import design as designing
from workhold.search import estimate

PARTS = {"flange": load("flange"), "widget": load("widget"), "bores": cad_part(2)}
KITS: dict[str, Toolkit] = {
    "plate": Plate(pitch=10, peg_radius=3),
    "two clamps": Plate(pitch=20, peg_radius=3, clamps=2),
    "vise": Vise(pitch=6, columns=2, peg_radius=2),
    "opening": OpeningVise(pitch=8, columns=3, peg_radius=3),
}


@pytest.fixture
def unasked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of small searches, too, a part is looked at only."""
    monkeypatch.setattr(estimate, "FEW", 0.0)
    monkeypatch.setattr(estimate, "WORK", 1e5)
    monkeypatch.setattr(estimate, "CONTACTS_DECIDED", 400)


@pytest.mark.thorough
@pytest.mark.usefixtures("unasked")
@pytest.mark.parametrize("kit", KITS)
@pytest.mark.parametrize("part", PARTS)
def test_an_estimate_is_right_within_a_factor_of_two(part: str, kit: str) -> None:
    """On every kind of toolkit whose fixtures are estimated; every run and any number of threads say the same."""
    query = Query(PARTS[part], KITS[kit])
    about, known = estimate.estimate_fixtures(query, 1), len(answer(query))
    assert about is not None
    if known < 100:
        assert about <= 200
        return
    assert known / 2 <= about <= 2 * known
    assert estimate.estimate_fixtures(query, 3) == about


@pytest.mark.thorough
@pytest.mark.usefixtures("unasked")
def test_every_pair_of_two_clamps_counts_where_all_are_listed() -> None:
    """There are many more pairs than seats."""
    query = Query(PARTS["widget"], KITS["two clamps"], listing="all")
    about = estimate.estimate_fixtures(query, 2)
    assert about is not None and len(answer(query)) / 2 <= about <= 2 * len(answer(query))


def test_small_searches_and_walls_have_no_estimate() -> None:
    """What is soon counted is not estimated, nor what nobody can tell."""
    assert (
        estimate.estimate_fixtures(Query(load("widget"), Vise(pitch=10, columns=1, peg_radius=3)), 1) is None
    )
    assert (
        estimate.estimate_fixtures(Query(load("widget"), Fence(pitch=7, wall_offset=8, peg_radius=3)), 1)
        is None
    )


@pytest.mark.usefixtures("unasked")
@pytest.mark.parametrize("kit", ["plate", "two clamps"])
def test_who_stops_hears_no_estimate(kit: str) -> None:
    """A part of a sample says nothing."""
    stopped = Event()
    stopped.set()
    assert estimate.estimate_fixtures(Query(load("widget"), KITS[kit]), 1, stopped) is None


def test_the_best_are_asked_for_where_there_are_many(monkeypatch: pytest.MonkeyPatch) -> None:
    """Up to a limit nothing changes, nor for who asks for the best already."""
    query = Query(load("widget"), KITS["vise"])
    monkeypatch.setattr(estimate, "estimate_fixtures", lambda *asked: estimate.MANY)
    assert estimate.ask_for_best_where_many(query, 1) == (query, estimate.MANY)
    monkeypatch.setattr(estimate, "estimate_fixtures", lambda *asked: estimate.MANY + 1)
    assert estimate.ask_for_best_where_many(query, 1) == (
        evolve(query, best=estimate.LISTED),
        estimate.MANY + 1,
    )
    few = evolve(query, best=3)
    assert estimate.ask_for_best_where_many(few, 1) == (few, None)


@pytest.mark.thorough
@pytest.mark.usefixtures("unasked")
def test_what_is_thinned_counts_as_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where cells hold too much, one chord curve in some is looked at, and what is found stands for all."""
    monkeypatch.setattr(estimate, "WORK", 1e9)
    query = Query(PARTS["bores"], KITS["vise"])
    known = len(answer(query))
    assert estimate.estimate_fixtures(query, 2) == pytest.approx(known, rel=0.05)
    monkeypatch.setattr(estimate, "MOST_WORK", 2e4)
    about = estimate.estimate_fixtures(query, 2)
    assert about is not None and about != known and known / 2 <= about <= 2 * known


@pytest.mark.thorough
@pytest.mark.usefixtures("unasked")
def test_triples_of_stretches_stand_for_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """With two clamps some are drawn where cells hold too much; seats are drawn whole, on bores and corners too."""
    monkeypatch.setattr(estimate, "WORK_OF_TWO", 1e9)
    monkeypatch.setattr(estimate, "MOST_OF_TWO", 1 << 10)
    monkeypatch.setattr(estimate, "CONTACTS_DECIDED", 1 << 20)
    query = Query(PARTS["bores"], KITS["two clamps"])
    known = len(answer(query))
    assert estimate.estimate_fixtures(query, 2) == pytest.approx(known, rel=0.05)
    monkeypatch.setattr(estimate, "MOST_IN_CELL", 3e3)
    about = estimate.estimate_fixtures(query, 2)
    assert about is not None and about != known and known / 1.5 <= about <= 1.5 * known
    assert estimate.estimate_fixtures(query, 1) == about


@pytest.mark.usefixtures("unasked")
def test_candidates_that_are_not_proven_do_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of those that are decided the share that is proven counts."""
    query = Query(PARTS["widget"], KITS["vise"])
    every, real = estimate.estimate_fixtures(query, 2), estimate.decide_on_this_thread

    def decide_half(records: Any, *asked: Any) -> Any:
        return real([records[0][::2]], *asked)

    monkeypatch.setattr(estimate, "decide_on_this_thread", decide_half)
    assert every is not None and estimate.estimate_fixtures(query, 2) == pytest.approx(every / 2, rel=0.2)


@pytest.mark.usefixtures("unasked")
def test_all_ways_of_a_toolkit_count() -> None:
    """A clamp that may push along columns or rows holds the part in either way."""
    kit = Plate(pitch=16, peg_radius=3, directions=("+x", "+y"))
    assert len(kit.ways) > 1
    query = Query(PARTS["widget"], kit)
    ways = [estimate.estimate_fixtures(evolve(query, toolkit=way), 2) for way in kit.ways]
    assert all(ways) and estimate.estimate_fixtures(query, 2) == sum(way or 0 for way in ways)


@pytest.mark.thorough
@pytest.mark.usefixtures("unasked")
def test_a_comparison_counts_about_and_seeks_the_first_choice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its figures are those of the first of all; where nothing is found, that is counted."""
    asked = []
    monkeypatch.setattr(designing, "answer", lambda query, **_: asked.append(query.best) or answer(query))
    kits = {"vise": KITS["vise"], "none": Vise(pitch=10, columns=1, peg_radius=3, max_opening=11)}
    found = list(designing.explore((name, Query(PARTS["flange"], kit)) for name, kit in kits.items()))
    whole = answer(Query(PARTS["flange"], kits["vise"]))
    assert found[0].about is not None and found[0].fixtures == found[0].about
    assert len(whole) / 2 <= found[0].fixtures <= 2 * len(whole)
    assert found[0].figures == dict(whole[0].quality) and not found[0].found
    assert asked == [1, 1]
    assert found[1].fixtures == 0 and found[1].about is None and found[1].reason
