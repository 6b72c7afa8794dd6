"""The search of a toolkit: its lattice steps, its blocks of work, and the count of simultaneous contacts.

Two pegs of one carrier are a lattice step apart. Two carriers share the direction of rows and differ by the
travel of the one that moves, along x in the frame of the search. The properties of a toolkit are data
(``fixels.toolkit``), and ``KERNELS`` has the kernels for each arrangement of pegs. The number of simultaneous
contacts measures the size of a search (paper, section 5).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from itertools import pairwise
from math import hypot, inf, pi, tau
from threading import Event

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.contact.curves import (
    ANY_TURN,
    EVERYWHERE,
    CurveTable,
    LatticeSteps,
    join_curve_tables,
    loosen_rows,
    make_curve_table,
    number_centers,
)
from workhold.contact.problem import Problem, SearchFrame
from workhold.conventions import ANGLE_HAIR, GAP_SLACK, MARGIN_SLACK, PARALLEL, WEAK_CLOSURE
from workhold.fixels.toolkit import Arrangement, Carrier, Toolkit
from workhold.kernels.base.feature import AXIS_X, AXIS_Y, HALF_EXTENT, IS_ARC, SEGMENT_LENGTH
from workhold.kernels.base.tables import (
    DIRECTION,
    HEAD,
    ORIENTATION,
    STEP_LENGTH,
    TAIL,
    Features,
    Limits,
    NearSpots,
    Precision,
)
from workhold.kernels.contact.record import RECORD_LENGTH
from workhold.kernels.curves.block_work import CONTACTS, CROSSED, PAIRS, STATISTICS, STOPPED
from workhold.kernels.curves.sliding_pairs import write_sliding_fixtures
from workhold.kernels.curves.three_and_one import write_three_and_one
from workhold.kernels.curves.two_and_two import write_two_and_two
from workhold.limits import choose_thread_count
from workhold.listing.collector import InterestLimits
from workhold.model.first_choice import FACTORS
from workhold.model.query import Query
from workhold.model.workpiece import Workpiece
from workhold.search.block_memory import BlockMemory
from workhold.search.cells import (
    FIRST_ORIENTATION,
    SearchBlock,
    count_curves_in_cells,
    divide_into_cells,
    find_curves_in_cell,
    run_blocks,
)

__all__ = ["LEAST_BLOCKS", "ToolkitSearch", "count_problem_contacts", "count_contacts", "list_lattice_steps"]

Array = NDArray[np.float64]

# The kernel of crossings for each arrangement of pegs, and how long it takes, relative to others.
KERNELS: dict[tuple[int, ...], tuple[Callable[..., int], float]] = {
    (2, 2): (write_two_and_two, 1.0),
    (3, 1): (write_three_and_one, 0.5),
}
# Sliding pairs give about this many times the records of crossings at equal cost.
SLIDING_DENSE = 25.0
# Cells of a half turn for each pitch that L of the wrenches holds, and limits of their number.
CELLS_PER_PITCH = 10.0
FEWEST_CELLS, MOST_CELLS = 96, 1024
# Neighbouring cells make a block until they hold this many pairs of curves; a half turn has at least so many
# blocks.
PAIRS_PER_BLOCK = 2e6
LEAST_BLOCKS = 8
# Sliding pairs whose orientation may be off by more radians than VAGUE are vague. Lengths that determine one
# are off by less than APART mm.
VAGUE, APART = 1e-5, 1e-8
# Factor on the error for an angle that is not a quarter turn of the drawing.
ASLANT = next(one.times for one in FACTORS if one.key == "other_angle")
# Location errors of any size are of interest.
ANY_ERROR = Precision(np.zeros(0, np.int64), np.zeros(0), np.zeros(0), np.zeros((0, 3)), 0.0, 0.0, inf, inf)


def list_lattice_steps(carriers: Sequence[Carrier], longest: float) -> LatticeSteps:
    """Return the differences between two holes of one carrier, up to
    ``longest`` mm, in both directions, shortest first.

    All carriers have the same pitch. A difference is listed if it occurs on at least one of them. These are
    left out: differences at which the pegs' bodies overlap, and those that no two unblocked holes have.
    """
    pitch_x, pitch_y = carriers[0].pitch
    most_columns = min(max(carrier.column_count for carrier in carriers) - 1, int(longest / pitch_x))
    most_rows = int(longest / pitch_y)
    if all(carrier.rows is not None for carrier in carriers):
        most_rows = min(max(carrier.rows or 0 for carrier in carriers) - 1, most_rows)
    columns, rows = np.meshgrid(
        np.arange(-most_columns, most_columns + 1), np.arange(-most_rows, most_rows + 1), indexing="ij"
    )
    steps = np.stack([columns.ravel(), rows.ravel()], axis=1).astype(np.int64)
    known = [[hypot(k * pitch_x, m * pitch_y) for m in range(most_rows + 1)] for k in range(most_columns + 1)]
    sizes = np.array(known)[tuple(np.abs(steps).T)]
    keep = (sizes > 0.0) & (sizes <= longest)
    thick = [carrier.body_radius for carrier in carriers if carrier.body_radius > carrier.peg_radius]
    if thick:
        keep &= sizes >= 2.0 * min(thick) - GAP_SLACK
    if any(carrier.blocked for carrier in carriers):
        keep &= np.any([is_between_free_holes(carrier, steps) for carrier in carriers], axis=0)
    steps, sizes = steps[keep], sizes[keep]
    order = np.lexsort((steps[:, 1], steps[:, 0], sizes))
    steps, sizes = steps[order], sizes[order]
    lengths, starts = np.unique(sizes, return_index=True)
    angles = np.arctan2(steps[:, 1] * pitch_y, steps[:, 0] * pitch_x)
    return LatticeSteps(lengths, np.append(starts, len(steps)).astype(np.int64), steps, angles)


def is_between_free_holes(carrier: Carrier, steps: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return a mask (S,): True for differences that exist between two unblocked holes of a carrier.

    ``steps`` (S, 2) has the differences in columns and rows. Where the carrier's rows are unlimited, only
    wholly blocked columns count as blocked.
    """
    rows = 1 if carrier.rows is None else carrier.rows
    free = np.ones((carrier.column_count, rows), np.bool_)
    for holes in carrier.blocked:
        if holes.row is None:
            free[holes.column] = False
        elif carrier.rows is not None:
            free[holes.column, holes.row] = False
    # Number of pairs of free holes for each difference: the autocorrelation of the mask of free holes.
    shape = 2 * carrier.column_count, 2 * rows
    pairs = np.fft.irfft2(np.abs(np.fft.rfft2(free, shape)) ** 2, shape)
    column, row = steps[:, 0], steps[:, 1] * (carrier.rows is not None)
    there = (np.abs(column) < carrier.column_count) & (np.abs(row) < rows)
    return np.asarray(there & (pairs[column % shape[0], row % shape[1]] > 0.5))


