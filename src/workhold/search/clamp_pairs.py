"""Fixtures with two clamps: the seats of the searches of all directions, and the pairs of clamps that hold the part there.

Three locators alone fix the pose, and both clamps follow in closed form; so the contacts of three locators and one clamp
that the search of each direction proves, not asked to close, are all that pairs are made of. Orientations are worked through
range by range, so that no more than the seats of one range are in memory.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from itertools import pairwise
from math import degrees, tau
from threading import Event

import numpy as np
from attrs import evolve
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.conventions import SAME_POSE
from workhold.kernels.crossing.two_and_two import CANDIDATES
from workhold.listing.canonical_form import Candidates, candidates_of, canonical_form, joined, listed_once
from workhold.listing.finish import Batches
from workhold.listing.listed import Work, stage
from workhold.listing.paired import PairedFixtures
from workhold.listing.placing import at_angle
from workhold.listing.seats import seats_of
from workhold.listing.ways import summed
from workhold.model.notes import no_pair_note
from workhold.model.query import Query
from workhold.model.result import Result
from workhold.model.toolkit import Toolkit
from workhold.proof.deciding import Account, Course, decided
from workhold.search.cells import Block, run_blocks
from workhold.search.preview import Preview
from workhold.search.toolkit_search import LEAST_BLOCKS, ToolkitSearch

__all__ = ["answer_of_pairs"]

# Blocks of one direction's search that are worked on before seats are made of what they found, and most such ranges.
BLOCKS_TOGETHER, MOST_RANGES = 48, 256
# Of a range few cells are searched, which the threads are to share.
BLOCKS_PER_HALF_TURN = 2 * LEAST_BLOCKS
# Ranges after which what has been found so far is shown.
MOST_PREVIEWS = 8
# Radians beside a range that are searched as well, so that a seat on its edge is found whole from either side.
OVERLAP = 10 * SAME_POSE


def answer_of_pairs(
    query: Query, threads: int, progress: Progress | None, cancel: Event | None, preview: Preview | None
) -> Result:
    """The fixtures with two clamps that a query asks for, see ``search.design.answer``."""
    searches = [search_of(query, way, threads, cancel) for way in query.toolkit.ways]
    kept = PairedFixtures(query, searches[0].problem)
    whole_turn = [search.blocks(search.problem.toolkit.types, BLOCKS_PER_HALF_TURN) for search in searches]
    ranges = min(max(max(map(len, whole_turn)) // BLOCKS_TOGETHER, 1), MOST_RANGES)
    edges = np.linspace(0.0, tau, ranges + 1) - SAME_POSE
    accounts, cells, complete = list[Account](), 0, True
    with ThreadPoolExecutor(max_workers=threads) as pool:
        for number, (low, high) in enumerate(pairwise(edges.tolist())):
            share = stage(progress, number / ranges, (number + 1) / ranges)
            parts = []
            for place, search in enumerate(searches):
                one = stage(share, place / len(searches), (place + 1) / len(searches))
                blocks = whole_turn[place] if ranges == 1 else blocks_within(search, low, high)
                records, done, whole = records_of(search, blocks, pool, threads, one, cancel, len(kept))
                candidates, account = contacts_of(records, search.problem, pool, cancel)
                parts.append((candidates, search.problem, search.frame.toolkit.arrangements[0].direction or ""))
                accounts.append(account)
                cells, complete = cells + done, complete and whole
            kept.add(seats_of(parts, (low, high)))
            if preview is not None and number < MOST_PREVIEWS:
                preview(kept.so_far())
            if cancel is not None and cancel.is_set():
                complete = complete and number + 1 == ranges
                break
    account = Account.together(accounts)
    examined = int(sum(search.totals[CANDIDATES] for search in searches))
    work = Work(complete and account.left == 0, summed(search.statistics for search in searches), cells, examined)
    result = kept.result(account, work)
    if not result.complete or len(result) or result.reasons:
        return result
    return evolve(result, notes=(no_pair_note(kept.seats_looked_at, account.verified),))


def search_of(query: Query, way: Toolkit, threads: int, cancel: Event | None) -> ToolkitSearch:
    """The search of one direction, for contacts that need not close."""
    single = evolve(query, toolkit=way, arrangements=None, ranking=None, best=None, listing=None)
    return ToolkitSearch.of(Problem.of(single, pairing=True), threads=threads, cancel=cancel)


def blocks_within(search: ToolkitSearch, low: float, high: float) -> list[Block]:
    """The blocks of the orientations of a range in radians, and of some near it."""
    within = degrees(low - OVERLAP), degrees(high + OVERLAP)
    return search.blocks(search.problem.toolkit.types, BLOCKS_PER_HALF_TURN, within)


def records_of(
    search: ToolkitSearch,
    blocks: Sequence[Block],
    pool: Executor,
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    found: int,
) -> tuple[list[NDArray[np.float64]], int, bool]:
    """Records of some blocks, how many cells they are from, and whether all blocks came to their end."""
    told = None if progress is None else lambda fraction, _: progress(fraction, found)
    records, done = run_blocks(blocks, threads, told, cancel, stop=search.stop, pool=pool)
    return records, sum(block.cells for block in done), len(done) == len(blocks)


def contacts_of(
    records: Sequence[NDArray[np.float64]], problem: Problem, pool: Executor, cancel: Event | None
) -> tuple[Candidates, Account]:
    """Contacts of three locators and a clamp that are proven, each once, and what became of all records."""
    course, batches = Course(sum(map(len, records)), cancel=cancel), Batches()
    blocks = [*(block for array in records for block in batches.add(array)), batches.rest()]

    def work(block: NDArray[np.float64]) -> tuple[Candidates, Account]:
        proven, account = decided(block, problem, course)
        candidates = canonical_form(candidates_of(proven, problem), 0)
        return candidates.take(at_angle(candidates.theta, problem.restrictions.angles, problem.frame)), account

    parts, accounts = zip(*pool.map(work, blocks), strict=True)
    return listed_once(joined(list(parts))), Account.together(list(accounts))
