"""From the kernels' records to fixtures: decided, brought to the listed form, placed in the toolkit, listed once."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from threading import Event

import numpy as np
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.kernels.contact import record
from workhold.listing.canonical_form import Candidates, candidates_of, canonical_form, joined, listed_once
from workhold.listing.placing import arranged
from workhold.proof.deciding import Account, Course, decided

__all__ = ["finish"]

Array = NDArray[np.float64]

# Records decided at a time; few enough that threads end together.
BLOCK = 1 << 14
# Seconds between looks at how far the threads have come.
NAP = 0.1


def finish(
    records: list[Array],
    problem: Problem,
    progress: Progress | None = None,
    cancel: Event | None = None,
    threads: int = 1,
) -> tuple[Candidates, Account]:
    """Polish, decide, bring to the listed form and list once.

    Parameters
    ----------
    records : (N, 19) arrays from the kernels.
    progress : called from this thread as ``progress(fraction done, records that still may be fixtures)``.
    cancel : when set, only what needs no ball arithmetic and the like is decided.
    threads : how many threads share the deciding; the outcome does not depend on it.

    Returns
    -------
    (the fixtures, an account of all records)
    """
    course, swapped = Course(sum(map(len, records)), cancel=cancel), problem.frame.swapped

    def listed_form(block: Array) -> tuple[Candidates, Account]:
        proven, account = decided(block, problem, course)
        return canonical_form(candidates_of(proven, problem), swapped), account

    with ThreadPoolExecutor(max_workers=threads) as pool:
        running = [pool.submit(listed_form, block) for block in blocks_of(records)]
        waiting = set(running)
        while waiting:
            _, waiting = wait(waiting, timeout=NAP, return_when=FIRST_COMPLETED)
            if progress is not None:
                progress(course.fraction, course.kept)
    parts, accounts = zip(*(future.result() for future in running), strict=True)
    everything = joined(list(parts))
    fits = arranged(everything, problem).fits
    if not fits.all():
        everything = everything.take(fits)
    return listed_once(everything), Account.together(list(accounts))


def blocks_of(records: list[Array]) -> Iterator[Array]:
    """Arrays of records put together and cut into blocks, for fewer steps of array arithmetic; at least one, if empty."""
    waiting: list[Array] = [np.zeros((0, record.RECORD_LENGTH))]
    count = 0
    for array in records:
        waiting.append(array)
        count += len(array)
        if count >= BLOCK:
            together = np.concatenate(waiting)
            waiting, count = [together[:0]], 0
            yield from (together[k : k + BLOCK] for k in range(0, len(together), BLOCK))
    yield np.concatenate(waiting)
