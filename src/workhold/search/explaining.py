"""Why there is no fixture: what each rule takes away of the contacts, what is nearest, which change helps.

Of contacts on a lattice the rules are asked in ``search.broken_rules``, of contacts beside a wall here.
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
from workhold.fixels.toolkit import Change, Toolkit
from workhold.limits import choose_thread_count
from workhold.listing.asked import are_as_asked
from workhold.listing.ranking import measure_table
from workhold.model.fixture_table import FixtureTable, make_fixture_of_row
from workhold.model.notes import NoFixture, Note, Remark
from workhold.model.quality import WARNINGS
from workhold.model.query import Query
from workhold.model.requirements import Restrictions
from workhold.model.result import Result
from workhold.model.search_report import Explanation, Help, NearestMiss, Removal
from workhold.model.workpiece import Workpiece
from workhold.search.broken_rules import (
    SECOND_CLAMP,
    Removals,
    count_removals,
    describe_program_rule,
    describe_stroke_rule,
    find_program_line_in_the_way,
)
from workhold.search.design import answer
from workhold.search.flush_search import FlushSearch
from workhold.search.jaw_search import RULES, JawSearch
from workhold.search.seat_search import find_seats
from workhold.search.strapped_search import within_error
from workhold.search.toolkit_search import is_round
from workhold.search.wall_search import WallSearch
from workhold.search.wall_shares import LatticePairSearch
from workhold.units import MILLIMETRE, Unit

__all__ = ["explain", "count_removals_beside_wall"]


def count_removals_beside_wall(query: Query, alone: bool) -> Removals:
    """What the rules leave of the pairs of contacts in a toolkit of which one clamp moves.

    It says how many pairs of contacts of locator and clamp there are before any rule, what each rule takes
    away of them, and what comes nearest.

    Parameters
    ----------
    alone : whether one clamp is to hold the part; of two none comes nearest, as each pair is a clamp short.
    """
    counts = list(count_left_by_rules(query, alone))
    before = first = counts[0][1]
    removals = []
    for rule, count in counts[1:]:
        after = min(count, before)
        removals.append(Removal(rule, before, after))
        before = after
    search, nearest = searched(query) if alone else None, None
    if search is not None and search.verified == 0 and search.nearest is not None:
        nearest = miss_of(search.nearest[1], search.alone, query.workpiece)
    return Removals(first, removals, nearest)


def count_left_by_rules(query: Query, alone: bool) -> Iterator[tuple[str, int]]:
    """The rules in the order they are asked, with how many pairs are left after each; the first is no
    rule."""
    toolkit, asked = query.toolkit, query.restrictions
    free = toolkit.without(toolkit.limits)
    others = [limit for limit in toolkit.limits if limit.bounds != "holes"]
    holes = toolkit.without(others)
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
            yield rule, examined(bare)
    if not alone:
        yield SECOND_CLAMP, 0
        return
    search = searched(bare)
    yield "closure and clamping", 0 if search is None else search.verified
    yield toolkit.wording.clear, placed(bare)
    for number, limit in enumerate(others, 1):
        held_in = toolkit.without(others[number:])
        yield describe_stroke_rule(query, limit.rule), placed(evolve(bare, toolkit=held_in))
    bare = evolve(bare, toolkit=toolkit)
    if asked.touch:
        bare = restricted(bare, touch=asked.touch)
        yield "faces to touch", placed(bare)
    if query.max_location_error is not None:
        bare = evolve(bare, max_location_error=query.max_location_error)
        yield "largest location error", placed(bare)


def search_of(query: Query, explains: bool = False) -> FlushSearch | None:
    """The search of a query; None where nothing is left to touch."""
    kind = LatticePairSearch if query.toolkit.moving.on is None else WallSearch
    try:
        return kind(Problem.of(query), explains)
    except InputError:
        return None


def searched(query: Query) -> FlushSearch | None:
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
    """How many pairs have a place and are as asked of each by itself."""
    search = search_of(query)
    if search is None:
        return 0
    tables = (search.placed([part], edge) for edge in search.edges for part in search.fixtures(edge))
    if not query.is_sifted:
        return sum(map(len, tables))
    return sum(int(are_as_asked(measure_table(table, search.problem), query).sum()) for table in tables)


def miss_of(table: FixtureTable, toolkit: Toolkit, workpiece: Workpiece) -> NearestMiss:
    """The pair that comes nearest to pressing the part, as it would stand."""
    fixture = make_fixture_of_row(table, toolkit, 0, workpiece)
    pulls = sum(peg.force < 0 for peg in fixture.pegs)
    if pulls == 0:
        words = "one of its contacts would not press at all."
    else:
        one = "one of its contacts" if pulls == 1 else f"{pulls} of its contacts"
        words = f"{one} would have to pull the part instead of pressing on it: the part can slip out."
    return NearestMiss(fixture, words)


# Faces to avoid that are given back one by one.
MOST_FACES = 8
# Seconds after which a change has shown that it helps; how many fixtures there are in all is then not known.
HELP_SECONDS = 10.0


def explain(query: Query, threads: int | None = None, unit: Unit = MILLIMETRE) -> Explanation:
    """Explains why there is no fixture that a query asks for.

    Parameters
    ----------
    query : what was asked in vain.
    threads : how many threads share the work; None for one on each processor.
    unit : of the lengths in its words.
    """
    # What is to come first makes no difference, and may be a figure that a changed toolkit has not.
    query = evolve(query, rank_by="warnings")
    toolkit, alone = query.toolkit, query.toolkit.travels == 1
    ways = [held_in(query, way) for way in toolkit.ways]
    if toolkit.strap_set is not None:
        # Loads choose straps, and no seat is there or not because of them.
        query = evolve(query, loads=())
        found = [count_removals_of_seats(query, threads)]
    elif toolkit.flat_jaws is not None:
        found = [count_removals_between_jaws(query)]
    elif WALL_END in toolkit.contacts:
        found = [count_removals_beside_wall(way, alone) for way in ways]
    else:
        found = [count_removals(Problem.of(way), threads, unit, alone) for way in ways]
    together, helped = Removals.together(found), helps(query, threads, unit)
    nothing = None if together.first else no_contacts(ways)
    return Explanation(together.first, together.removals, together.nearest, helped, nothing)


def count_removals_between_jaws(query: Query) -> Removals:
    """What the rules leave of the ways in which a part can lie between flat jaws, and which rule takes how many."""
    rules = Counter(one.rule for one in JawSearch(query).examined())
    first = left = sum(rules.values())
    removals = []
    for rule, words in RULES.items():
        if rules[rule]:
            removals.append(Removal(words, left, left - rules[rule]))
            left -= rules[rule]
    return Removals(first, removals, None)


def count_removals_of_seats(query: Query, threads: int | None) -> Removals:
    """What the rules leave of the seats of three locators on a plate, and which rule takes how many."""
    toolkit, asked = query.toolkit, query.restrictions
    bare = evolve(
        query,
        toolkit=toolkit.without(toolkit.limits),
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
            removals.append(Removal(rule, before, after))
            before = after
    return Removals(first, removals, None)


def count_seats(query: Query, threads: int | None) -> int:
    """How many seats a query has; 0 where nothing is left to touch."""
    try:
        return len(within_error(find_seats(query, choose_thread_count(threads)).table, query))
    except InputError:
        return 0


def no_contacts(ways: Sequence[Query]) -> Note:
    """Why nothing touches a part at the same time in any way of a toolkit."""
    wording = ways[0].toolkit.wording
    if ways[0].toolkit.strap_set is not None:
        return NoFixture("pair", wording)
    if WALL_END not in ways[0].toolkit.contacts and all(is_round(Problem.of(way)) for way in ways):
        return NoFixture("shape", wording)
    return Remark(f"No {wording.four} can touch the part at the same time.")


def helps(query: Query, threads: int | None, unit: Unit) -> tuple[Help, ...]:
    """Single changes of what was asked for with which there are fixtures, the most first."""
    out, lifts = [], list[Lift]()
    for change in changes(query, unit):
        result = answer_of(change.change, query, threads)
        if result is not None and any(result.found.values()):
            words = change.words + describe_nearest_turn(query, result)
            found = sum(result.found.values())
            out.append(Help(words, found, result.complete, change.fields, change.rules))
        if change.is_whole:
            lifts.append(change)
    if len(lifts) > 1 and not any(help.rules for help in out):
        out += together(query, lifts, threads)
    return tuple(sorted(out, key=lambda help: -help.fixtures))


def answer_of(changed: Callable[[Query], Query], query: Query, threads: int | None) -> Result | None:
    """What a changed query finds within the time for one; None where there is no such query."""
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


def together(query: Query, lifts: Sequence[Lift], threads: int | None) -> Iterator[Help]:
    """The fewest things asked for that leave fixtures if left out together, where one alone does not."""

    def found_without(some: Sequence[Lift]) -> Result | None:
        def changed(asked: Query) -> Query:
            for lift in some:
                asked = lift.change(asked)
            return asked

        result = answer_of(changed, query, threads)
        return result if result is not None and any(result.found.values()) else None

    needed, result = list(lifts), found_without(lifts)
    for lift in lifts if result is not None else ():
        fewer = [one for one in needed if one is not lift]
        if (found := found_without(fewer)) is not None:
            needed, result = fewer, found
    if result is not None:
        words = join_words([lift.words for lift in needed])
        rules = tuple(rule for lift in needed for rule in lift.rules)
        yield Help(words, sum(result.found.values()), result.complete, None, rules)


def describe_nearest_turn(query: Query, result: Result) -> str:
    """Where angles were asked for, how far beyond them the part can be held, without warnings if that can
    be."""
    if not query.restrictions.angles or result.query.restrictions.angles:
        return ""
    quality = result.table.quality
    good = quality[:, WARNINGS] == quality[:, WARNINGS].min()
    found = np.degrees(result.table.theta[good])
    # What half a turn leaves in its arrangement lies in the jaws either way round.
    swaps = bool(result.toolkit.symmetries)
    pegs = np.array([swaps and one.pegs[0] == one.pegs[-1] for one in result.toolkit.arrangements])
    found = np.concatenate([found, found[pegs[result.table.arrangement[good]]] + 180.0])
    beyond = np.full(len(found), np.inf)
    for low, high in query.restrictions.angles:
        past = (found - high) % 360.0
        beyond = np.minimum(beyond, np.minimum(past, 360.0 - (past + high - low) % 360.0))
    nearest = int(beyond.argmin())
    return f", the nearest {beyond[nearest]:.1f} degrees farther, at {found[nearest] % 360.0:.2f}"


class Lift(NamedTuple):
    """A change of a query to try.

    Parameters
    ----------
    words : what it does.
    changed : makes the changed query, or finds that there is none such.
    fields : those of the toolkit that it changes, if it does.
    rules : what was asked for that it leaves out, see ``Query.asked``.
    change : the same for any query, so that it can be made together with others.
    is_whole : whether nothing is left of the rules.
    """

    words: str
    changed: Callable[[], Query]
    fields: Mapping[str, Any] | None
    rules: tuple[str, ...]
    change: Callable[[Query], Query]
    is_whole: bool


def changes(query: Query, unit: Unit) -> Iterator[Lift]:
    """Changes of a query to try, one at a time."""
    asked, toolkit = query.restrictions, query.toolkit

    def lift(
        words: str,
        change: Callable[[Query], Query],
        rules: tuple[str, ...],
        fields: Mapping[str, Any] | None = None,
        is_whole: bool = True,
    ) -> Lift:
        return Lift(words, partial(change, query), fields, rules, change, is_whole)

    if asked.avoid:
        faces = ("faces " if len(asked.avoid) > 1 else "face ") + ", ".join(map(str, asked.avoid))
        yield lift(f"touching {faces} too", partial(restricted, avoid=()), ("faces to avoid",))
        for face in asked.avoid[: MOST_FACES if len(asked.avoid) > 1 else 0]:
            rest = tuple(number for number in asked.avoid if number != face)
            touching = partial(restricted, avoid=rest)
            yield lift(f"touching face {face} too", touching, ("faces to avoid",), is_whole=False)
    if asked.zones:
        yield lift("without the keep-out zones", partial(restricted, zones=()), ("keep-out zones",))
    if query.program is not None:
        line = find_program_line_in_the_way(query)
        first = "" if line is None else f", of which line {line} is most in the way"
        without = attrgetter("without_program")
        yield lift(f"without the program{first}", without, ("tools of the program",))
    if asked.angles:
        yield lift("at any angle", partial(restricted, angles=()), ("angles of the part",))
    if query.contact_margin > 0:
        yield lift("without a contact margin", partial(evolve, contact_margin=0.0), ("contact margin",))
    if asked.touch:
        yield lift("without the faces to touch", partial(restricted, touch=()), ("faces to touch",))
    if query.max_location_error is not None:
        imprecise = partial(evolve, max_location_error=None)
        yield lift("with any location error", imprecise, ("largest location error",))
    if len(query.types) < len(toolkit.types):
        yield lift("with all types", partial(evolve, types=None), ("types sought",))
    for limit in toolkit.limits:
        held, fields = partial(change_toolkit, change=limit.lifted), limit.lifted.fields
        yield lift(limit.lifted.words, held, (limit.rule,), fields)
    for change in toolkit.list_further_changes(unit):
        yield lift(change.words, partial(change_toolkit, change=change), (), change.fields, is_whole=False)


def restricted(query: Query, **changed: Any) -> Query:
    """A query with some of its restrictions changed."""
    return evolve(query, restrictions=evolve(query.restrictions, **changed))


def change_toolkit(query: Query, change: Change) -> Query:
    """A query in a changed toolkit.

    Raises
    ------
    InputError
        When there is no such toolkit.
    """
    return held_in(query, query.toolkit.changed(change.fields))


def held_in(query: Query, toolkit: Toolkit) -> Query:
    """A query in another toolkit of the kind, where that has another number of clamps without what only the
    first has."""
    if toolkit.peg_count == query.toolkit.peg_count:
        return evolve(query, toolkit=toolkit)
    return evolve(query, toolkit=toolkit, types=None, rank_by=None, listing=None)
