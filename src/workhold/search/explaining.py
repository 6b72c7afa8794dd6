"""Why there is no fixture: how many contacts each rule removes, the nearest miss, and which changes help.

Contacts on a lattice are tested in ``search.broken_rules``, contacts beside a wall here.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from operator import attrgetter
from threading import Event, Timer
from typing import Any, NamedTuple

import numpy as np
from attrs import evolve

from workhold.contact.problem import Problem
from workhold.errors import InputError, join_words
from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Toolkit, ToolkitChange
from workhold.limits import choose_thread_count
from workhold.listing.asked import are_as_asked
from workhold.listing.ranking import measure_table
from workhold.model.fixture_table import FixtureTable, make_fixture_of_row
from workhold.model.notes import NoFixture, Note, Remark
from workhold.model.quality import WARNINGS
from workhold.model.query import Query
from workhold.model.requirements import Restrictions
from workhold.model.result import Result
from workhold.model.search_report import Explanation, HelpfulChange, NearestMiss, RuleRemoval
from workhold.model.workpiece import Workpiece
from workhold.search.broken_rules import (
    SECOND_CLAMP,
    RuleRemovals,
    count_removals,
    describe_program_rule,
    describe_stroke_rule,
    find_program_line_in_the_way,
)
from workhold.search.design import answer
from workhold.search.flush_search import FlushSearch
from workhold.search.jaw_search import RULES, JawSearch
from workhold.search.seat_search import find_seats
from workhold.search.strapped_search import select_within_error
from workhold.search.toolkit_search import is_round
from workhold.search.wall_search import WallSearch
from workhold.search.wall_shares import LatticePairSearch
from workhold.units import MILLIMETRE, Unit

__all__ = ["explain", "count_removals_beside_wall"]


def count_removals_beside_wall(query: Query, alone: bool) -> RuleRemovals:
    """Return how many pairs of contacts there are beside a wall, and how many each rule removes.

    A pair is a locator and the clamp, or two pegs of a sliding lattice. The query's toolkit has one direction
    of the clamp.

    Parameters
    ----------
    alone : whether one clamp holds the part. If False, two are needed, the rule :data:`SECOND_CLAMP` removes
        all pairs, and there is no nearest miss.
    """
    counts = list(count_left_by_rules(query, alone))
    before = first = counts[0][1]
    removals = []
    for rule, count in counts[1:]:
        after = min(count, before)
        removals.append(RuleRemoval(rule, before, after))
        before = after
    search, nearest = run_flush_search(query) if alone else None, None
    if search is not None and search.verified == 0 and search.nearest is not None:
        nearest = make_nearest_miss(search.nearest[1], search.pair_toolkit, query.workpiece)
    return RuleRemovals(first, removals, nearest)


def count_left_by_rules(query: Query, alone: bool) -> Iterator[tuple[str, int]]:
    """Yield (name of a rule, number of pairs that satisfy it and all rules before it), in the order of the
    rules.

    The first entry has an empty name and counts all pairs. ``alone`` as in
    :func:`count_removals_beside_wall`.
    """
    toolkit, asked = query.toolkit, query.restrictions
    free = toolkit.without_limits(toolkit.limits)
    others = [limit for limit in toolkit.limits if limit.bounds != "holes"]
    holes = toolkit.without_limits(others)
    bare = evolve(
        query.without_program,
        toolkit=free,
        restrictions=Restrictions(),
        contact_margin=0.0,
        max_location_error=None,
    )
    passed = {"program": query.program, "peg_height": query.peg_height}
    steps: list[tuple[bool, str, dict[str, Any]]] = [
        (True, "", {}),
        (bool(asked.avoid), "faces to avoid", {"restrictions": Restrictions(avoid=asked.avoid)}),
        (bool(asked.zones), "keep-out zones", {"restrictions": evolve(asked, angles=(), touch=())}),
        (query.program is not None, describe_program_rule(query), passed),
        (bool(asked.angles), "angles of the part", {"restrictions": evolve(asked, touch=())}),
        (bool(holes.limits), toolkit.wording.holes, {"toolkit": holes}),
        (query.contact_margin > 0.0, "contact margin", {"contact_margin": query.contact_margin}),
    ]
    for is_asked, rule, changed in steps:
        if is_asked:
            bare = evolve(bare, **changed)
            yield rule, count_examined(bare)
    if not alone:
        yield SECOND_CLAMP, 0
        return
    search = run_flush_search(bare)
    yield "closure and clamping", 0 if search is None else search.verified
    yield toolkit.wording.clear, count_placed(bare)
    for number, limit in enumerate(others, 1):
        held_in = toolkit.without_limits(others[number:])
        yield describe_stroke_rule(query, limit.rule), count_placed(evolve(bare, toolkit=held_in))
    bare = evolve(bare, toolkit=toolkit)
    if asked.touch:
        bare = change_restrictions(bare, touch=asked.touch)
        yield "faces to touch", count_placed(bare)
    if query.max_location_error is not None:
        bare = evolve(bare, max_location_error=query.max_location_error)
        yield "largest location error", count_placed(bare)


def make_search(query: Query, explains: bool = False) -> FlushSearch | None:
    """Return the search of a query beside a wall, not yet run; None where the query has no valid problem.

    ``explains`` makes the search keep the nearest miss.
    """
    kind = LatticePairSearch if query.toolkit.moving.on is None else WallSearch
    try:
        return kind(Problem.from_query(query), explains)
    except InputError:
        return None


def run_flush_search(query: Query) -> FlushSearch | None:
    """Return the search of a query beside a wall, run on all hull edges, with its nearest miss.

    None where the query has no valid problem, as when no feature is left to touch.
    """
    search = make_search(query, explains=True)
    for edge in [] if search is None else search.edges:
        for _ in search.iterate_fixtures(edge) if search is not None else ():
            pass
    return search


def count_examined(query: Query) -> int:
    """Return how many pairs of contacts the search of a query beside a wall examines."""
    search = run_flush_search(query)
    return 0 if search is None else search.examined


def count_placed(query: Query) -> int:
    """Return the number of pairs beside a wall that hold the part, have a place in the toolkit, and satisfy
    the fixture rules.

    The fixture rules are the faces to touch and the largest location error.
    """
    search = make_search(query)
    if search is None:
        return 0
    tables = (
        search.place_fixtures([part], edge) for edge in search.edges for part in search.iterate_fixtures(edge)
    )
    if not query.is_sifted:
        return sum(map(len, tables))
    return sum(int(are_as_asked(measure_table(table, search.problem), query).sum()) for table in tables)


def make_nearest_miss(table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> NearestMiss:
    """Return the first row of a table as a nearest miss, with a
    sentence that says why its contacts do not press the part.
    """
    fixture = make_fixture_of_row(table, toolkit, 0, workpiece)
    pulls = sum(peg.force < 0 for peg in fixture.pegs)
    if pulls == 0:
        words = "one of its contacts would not press at all."
    else:
        one = "one of its contacts" if pulls == 1 else f"{pulls} of its contacts"
        words = f"{one} would have to pull the part instead of pressing on it: the part can slip out."
    return NearestMiss(fixture, words)


# Largest number of faces to avoid that are tried one by one.
MOST_FACES = 8
# Seconds for the search with a change; the fixtures counted by then show that it helps.
HELP_SECONDS = 10.0


def explain(query: Query, threads: int | None = None, unit: Unit = MILLIMETRE) -> Explanation:
    """Return an explanation why there is no fixture that a query asks for.

    Parameters
    ----------
    query : a query without any fixture.
    threads : how many threads share the work; None for one on each processor.
    unit : unit of lengths in the explanation's sentences.
    """
    # The ranking makes no difference here, and may name a figure that a changed toolkit has not.
    query = evolve(query, rank_by="warnings")
    toolkit, alone = query.toolkit, query.toolkit.travel_count == 1
    ways = [move_to_toolkit(query, way) for way in toolkit.ways]
    if toolkit.strap_set is not None:
        # Loads only choose straps; seats do not depend on them.
        query = evolve(query, loads=())
        found = [count_removals_of_seats(query, threads)]
    elif toolkit.flat_jaws is not None:
        found = [count_removals_between_jaws(query)]
    elif WALL_END in toolkit.contacts:
        found = [count_removals_beside_wall(way, alone) for way in ways]
    else:
        found = [count_removals(Problem.from_query(way), threads, unit, alone) for way in ways]
    together, helped = RuleRemovals.merge(found), find_helpful_changes(query, threads, unit)
    nothing = None if together.first else explain_no_contacts(ways)
    return Explanation(together.first, together.removals, together.nearest, helped, nothing)


def count_removals_between_jaws(query: Query) -> RuleRemovals:
    """Return the number of ways in which a part can lie between flat jaws, and the number that each rule
    removes.
    """
    rules = Counter(one.rule for one in JawSearch(query).examine_all())
    first = left = sum(rules.values())
    removals = []
    for rule, words in RULES.items():
        if rules[rule]:
            removals.append(RuleRemoval(words, left, left - rules[rule]))
            left -= rules[rule]
    return RuleRemovals(first, removals, None)


def count_removals_of_seats(query: Query, threads: int | None) -> RuleRemovals:
    """Return the number of seats of three locators on a plate, and the number that each rule removes."""
    toolkit, asked = query.toolkit, query.restrictions
    bare = evolve(
        query,
        toolkit=toolkit.without_limits(toolkit.limits),
        restrictions=Restrictions(),
        contact_margin=0.0,
        max_location_error=None,
    )
    steps: list[tuple[bool, str, dict[str, Any]]] = [
        (bool(asked.avoid), "faces to avoid", {"restrictions": Restrictions(avoid=asked.avoid)}),
        (bool(asked.zones), "keep-out zones", {"restrictions": evolve(asked, angles=(), touch=())}),
        (bool(asked.angles), "angles of the part", {"restrictions": evolve(asked, touch=())}),
        (bool(toolkit.limits), toolkit.wording.holes, {"toolkit": toolkit}),
        (query.contact_margin > 0.0, "contact margin", {"contact_margin": query.contact_margin}),
        (bool(asked.touch), "faces to touch", {"restrictions": asked}),
        (
            query.max_location_error is not None,
            "largest location error",
            {"max_location_error": query.max_location_error},
        ),
    ]
    before = first = count_seats(bare, threads)
    removals = []
    for is_asked, rule, changed in steps:
        if is_asked:
            bare = evolve(bare, **changed)
            after = min(count_seats(bare, threads), before)
            removals.append(RuleRemoval(rule, before, after))
            before = after
    return RuleRemovals(first, removals, None)


def count_seats(query: Query, threads: int | None) -> int:
    """Return the number of seats of three locators that satisfy a query's rules, the largest location error
    included.

    0 if the search refuses the query, as when no face is left to touch.
    """
    try:
        return len(select_within_error(find_seats(query, choose_thread_count(threads)).table, query))
    except InputError:
        return 0


def explain_no_contacts(ways: Sequence[Query]) -> Note:
    """Return the note that says why no set of pegs can touch the part at the same time.

    ``ways`` has the query of each direction of the toolkit.
    """
    wording = ways[0].toolkit.wording
    if ways[0].toolkit.strap_set is not None:
        return NoFixture("pair", wording)
    if WALL_END not in ways[0].toolkit.contacts and all(is_round(Problem.from_query(way)) for way in ways):
        return NoFixture("shape", wording)
    return Remark(f"No {wording.four} can touch the part at the same time.")


def find_helpful_changes(query: Query, threads: int | None, unit: Unit) -> tuple[HelpfulChange, ...]:
    """Return changes of a query that lead to fixtures; the change with the most fixtures comes first.

    All are single changes. Only if no single change that drops a request helps, the smallest combination of
    such changes that was found is added.
    """
    out, lifts = [], list[QueryChange]()
    for change in list_changes(query, unit):
        result = answer_changed_query(change.change, query, threads)
        if result is not None and any(result.found.values()):
            words = change.words + describe_nearest_turn(query, result)
            found = sum(result.found.values())
            out.append(HelpfulChange(words, found, result.complete, change.fields, change.rules))
        if change.is_whole:
            lifts.append(change)
    if len(lifts) > 1 and not any(help.rules for help in out):
        out += find_changes_together(query, lifts, threads)
    return tuple(sorted(out, key=lambda help: -help.fixtures))


def answer_changed_query(
    changed: Callable[[Query], Query], query: Query, threads: int | None
) -> Result | None:
    """Return the result of a query after a change.

    The search is stopped after :data:`HELP_SECONDS`; the result is then incomplete. None where the changed
    query is invalid.
    """
    enough = Event()
    timer = Timer(HELP_SECONDS, enough.set)
    timer.start()
    try:
        asked = evolve(changed(query), rank_by="warnings", best=None)
        return answer(asked, threads=threads, cancel=enough)
    except InputError:
        return None
    finally:
        timer.cancel()


def find_changes_together(
    query: Query, lifts: Sequence[QueryChange], threads: int | None
) -> Iterator[HelpfulChange]:
    """Yield at most one change: the drop of several requests at once, as few as possible, that leads to
    fixtures.

    ``lifts`` are the changes that drop one request each. Nothing is yielded if dropping all of them gives no
    fixture.
    """

    def search_without(some: Sequence[QueryChange]) -> Result | None:
        """Return the result without the requests that ``some`` changes drop; None if it has no fixture."""

        def apply_changes(asked: Query) -> Query:
            """Return a query after all of the changes ``some``."""
            for lift in some:
                asked = lift.change(asked)
            return asked

        result = answer_changed_query(apply_changes, query, threads)
        return result if result is not None and any(result.found.values()) else None

    needed, result = list(lifts), search_without(lifts)
    for lift in lifts if result is not None else ():
        fewer = [one for one in needed if one is not lift]
        if (found := search_without(fewer)) is not None:
            needed, result = fewer, found
    if result is not None:
        words = join_words([lift.words for lift in needed])
        rules = tuple(rule for lift in needed for rule in lift.rules)
        yield HelpfulChange(words, sum(result.found.values()), result.complete, None, rules)


def describe_nearest_turn(query: Query, result: Result) -> str:
    """Return words that say by how many degrees the nearest fixture of a result is outside the allowed
    angles.

    Only fixtures with the fewest warnings are considered. Empty if the query allows all angles, or if the
    result was found with the query's angles.
    """
    if not query.restrictions.angles or result.query.restrictions.angles:
        return ""
    quality = result.table.quality
    good = quality[:, WARNINGS] == quality[:, WARNINGS].min()
    found = np.degrees(result.table.theta[good])
    # Fixtures that a half turn maps to their own arrangement fit the jaws either way round.
    swaps = bool(result.toolkit.symmetries)
    pegs = np.array([swaps and one.pegs[0] == one.pegs[-1] for one in result.toolkit.arrangements])
    found = np.concatenate([found, found[pegs[result.table.arrangement[good]]] + 180.0])
    beyond = np.full(len(found), np.inf)
    for low, high in query.restrictions.angles:
        past = (found - high) % 360.0
        beyond = np.minimum(beyond, np.minimum(past, 360.0 - (past + high - low) % 360.0))
    nearest = int(beyond.argmin())
    return f", the nearest {beyond[nearest]:.1f} degrees farther, at {found[nearest] % 360.0:.2f}"


class QueryChange(NamedTuple):
    """A change of a query to try.

    Parameters
    ----------
    words : description of the change.
    changed : returns the changed query; raises InputError where the changed query is invalid.
    fields : new values of the toolkit's fields that the change sets; None if it sets none.
    rules : names of the requests that the change drops, see ``Query.asked``.
    change : makes the same change to any query, so that changes can be combined.
    is_whole : whether the change drops its requests entirely rather than in part.
    """

    words: str
    changed: Callable[[], Query]
    fields: Mapping[str, Any] | None
    rules: tuple[str, ...]
    change: Callable[[Query], Query]
    is_whole: bool


def list_changes(query: Query, unit: Unit) -> Iterator[QueryChange]:
    """Yield the single changes of a query to try.

    First come the changes that drop one request each, then those that lift or change a limit of the toolkit.
    """
    asked, toolkit = query.restrictions, query.toolkit

    def make_change(
        words: str,
        change: Callable[[Query], Query],
        rules: tuple[str, ...],
        fields: Mapping[str, Any] | None = None,
        is_whole: bool = True,
    ) -> QueryChange:
        """Return a change of the query that drops some requests."""
        return QueryChange(words, partial(change, query), fields, rules, change, is_whole)

    if asked.avoid:
        faces = ("faces " if len(asked.avoid) > 1 else "face ") + ", ".join(map(str, asked.avoid))
        yield make_change(
            f"touching {faces} too", partial(change_restrictions, avoid=()), ("faces to avoid",)
        )
        for face in asked.avoid[: MOST_FACES if len(asked.avoid) > 1 else 0]:
            rest = tuple(number for number in asked.avoid if number != face)
            touching = partial(change_restrictions, avoid=rest)
            yield make_change(f"touching face {face} too", touching, ("faces to avoid",), is_whole=False)
    if asked.zones:
        yield make_change(
            "without the keep-out zones", partial(change_restrictions, zones=()), ("keep-out zones",)
        )
    if query.program is not None:
        line = find_program_line_in_the_way(query)
        first = "" if line is None else f", of which line {line} is most in the way"
        without = attrgetter("without_program")
        yield make_change(f"without the program{first}", without, ("tools of the program",))
    if asked.angles:
        yield make_change("at any angle", partial(change_restrictions, angles=()), ("angles of the part",))
    if query.contact_margin > 0:
        yield make_change(
            "without a contact margin", partial(evolve, contact_margin=0.0), ("contact margin",)
        )
    if asked.touch:
        yield make_change(
            "without the faces to touch", partial(change_restrictions, touch=()), ("faces to touch",)
        )
    if query.max_location_error is not None:
        imprecise = partial(evolve, max_location_error=None)
        yield make_change("with any location error", imprecise, ("largest location error",))
    if len(query.types) < len(toolkit.types):
        yield make_change("with all types", partial(evolve, types=None), ("types sought",))
    for limit in toolkit.limits:
        held, fields = partial(change_toolkit, change=limit.lifted), limit.lifted.fields
        yield make_change(limit.lifted.words, held, (limit.rule,), fields)
    for change in toolkit.list_further_changes(unit):
        yield make_change(
            change.words, partial(change_toolkit, change=change), (), change.fields, is_whole=False
        )


def change_restrictions(query: Query, **changed: Any) -> Query:
    """Return a query with some fields of its restrictions replaced, given by name."""
    return evolve(query, restrictions=evolve(query.restrictions, **changed))


def change_toolkit(query: Query, change: ToolkitChange) -> Query:
    """Return a query with some fields of its toolkit changed.

    Raises
    ------
    InputError
        When the changed toolkit is invalid.
    """
    return move_to_toolkit(query, query.toolkit.with_fields(change.fields))


def move_to_toolkit(query: Query, toolkit: Toolkit) -> Query:
    """Return a query with another toolkit of the same kind.

    Where the number of pegs differs, the query's types, ranking and listing go back to their defaults.
    """
    if toolkit.peg_count == query.toolkit.peg_count:
        return evolve(query, toolkit=toolkit)
    return evolve(query, toolkit=toolkit, types=None, rank_by=None, listing=None)