def make_curve_tables(
    problem: Problem,
    loose: Array,
    threads: int,
    cancel: Event | None,
    near: NearSpots = EVERYWHERE,
    within: Array = ANY_TURN,
) -> CurveTable:
    """Return the chord curves of a problem's features, given as rows ``loose`` (F, 10) whose ends are moved
    out a little.

    If fixed and moving pegs touch the same features, both carriers share curves; else each has its own.
    ``within`` limits the curves to ranges of psi in radians, ``near`` to some spots of the locators.
    """
    share = partial(make_curve_table, threads=threads, cancel=cancel, near=near, within=within)
    longest, (standing, moving) = problem.diameter + 1e-6, problem.frame.carriers
    if all(arrangement.pegs[-1] == 1 for arrangement in problem.toolkit.arrangements):
        # No two pegs move.
        moving = evolve(moving, columns=1, rows=1, blocked=())
    if problem.standing == problem.moving:
        return share(loose, list_lattice_steps((standing, moving), longest))
    (first, end), (begin, last) = problem.standing, problem.moving
    one, other = (
        share(rows, list_lattice_steps([carrier], longest))
        for rows, carrier in zip((loose[first:end], loose[begin:last]), (standing, moving), strict=True)
    )
    return join_curve_tables(one, other, begin)


