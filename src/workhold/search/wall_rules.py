"""Why no contacts beside a wall make a fixture: what each rule takes away of them, and what comes nearest."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from attrs import evolve

from workhold.contact.problem import Problem
from workhold.errors import InputError
from workhold.model.explanation import NearestMiss, Removal
from workhold.model.query import Query
from workhold.model.restrictions import Restrictions
from workhold.model.result import FixtureTable, fixture_at
from workhold.search.lattice_pair_shares import LatticePairSearch
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
        nearest = miss_of(*search.nearest_alone())
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
    yield toolkit.wording.clear, placed(bare)
    if toolkit.limits != holes.limits:
        yield (
            next(limit.rule for limit in toolkit.limits if limit.bounds != "holes"),
            placed(evolve(bare, toolkit=toolkit)),
        )


def search_of(query: Query, explains: bool = False) -> WallSearch | LatticePairSearch | None:
    """The search of a query; None where nothing is left to touch."""
    kind = LatticePairSearch if query.toolkit.moving.on is None else WallSearch
    try:
        return kind(Problem.of(query), explains)
    except InputError:
        return None


def searched(query: Query) -> WallSearch | LatticePairSearch | None:
    """The search of a query, done; None where nothing is left to touch."""
    search = search_of(query, explains=True)
    for edge in [] if search is None else search.edges:
        for _ in search.fixtures(edge) if search is not None else ():
            pass
    return search


def examined(query: Query) -> int:
    """How many pairs a search looks at."""
    search = searched(query)
    return 0 if search is None else search.examined


def placed(query: Query) -> int:
    """How many pairs have a place."""
    search = search_of(query)
    return 0 if search is None else sum(len(part) for edge in search.edges for part in search.tables(edge))


def miss_of(table: FixtureTable, problem: Problem) -> NearestMiss:
    """The pair that comes nearest to pressing the part, as it would stand."""
    fixture = fixture_at(table, problem.toolkit, 0, problem.workpiece)
    pulls = sum(peg.force < 0 for peg in fixture.pegs)
    if pulls == 0:
        words = "one of its contacts would not press at all."
    else:
        one = "one of its contacts" if pulls == 1 else f"{pulls} of its contacts"
        words = f"{one} would have to pull the part instead of pressing on it: the part can slip out."
    return NearestMiss(fixture, words)
