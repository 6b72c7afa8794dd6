"""The best few triples are exactly the first of all, however they are looked at; too many are refused."""

from __future__ import annotations

from threading import Event

import numpy as np
import pytest
from attrs import evolve

from supports.cases import case
from supports.random_supports import random_demand, random_fixtures
from workhold import Vise, Workpiece, design
from workhold.errors import InputError
from workhold.model.support_request import SupportRequest
from workhold.supports import choosing, listing
from workhold.supports.choosing import coarse, digits_of
from workhold.supports.listing import supports_of, supports_one_by_one


@pytest.mark.parametrize("few", [0, 48])
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.prove)])
def test_the_best_few_of_random_fixtures_are_the_first_of_all(
    few: int, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In blocks and at once, with and without loads, rings and a point: the same, to the last bit."""
    with_some = 0
    for random, query, fixture in random_fixtures(seed, of_each=4):
        request, loads = random_demand(random, query.workpiece)
        if random.random() < 0.3:
            request = evolve(request, reach=[(20.0, 20.0, 5.0, 40.0)])
        everything = supports_of(fixture, query, request, loads)
        assert everything.complete
        with monkeypatch.context() as patch:
            patch.setattr(choosing, "FEW_HOLES", few)
            patch.setattr(choosing, "FIRST", 2)
            patch.setattr(choosing, "LATER", 5)
            for count in (1, 3, 12):
                best = supports_of(fixture, query, request, loads, best=count)
                assert best.triples == everything.triples[:count]
                assert best.count in (None, everything.count)
        with_some += bool(everything.triples)
    assert with_some > 15


@pytest.mark.parametrize("value", [0.0, 1.0, 9.9, 10.0, 1500.0, 0.0123, 134.99, 99.4])
def test_digits_bound_all_that_count_as_a_figure(value: float) -> None:
    """All figures below the first count as less, all above the second as more."""
    value = coarse(value)
    low, high = digits_of(value)
    assert low <= value <= high
    for near in np.linspace(0.9 * value, 1.1 * value + 1e-8, 2001):
        if abs(near - low) > 1e-6 * value and abs(near - high) > 1e-6 * value:
            assert (coarse(near) < value) == (near < low) and (coarse(near) > value) == (near > high)


def test_a_list_of_too_many_is_refused_and_the_best_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """One plain sentence, and no more memory than the best few need."""
    one = case("plate100")
    monkeypatch.setattr(choosing, "MOST_LISTED", 50)
    with pytest.raises(InputError, match="more than 50 sets of three supports hold the part up, too many"):
        supports_of(one.fixture, one.query, one.request, one.loads, one.jaw_force)
    assert (
        len(supports_of(one.fixture, one.query, one.request, one.loads, one.jaw_force, best=5).triples) == 5
    )
    monkeypatch.setattr(listing, "MOST_POSITIONS", 10)
    with pytest.raises(InputError, match="holes could hold a support, more than 10"):
        supports_of(one.fixture, one.query, one.request, one.loads, one.jaw_force, best=5)


def test_a_search_is_followed_and_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """Progress rises to 1; once it is stopped no further fixture is looked at, and the list says so."""
    monkeypatch.setattr(choosing, "FEW_HOLES", 0)
    plate = Workpiece.from_loops("plate", [[[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]]])
    result = design(plate, Vise(pitch=20, columns=5, peg_radius=3), best=3)
    request, seen, cancel = SupportRequest.of(plate, 20, toolkit=result.toolkit), list[float](), Event()
    found = list(supports_one_by_one(result, result.query, request, each=2, progress=seen.append))
    assert len(found) == 3 and seen == sorted(seen) and seen[-1] == 1.0 and len(seen) > 10
    assert not any(one.stopped for one in found)

    def stop(fraction: float) -> None:
        if fraction > 0.5:
            cancel.set()

    stopped = list(supports_one_by_one(result, result.query, request, each=2, cancel=cancel, progress=stop))
    assert [one.stopped for one in stopped] == [False, True]
    assert stopped[1].count is None and stopped[0].triples == found[0].triples
