"""Every kernel that Python calls, called once with arrays of nothing: which compiles it for the types it is
called with.

Numba compiles one kernel at a time in a process, so there are parts for several processes. Kernels that call
the same ones are in one part, since each process compiles those anew. On a first run two processes share the
work through the cache folder; when a wheel is built, the code of all parts goes into one library.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np

from workhold.kernels.base.distance import is_inside, outline_distances, piece_distances, turns_around
from workhold.kernels.base.feature import FEATURE_LENGTH, SEGMENT_LENGTH
from workhold.kernels.base.given import Features, Lattice, Limits, Setting
from workhold.kernels.chord.coincidences import are_concentric
from workhold.kernels.chord.columns import (
    CURVE_INTEGERS,
    CURVE_REALS,
    SLIDING_PAIR_REALS,
    Curves,
    SlidingPairs,
)
from workhold.kernels.chord.stretches import STRETCH_LENGTH
from workhold.kernels.contact.clamp_pairs import (
    CLAMP_LENGTH,
    HOLE_LENGTH,
    Clamps,
    Hardware,
    closures_of,
    pairs_of,
)
from workhold.kernels.contact.contact_matrix import contact_matrices_of
from workhold.kernels.contact.pair_bounds import BOUND_LENGTH, FORCE_LENGTH, bounds_of_pairs
from workhold.kernels.contact.quality import LOAD_LENGTH, figures
from workhold.kernels.contact.record import RECORD_LENGTH, WORK_LENGTH
from workhold.kernels.contact.seat_numbers import numbers_of_seats
from workhold.kernels.contact.swept import DEPTH as TREE_DEPTH
from workhold.kernels.contact.swept import SweptTree, nearest_swept
from workhold.kernels.curves.block_work import STATISTICS
from workhold.kernels.curves.sliding_pairs import sliding_fixtures
from workhold.kernels.curves.table import tail_curves
from workhold.kernels.curves.three_and_one import three_and_one_cells
from workhold.kernels.curves.two_and_two import two_and_two_cells
from workhold.kernels.proof.canonical_form import contacts_of, to_canonical_form
from workhold.kernels.proof.interval_newton import interval_newton, jacobians
from workhold.kernels.proof.merging import merge_boxes
from workhold.kernels.proof.newton_kantorovich import certified
from workhold.kernels.seating.candidates import (
    complete_third,
    complete_three,
    complete_two,
    fourths,
    judge_balance,
    settle,
)
from workhold.kernels.seating.cell_middles import MIDDLE_LENGTH, write_middles
from workhold.kernels.seating.closing import close_jaws, reach_out
from workhold.kernels.seating.columns import (
    CANDIDATE_LENGTH,
    CELL_LENGTH,
    DEPTH,
    NODE_LENGTH,
    PAIR_LENGTH,
    DescentWorkSpace,
    Given,
    JawCells,
    Manifolds,
    Obstacles,
    SelfMotions,
)
from workhold.kernels.seating.descent_paths import (
    begin_descents,
    free_until,
    leads_out,
    take_up,
    write_places,
)
from workhold.kernels.seating.four_contacts import third_of_jaw, two_pairs
from workhold.kernels.seating.free_space import free_poses, leave
from workhold.kernels.seating.freedom import free_runs, keep_free
from workhold.kernels.seating.gathering import (
    GATHERED_LENGTH,
    SUBSET_LENGTH,
    first_of_each,
    first_sets,
    gathered,
    write_beyond,
    write_each_once,
)
from workhold.kernels.seating.obstacles import clearances, cover_same
from workhold.kernels.seating.parallel_and_concentric import (
    ALPHA,
    THREE_FACES,
    about_one_center,
    at_tangencies,
    on_three_faces,
    tangent_chords,
)
from workhold.kernels.seating.slides import SLIDE_LENGTH, slides_blocked, slides_held, slides_squared
from workhold.kernels.seating.sticking import least_friction
from workhold.kernels.seating.three_contacts import ROOT_LENGTH, three_contacts
from workhold.kernels.seating.tip_in_pocket import tip_in_pocket
from workhold.kernels.seating.turning import SHAPE_LENGTH
from workhold.kernels.seating.two_contact_curves import make_cells
from workhold.kernels.seating.wall_equilibria import Stood, stationary

# Numbers of a configuration.
CONFIGURATION = 4

__all__ = ["PARTS", "SEARCH", "SEATING", "kernel_count", "prepared"]

LATTICE, LIMITS = Lattice(1.0, 1.0, 0.0), Limits(1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0)
# A kernel and what it is called with.
Calls = Iterator[tuple[Callable[..., Any], tuple[Any, ...]]]


def crossings_and_pairs() -> Calls:
    """The kernels of crossings and sliding pairs, which take longest."""
    none, integers = np.zeros(0, np.int64), np.zeros((0, CURVE_INTEGERS), np.int64)
    features = Features(np.zeros((0, SEGMENT_LENGTH)), np.zeros((0, FEATURE_LENGTH)), (0, 0), (0, 0))
    curves = Curves(integers, np.zeros((0, CURVE_REALS)), np.zeros((0, STRETCH_LENGTH)))
    sliding_pairs = SlidingPairs(integers, np.zeros((0, SLIDING_PAIR_REALS)))
    given = (features, curves, LATTICE, LIMITS, False, np.zeros(STATISTICS, np.int64))
    for cells in (two_and_two_cells, three_and_one_cells):
        yield cells, (np.zeros(1), none, *given)
    yield sliding_fixtures, (2, none, sliding_pairs, none, *given)


def matrices_and_figures() -> Calls:
    """Kernels after the search that share hardly any with others."""
    none, whole, fours, pairs = (
        np.zeros(0, np.int64),
        np.zeros((0, 4), np.int64),
        np.zeros((0, 4)),
        np.zeros((0, 4, 2)),
    )
    yield to_canonical_form, (none, np.zeros(0), whole, whole, whole, 2, 0.0)
    given = (
        pairs,
        np.zeros((0, 3)),
        fours,
        np.zeros((0, 2)),
        whole,
        np.zeros((0, FEATURE_LENGTH)),
        none,
        np.zeros(2),
        1.0,
    )
    contacts = pairs, pairs, fours, fours, np.zeros((0, 4, 4))
    yield contact_matrices_of, (*given, *contacts, np.zeros((4, 4)))
    rows = (np.zeros((0, width)) for width in (2, 6, LOAD_LENGTH, 8, 3))
    yield figures, (*contacts, whole, 1.0, np.zeros(2), *rows)


def table_and_proof() -> Calls:
    """Most of the kernels that come before and after the search."""
    none, features = np.zeros(0, np.int64), np.zeros((1, SEGMENT_LENGTH))
    records, checked, outline = (
        np.zeros((0, width)) for width in (RECORD_LENGTH, FEATURE_LENGTH, SEGMENT_LENGTH)
    )
    outline.setflags(write=False)
    setting = Setting(LATTICE, LIMITS, 0.0, 0.0, 0.0)
    yield (
        tail_curves,
        (0, features, np.zeros(1, np.int64), np.zeros(0), none, np.zeros((0, 2), np.int64), np.zeros(0)),
    )
    work, fours, pairs = (
        (np.zeros((WORK_LENGTH, 4)), np.zeros((2, 4, 2))),
        np.zeros((0, 4)),
        np.zeros((0, 4, 2)),
    )
    yield certified, (records, checked, outline, fours, setting, fours, np.zeros(0, np.int8), *work)
    yield merge_boxes, (fours, fours, none, none)
    yield interval_newton, (records, checked, setting, np.zeros((0, 2, 4, 4)))
    yield jacobians, (records, checked, setting)
    yield contacts_of, (records, checked, setting, pairs, np.zeros(0), fours, fours, *work)


def clamps() -> Calls:
    """The kernels of searches for two clamps."""
    none, whole = np.zeros(0, np.int64), np.zeros((0, 4), np.int64)
    given = Clamps(np.zeros(1, np.int64), whole, np.zeros((0, CLAMP_LENGTH)), np.zeros((0, HOLE_LENGTH)))
    hardware = Hardware(np.full((4, 4), -1), 0.0, 0.0, 0.0, False)
    yield pairs_of, (np.zeros((0, 2), np.int64), none, given, hardware, False)
    records = np.zeros((0, RECORD_LENGTH)), np.zeros(3), np.zeros(2), 0.0
    yield numbers_of_seats, (*records, none, np.zeros(0), np.zeros(0))
    yield closures_of, (np.zeros((0, 2, CLAMP_LENGTH)), np.zeros((0, 2)))
    forces, bounds = np.zeros((0, FORCE_LENGTH)), np.zeros((0, BOUND_LENGTH))
    asked = np.zeros((4, 4), np.int64)
    yield bounds_of_pairs, (np.zeros(1, np.int64), none, forces, asked, False, bounds, np.zeros((2, 3)))


def distances() -> Calls:
    """The kernels of reading a part."""
    row, outline = np.zeros(SEGMENT_LENGTH), np.zeros((0, SEGMENT_LENGTH))
    outline.setflags(write=False)
    yield outline_distances, (np.zeros((0, 2)), outline)
    yield piece_distances, (np.zeros((0, 2)), np.zeros((0, 2)), outline, np.zeros(0))
    yield turns_around, (0.0, 0.0, outline)
    yield is_inside, (0.0, 0.0, outline)
    yield are_concentric, (row, row)
    points, whole = np.zeros((0, 2)), np.zeros(TREE_DEPTH, np.int64)
    tree = SweptTree(outline, np.zeros(0), np.zeros((2, 5)))
    yield nearest_swept, (points, points, tree, whole, np.zeros(0), np.zeros(0, np.int64))


def seats_and_passes() -> Calls:
    """The kernels of seating, which no search needs."""
    one, points, many = np.zeros(CONFIGURATION), np.zeros((0, 2)), np.zeros((0, CANDIDATE_LENGTH))
    rows, pegs, sides = np.zeros((0, SEGMENT_LENGTH)), np.zeros((4, 2)), np.zeros(4, np.int64)
    outline = np.zeros((0, SEGMENT_LENGTH))
    outline.setflags(write=False)
    curves = np.zeros((0, CURVE_INTEGERS), np.int64), np.zeros((0, CURVE_REALS))
    parts = np.zeros((2, 2), np.int64)
    given = Given(np.zeros((0, PAIR_LENGTH)), *curves, rows, pegs, sides, parts)
    wall = np.zeros((0, 6)), np.zeros(3)
    obstacles = Obstacles(rows, points, np.zeros((0, 3)), pegs, sides, parts, 1.0, 0.0, *wall)
    cells, stack, roots = np.zeros((0, CELL_LENGTH)), np.zeros((DEPTH, 2)), np.zeros((0, ROOT_LENGTH))
    none, pockets = np.zeros(0, np.int64), np.zeros((0, 2), np.int64)
    yield clearances, (points, rows, 0, 0, one)
    yield make_cells, (given, np.zeros((0, STRETCH_LENGTH)), cells)
    between = np.zeros((0, MIDDLE_LENGTH))
    yield write_middles, (cells, given, between)
    yield three_contacts, (cells, between, given, np.zeros((0, 3)), 0.0, stack, np.zeros((5, 0)), roots)
    jaw = JawCells(cells, 0, 0.0)
    yield two_pairs, (jaw, jaw, given, np.zeros((2, CELL_LENGTH)), stack, none, roots)
    yield third_of_jaw, (cells, between, given, np.zeros((0, 3)), stack, roots)
    for complete in (complete_three, complete_two, complete_third):
        yield complete, (roots, given, pockets, many)
    yield fourths, (many, 0, given, many)
    gathering = 0.0, 0.0, given, np.zeros(CANDIDATE_LENGTH), np.zeros((0, GATHERED_LENGTH))
    yield gathered, (np.zeros((0, SUBSET_LENGTH)), many, many, many, *gathering)
    slides = np.zeros((0, SLIDE_LENGTH))
    for slid in (slides_squared, slides_blocked):
        yield slid, (slides, given, many)
    yield slides_held, (slides, jaw, jaw, given, pockets, many)
    yield at_tangencies, (0, 0, np.zeros((0, ALPHA + 1)), 0.0, 0.0, given, many)
    yield tangent_chords, (rows, 0, 0, 1.0, np.zeros((0, ALPHA + 1)))
    yield about_one_center, (given, 0.0, 0.0, many)
    yield on_three_faces, (slides, given, 0.0, 0.0, np.zeros((0, THREE_FACES)))
    seen, fours, known = np.zeros((4, 4)), np.zeros((0, 4)), np.zeros(0, np.int8)
    along, loose = SelfMotions.room(0, 0), Manifolds.room(0, 0)
    yield keep_free, (along, obstacles, seen)
    yield free_runs, (along, 0.0, 0.0, obstacles, fours, seen, none, pegs, loose)
    yield first_sets, (fours, loose, none, 1.0, 1.0, none)
    yield write_each_once, (loose, 1.0, 1.0, loose)
    yield write_beyond, (loose, 1.0, 1.0, fours, none)
    yield write_places, (fours, known, known, loose, none, none, fours, none, 0, 1.0, fours, 0, none, none)
    yield leads_out, (pockets, 0, np.zeros(2, np.int64))
    yield first_of_each, (many, 1.0, 1.0, none)
    stood = Stood(rows, np.zeros((0, 3)), parts, wall[0], np.zeros((0, 3)), points, wall[1])
    yield stationary, (stood, np.zeros((0, SHAPE_LENGTH)), stack, many)
    yield tip_in_pocket, (stood, points, pockets, stack, points, many)
    yield judge_balance, (many, 0.0, 0.0, np.zeros(0, np.int8))
    yield settle, (many, given, 1.0, np.zeros((4, 4)), np.zeros((4, 5)))
    work, ways = DescentWorkSpace.for_pieces(0), np.zeros((0, 4))
    begins, nodes = np.zeros(1, np.int64), np.zeros((0, NODE_LENGTH))
    yield close_jaws, (ways, points, 1.0, obstacles, ways, work, np.zeros(0, np.int8), begins, nodes)
    yield reach_out, (ways, ways, np.zeros(0), 1.0, 1.0, obstacles, work, begins, nodes)
    followed = none, none, nodes, begins, ways, np.zeros((0, 4), np.int8)
    yield free_until, (*followed, 1.0, obstacles, np.zeros((4, 4)), none)
    yield begin_descents, (many, 1.0, ways, points)
    yield (
        take_up,
        (
            none,
            none,
            none,
            none,
            nodes,
            begins,
            np.zeros(0, np.int8),
            ways,
            ways,
            points,
            np.zeros(0, np.int8),
        ),
    )
    yield (
        least_friction,
        (pegs, pegs, sides, np.zeros((4, 3)), np.zeros((4, 3)), np.zeros((4, 4)), np.zeros((4, 4))),
    )
    crossings, intervals = np.zeros((1, 2)), np.zeros((2, 1, 2))
    yield free_poses, (one, 1.0, 0, np.ones(2), 0.0, 1.0, obstacles, crossings, intervals, np.zeros((0, 5)))
    yield cover_same, (one, ways, known, outline, points, 0.0, np.zeros(0, np.int8))
    yield leave, (ways, obstacles, np.zeros(0), points, np.zeros(0))


# Kernels of seating of which many call the same ones: half of the work.
PAIR_KERNELS = (
    make_cells,
    write_middles,
    three_contacts,
    two_pairs,
    third_of_jaw,
    complete_three,
    at_tangencies,
    tangent_chords,
    about_one_center,
    first_sets,
    write_each_once,
    write_places,
    stationary,
    least_friction,
)


def half_of_seating(first: bool) -> Calls:
    """The kernels of seating that are among ``PAIR_KERNELS``, or the others."""
    for kernel, arguments in seats_and_passes():
        if (kernel in PAIR_KERNELS) == first:
            yield kernel, arguments


PARTS: dict[str, Callable[[], Calls]] = {
    "crossings": crossings_and_pairs,
    "matrices": matrices_and_figures,
    "others": table_and_proof,
    "distances": distances,
    "clamps": clamps,
    "curves": partial(half_of_seating, True),
    "seats": partial(half_of_seating, False),
}
# The parts that all searches need, and those of seating, in two shares of about the same length, for two
# processes. What a search for two clamps needs besides is compiled when it is called, in a second.
SEARCH = ("distances", "others"), ("crossings", "matrices")
SEATING = ("seats",), ("curves",)


def kernel_count(parts: Sequence[str]) -> int:
    """How many kernels parts have in all."""
    return sum(1 for part in parts for _ in PARTS[part]())


@contextmanager
def without_collector() -> Iterator[None]:
    """Compiles without the garbage collector, which would look through all that is compiled again and
    again."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def prepared(*parts: str) -> Iterator[Callable[..., Any]]:
    """The kernels of parts, each once it has been compiled."""
    for part in parts:
        for kernel, arguments in PARTS[part]():
            with without_collector():
                kernel(*arguments)
            yield kernel
