"""Why there is no fixture on a fence: what each rule took away, and what came nearest."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from attrs import evolve

from workhold.contact.problem import Problem
from workhold.errors import InputError
from workhold.listing.on_fence import Pressed, listed_on_fence, written_out
from workhold.model.explanation import NearestMiss, Removal
from workhold.model.query import Query
from workhold.model.restrictions import Restrictions
from workhold.model.result import fixture_at
from workhold.search.fence_search import FenceSearch

__all__ = ["removals_on_fence"]


def removals_on_fence(query: Query) -> tuple[int, tuple[Removal, ...], NearestMiss | None]:
    """How many pairs of contacts of locator and clamp there are in a toolkit of which one clamp moves, before any rule; what
    each rule takes away of them; and what comes nearest."""
    counts = list(left_by_rules(query))
    (_, first), *rest = counts
    removals, before = [], first
    for rule, count in rest:
        after = min(count, before)
        removals.append(Removal(rule, before, after))
        before = after
    search = searched(query)
    nearest = None
    if search is not None and search.verified == 0 and search.nearest is not None:
        nearest = miss_of(search, search.nearest[1])
    return first, tuple(removal for removal in removals if removal.before > 0), nearest


def left_by_rules(query: Query) -> Iterator[tuple[str, int]]:
    """The rules in the order they are asked, with how many pairs are left after each; the first is no rule."""
    toolkit, asked = query.toolkit, query.restrictions
    free = toolkit.without(toolkit.limits)
    holes = toolkit.without([limit for limit in toolkit.limits if limit.bounds != "holes"])
    bare = evolve(query, toolkit=free, restrictions=Restrictions(), contact_margin=0.0)
    yield "", examined(bare)
    if asked.avoid:
        bare = evolve(bare, restrictions=Restrictions(avoid=asked.avoid))
        yield "faces to avoid", examined(bare)
    if asked.zones:
        bare = evolve(bare, restrictions=evolve(asked, angles=()))
        yield "keep-out zones", examined(bare)
    if asked.angles:
        bare = evolve(bare, restrictions=asked)
        yield "angles of the part", examined(bare)
    if holes.limits:
        bare = evolve(bare, toolkit=holes)
        yield toolkit.wording.holes, examined(bare)
    if query.contact_margin > 0.0:
        bare = evolve(bare, contact_margin=query.contact_margin)
        yield "contact margin", examined(bare)
    search = searched(bare)
    yield "closure and clamping", 0 if search is None else search.verified
    yield "locator clear of the clamp", placed(bare)
    if toolkit.limits != holes.limits:
        yield "stroke of the clamp", placed(evolve(bare, toolkit=toolkit))


def searched(query: Query) -> FenceSearch | None:
    """The search of a query, done; None where nothing is left to touch."""
    try:
        search = FenceSearch(Problem.of(query), explains=True)
    except InputError:
        return None
    for edge in search.edges:
        for _ in search.pressed(edge):
            pass
    return search


def examined(query: Query) -> int:
    """How many pairs a search looks at."""
    search = searched(query)
    return 0 if search is None else search.examined


def placed(query: Query) -> int:
    """How many pairs have a place."""
    try:
        search = FenceSearch(Problem.of(query))
    except InputError:
        return 0
    return sum(len(listed_on_fence(part, search.problem)[0]) for edge in search.edges for part in search.pressed(edge))


def miss_of(search: FenceSearch, pair: Pressed) -> NearestMiss:
    """The pair that comes nearest to pressing the part, as it would stand."""
    table = written_out(pair, np.zeros(1, np.int64), without_travel(search.problem))
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
