"""Smaller pads and tips where the usual ones hold no part, and never others than a toolkit has."""

from __future__ import annotations

import pytest
from attrs import evolve

from supports.cases import case
from workhold import Query
from workhold.fixels.support_hardware import SupportPads, TopClamp
from workhold.model.support_request import SpatialLoad
from workhold.model.support_triples import Supports
from workhold.supports.asking import SMALLER, support_with_smaller_sizes, try_smaller_requests
from workhold.supports.forces import WeakJawError


def sizes(query: Query) -> list[tuple[float, float]]:
    """The radii of pads and tip that are tried for a query, in order."""
    tried = try_smaller_requests(query, 12.0)
    return [(one.pad_radius, one.tip_radius) for one in tried]


def test_sizes_fall_and_the_toolkits_own_stay() -> None:
    """The usual ones first; a size that the toolkit has is the only one of its kind, and inside goes with the tip."""
    query = case("bracketL").query
    assert sizes(query) == [(4.0, 5.0), *SMALLER]
    pads, clamp = SupportPads(pad_radius=2.5), TopClamp(tip_radius=6.0)
    own = evolve(query, toolkit=evolve(query.toolkit, supports=pads))
    assert sizes(own) == [(2.5, 5.0), (2.5, 4.0), (2.5, 3.0)]
    own = evolve(query, toolkit=evolve(query.toolkit, top_clamp=clamp))
    assert sizes(own) == [(4.0, 6.0), (3.0, 6.0), (2.0, 6.0)]
    own = evolve(query, toolkit=evolve(query.toolkit, supports=pads, top_clamp=clamp))
    assert sizes(own) == [(2.5, 6.0)]
    assert [one.inside for one in try_smaller_requests(query, 12.0)] == [5.0, 4.0, 3.0]


def test_who_asks_for_a_size_is_given_no_other() -> None:
    """A margin or a distance inside is a size as well; a band of heights is none."""
    query = case("bracketL").query
    for asked in ({"pad_radius": 4.0}, {"tip_radius": 5.0}, {"pad_margin": 0.5}, {"inside": 2.0}):
        assert len(list(try_smaller_requests(query, 12.0, asked))) == 1, asked
    assert [one.band for one in try_smaller_requests(query, 12.0, {"band": (2.0, 9.0)})] == [(2.0, 9.0)] * 3


def test_a_jaw_force_that_is_too_weak_is_refused_or_dropped() -> None:
    """Dropped it is as if none had been given: the force that keeps all pegs in contact."""
    one = case("bracketL")
    load = SpatialLoad(points=((20.0, 15.0),), force=200.0)

    def found(force: float | None, drops: bool) -> Supports:
        requests = try_smaller_requests(one.query, 12.0)
        asked = [one.fixture], one.query, requests, [load], force
        return support_with_smaller_sizes(*asked, drops_weak_force=drops)[0][0]

    with pytest.raises(WeakJawError):
        found(1.0, False)
    assert found(1.0, True).jaw_force == found(None, False).jaw_force > 1.0


def test_the_largest_sizes_that_hold_any_are_taken() -> None:
    """Usual ones where they hold; else the first smaller ones that do; where none do the least, to say why."""
    one = case("bracketL")
    found, usual = support_with_smaller_sizes([one.fixture], one.query, try_smaller_requests(one.query, 12.0))
    assert found is usual and found[0].triples and found[0].request.pad_radius == 4.0
    for margin, pad, held in ((6.5, 4.0, True), (7.0, 3.0, True), (8.0, 2.0, True), (9.0, 2.0, False)):
        pads = SupportPads(pad_margin=margin)
        query = evolve(one.query, toolkit=evolve(one.query.toolkit, supports=pads))
        found, usual = support_with_smaller_sizes([one.fixture], query, try_smaller_requests(query, 12.0))
        assert (found[0].request.pad_radius, bool(found[0].triples)) == (pad, held), margin
        assert usual[0].request.pad_radius == 4.0 and bool(usual[0].triples) == (pad == 4.0)
