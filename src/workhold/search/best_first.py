"""The search for the best fixtures: those that lie square before all others, where that may end it.

Where tilt counts, a bound of all tilted fixtures is known beforehand (``listing.tilted_bound``). Let as many
square ones be kept as are asked for. If the last of them ranks before the bound, no other orientation is
searched.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from threading import Event

import numpy as np
from numpy.typing import NDArray

from workhold.contact.problem import Problem, Progress
from workhold.kernels.curves.block_work import CANDIDATES
from workhold.listing.collector import BestFixtures
from workhold.listing.results import Work, stage
from workhold.listing.tilted_bound import square_angles, tilted_keys
from workhold.model.query import Query
from workhold.search.cells import Block, cost_of, run_blocks
from workhold.search.toolkit_search import LEAST_BLOCKS, ToolkitSearch

__all__ = ["best_first", "tilted_bound", "work_of"]

Array = NDArray[np.float64]

# Searches that cost more begin with what lies square, see ``cells.Block``: those of a tenth of a second.
SQUARE_FIRST = 1e6


def best_first(
    search: ToolkitSearch,
    kept: BestFixtures,
    threads: int,
    progress: Progress | None,
    cancel: Event | None,
    look: Callable[[Array], None] | None,
) -> Work:
    """Hands what may be among the best to those kept, see ``search.design.answer``."""
    query, problem = search.problem.query, search.problem
    # Smaller blocks learn earlier what margin is to be reached.
    blocks_in = partial(search.blocks, query.arrangements, 4 * LEAST_BLOCKS)
    parts = [blocks_in()]
    total = cost_of(parts[0])
    bound = tilted_bound(query, problem, total)
    if bound is not None:
        parts = [blocks_in(first=square_angles(query), rest=rest) for rest in (False, True)]
    begun, done = list[Block](), list[Block]()
    for part in parts:
        if begun and bound is not None and kept.rules_out(bound):
            break
        before, begun = cost_of(begun) / total if begun else 0.0, begun + part
        share = stage(progress, before, 1.0 if part is parts[-1] else cost_of(begun) / total)
        done += run_blocks(part, threads, share, cancel, kept.add, look, search.stop)[1]
    return work_of(search, begun, done)


def tilted_bound(query: Query, problem: Problem, cost: float) -> Array | None:
    """Keys (R,) that no tilted fixture ranks before, where a search of a cost begins with square ones.

    None where it does not.
    """
    return tilted_keys(query, problem) if query.best is not None and cost > SQUARE_FIRST else None


def work_of(search: ToolkitSearch, blocks: Sequence[Block], done: Sequence[Block]) -> Work:
    """How a search went."""
    return Work(
        complete=len(done) == len(blocks),
        statistics=search.statistics,
        cells=sum(block.cells for block in done),
        examined=int(search.totals[CANDIDATES]),
    )
