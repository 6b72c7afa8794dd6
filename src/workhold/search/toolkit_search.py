"""The search of the fixture vise: its lattice steps and its blocks of work.

Two pegs of one jaw are a lattice step apart; the two jaws share the direction of rows and differ by the sliding of the
right jaw along x. Another toolkit would bring its own module in place of this one and of ``kernels.contact.rules``,
``kernels.crossing.two_and_two`` and ``kernels.crossing.three_and_one``; features, chord curves, crossings and closure
are common to all.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import partial
from itertools import pairwise
from math import hypot, pi, tau

import numpy as np
from attrs import define, evolve, field
from numpy.typing import NDArray

from workhold.contact.curves import CurveTable, LatticeSteps, curve_table, loosened
from workhold.contact.problem import Problem
from workhold.conventions import ANGLE_HAIR
from workhold.kernels.contact.rules import GAP_SLACK, LEAST_MARGIN
from workhold.kernels.crossing.sliding_pairs import ORIENTATION, sliding_three_and_one, sliding_two_and_two
from workhold.kernels.crossing.three_and_one import three_and_one_cells
from workhold.kernels.crossing.two_and_two import STATISTICS, two_and_two_cells
from workhold.kernels.curves.columns import FROM, TO
from workhold.model.vise import Vise
from workhold.search.cells import FIRST_ORIENTATION, Block, cell_edges, members_of_cell

__all__ = ["LEAST_BLOCKS", "ViseSearch", "lattice_steps"]

Array = NDArray[np.float64]

# Cells of a half turn: so many for each pitch that L of the wrenches holds, within limits.
CELLS_PER_PITCH = 10.0
FEWEST_CELLS, MOST_CELLS = 96, 1024
# Cells are worked on together until they hold so many pairs of curves, but in no fewer blocks than this for a half turn.
PAIRS_PER_BLOCK = 2e6
LEAST_BLOCKS = 16


def lattice_steps(vise: Vise, longest: float) -> LatticeSteps:
    """Differences between two holes of one jaw, up to a length in mm, both directions of each.

    Left out are those between pegs whose bodies would overlap, and those that two holes free of blocks never have.
    """
    pitch_x, pitch_y = vise.pitch
    most_rows = int(longest / pitch_y) if vise.rows is None else min(vise.rows - 1, int(longest / pitch_y))
    columns, rows = np.meshgrid(
        np.arange(-(vise.columns - 1), vise.columns), np.arange(-most_rows, most_rows + 1), indexing="ij"
    )
    steps = np.stack([columns.ravel(), rows.ravel()], axis=1).astype(np.int64)
    sizes = np.array([hypot(k * pitch_x, m * pitch_y) for k, m in np.abs(steps)])
    keep = (sizes > 0.0) & (sizes <= longest)
    if vise.body_radius > vise.peg_radius:
        keep &= sizes >= 2.0 * vise.body_radius - GAP_SLACK
    if vise.blocked:
        keep &= is_between_free_holes(vise, steps)
    steps, sizes = steps[keep], sizes[keep]
    order = np.lexsort((steps[:, 1], steps[:, 0], sizes))
    steps, sizes = steps[order], sizes[order]
    lengths, starts = np.unique(sizes, return_index=True)
    angles = np.arctan2(steps[:, 1] * pitch_y, steps[:, 0] * pitch_x)
    return LatticeSteps(lengths, np.append(starts, len(steps)).astype(np.int64), steps, angles)


def is_between_free_holes(vise: Vise, steps: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which differences (S, 2) of columns and rows two free holes of either jaw have, one way or the other.

    Both jaws count for both directions, because the half turn swaps them. Where rows have no end, only whole blocked
    columns are looked at: any pattern can be shifted up past a blocked hole.
    """
    rows = 1 if vise.rows is None else vise.rows
    possible = np.zeros((2 * vise.columns - 1, 2 * rows - 1), np.bool_)
    for jaw in ("left", "right"):
        free = np.ones((vise.columns, rows), np.bool_)
        for holes in vise.blocked:
            if holes.jaw != jaw:
                continue
            if holes.row is None:
                free[holes.column] = False
            elif vise.rows is not None:
                free[holes.column, holes.row] = False
        places = np.argwhere(free)
        for place in places:
            apart = places - place + (vise.columns - 1, rows - 1)
            possible[apart[:, 0], apart[:, 1]] = True
    row_places = steps[:, 1] + rows - 1 if vise.rows is not None else np.zeros(len(steps), np.int64)
    return np.asarray(possible[steps[:, 0] + vise.columns - 1, row_places])