def may_lie_at(
    edges: Array, angles: Collection[Sequence[float]], half_turns: int, turned: float = 0.0
) -> NDArray[np.bool_]:
    """Return a mask (K,): True for cells of orientation that hold an angle of the part in one of some ranges.

    ``edges`` (K + 1,) are the edges of the cells, psi in radians; ``angles`` are ranges in degrees; without
    ranges all cells are True. The part's angle is -psi plus ``turned``, the degrees by which the toolkit's
    frame is turned against that of the search. With ``half_turns`` 1, psi and psi + pi count as equal.
    """
    wanted = np.full(len(edges) - 1, not angles)
    low, turn = turned - np.degrees(edges[1:]), 180.0 * half_turns
    width = float(np.degrees(edges[1] - edges[0]))
    for least, most in angles:
        wanted |= (least - ANGLE_HAIR - low) % turn <= width
        wanted |= (low - least + ANGLE_HAIR) % turn <= most - least + 2 * ANGLE_HAIR
    return wanted


def count_half_turn_cells(problem: Problem) -> int:
    """Return the number of cells that a half turn of orientations is divided into.

    Within a cell, the curves move across the lattice by only a part of a pitch, so that most pairs of pieces
    cannot cross.
    """
    most = CELLS_PER_PITCH * problem.wrench_length / problem.frame.lattice.pitch_y
    return int(min(max(most, FEWEST_CELLS), MOST_CELLS))


def iterate_cell_runs(wanted: NDArray[np.bool_], together: int) -> Iterator[tuple[int, int]]:
    """Yield (first index, index past the last) of runs of adjacent True entries of ``wanted``.

    No run is longer than ``together``.
    """
    first = 0
    while first < len(wanted):
        if not wanted[first]:
            first += 1
            continue
        last = first
        while last < len(wanted) and wanted[last] and last - first < together:
            last += 1
        yield first, last
        first = last


def limit_precision(precision: Precision, most: float) -> Precision:
    """Return the bounds with ``most`` mm as the largest effective location error to be searched."""
    return precision._replace(most=most, most_aslant=most / ASLANT)


def sample_numbers(numbers: NDArray[np.int64], many: int) -> NDArray[np.bool_]:
    """Return a mask (N,): True for the numbers that a fixed hash chooses, about one in ``many``."""
    mixed = numbers.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    return np.asarray((mixed >> np.uint64(33)) % np.uint64(many) == 0)


def is_round(problem: Problem) -> bool:
    """Return whether all features that pegs can touch are arcs about one common centre."""
    arcs = problem.rows[:, IS_ARC] != 0.0
    return bool(arcs.all()) and len(set(number_centers(problem.rows).tolist())) == 1


