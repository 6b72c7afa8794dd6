"""Results for the user: of an engine's records, of fixtures found a few at a time, and joined from several
directions.

Where fixtures are found a few at a time, those found so far, or the best of them, are measured, counted and
ranked. For a toolkit with several directions, the results of all directions are joined.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import numpy as np
from attrs import define, evolve, field, frozen
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.listing.asked import are_as_asked
from workhold.listing.canonical_form import CandidateFixtures
from workhold.listing.collector import BestFixtures, ResultCollector
from workhold.listing.identity import FixtureIdentity, SetCounter, order_by_identity
from workhold.listing.ranking import (
    OrderKeys,
    convert_to_mm,
    find_usual_errors,
    make_table_keys,
    measure_table_as_touched,
)
from workhold.model.fixture_table import FixtureTable
from workhold.model.notes import STAGES, BestOnly, Cut, LeftUndecided, NoFixture, NoPlace, Note
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.search_report import ProofReport
from workhold.proof.deciding import SearchReport
from workhold.statics.contact_matrix import TouchableFeatures
from workhold.statics.effective_error import EffectiveErrors

__all__ = [
    "MEASURED",
    "RankedTable",
    "SearchWork",
    "make_best_result",
    "make_collected_result",
    "join_ways",
    "list_result",
    "make_result",
    "make_stage_progress",
    "sum_counts",
]

# Fractions of the work, as progress reports it, at which all is decided and all is measured.
DECIDED, MEASURED = 0.5, 0.8
# Fixtures that wait to be measured together.
WAITING = 1 << 14


@frozen
class SearchWork:
    """Statistics of a search.

    Parameters
    ----------
    complete : whether the search came to its end.
    statistics : see ``Result.statistics``.
    cells : number of ranges of orientation that were examined.
    examined : number of sets of four contacts that were examined; None for the number of records.
    """

    complete: bool
    statistics: Mapping[str, int]
    cells: int = 0
    examined: int | None = None


def make_stage_progress(progress: Progress | None, low: float, high: float) -> Progress | None:
    """Return a progress callback for one stage of the work: its
    fraction 0 to 1 is reported as ``low`` to ``high``.

    None where ``progress`` is None.
    """
    if progress is None:
        return None
    return lambda fraction, found: progress(low + (high - low) * fraction, found)


def list_result(
    problem: Problem,
    records: list[NDArray[np.float64]],
    work: SearchWork,
    *,
    progress: Progress | None = None,
    cancel: Event | None = None,
    threads: int = 1,
    is_part: bool = False,
) -> Result:
    """Decide the records that an engine found, and return the result: fixtures listed once, ranked and
    counted.

    Parameters
    ----------
    records : (N, 19) arrays of fixtures, see ``kernels.contact.record`` for their layout.
    progress : called as ``progress(fraction done, records that still may be fixtures)``.
    cancel : when set, records that need slow methods are left undecided, and the result is incomplete.
    threads : number of threads for deciding.
    is_part : whether the result is joined with others before ranking; then it lists more than the query's
        ``best``.
    """
    with ThreadPoolExecutor(max_workers=threads) as pool:
        collector = ResultCollector(problem, pool, 2 * threads, cancel, is_part=is_part)
        with collector.give_up_on_errors():
            for array in records:
                collector.take_records(array)
            result = make_collected_result(collector, work, make_stage_progress(progress, 0.0, MEASURED))
            result = add_table(result, collector, make_stage_progress(progress, MEASURED, 1.0))
    return result if is_part else evolve(result, table=result.table.take(slice(0, problem.query.best)))


def make_collected_result(
    collector: ResultCollector, work: SearchWork, progress: Progress | None = None
) -> Result:
    """Finish a collector's work and return its result, whose table is empty.

    The collector yields the fixtures afterwards.

    Parameters
    ----------
    progress : called as ``progress(fraction done, records that still may be fixtures)``.
    """
    account = collector.finish_deciding(make_stage_progress(progress, 0.0, DECIDED))
    whole = collector.measure(make_stage_progress(progress, DECIDED, 1.0))
    query = collector.problem.query
    names = [one.name for one in query.toolkit.arrangements]
    found, distinct = (
        dict(zip(names, counts.tolist(), strict=True)) for counts in (collector.found, collector.distinct)
    )
    return Result(
        query=query,
        table=FixtureTable.make_empty(query.toolkit),
        found=found,
        distinct=distinct,
        complete=work.complete and account.left == 0 and whole,
        notes=(LeftUndecided(len(account.undecided)),) if account.undecided else (),
        statistics=work.statistics,
        proof=make_proof(account, work),
        least_effective_error=convert_to_mm(collector.least_error),
    )


def add_table(result: Result, collector: ResultCollector, progress: Progress | None = None) -> Result:
    """Return the result with the collector's fixtures as its table, marked
    as cut short if some are left out.
    """
    tables, listed = list(collector.iterate_tables(progress)), collector.listed_count
    # After a cancel in the meantime, millions of fixtures are not put together any more.
    enough = 1 + int(np.searchsorted(np.cumsum([len(table) for table in tables]), listed))
    table = FixtureTable.concatenate(tables[:enough]).take(slice(listed))
    result = evolve(result, table=table)
    return result if len(table) == sum(result.found.values()) else result.mark_cut_short(len(table))


def make_best_result(
    kept: BestFixtures, work: SearchWork, is_part: bool = False, is_limited: bool = False
) -> Result:
    """Return the result of a search for the best fixtures.

    With ``is_part``, it holds every fixture that may still be among the best. Where fixtures were dropped, or with
    ``is_limited``, the total is not known; then only listed fixtures are counted.
    """
    candidates, account = kept.finish()
    kept.has_dropped |= is_limited
    result = make_result(kept.problem, candidates, account, work, is_part)
    if kept.has_dropped and not is_part:
        # Only those that are listed are counted.
        result = evolve(result, table=result.table.take(slice(kept.wanted_count)))
        counted = SetCounter(FixtureIdentity(result.toolkit, result.workpiece))
        counted.add(result.table)
        result = evolve(
            result,
            found=counted.count_by_type(counted.found),
            distinct=counted.count_by_type(counted.distinct),
        )
    if not (work.complete and kept.has_dropped):
        return result
    return evolve(result, notes=(BestOnly(kept.wanted_count), *result.notes))


def make_result(
    problem: Problem,
    candidates: CandidateFixtures,
    account: SearchReport,
    work: SearchWork,
    is_part: bool = False,
) -> Result:
    """Return the result of candidates that are decided already.

    ``account`` is the report on their records, ``work`` the statistics of the search. ``is_part`` says that
    the result is to be joined with others.
    """
    with ThreadPoolExecutor(max_workers=1) as pool:
        collector = ResultCollector(problem, pool, 1, is_part=is_part)
        collector.add_candidates(candidates, account)
        return add_table(make_collected_result(collector, work), collector)


def make_proof(account: SearchReport, work: SearchWork) -> ProofReport:
    """Return the proof report, made of the report on records and the statistics of the search."""
    # A pair of chords that was given up counts as one candidate.
    examined = work.examined
    candidates = account.records if examined is None else examined + account.given_up - account.left
    kept = account.verified + len(account.undecided)
    # One candidate may hold two solutions, which then count as two.
    candidates = max(candidates, kept)
    return ProofReport(
        work.cells, candidates, candidates - kept, account.verified, account.escalated, account.undecided
    )


@define(eq=False)
class RankedTable:
    """Fixtures added in tables without repetitions; where the query asks for the best, only those are kept.

    Parameters
    ----------
    query : the query.
    problem : problem of one direction of the clamp; only data common to all directions are used.
    waiting : tables not yet measured.
    has_dropped : whether fixtures were skipped uncounted since they cannot be among the best.
    """

    query: Query
    problem: Problem
    waiting: list[FixtureTable] = field(factory=list, init=False)
    touched: TouchableFeatures = field(init=False)
    effective: EffectiveErrors | None = field(init=False)
    known: OrderKeys | None = field(default=None, init=False)
    count: SetCounter = field(init=False)
    tables: list[FixtureTable] = field(init=False)
    has_dropped: bool = field(default=False, init=False)

    def __attrs_post_init__(self) -> None:
        part, toolkit = self.query.workpiece, self.query.toolkit
        self.touched = TouchableFeatures.from_workpiece(part, toolkit, length=self.problem.wrench_length)
        self.effective = find_usual_errors(self.query)
        self.count = SetCounter(FixtureIdentity(toolkit, part, self.query.listing != "best"))
        self.tables = [FixtureTable.make_empty(toolkit)]

    def __len__(self) -> int:
        return int(self.count.found.sum()) + sum(map(len, self.waiting))

    def add(self, table: FixtureTable) -> None:
        """Add a table of fixtures, not yet measured."""
        self.waiting.append(table)
        if sum(map(len, self.waiting)) > WAITING:
            self.measure()

    def measure(self) -> None:
        """Measure and count the waiting fixtures; if only the best are asked for, keep those that may be
        among them.
        """
        if not self.waiting:
            return
        query, most, table = self.query, self.query.best, FixtureTable.concatenate(self.waiting)
        self.waiting = []
        table = measure_table_as_touched(table, query, self.touched)
        if query.is_sifted:
            table = table.take(are_as_asked(table, query))
        self.count.add(table)
        self.tables.append(table)
        if most is not None:
            together = self.concatenate()
            keys = make_table_keys(together, query, self.effective)
            chosen = keys.are_among_best(most)
            self.tables, self.known = [together.take(chosen)], keys.take(chosen)

    def make_keys(self, table: FixtureTable) -> OrderKeys:
        """Return the ranking keys of a table that is not yet measured, without adding it."""
        return make_table_keys(
            measure_table_as_touched(table, self.query, self.touched), self.query, self.effective
        )

    @property
    def keys(self) -> OrderKeys:
        """Ranking keys of the fixtures kept; those that wait are measured first."""
        self.measure()
        if self.known is None:
            return make_table_keys(self.concatenate(), self.query, self.effective)
        return self.known

    def are_beaten(self, bounds: OrderKeys, floor: int) -> NDArray[np.bool_]:
        """Return a mask (N,): True for bounds of fixtures that are surely not among the best.

        All False where all fixtures are asked for.

        Parameters
        ----------
        floor : a lower bound of the errors, in billionths of a mm, of all fixtures not yet found.
        """
        if self.query.best is None:
            return np.zeros(len(bounds), np.bool_)
        return bounds.are_beaten(self.keys, self.query.best, floor)

    def rules_out(self, bound: OrderKeys) -> bool:
        """Return whether every fixture whose keys are at least
        ``bound`` (one row) is surely not among the best.

        If so, ``has_dropped`` is set.
        """
        is_out = bool(self.are_beaten(bound, bound.lowest_error).all())
        self.has_dropped |= is_out
        return is_out

    def concatenate(self) -> FixtureTable:
        """Return the fixtures kept as one table, measured, in the order of their identities."""
        self.measure()
        everything = FixtureTable.concatenate(self.tables)
        self.tables = [everything.take(order_by_identity(everything, self.query.toolkit))]
        return self.tables[0]

    def make_result(self, account: SearchReport, work: SearchWork) -> Result:
        """Return the result of all fixtures added, best first."""
        query, table = self.query, self.concatenate()
        keys = make_table_keys(table, query, self.effective)
        order = keys.sort(keys.least_error)[: query.best]
        table, count, notes = table.take(order), self.count, list[Note]()
        if self.has_dropped:
            # Only those that are listed are counted.
            count = SetCounter(self.count.identity)
            count.add(table)
            notes.append(BestOnly(query.best or 0))
        if account.undecided:
            notes.append(LeftUndecided(len(account.undecided)))
        return Result(
            query=query,
            table=table,
            found=count.count_by_type(count.found),
            distinct=count.count_by_type(count.distinct),
            complete=work.complete,
            notes=tuple(notes),
            statistics=work.statistics,
            proof=make_proof(account, work),
            least_effective_error=convert_to_mm(keys.least_error),
        )


def join_ways(results: Sequence[Result], query: Query) -> Result:
    """Return one ranked result, joined from the results of the separate directions of a toolkit.

    ``results`` are in the order of ``Toolkit.ways``.
    """
    table = join_tables([result.table for result in results])
    # After a cancel only the best of a direction may be listed; then no more of all directions can be.
    cut = (
        []
        if query.best
        else [len(result) for result in results if 0 < len(result) < sum(result.found.values())]
    )
    most = min(cut, default=query.best)
    keys = make_table_keys(table, query, find_usual_errors(query))
    ranked = table.take(keys.sort(keys.least_error)[:most])
    proofs = [result.proof for result in results if result.proof is not None]
    found, distinct = (
        sum_counts(getattr(result, name) for result in results) for name in ("found", "distinct")
    )
    if any(isinstance(note, BestOnly) for result in results for note in result.notes):
        # Each direction dropped all but its own best, so only the best of all are known.
        counted = SetCounter(FixtureIdentity(query.toolkit, query.workpiece))
        counted.add(ranked)
        found, distinct = counted.count_by_type(counted.found), counted.count_by_type(counted.distinct)
    joined = Result(
        query=query,
        table=ranked,
        found=found,
        distinct=distinct,
        complete=all(result.complete for result in results),
        notes=tuple(join_notes(results, query)),
        statistics=sum_counts(result.statistics for result in results),
        proof=join_proofs(proofs) if len(proofs) == len(results) else None,
        least_effective_error=convert_to_mm(keys.least_error),
    )
    return joined.mark_cut_short(len(ranked)) if cut else joined


def join_notes(results: Sequence[Result], query: Query) -> Iterator[Note]:
    """Yield the notes of a joined result: those of its parts, and one on undecided candidates or no fixture.

    If the parts give several reasons for having no fixture, the reason of the latest stage is chosen.
    """
    proofs = [result.proof for result in results if result.proof is not None]
    verified, undecided = (
        sum(proof.verified for proof in proofs),
        sum(len(proof.undecided) for proof in proofs),
    )
    notes = dict.fromkeys(note for result in results for note in result.notes)
    stages = [note for note in notes if isinstance(note, NoFixture) and not note.asked]
    placeless = [note for note in notes if isinstance(note, NoPlace)]
    counted = (*stages, *placeless)
    yield from (note for note in notes if note not in counted and not isinstance(note, LeftUndecided | Cut))
    if undecided:
        yield LeftUndecided(undecided)
    elif not any(result.found[kind] for result in results for kind in result.found):
        wording = query.toolkit.wording
        if verified:
            yield NoPlace(verified, wording, any(note.with_body for note in placeless))
        elif stages:
            # The program's line that is most in the way may be another one for each way.
            last = max(reversed(stages), key=lambda note: STAGES.index(note.stage))
            yield evolve(last, wording=wording)


def join_tables(tables: Sequence[FixtureTable]) -> FixtureTable:
    """Return the tables concatenated; fixtures of table k, whose
    arrangement there is 0, get arrangement k.
    """
    numbered = [
        evolve(table, arrangement=(table.arrangement + number).astype(np.int8))
        for number, table in enumerate(tables)
    ]
    return FixtureTable.concatenate(numbered)


def sum_counts(counts: Iterable[Mapping[str, int]]) -> dict[str, int]:
    """Return the sums of counts by name."""
    total: Counter[str] = Counter()
    for one in counts:
        total.update({name: int(count) for name, count in one.items()})
    return dict(total)


def join_proofs(proofs: Sequence[ProofReport]) -> ProofReport:
    """Return the sum of several proof reports, with all undecided candidates."""
    return ProofReport(
        cells=sum(proof.cells for proof in proofs),
        candidates=sum(proof.candidates for proof in proofs),
        discarded_by_bound=sum(proof.discarded_by_bound for proof in proofs),
        verified=sum(proof.verified for proof in proofs),
        escalated=sum(proof.escalated for proof in proofs),
        undecided=tuple(item for proof in proofs for item in proof.undecided),
    )
