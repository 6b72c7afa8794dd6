"""Fixtures made of the kernels' records: decided, brought to the listed form, placed in the toolkit, listed
once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from threading import Event

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from workhold.contact.problem import Problem
from workhold.kernels.contact import record
from workhold.listing.canonical_form import Candidates, candidates_of, canonical_form, joined, listed_once
from workhold.listing.placing import placeable
from workhold.proof.deciding import Account, Course, decided

__all__ = ["BLOCK", "Batches", "blocks_of", "finish", "listed_form"]

Array = NDArray[np.float64]

# Records decided at a time; few enough that threads end together.
BLOCK = 1 << 14


def finish(records: list[Array], problem: Problem, cancel: Event | None = None) -> tuple[Candidates, Account]:
    """Decides records, brings them to the listed form and lists them once, on this thread.

    Parameters
    ----------
    records : (N, 19) arrays from the kernels.
    cancel : when set, only what needs no ball arithmetic and the like is decided.

    Returns
    -------
    (the fixtures, an account of all records)
    """
    course = Course(sum(map(len, records)), cancel=cancel)
    parts, accounts = zip(*(listed_form(block, problem, course) for block in blocks_of(records)), strict=True)
    return listed_once(joined(list(parts))), Account.together(list(accounts))


def blocks_of(records: Iterable[Array]) -> Iterator[Array]:
    """Records (N, 19) in blocks, of which there is at least one."""
    batches = Batches()
    for array in records:
        yield from batches.add(array)
    yield batches.rest()


def listed_form(records: Array, problem: Problem, course: Course) -> tuple[Candidates, Account]:
    """Records (N, 19) decided: the fixtures among them that fit the toolkit, in the form they are listed in,
    and an account of all."""
    proven, account = decided(records, problem, course)
    candidates = canonical_form(candidates_of(proven, problem), problem.frame.swapped)
    fits = placeable(candidates, problem)
    return candidates if fits.all() else candidates.take(fits), account


@define(eq=False)
class Batches:
    """Records put together and cut into blocks, for fewer steps of array arithmetic."""

    waiting: list[Array] = field(factory=lambda: [np.zeros((0, record.RECORD_LENGTH))], init=False)

    def add(self, records: Array) -> list[Array]:
        """Takes records (N, 19); the blocks that are full."""
        self.waiting.append(records)
        if sum(map(len, self.waiting)) < BLOCK:
            return []
        together = np.concatenate(self.waiting)
        self.waiting = [together[:0]]
        return [together[k : k + BLOCK] for k in range(0, len(together), BLOCK)]

    def rest(self) -> Array:
        """The records that fill no block, which may be none."""
        return np.concatenate(self.waiting)