@define(eq=False)
class ToolkitSearch:
    """The kernels' input for one problem, and the blocks of work made from it.

    Parameters
    ----------
    problem : the problem that is searched.
    loose : (F, 10) kernel rows of F features, with their ends moved out a little.
    table : chord curves and sliding pairs between the loose features.
    precision : bounds of the location error, with the largest one that is searched.
    near : spots of features that locators may touch together.
    counting : whether to count all simultaneous contacts instead of looking for fixtures only.
    most_listed : number of contacts that each block lists regardless of the rules, when counting.
    every : only one in ``every`` chord curves is used, for an estimate.
    stats : (5,) statistics for each block; blocks do not share them, as they run in different threads.
    """

    problem: Problem
    loose: Array
    table: CurveTable
    precision: Precision = ANY_ERROR
    near: NearSpots = EVERYWHERE
    counting: bool = False
    most_listed: int = 0
    every: int = 1
    stats: list[NDArray[np.int64]] = field(factory=list, init=False)
    memory: BlockMemory = field(factory=BlockMemory, init=False)

    @classmethod
    def from_problem(
        cls,
        problem: Problem,
        counting: bool = False,
        most_listed: int = 0,
        threads: int = 1,
        cancel: Event | None = None,
        near: NearSpots = EVERYWHERE,
        precision: Precision = ANY_ERROR,
        only: Collection[tuple[float, float]] = (),
    ) -> ToolkitSearch:
        """Return the search of a problem with its chord curves; only some of these once ``cancel`` is set.

        ``counting`` sets the contact margin to 0. Contacts that ``near`` and ``precision`` rule out get no
        curves. ``only`` are ranges of the part's angle in degrees to make curves for; empty for all. With
        ``only``, call :meth:`make_blocks` with the same ranges as ``first``.
        """
        if counting:
            problem = Problem.from_query(evolve(problem.query, contact_margin=0.0), problem.pairing)
        loose = loosen_rows(problem.rows[:, :SEGMENT_LENGTH])
        within = ANY_TURN
        if only:
            edges = divide_into_cells(2, 2 * count_half_turn_cells(problem))
            chosen = may_lie_at(edges, only, 2, 90.0 * problem.frame.quarters)
            within = np.stack([edges[:-1], edges[1:]], axis=1)[chosen]
        table = make_curve_tables(problem, loose, threads, cancel, near, within)
        return cls(problem, loose, table, precision, near, counting, most_listed)

    @property
    def frame(self) -> SearchFrame:
        """The toolkit in the frame of the search."""
        return self.problem.frame

    @property
    def features(self) -> Features:
        """The features in the form that kernels take."""
        problem = self.problem
        return Features(self.loose, problem.rows, problem.standing, problem.moving, self.precision, self.near)

    @property
    def totals(self) -> NDArray[np.int64]:
        """Statistics (5,) summed over all blocks."""
        return np.asarray(np.array(self.stats, np.int64).reshape(-1, STATISTICS).sum(axis=0))

    @property
    def statistics(self) -> dict[str, int]:
        """Counts by name that show how much work the search was, see ``Result.statistics``."""
        totals = self.totals
        return {
            "features": len(self.problem.rows),
            "chord_curves": len(self.table),
            "sliding_pairs": len(self.table.sliding_pairs.integers),
            "curve_pairs": int(totals[PAIRS]),
            "crossings_sought": int(totals[CROSSED]),
            "contacts_examined": int(totals[CONTACTS]),
        }

    @property
    def mean_curve_count(self) -> float:
        """Average number of chord curves that exist at an orientation."""
        first, last = self.table.spans
        return float((last - first).sum()) / tau

    def make_blocks(
        self,
        types: Collection[str],
        least: int = LEAST_BLOCKS,
        within: Collection[tuple[float, float]] = (),
        first: Collection[tuple[float, float]] = (),
        rest: bool = False,
    ) -> list[SearchBlock]:
        """Return blocks of work that together find all fixtures of the arrangements named in ``types``.

        Parameters
        ----------
        least : about the smallest number of blocks in a half turn.
        within : ranges of the part's angle in degrees. The blocks find all fixtures at these angles, and some
            at other angles. Empty for all angles.
        first : ranges of the part's angle in degrees that are searched before all others. Empty for no split.
        rest : False for the blocks that find the fixtures at the angles of ``first``, True for those that
            find all others.
        """
        # All lines of action pass a round part's centre, so nothing keeps it from turning.
        is_idle = not self.counting and is_round(self.problem)
        cells = count_half_turn_cells(self.problem)
        most = max(cells // least, 1)
        together = int(min(max(PAIRS_PER_BLOCK / max(self.mean_curve_count, 1.0) ** 2, 1.0), most))
        blocks: list[SearchBlock] = []
        frame = self.frame
        for arrangement in frame.toolkit.arrangements:
            if arrangement.name not in types:
                continue
            half_turns = 1 if arrangement.pegs[0] == frame.swapped_peg_count else 2
            edges = divide_into_cells(half_turns, half_turns * cells)
            wanted = may_lie_at(edges, self.problem.restrictions.angles, half_turns, 90.0 * frame.quarters)
            if within:
                wanted &= may_lie_at(edges, within, half_turns, 90.0 * frame.quarters)
            if is_idle:
                blocks.append(
                    SearchBlock(lambda needed: np.zeros((0, RECORD_LENGTH)), 1.0, int(wanted.sum()))
                )
                continue
            sliding_pairs, crossing = self.sort_sliding_pairs_into_cells(half_turns, edges), wanted
            if first:
                is_first = may_lie_at(edges, first, half_turns, 90.0 * frame.quarters)
                crossing, vague = wanted & (is_first != rest), self.vague_sliding_pairs
                sliding_pairs = [
                    pairs[(vague[pairs] | here) != rest]
                    for pairs, here in zip(sliding_pairs, is_first, strict=True)
                ]
            ranges = np.array(list(iterate_cell_runs(crossing, together)), np.int64).reshape(-1, 2)
            counts = count_curves_in_cells(self.table, edges[ranges[:, 0]], edges[ranges[:, 1]])
            for (begin, end), count in zip(ranges.tolist(), counts.tolist(), strict=True):
                blocks.append(self.make_crossing_block(arrangement, edges[begin : end + 1], count))
            for begin, end in iterate_cell_runs(wanted, together):
                some = [cell for cell in range(begin, end) if len(sliding_pairs[cell])]
                if some:
                    blocks.append(self.make_sliding_pair_block(arrangement, edges, some, sliding_pairs))
        return blocks

    @property
    def vague_sliding_pairs(self) -> NDArray[np.bool_]:
        """Mask (P,) of the sliding pairs whose orientation is known too roughly.

        See ``sliding_pairs.bound_orientation_error``.
        """
        whole, reals = self.table.sliding_pairs
        tail, head = self.loose[whole[:, TAIL]], self.loose[whole[:, HEAD]]
        direction, d = reals[:, DIRECTION], reals[:, STEP_LENGTH]
        along = np.abs(np.cos(direction) * tail[:, AXIS_X] + np.sin(direction) * tail[:, AXIS_Y])
        along[tail[:, IS_ARC] != 0.0] = 1.0
        off = APART + PARALLEL * (tail[:, HALF_EXTENT] + head[:, HALF_EXTENT] + d)
        return np.asarray(off > VAGUE * d * along)

    def sort_sliding_pairs_into_cells(self, half_turns: int, edges: Array) -> list[NDArray[np.int64]]:
        """Return, for each cell of orientation, the indices of the
        sliding pairs whose orientation lies in it.

        Orientations in the search's table are reduced to one turn in place. Sliding pairs outside all cells
        are left out.
        """
        reals = self.table.sliding_pairs.reals
        psi = reals[:, ORIENTATION]
        psi = FIRST_ORIENTATION + (psi - FIRST_ORIENTATION) % tau
        reals[:, ORIENTATION] = psi
        cells = np.searchsorted(edges, psi, side="right") - 1
        cells[psi >= FIRST_ORIENTATION + half_turns * pi] = -1
        order = np.argsort(cells, kind="stable")
        starts = np.searchsorted(cells[order], np.arange(len(edges)))
        return [order[first:last] for first, last in pairwise(starts)]

    def make_crossing_block(self, arrangement: Arrangement, edges: Array, members: int) -> SearchBlock:
        """Return the block that searches adjacent cells of orientation for crossings of curves.

        ``edges`` are the limits of the cells. ``members`` is the approximate number of curves there; the block's
        cost follows from it.
        """
        kernel, weight = KERNELS[arrangement.pegs]
        work = partial(
            self.run_kernel,
            partial(kernel, edges),
            float(edges[0]),
            float(edges[-1]),
            self.add_statistics_row(),
        )
        return SearchBlock(work, 1.0 + weight * members**2, len(edges) - 1, float(edges[0]))

    def make_sliding_pair_block(
        self, arrangement: Arrangement, edges: Array, cells: list[int], sliding_pairs: list[NDArray[np.int64]]
    ) -> SearchBlock:
        """Return the block that searches the sliding pairs of some cells, given by index.

        ``edges`` and ``sliding_pairs`` are those of all cells.
        """
        standing, stats = arrangement.pegs[0], self.add_statistics_row()
        parts = [
            partial(
                self.run_kernel,
                partial(write_sliding_fixtures, standing, sliding_pairs[cell], self.table.sliding_pairs),
                float(edges[cell]),
                float(edges[cell + 1]),
                stats,
            )
            for cell in cells
        ]
        members = count_curves_in_cells(self.table, edges[cells], edges[np.add(cells, 1)])
        cost = float(members @ np.array([len(sliding_pairs[cell]) for cell in cells]))
        return SearchBlock(
            lambda needed: np.concatenate([part(needed) for part in parts]),
            len(cells) + cost,
            len(cells),
            float(edges[cells[0]]),
            SLIDING_DENSE,
        )

    def add_statistics_row(self) -> NDArray[np.int64]:
        """Append a row (5,) of zeros to ``stats`` for a kernel to add to, and return it."""
        self.stats.append(np.zeros(STATISTICS, np.int64))
        return self.stats[-1]

    def stop(self) -> None:
        """Make running kernels in other threads return soon with what they have found."""
        for counts in self.stats:
            counts[STOPPED] = 1

    def run_kernel(
        self,
        kernel: Callable[..., int],
        low: float,
        high: float,
        stats: NDArray[np.int64],
        needed: InterestLimits,
    ) -> Array:
        """Run a kernel on the curves between two orientations psi in radians; return its records (N, 19).

        ``needed`` are the limits that fixtures must keep to be of interest, ``stats`` the row that the kernel
        adds to.
        """
        most = min(self.precision.most, needed.error)
        features = self.features
        if most < self.precision.most and len(self.precision.probes):
            features = features._replace(precision=limit_precision(features.precision, most))
        limits = self.make_limits(needed.margin, features.precision.most)
        members = find_curves_in_cell(self.table, low, high)
        if self.every > 1:
            members = members[sample_numbers(members, self.every)]
        curves, lattice = self.table.curves, self.frame.lattice
        return self.memory.run_kernel(
            kernel, members, stats, features, curves, lattice, limits, self.counting
        )

    def make_limits(self, margin: float, most: float) -> Limits:
        """Return the kernels' limits for a least closure margin, and a
        largest effective error ``most`` in mm.

        With a finite error the margin is at least that of a weak closure, because fixtures with a warning are
        then of no interest.
        """
        if most < inf:
            margin = max(margin, WEAK_CLOSURE - MARGIN_SLACK)
        return self.problem.limits._replace(least_margin=margin, most_listed=float(self.most_listed))


def count_contacts(workpiece: Workpiece, toolkit: Toolkit, *, threads: int | None = None) -> int:
    """Return the number of sets of four pegs that touch a workpiece at the same time, each contact inside its
    feature.

    Gap, closure and clamping are not tested. Two kinds of sets count only if their members can be
    distinguished: sets with a chord between parallel faces, and sets whose moving pegs touch faces square to
    the motion.

    Parameters
    ----------
    workpiece, toolkit : the part, and the toolkit that holds it.
    threads : number of threads; None for one on each processor.

    Raises
    ------
    InputError
        For a peg too large to touch any face of the part.
    """
    return count_problem_contacts(Problem.from_query(Query(workpiece, toolkit)), threads)


def count_problem_contacts(problem: Problem, threads: int | None, cancel: Event | None = None) -> int:
    """Return the number of simultaneous contacts of a problem, see
    :func:`count_contacts`; fewer once cancelled.
    """
    workers = choose_thread_count(threads)
    search = ToolkitSearch.from_problem(problem, counting=True, threads=workers, cancel=cancel)
    run_blocks(search.make_blocks(problem.query.types), workers, None, cancel, stop=search.stop)
    return int(search.totals[CONTACTS])