def may_lie_at(edges: Array, angles: Collection[tuple[float, float]], half_turns: int) -> NDArray[np.bool_]:
    """Which cells (K,) between edges (K + 1,) of psi hold orientations of the part in one of some ranges in degrees.

    The part's angle is -psi; over one half turn of cells an angle stands for its opposite as well.
    """
    wanted = np.full(len(edges) - 1, not angles)
    low, turn = -np.degrees(edges[1:]), 180.0 * half_turns
    width = float(np.degrees(edges[1] - edges[0]))
    for least, most in angles:
        wanted |= (least - ANGLE_HAIR - low) % turn <= width
        wanted |= (low - least + ANGLE_HAIR) % turn <= most - least + 2 * ANGLE_HAIR
    return wanted


def neighbours(wanted: NDArray[np.bool_], together: int) -> Iterator[tuple[int, int]]:
    """First and past-the-last numbers of runs of wanted cells, none longer than ``together``."""
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


@define(eq=False)
class ViseSearch:
    """Everything the vise's kernels need, and the blocks of work made of it.

    Parameters
    ----------
    problem : what is searched.
    loose : (F, 8) rows of the features with their ends moved out by a hair.
    table : chord curves and sliding pairs between the loose features.
    counting : count all simultaneous contacts instead of looking for fixtures only.
    most_listed : of these so many are listed by each block, whatever the rules say of them.
    limits : what bounds a fixture, see ``kernels.contact.rules``.
    stats : (blocks, 4) statistics the kernels add to, one row for each block so that threads never share one.
    """

    problem: Problem
    loose: Array
    table: CurveTable
    counting: bool = False
    most_listed: int = 0
    stats: list[NDArray[np.int64]] = field(factory=list, init=False)
    limits: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        """Write the limits as the kernels take them (see ``kernels.contact.rules``)."""
        problem, vise = self.problem, self.problem.vise
        lengths = [vise.min_gap, problem.contact_margin, problem.wrench_length]
        self.limits = np.array([*lengths, vise.columns - 1.0, 0.0, self.most_listed])

    @classmethod
    def of(cls, problem: Problem, counting: bool = False, most_listed: int = 0) -> ViseSearch:
        """The search of a problem, with its chord curves; ``counting`` leaves the contact margin out."""
        if counting:
            problem = evolve(problem, contact_margin=0.0)
        loose = loosened(problem.rows[:, :8])
        return cls(
            problem,
            loose,
            curve_table(loose, lattice_steps(problem.vise, problem.diameter + 1e-6)),
            counting,
            most_listed,
        )

    @property
    def vise(self) -> Vise:
        """The vise."""
        return self.problem.vise

    @property
    def totals(self) -> NDArray[np.int64]:
        """Statistics (5,) of all blocks together."""
        return np.asarray(np.array(self.stats, np.int64).reshape(-1, STATISTICS).sum(axis=0))

    @property
    def alive(self) -> float:
        """How many chord curves exist at an orientation, on average."""
        return float((self.table.reals[:, TO] - self.table.reals[:, FROM]).sum()) / tau

    def blocks(self, types: Collection[str], least: int = LEAST_BLOCKS) -> list[Block]:
        """Blocks of work that together find all fixtures of the given types ("I", "II"), about ``least`` or more for a half
        turn."""
        # In a cell heights should change by no more than part of a pitch, so that most pairs of pieces cannot cross.
        cells = int(
            min(max(CELLS_PER_PITCH * self.problem.wrench_length / self.vise.pitch[1], FEWEST_CELLS), MOST_CELLS)
        )
        together = int(min(max(PAIRS_PER_BLOCK / max(self.alive, 1.0) ** 2, 1.0), cells // least))
        blocks: list[Block] = []
        for name, half_turns in (("I", 1), ("II", 2)):
            if name not in types:
                continue
            edges = cell_edges(half_turns, half_turns * cells)
            wanted = may_lie_at(edges, self.problem.restrictions.angles, half_turns)
            for first, last in neighbours(wanted, together):
                blocks.append(self.crossing_block(name, edges[first : last + 1]))
            for cell, sliding_pairs in enumerate(self.sliding_pair_cells(half_turns, edges)):
                if len(sliding_pairs) and wanted[cell]:
                    blocks.append(
                        self.sliding_pair_block(name, float(edges[cell]), float(edges[cell + 1]), sliding_pairs)
                    )
        return blocks

    def sliding_pair_cells(self, half_turns: int, edges: Array) -> list[NDArray[np.int64]]:
        """Sliding pairs by the cell their orientation falls into."""
        psi = self.table.sliding_pair_reals[:, ORIENTATION]
        psi = FIRST_ORIENTATION + (psi - FIRST_ORIENTATION) % tau
        self.table.sliding_pair_reals[:, ORIENTATION] = psi
        cells = np.searchsorted(edges, psi, side="right") - 1
        cells[psi >= FIRST_ORIENTATION + half_turns * pi] = -1
        order = np.argsort(cells, kind="stable")
        starts = np.searchsorted(cells[order], np.arange(len(edges)))
        return [order[first:last] for first, last in pairwise(starts)]

    def crossing_block(self, name: str, edges: Array) -> Block:
        """The crossings of some neighbouring cells."""
        kernel = two_and_two_cells if name == "I" else three_and_one_cells
        members = members_of_cell(self.table, float(edges[0]), float(edges[-1]))
        weight = 1.0 if name == "I" else 0.5
        return Block(
            partial(self.cross, kernel, edges, members, self.tally()), 1.0 + weight * len(members) ** 2, len(edges) - 1
        )

    def sliding_pair_block(self, name: str, low: float, high: float, sliding_pairs: NDArray[np.int64]) -> Block:
        """The sliding pairs of one cell."""
        kernel = sliding_two_and_two if name == "I" else sliding_three_and_one
        members = members_of_cell(self.table, low, high)
        return Block(
            partial(self.meet_sliding_pairs, kernel, sliding_pairs, members, self.tally()),
            1.0 + len(sliding_pairs) * len(members),
        )

    def tally(self) -> NDArray[np.int64]:
        """A new row of statistics for a kernel to add to."""
        self.stats.append(np.zeros(STATISTICS, np.int64))
        return self.stats[-1]

    def limits_from(self, margin: float) -> Array:
        """The limits with a closure margin to reach."""
        limits = self.limits.copy()
        limits[LEAST_MARGIN] = margin
        return limits

    def cross(
        self,
        kernel: Callable[..., Array],
        edges: Array,
        members: NDArray[np.int64],
        stats: NDArray[np.int64],
        margin: float,
    ) -> Array:
        """Run a kernel of crossings on some cells, for fixtures of a closure margin or more."""
        return kernel(
            edges,
            members,
            self.loose,
            self.problem.rows,
            self.table.integers,
            self.table.reals,
            self.table.stretches,
            self.vise.pitch[0],
            self.vise.pitch[1],
            self.vise.row_offset,
            self.limits_from(margin),
            self.counting,
            stats,
        )

    def meet_sliding_pairs(
        self,
        kernel: Callable[..., Array],
        sliding_pairs: NDArray[np.int64],
        members: NDArray[np.int64],
        stats: NDArray[np.int64],
        margin: float,
    ) -> Array:
        """Run a kernel of sliding pairs on one cell, for fixtures of a closure margin or more."""
        return kernel(
            sliding_pairs,
            self.table.sliding_pair_integers,
            self.table.sliding_pair_reals,
            members,
            self.loose,
            self.problem.rows,
            self.table.integers,
            self.table.reals,
            self.vise.pitch[1],
            self.vise.row_offset,
            self.limits_from(margin),
            self.counting,
            stats,
        )
