"""Why no contacts beside a wall make a fixture: what each rule takes away of them, and what comes nearest."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from attrs import evolve

from workhold.contact.problem import Problem
from workhold.errors import InputError
from workhold.listing.wall_fixtures import WallFixtures, placed_on_wall, wall_table
from workhold.model.explanation import NearestMiss, Removal
from workhold.model.query import Query
from workhold.model.restrictions import Restrictions
from workhold.model.result import fixture_at
from workhold.search.removals import SECOND_CLAMP, Removals
from workhold.search.wall_search import WallSearch

__all__ = ["removals_beside_wall"]


def removals_beside_wall(query: Query, alone: bool) -> Removals:
    """How many pairs of contacts of locator and clamp there are in a toolkit of which one clamp moves, before
    any rule; what each rule takes away of them; and what comes nearest.

    Parameters
    ----------
    alone : whether one clamp is to hold the part; of two none comes nearest, as each pair is a clamp short.
    """
    counts = list(left_by_rules(query, alone))
    before = first = counts[0][1]
    removals = []
    for rule, count in counts[1:]:
        after = min(count, before)
        removals.append(Removal(rule, before, after))
        before = after
    search, nearest = searched(query) if alone else None, None
    if search is not None and search.verified == 0 and search.nearest is not None:
        nearest = miss_of(search, search.nearest[1])
    return Removals(first, removals, nearest)


def left_by_rules(query: Query, alone: bool) -> Iterator[tuple[str, int]]:
    """The rules in the order they are asked, with how many pairs are left after each; the first is no
    rule."""
    toolkit, asked = query.toolkit, query.restrictions
    free = toolkit.without(toolkit.limits)
    holes = toolkit.without([limit for limit in toolkit.limits if limit.bounds != "holes"])
    bare = evolve(query, toolkit=free, restrictions=Restrictions(), contact_margin=0.0)
    steps: list[tuple[bool, str, dict[str, Any]]] = [
        (True, "", {}),
        (bool(asked.avoid), "faces to avoid", {"restrictions": Restrictions(avoid=asked.avoid)}),
        (bool(asked.zones), "keep-out zones", {"restrictions": evolve(asked, angles=())}),
        (bool(asked.angles), "angles of the part", {"restrictions": asked}),
        (bool(holes.limits), toolkit.wording.holes, {"toolkit": holes}),
        (query.contact_margin > 0.0, "contact margin", {"contact_margin": query.contact_margin}),
    ]
    for is_asked, rule, changed in steps:
        if is_asked:
            bare = evolve(bare, **changed)
            yield rule, examined(bare)
    if not alone:
        yield SECOND_CLAMP, 0
        return
    search = searched(bare)
    yield "closure and clamping", 0 if search is None else search.verified
    yield "locator clear of the clamp", placed(bare)
    if toolkit.limits != holes.limits:
        yield "stroke of the clamp", placed(evolve(bare, toolkit=toolkit))


def searched(query: Query) -> WallSearch | None:
    """The search of a query, done; None where nothing is left to touch."""
    try:
        search = WallSearch(Problem.of(query), explains=True)
    except InputError:
        return None
    for edge in search.edges:
        for _ in search.fixtures(edge):
            pass
    return search


def examined(query: Query) -> int:
    """How many pairs a search looks at."""
    search = searched(query)
    return 0 if search is None else search.examined


def placed(query: Query) -> int:
    """How many pairs have a place."""
    try:
        search = WallSearch(Problem.of(query))
    except InputError:
        return 0
    return sum(len(placed_on_wall(part, search.problem)) for edge in search.edges for part in search.fixtures(edge))


def miss_of(search: WallSearch, pair: WallFixtures) -> NearestMiss:
    """The pair that comes nearest to pressing the part, as it would stand."""
    table = wall_table(pair, np.zeros(1, np.int64), without_travel(search.problem))
    fixture = fixture_at(table, without_travel(search.problem).toolkit, 0, search.problem.workpiece)
    pulls = sum(peg.force < 0 for peg in fixture.pegs)
    if pulls == 0:
        words = "one of its contacts would not press at all."
    else:
        one = "one of its contacts" if pulls == 1 else f"{pulls} of its contacts"
        words = f"{one} would have to pull the part instead of pressing on it: the part can slip out."
    return NearestMiss(fixture, words)


def without_travel(problem: Problem) -> Problem:
    """A problem whose clamp is its tip alone."""
    return evolve(problem, query=evolve(problem.query, toolkit=problem.toolkit.changed({"travel": None})))
