"""The best few triples are exactly the first of all, however they are looked at; too many are refused."""

from __future__ import annotations

from itertools import pairwise
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
from workhold.supports.choosing import bound_coarse_figure, round_coarsely
from workhold.supports.listing import find_supports, yield_supports


@pytest.mark.thorough
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
        everything = find_supports(fixture, query, request, loads)
        assert everything.complete
        with monkeypatch.context() as patch:
            patch.setattr(choosing, "FEW_HOLES", few)
            patch.setattr(choosing, "FIRST", 2)
            patch.setattr(choosing, "LATER", 5)
            for count in (1, 3, 12):
                best = find_supports(fixture, query, request, loads, best=count)
                assert best.triples == everything.triples[:count]
                assert best.count in (None, everything.count)
        with_some += bool(everything.triples)
    assert with_some > 15


@pytest.mark.thorough
def test_of_a_part_that_hangs_in_places_the_best_few_are_the_first_of_all() -> None:
    """Places over material before places over air, and sets from which the part falls last of all."""
    kinds = set()
    for random, query, fixture in random_fixtures(7, of_each=3):
        request, loads = random_demand(random, query.workpiece)
        x0, y0, x1, y1 = query.workpiece.bounds
        a, b, c, d = ([random.uniform(x0, x1), random.uniform(y0, y1)] for _ in range(4))
        request = evolve(
            request,
            top=query.workpiece.loops,
            top_heights=[request.thickness] * len(query.workpiece.loops),
            hanging=[rectangle(a, b, 20.0)],
            hanging_heights=[request.thickness],
            rising=[rectangle(c, d, 1.0)],
            rising_heights=[request.thickness],
            head_radius=random.uniform(1.0, 6.0),
            tip_margin=random.uniform(0.0, 1.0),
        )
        everything = find_supports(fixture, query, request, loads)
        for count in (1, 3, 12):
            assert (
                find_supports(fixture, query, request, loads, best=count).triples
                == everything.triples[:count]
            )
        order = [(one.standing < -1e-9, one.given is None, one.clamp.hangs) for one in everything.triples]
        late = request.point is not None
        assert all(
            a[0] <= b[0] and (a[0] < b[0] or not late or a[1] <= b[1]) for a, b in pairwise(order)
        ) and (late or order == sorted(order))
        kinds |= {(one[0], one[2]) for one in order}
    assert kinds == {(False, False), (False, True), (True, False), (True, True)}


def rectangle(a: list[float], b: list[float], most: float) -> list[list[float]]:
    """A rectangle between two points, no larger than a length, as a loop with itself on the left."""
    x0, y0 = min(a[0], b[0]), min(a[1], b[1])
    x1, y1 = x0 + min(abs(a[0] - b[0]), most) + 0.5, y0 + min(abs(a[1] - b[1]), most) + 0.5
    return [[x0, y0, 0.0], [x1, y0, 0.0], [x1, y1, 0.0], [x0, y1, 0.0]]


@pytest.mark.parametrize("name", ["plate100", "bracketL"])
def test_sets_from_which_the_part_falls_come_after_all_others(name: str) -> None:
    """By the whole list, and with the loads of the truth."""
    one = case(name)
    every = find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force).triples
    falls = [triple.standing < -1e-9 for triple in every]
    assert any(falls) and not all(falls) and falls == sorted(falls)
    standing = [triple for triple in every if triple.standing >= -1e-9]
    needs = [
        round_coarsely((triple.given or triple.best).clamp_needed)
        for triple in standing
        if triple.given or not one.request.point
    ]
    assert needs == sorted(needs)


@pytest.mark.parametrize("value", [0.0, 1.0, 9.9, 10.0, 1500.0, 0.0123, 134.99, 99.4])
def test_digits_bound_all_that_count_as_a_figure(value: float) -> None:
    """All figures below the first count as less, all above the second as more."""
    value = round_coarsely(value)
    low, high = bound_coarse_figure(value)
    assert low <= value <= high
    for near in np.linspace(0.9 * value, 1.1 * value + 1e-8, 2001):
        if abs(near - low) > 1e-6 * value and abs(near - high) > 1e-6 * value:
            assert (round_coarsely(near) < value) == (near < low) and (round_coarsely(near) > value) == (
                near > high
            )


def test_a_list_of_too_many_is_refused_and_the_best_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """One plain sentence, and no more memory than the best few need."""
    one = case("plate100")
    monkeypatch.setattr(choosing, "MOST_LISTED", 50)
    with pytest.raises(InputError, match="more than 50 sets of three supports hold the part up, too many"):
        find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force)
    assert (
        len(find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force, best=5).triples) == 5
    )
    monkeypatch.setattr(listing, "MOST_POSITIONS", 10)
    with pytest.raises(InputError, match="holes could hold a support, more than 10"):
        find_supports(one.fixture, one.query, one.request, one.loads, one.jaw_force, best=5)


def test_a_search_is_followed_and_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """Progress rises to 1; once it is stopped no further fixture is looked at, and the list says so."""
    monkeypatch.setattr(choosing, "FEW_HOLES", 0)
    plate = Workpiece.from_loops("plate", [[[0, 0, 0], [100, 0, 0], [100, 60, 0], [0, 60, 0]]])
    result = design(plate, Vise(pitch=20, columns=5, peg_radius=3), best=3)
    request, seen, cancel = (
        SupportRequest.from_workpiece(plate, 20, toolkit=result.toolkit),
        list[float](),
        Event(),
    )
    found = list(yield_supports(result, result.query, request, each=2, progress=seen.append))
    assert len(found) == 3 and seen == sorted(seen) and seen[-1] == 1.0 and len(seen) > 10
    assert not any(one.stopped for one in found)

    def stop(fraction: float) -> None:
        if fraction > 0.5:
            cancel.set()

    stopped = list(yield_supports(result, result.query, request, each=2, cancel=cancel, progress=stop))
    assert [one.stopped for one in stopped] == [False, True]
    assert stopped[1].count is None and stopped[0].triples == found[0].triples
