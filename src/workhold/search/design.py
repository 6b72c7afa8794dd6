"""Design: every fixture of a workpiece in a toolkit, or the number and the first choice in each of many.

Trying the same part in many toolkits shows which one to buy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial, reduce
from math import inf
from threading import Event
from typing import Any

import numpy as np
from attrs import evolve, frozen

from workhold.contact.problem import Problem, Progress
from workhold.errors import InputError, refuse_kind
from workhold.fixels.contacts import WALL_END
from workhold.fixels.toolkit import Toolkit
from workhold.kernels.curves.block_work import CONTACTS
from workhold.limits import check_count, choose_thread_count
from workhold.listing.collector import BestFixtures, ResultCollector
from workhold.listing.ranking import OrderKeys, make_figure_keys
from workhold.listing.results import (
    MEASURED,
    SearchWork,
    join_ways,
    list_result,
    make_best_result,
    make_collected_result,
    make_stage_progress,
)
from workhold.model.first_choice import list_ranking_figures
from workhold.model.fixture import Fixture
from workhold.model.jaw_hold import JawHold
from workhold.model.notes import STAGES, NoFixture, NoPlace, Note, round_to_two_digits
from workhold.model.quality import FIGURES, WARNINGS, find_ranked_number, read_asked_ranking
from workhold.model.query import Query
from workhold.model.requirements import Load, Restrictions, Tolerance
from workhold.model.result import Result
from workhold.model.straps import StrappedHold
from workhold.model.workpiece import Workpiece
from workhold.search.broken_rules import find_program_line_in_the_way
from workhold.search.cells import run_blocks
from workhold.search.error_limits import (
    ErrorLimit,
    LocatorSpots,
    bound_location_errors,
    can_limit_errors,
    choose_first_limit,
    choose_next_limit,
    is_enough,
)
from workhold.search.estimate import estimate_fixtures
from workhold.search.lattice_shares import (
    LatticeShares,
    count_ways,
    list_search_blocks,
    make_problems,
    make_searches,
)
from workhold.search.seated import ResultSink, answer_with_seating
from workhold.search.shares import (
    LIMITED_FROM,
    OF_TWO,
    Preview,
    Previews,
    answer_by_shares,
    has_body_to_pass,
    make_one_clamp_query,
    search_best_first,
    search_within_error,
    summarize_work,
)
from workhold.search.toolkit_search import (
    ANY_ERROR,
    ToolkitSearch,
    count_problem_contacts,
    is_round,
    list_lattice_steps,
)
from workhold.statics.judging import are_unfit

__all__ = ["ToolkitOutcome", "ResultSink", "answer", "design", "explore", "choose_first_toolkit"]

# The share of the work, as progress reports it, that goes into finding records. The rest decides which of
# them are fixtures.
SEARCH = 0.9


def design(
    workpiece: Workpiece,
    toolkit: Toolkit,
    *,
    types: str | Sequence[str] | None = None,
    contact_margin: float = 0.0,
    restrictions: Restrictions | None = None,
    rank_by: str | Sequence[str] | None = None,
    prefer: str | None = None,
    tolerance: Tolerance | None = None,
    loads: Sequence[Load] = (),
    best: int | None = None,
    jaw_force: float | None = None,
    max_location_error: float | None = None,
    thickness: float | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    cancel: Event | None = None,
    preview: Preview | None = None,
    **further: Any,
) -> Result:
    """Return every fixture of a workpiece in a toolkit, or only the best ones; the best come first.

    Parameters
    ----------
    workpiece, toolkit, contact_margin, restrictions, tolerance, loads, best, jaw_force : see
        :class:`workhold.Query`.
    max_location_error, thickness : the same.
    types : names of the arrangements to search. Those of a vise are "I" (two pegs on each jaw) and "II"
        (three and one). None for all.
    rank_by : the query's ranking.
    prefer : instead of a ranking, the most important quality: "square", "strong", "precise" or "roomy".
    threads, progress, cancel, preview : see :func:`answer`.
    further : any other field of :class:`workhold.Query`, such as ``seating``, ``opening``, ``listing`` or
        ``program``.

    Returns
    -------
    Result
        The same as :func:`answer` returns.

    Raises
    ------
    InputError
        For invalid arguments of :class:`workhold.model.query.Query`, in the cases of :func:`answer`, and for
        a ranking given together with a preference.

    Examples
    --------
    >>> import workhold
    >>> widget = workhold.load("widget")
    >>> vise = workhold.Vise(pitch=8, columns=1, peg_radius=3)
    >>> result = workhold.design(widget, vise, rank_by="closure-margin")
    >>> result.counts
    {'I': 459, 'II': 46}
    >>> [peg.hole for peg in result[0].pegs]
    ['L-A1', 'L-A2', 'R-A1', 'R-A2']
    """
    ranking = read_asked_ranking(rank_by, prefer, loads)
    query = Query(
        workpiece,
        toolkit,
        types,
        restrictions,
        ranking,
        tolerance,
        loads,
        contact_margin=contact_margin,
        best=best,
        jaw_force=jaw_force,
        thickness=thickness,
        max_location_error=max_location_error,
        **further,
    )
    return answer(query, threads=threads, progress=progress, cancel=cancel, preview=preview)


def answer(
    query: Query,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
    cancel: Event | None = None,
    preview: Preview | None = None,
    sink: ResultSink | None = None,
) -> Result:
    """Return every fixture that a query asks for, or the best of them.

    Parameters
    ----------
    threads : how many threads share the work; None for one on each processor. The result does not depend on
        it.
    progress : called from this thread as ``progress(fraction done, fixtures found so far)``.
    cancel : when set, the search stops soon; the result is marked incomplete and has the fixtures found so
        far.
    preview : called from this thread at intervals, not in the first 0.3 s, with some fixtures found so far,
        as a result marked incomplete.
    sink : receives the fixtures in batches, so that memory never holds all of them; the returned result then
        has none.

    Returns
    -------
    Result
        Fixtures, best first (see ``listing.ranking``). Equally good fixtures are in the order of their
        holes, orientation, faces and place.

    Raises
    ------
    InputError
        For faces that do not exist, a peg too large to touch any face, restrictions that leave no face to
        touch, and an invalid number of threads.

    Examples
    --------
    >>> from workhold import Query, Vise, answer, load
    >>> query = Query(load("widget"), Vise(pitch=8, columns=1, peg_radius=3), types="II", best=3)
    >>> len(answer(query)), answer(query).query == query
    (3, True)
    """
    refuse_kind(query, Query, "the query", "give a Query, such as workhold.Query(part, toolkit)")
    workers = choose_thread_count(check_count("threads", threads))
    if query.toolkit.flat_jaws is not None:
        # Flat jaws need a solver of their own, which is imported only here.
        from workhold.search.jaw_search import find_fixtures_between_jaws

        return send_to_sink(find_fixtures_between_jaws(query, progress, cancel), sink)
    if query.toolkit.strap_set is not None:
        from workhold.search.strapped_search import find_strapped_fixtures

        return send_to_sink(find_strapped_fixtures(query, workers, progress, cancel), sink)
    if query.seating is not None:
        search = partial(answer, threads=workers, preview=preview)
        return answer_with_seating(
            query, search, threads=workers, progress=progress, cancel=cancel, sink=sink
        )
    if WALL_END in query.toolkit.contacts:
        # Searches beside walls import ball arithmetic, which no other toolkit needs beforehand.
        from workhold.search.wall_shares import WallShares

        return send_to_sink(answer_by_shares(WallShares.from_query(query, cancel), progress, cancel), sink)
    if can_limit_errors(query) and is_large(query, workers, cancel):
        result = find_best_fixtures(query, workers, progress, cancel, preview)
        if result is not None:
            return send_to_sink(result, sink)
    if query.toolkit.travel_count > 1:
        with LatticeShares.open_for_query(query, workers, cancel) as shares:
            return send_to_sink(answer_by_shares(shares, progress, cancel, preview), sink)
    ways = query.toolkit.ways
    if len(ways) == 1:
        return answer_one_direction(query, workers, progress, cancel, preview, sink)
    results = []
    for number, way in enumerate(ways):
        share = make_stage_progress(progress, number / len(ways), (number + 1) / len(ways))
        part = evolve(query, toolkit=way)
        results.append(answer_one_direction(part, workers, share, cancel, preview, is_part=True))
    return send_to_sink(join_ways(results, query), sink)


def is_large(query: Query, threads: int, cancel: Event | None) -> bool:
    """Return whether a query is so large that it is faster to search first within a limit of the location
    error.

    Always False where one of the query's arrangements has fewer than three standing pegs.
    """
    if any(one.pegs[0] < 3 for one in query.toolkit.arrangements if one.name in query.types):
        # With two standing pegs there is no bound of the error from the features they touch.
        return False
    problem = Problem.from_query(make_one_clamp_query(query, query.toolkit.ways[0]))
    first, end = problem.standing
    steps = list_lattice_steps((problem.frame.standing,), problem.diameter).steps
    # Pairs of chords that the lattice may join. A search looks at a tenth to a thousandth of them.
    pairs = float(len(steps) * (end - first) ** 2) ** 2
    if pairs / 10.0 < LIMITED_FROM:
        return False
    if pairs / 1000.0 > LIMITED_FROM:
        return True
    if query.toolkit.travel_count > 1:
        return (
            count_ways(map(list_search_blocks, make_searches(query, threads, cancel))) > OF_TWO * LIMITED_FROM
        )
    ways = [Problem.from_query(evolve(query, toolkit=way)) for way in query.toolkit.ways]
    searches = [ToolkitSearch.from_problem(way, threads=threads, cancel=cancel) for way in ways]
    return count_ways(search.make_blocks(query.types) for search in searches) > LIMITED_FROM


def find_best_fixtures(
    query: Query, threads: int, progress: Progress | None, cancel: Event | None, preview: Preview | None
) -> Result | None:
    """Return the best fixtures, by searches up to growing limits of the location error.

    None if limits do not help; the caller must then search everything. After ``cancel``, an incomplete
    result.
    """
    is_paired = query.toolkit.travel_count > 1
    problems = (
        make_problems(query)
        if is_paired
        else [Problem.from_query(evolve(query, toolkit=way)) for way in query.toolkit.ways]
    )
    spots = [LocatorSpots.from_problem(problem) for problem in problems[: 1 if is_paired else None]]
    most, number = choose_first_limit(spots, query), 0
    search_up_to = find_paired_fixtures_within_limits if is_paired else find_fixtures_within_limits
    while most < inf:
        share, number = (
            make_stage_progress(progress, 1.0 - 0.5**number, 1.0 - 0.5 ** (number + 1)),
            number + 1,
        )
        limits = [one.make_error_limit(most) for one in spots]
        keys, finish = search_up_to(limits, problems, query, threads, share, cancel, preview)
        if is_enough(most, keys, query) or (cancel is not None and cancel.is_set()):
            return finish()
        most = choose_next_limit(most, keys, query, number)
    return None


# The ranking keys of what was found within a limit, and a function that makes the result.
FoundUpTo = tuple[OrderKeys, Callable[[], Result]]


def find_fixtures_within_limits(
    limits: Sequence[ErrorLimit],
    problems: Sequence[Problem],
    query: Query,
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    preview: Preview | None,
) -> FoundUpTo:
    """Search for the fixtures with one clamp within a limit of the location error, direction by direction.

    Return (1) the ranking keys of the fixtures found, and (2) a function that makes the result. ``limits``
    and ``problems`` have one entry for each direction of the clamp.
    """
    kepts, works = list[BestFixtures](), list[SearchWork]()
    for place, (problem, limit) in enumerate(zip(problems, limits, strict=True)):
        kept = BestFixtures(problem, cancel, is_limited=True)
        part = make_stage_progress(progress, place / len(problems), (place + 1) / len(problems))
        look = None if preview is None else Previews(problem, preview).add
        works.append(search_within_error(limit, problem, kept, threads, part, cancel, look))
        kepts.append(kept)
    keys = reduce(OrderKeys.concatenate, [kept.found_keys for kept in kepts])

    def join_results() -> Result:
        """Return the result, joined from all directions."""
        results = [
            make_best_result(kept, work, len(kepts) > 1, is_limited=True)
            for kept, work in zip(kepts, works, strict=True)
        ]
        return join_ways(results, query) if len(results) > 1 else results[0]

    return keys, join_results


def find_paired_fixtures_within_limits(
    limits: Sequence[ErrorLimit],
    problems: Sequence[Problem],
    query: Query,
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    preview: Preview | None,
) -> FoundUpTo:
    """Search for the fixtures with two clamps whose location error is within the limit ``limits[0]``.

    Return (1) the ranking keys of the fixtures found, and (2) a function that makes the result. ``problems``
    is not used; it is there for the signature of :func:`find_fixtures_within_limits`.
    """
    with LatticeShares.open_for_query(query, threads, cancel, limits[0]) as shares:
        result = answer_by_shares(shares, progress, cancel, preview)
    statistics = {**result.statistics, **limits[0].statistics}
    return shares.collector.ranked.keys, lambda: evolve(result, statistics=statistics)


def answer_one_direction(
    query: Query,
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    preview: Preview | None,
    sink: ResultSink | None = None,
    is_part: bool = False,
) -> Result:
    """Return the answer to a query in a toolkit with one moving carrier, as :func:`answer` does.

    ``is_part`` tells that the toolkit is one of several directions of the clamp. The result then lists every
    fixture that may be among the best of all directions.
    """
    problem = Problem.from_query(query)
    precision = bound_location_errors(problem) if can_limit_errors(query) else ANY_ERROR
    search = ToolkitSearch.from_problem(problem, threads=threads, cancel=cancel, precision=precision)
    kept = None if query.best is None else BestFixtures(problem, cancel)
    look = None if preview is None else Previews(problem, preview).add
    before, rest = make_stage_progress(progress, 0.0, SEARCH), make_stage_progress(progress, SEARCH, 1.0)
    if kept is not None:
        work = search_best_first(search, kept, threads, before, cancel, look)
        return send_to_sink(add_reason(make_best_result(kept, work, is_part), search, threads, cancel), sink)
    blocks = search.make_blocks(query.types)
    if sink is not None:
        with ThreadPoolExecutor(max_workers=threads) as pool:
            collector = ResultCollector(problem, pool, 2 * threads, cancel, sink.folder)
            with collector.give_up_on_errors():
                _, done = run_blocks(
                    blocks, threads, before, cancel, collector.take_records, look, search.stop, pool
                )
                result = make_collected_result(
                    collector, summarize_work(search, blocks, done), make_stage_progress(rest, 0.0, MEASURED)
                )
                result = add_reason(result, search, threads, cancel)
                listed = collector.listed_count
                if listed < sum(result.found.values()):
                    result = result.mark_cut_short(listed)
                sink.receive(
                    result, listed, collector.iterate_tables(make_stage_progress(rest, MEASURED, 1.0))
                )
        return result
    records, done = run_blocks(blocks, threads, before, cancel, look=look, stop=search.stop)
    work = summarize_work(search, blocks, done)
    result = list_result(
        problem, records, work, progress=rest, cancel=cancel, threads=threads, is_part=is_part
    )
    return send_to_sink(add_reason(result, search, threads, cancel), sink)


def send_to_sink(result: Result, sink: ResultSink | None) -> Result:
    """Give a result to the sink, if there is one, and return the same result.

    The result's table must hold all its fixtures.
    """
    if sink is not None:
        sink.receive(result, len(result), [result.table])
    return result


def add_reason(result: Result, search: ToolkitSearch, threads: int, cancel: Event | None) -> Result:
    """Return a result with the reason why it has no fixture, if it is complete, has none and gives no reason
    yet.

    Any other result is returned unchanged, and so is any result where ``cancel`` is set meanwhile.
    """
    if not result.complete or any(result.found.values()) or result.reasons:
        return result
    proven = 0 if result.proof is None else result.proof.verified
    reason = explain_no_fixture(search, int(search.totals[CONTACTS]), proven, threads, cancel)
    reason = name_requests_at_fault(reason, search.problem, threads)
    return result if cancel is not None and cancel.is_set() else evolve(result, notes=(reason,))


def explain_no_fixture(
    search: ToolkitSearch, contacts: int, proven: int, threads: int, cancel: Event | None
) -> Note:
    """Return the reason why a search found no fixture.

    ``contacts`` is the number of simultaneous contacts examined, ``proven`` the number of those proven to
    hold the part.
    """
    problem, table, wording = search.problem, search.table, search.problem.toolkit.wording
    line = find_program_line_in_the_way(problem.query)
    if is_round(problem):
        # The program is not to blame for a part that is round without it.
        alone = problem.query.program is None or is_round(Problem.from_query(problem.query.without_program))
        return NoFixture("shape", wording, None if alone else line)
    if len(table) + len(table.sliding_pairs.integers) == 0:
        return NoFixture("pair", wording, line)
    # What cannot be a fixture was left out early; whether pegs can touch at all is then asked once more.
    if contacts == 0 and count_problem_contacts(problem, threads, cancel) == 0:
        return NoFixture("set", wording, line)
    if proven:
        return NoPlace(proven, wording, has_body_to_pass(problem.query))
    return NoFixture("hold", wording, line)


def name_requests_at_fault(reason: Note, problem: Problem, threads: int) -> Note:
    """Return the reason why there is no fixture, changed to name the query's own requests if they are the
    cause.

    A reason that blames the shape of the part or the pitch is tested without these requests. If the part or
    the pitch is then no longer to blame, the requests are named. Other reasons are returned unchanged.
    """
    query, toolkit = problem.query, problem.toolkit
    if not isinstance(reason, NoFixture) or reason.stage not in STAGES[:2] or reason.line is not None:
        return reason
    if not query.asked_of_places:
        return reason
    toolkit = toolkit.without_limits(
        [limit for limit in toolkit.limits if limit.rule in query.asked_of_places]
    )
    whole = Problem.from_query(evolve(query.without_program, toolkit=toolkit, restrictions=None))
    if reason.stage == "shape":
        is_to_blame = is_round(whole)
    else:
        table = ToolkitSearch.from_problem(whole, threads=threads).table
        is_to_blame = len(table) + len(table.sliding_pairs.integers) == 0
    return reason if is_to_blame else evolve(reason, asked=query.asked_of_places)


# Tenths of a part's length are rounded down; one that is short by less than this part of itself counts.
HELD_SLACK = 1e-6


@frozen
class ToolkitOutcome:
    """The result of one toolkit for a part.

    Parameters
    ----------
    name : name of the toolkit.
    found : number of fixtures of each arrangement; empty for an impossible toolkit, and if they were not
        counted.
    figures : figures of quality of the first fixture by key; empty when there is none.
    fit : whether the first fixture is fit for a workshop.
    held : share from 0 to 1 of the part's longer side that lies between the outermost contacts of the first
        fixture; 0 when there is none.
    reason : why there is no fixture, or why the toolkit is impossible; empty otherwise.
    about : estimated number of fixtures, to two digits, where there are too many to count; else None.
    """

    name: str
    found: Mapping[str, int]
    figures: Mapping[str, float]
    reason: str = ""
    fit: bool = False
    held: float = 0.0
    about: int | None = None

    @property
    def fixtures(self) -> int:
        """Number of fixtures; an estimate where ``about`` is given."""
        return sum(self.found.values()) if self.about is None else self.about


def explore(
    queries: Iterable[tuple[str, Query | InputError]], cancel: Event | None = None
) -> Iterator[ToolkitOutcome]:
    """Yield the outcome of each query, one toolkit after the other.

    If a query is an InputError, or its search raises one, the outcome has the error's text as reason. The
    iteration ends early once ``cancel`` is set.

    Parameters
    ----------
    queries : pairs of the toolkit's name and its query; instead of a query, the error that made it
        impossible.
    cancel : when set, no further query is answered.
    """
    for name, query in queries:
        if cancel is not None and cancel.is_set():
            return
        try:
            if isinstance(query, InputError):
                raise query
            count = (
                estimate_fixtures(query, choose_thread_count(None), cancel) if query.best is None else None
            )
            # Where there are many, the first is enough.
            result = answer(query if count is None else evolve(query, best=1), cancel=cancel)
        except InputError as error:
            yield ToolkitOutcome(name, {}, {}, str(error))
            continue
        if not result.complete:
            return
        reason = "" if len(result) else " ".join(map(str, result.reasons))
        figures = dict(result[0].quality) if len(result) else {}
        fit = bool(figures) and not are_unfit(result.table.quality[:1], result.query.tolerance)[0]
        if result.holds:
            fit = is_held_fit(result.holds[0])
        held = measure_held_share(result[0], result.workpiece) if len(result) else 0.0
        known = None if count is None or not len(result) else round_to_two_digits(count)
        found = dict(result.found) if known is None else {}
        yield ToolkitOutcome(name, found, figures, reason, fit, held, known)


def is_held_fit(hold: JawHold | StrappedHold) -> bool:
    """Return whether a hold by friction is fit for a workshop.

    The hold must not be marked as unfit. Besides, flat jaws must press over the whole contact, and straps
    must hold the part.
    """
    if isinstance(hold, JawHold):
        return not hold.is_unfit and hold.full_contact
    return not hold.is_unfit and not hold.holds_nothing


def measure_held_share(fixture: Fixture, workpiece: Workpiece) -> float:
    """Return the fraction, from 0 to 1, of the part's longer side that lies between the fixture's outermost
    contacts.

    The longer side is that of the bounding box of the part as drawn.
    """
    x0, y0, x1, y1 = workpiece.bounds
    sides, back = (x1 - x0, y1 - y0), fixture.pose.inverse
    longer = int(sides[1] > sides[0])
    points = [(peg.x, peg.y) for peg in fixture.pegs]
    if isinstance(fixture.hold, JawHold):
        jaws = (fixture.hold.fixed, 0.0), (fixture.hold.moving, fixture.hold.opening)
        points = [(x, y) for patch, y in jaws for x in patch.ends]
    places = [float(back.apply(x, y)[longer]) for x, y in points]
    return min((max(places) - min(places)) / sides[longer], 1.0)


def choose_first_toolkit(
    explored: Sequence[ToolkitOutcome],
    ranking: Sequence[str],
    is_sold: Callable[[str], bool] = lambda name: True,
) -> ToolkitOutcome | None:
    """Return the outcome of the toolkit whose first fixture is the best; None when no toolkit has a fixture.

    Fixtures fit for a workshop come first, then toolkits for which ``is_sold(name)`` is true. If the ranking
    begins with the warnings, the order continues: fewer warnings, more tenths of the part's length between
    the contacts, then the other figures. With any other ranking, its figures come first, then that length.
    """
    able = [item for item in explored if item.figures]
    if not able:
        return None
    quality = np.array([[item.figures.get(figure.key, np.nan) for figure in FIGURES] for item in able])
    keys = [np.array([not item.fit for item in able]), np.array([not is_sold(item.name) for item in able])]
    held = np.array([item.held for item in able])
    known = [name for name in list_ranking_figures(ranking) if find_ranked_number(name) is not None]
    figures, warned = make_figure_keys(quality, known) if known else [], FIGURES[WARNINGS].key
    # Holds by flat jaws have figures of their own, of which the contact area counts.
    figures += [np.array([-item.figures.get("contact_area", 0.0) for item in able])]
    first = 1 if ranking[:1] == (warned,) else len(figures)
    tenths = -np.floor(10.0 * held + HELD_SLACK)
    keys += [*figures[:first], tenths, *figures[first:], -held]
    order = np.lexsort(keys[::-1])
    return able[int(order[0])]
