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
from typing import Any

import numpy as np

from workhold.kernels.base import distance
from workhold.kernels.base.feature import SEGMENT_LENGTH
from workhold.kernels.base.tables import (
    Curves,
    Features,
    Lattice,
    Limits,
    NearSpots,
    Precision,
    Setting,
    SlidingPairs,
)
from workhold.kernels.chord.coincidences import are_concentric
from workhold.kernels.contact import clamp_pairs, contact_matrix, location_bounds, quality, seats
from workhold.kernels.contact.record import WORK_LENGTH
from workhold.kernels.curves import block_work, sliding_pairs, table, three_and_one, two_and_two
from workhold.kernels.proof import canonical_form, interval_newton, merging, newton_kantorovich
from workhold.kernels.seating import (
    candidates,
    closing,
    descent_paths,
    four_contacts,
    free_space,
    freedom,
    gathering,
    obstacles,
    parallel_and_concentric,
    slides,
    sticking,
    three_contacts,
    tip_in_pocket,
    two_contact_curves,
    wall_equilibria,
)
from workhold.kernels.seating.columns import (
    DescentWorkSpace,
    Given,
    JawCells,
    Manifolds,
    Obstacles,
    SelfMotions,
)

__all__ = ["PARTS", "SEARCH", "SEATING", "kernel_count", "prepared"]

# Arrays of nothing: reals, whole numbers and flags, of so many dimensions. Widths of rows do not matter.
LINE, ROWS, STACKS, DEEP = (np.zeros((0,) * dimensions) for dimensions in (1, 2, 3, 4))
NUMBERS, WHOLE = (np.zeros((0,) * dimensions, np.int64) for dimensions in (1, 2))
FLAGS, FLAGGED = (np.zeros((0,) * dimensions, np.int8) for dimensions in (1, 2))
OUTLINE = np.zeros((0, 0))
OUTLINE.setflags(write=False)
# Arrays of which kernels ask something before they know that there is nothing to do.
ONE, FOUR, SQUARE = np.zeros(1, np.int64), np.zeros(4), np.zeros((4, 4))
LATTICE, LIMITS = Lattice(1.0, 1.0, 0.0), Limits(1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0)
PRECISION, NEAR = (
    Precision(NUMBERS, LINE, LINE, ROWS, 0.0, 0.0, 1.0, 1.0),
    NearSpots(ONE, FLAGGED, np.zeros((0, 0, 0), np.int8)),
)
PEGS, SIDES, PIECES = np.zeros((4, 2)), np.zeros(4, np.int64), np.zeros((2, 2), np.int64)
GIVEN = Given(ROWS, WHOLE, ROWS, ROWS, PEGS, SIDES, PIECES)
AROUND = Obstacles(ROWS, ROWS, ROWS, PEGS, SIDES, PIECES, 1.0, 0.0, ROWS, np.zeros(3))
# A kernel and what it is called with.
Calls = Iterator[tuple[Callable[..., Any], tuple[Any, ...]]]


def crossings_and_pairs() -> Calls:
    """The kernels of crossings and sliding pairs, which take longest."""
    features, curves = Features(ROWS, ROWS, (0, 0), (0, 0), PRECISION, NEAR), Curves(WHOLE, ROWS, ROWS)
    given = (features, curves, LATTICE, LIMITS, False, np.zeros(block_work.STATISTICS, np.int64))
    for cells in (two_and_two.two_and_two_cells, three_and_one.three_and_one_cells):
        yield cells, (np.zeros(1), NUMBERS, *given)
    yield sliding_pairs.sliding_fixtures, (2, NUMBERS, SlidingPairs(WHOLE, ROWS), NUMBERS, *given)


def matrices_and_figures() -> Calls:
    """Kernels after the search that share hardly any with others."""
    yield canonical_form.to_canonical_form, (NUMBERS, LINE, WHOLE, WHOLE, WHOLE, 2, 0.0)
    contacts = STACKS, STACKS, ROWS, ROWS, STACKS
    placed = STACKS, ROWS, ROWS, ROWS, WHOLE, ROWS, NUMBERS, FOUR, 1.0
    yield contact_matrix.contact_matrices_of, (*placed, *contacts, SQUARE)
    yield quality.figures, (*contacts, WHOLE, 1.0, FOUR, ROWS, ROWS, ROWS, ROWS, ROWS)


def table_and_proof() -> Calls:
    """Most of the kernels that come before and after the search."""
    yield table.tail_curves, (0, np.zeros((1, SEGMENT_LENGTH)), ONE, LINE, NUMBERS, WHOLE, LINE, NEAR, ROWS)
    yield location_bounds.join_near_spots, (ROWS, 0, 1.0, PRECISION, NEAR, NUMBERS)
    yield location_bounds.least_middle_error, (ROWS, 0, PRECISION)
    setting, work = Setting(LATTICE, LIMITS, 0.0, 0.0, 0.0), (np.zeros((WORK_LENGTH, 4)), np.zeros((2, 4, 2)))
    yield newton_kantorovich.certified, (ROWS, ROWS, OUTLINE, ROWS, setting, ROWS, FLAGS, *work)
    yield merging.merge_boxes, (ROWS, ROWS, NUMBERS, NUMBERS)
    yield interval_newton.interval_newton, (ROWS, ROWS, setting, DEEP)
    yield interval_newton.jacobians, (ROWS, ROWS, setting)
    yield canonical_form.contacts_of, (ROWS, ROWS, setting, STACKS, LINE, ROWS, ROWS, *work)


def clamps() -> Calls:
    """The kernels of searches for two clamps."""
    hardware = clamp_pairs.Hardware(np.full((4, 4), -1), 0.0, 0.0, 0.0, False)
    yield clamp_pairs.pairs_of, (WHOLE, NUMBERS, clamp_pairs.Clamps(ONE, WHOLE, ROWS, ROWS), hardware, False)
    yield seats.numbers_of_seats, (ROWS, FOUR, FOUR, 0.0, NUMBERS, LINE, LINE)
    yield clamp_pairs.closures_of, (STACKS, ROWS)
    yield seats.bounds_of_pairs, (ONE, NUMBERS, ROWS, WHOLE, False, ROWS, ROWS)


def distances() -> Calls:
    """The kernels of reading a part."""
    yield distance.outline_distances, (ROWS, OUTLINE)
    yield distance.piece_distances, (ROWS, ROWS, OUTLINE, LINE)
    yield distance.turns_around, (0.0, 0.0, OUTLINE)
    yield distance.is_inside, (0.0, 0.0, OUTLINE)
    yield are_concentric, (np.zeros(SEGMENT_LENGTH), np.zeros(SEGMENT_LENGTH))
    yield (
        distance.nearest_swept,
        (ROWS, ROWS, distance.SweptTree(OUTLINE, LINE, ROWS), NUMBERS, LINE, NUMBERS),
    )


def contacts_in_balance() -> Calls:
    """The kernels of seating of which many evaluate pairs of contacts, half of the work."""
    jaw = JawCells(ROWS, 0, 0.0)
    yield two_contact_curves.make_cells, (GIVEN, ROWS, ROWS)
    yield two_contact_curves.write_middles, (ROWS, GIVEN, ROWS)
    yield three_contacts.three_contacts, (ROWS, ROWS, GIVEN, ROWS, 0.0, ROWS, ROWS, ROWS)
    yield four_contacts.two_pairs, (jaw, jaw, GIVEN, SQUARE, ROWS, NUMBERS, ROWS)
    yield four_contacts.third_of_jaw, (ROWS, ROWS, GIVEN, ROWS, ROWS, ROWS)
    yield candidates.complete_three, (ROWS, GIVEN, WHOLE, ROWS)
    yield parallel_and_concentric.at_tangencies, (0, 0, ROWS, 0.0, 0.0, GIVEN, ROWS)
    yield parallel_and_concentric.tangent_chords, (ROWS, 0, 0, 1.0, ROWS)
    yield parallel_and_concentric.about_one_center, (GIVEN, 0.0, 0.0, ROWS)
    loose = Manifolds.room(0, 0)
    yield gathering.first_sets, (ROWS, loose, NUMBERS, 1.0, 1.0, NUMBERS)
    yield gathering.write_each_once, (loose, 1.0, 1.0, loose)
    ended = ROWS, FLAGS, FLAGS, loose, NUMBERS, NUMBERS, ROWS, NUMBERS, 0, 1.0, ROWS, 0
    yield descent_paths.write_places, (*ended, NUMBERS, NUMBERS)
    stood = wall_equilibria.Stood(ROWS, ROWS, PIECES, ROWS, ROWS, ROWS, FOUR)
    yield wall_equilibria.stationary, (stood, ROWS, ROWS, ROWS)
    sides, square = np.zeros((4, 3)), np.zeros((4, 4))
    yield sticking.least_friction, (PEGS, PEGS, SIDES, sides, sides, square, square)


def seats_and_passes() -> Calls:
    """The other kernels of seating."""
    jaw = JawCells(ROWS, 0, 0.0)
    yield obstacles.clearances, (ROWS, ROWS, 0, 0, FOUR)
    for complete in (candidates.complete_two, candidates.complete_third):
        yield complete, (ROWS, GIVEN, WHOLE, ROWS)
    yield candidates.fourths, (ROWS, 0, GIVEN, ROWS)
    yield gathering.gathered, (ROWS, ROWS, ROWS, ROWS, 0.0, 0.0, GIVEN, LINE, ROWS)
    for slid in (slides.slides_squared, slides.slides_blocked):
        yield slid, (ROWS, GIVEN, ROWS)
    yield slides.slides_held, (ROWS, jaw, jaw, GIVEN, WHOLE, ROWS)
    yield parallel_and_concentric.on_three_faces, (ROWS, GIVEN, 0.0, 0.0, ROWS)
    along, loose = SelfMotions.room(0, 0), Manifolds.room(0, 0)
    yield freedom.keep_free, (along, AROUND, ROWS)
    yield freedom.free_runs, (along, 0.0, 0.0, AROUND, ROWS, ROWS, NUMBERS, ROWS, loose)
    yield gathering.write_beyond, (loose, 1.0, 1.0, ROWS, NUMBERS)
    yield descent_paths.leads_out, (WHOLE, 0, np.zeros(2, np.int64))
    yield gathering.first_of_each, (ROWS, 1.0, 1.0, NUMBERS)
    stood = wall_equilibria.Stood(ROWS, ROWS, PIECES, ROWS, ROWS, ROWS, FOUR)
    yield tip_in_pocket.tip_in_pocket, (stood, ROWS, WHOLE, ROWS, ROWS, ROWS)
    yield candidates.judge_balance, (ROWS, 0.0, 0.0, FLAGS)
    yield candidates.settle, (ROWS, GIVEN, 1.0, ROWS, ROWS)
    work = DescentWorkSpace.for_pieces(0)
    yield closing.close_jaws, (ROWS, ROWS, 1.0, AROUND, ROWS, work, FLAGS, np.zeros(1, np.int64), ROWS)
    yield closing.reach_out, (ROWS, ROWS, LINE, 1.0, 1.0, AROUND, work, np.zeros(1, np.int64), ROWS)
    followed = NUMBERS, NUMBERS, ROWS, NUMBERS, ROWS, FLAGGED
    yield descent_paths.free_until, (*followed, 1.0, AROUND, np.zeros((4, 4)), NUMBERS)
    yield descent_paths.begin_descents, (ROWS, 1.0, ROWS, ROWS)
    paths = NUMBERS, NUMBERS, NUMBERS, NUMBERS, ROWS, NUMBERS, FLAGS
    yield descent_paths.take_up, (*paths, ROWS, ROWS, ROWS, FLAGS)
    searched = FOUR, 1.0, 0, FOUR, 0.0, 1.0, AROUND
    yield free_space.free_poses, (*searched, ROWS, STACKS, ROWS)
    yield obstacles.cover_same, (FOUR, ROWS, FLAGS, OUTLINE, ROWS, 0.0, FLAGS)
    yield free_space.leave, (ROWS, AROUND, LINE, ROWS, LINE)


PARTS: dict[str, Callable[[], Calls]] = {
    "crossings": crossings_and_pairs,
    "matrices": matrices_and_figures,
    "others": table_and_proof,
    "distances": distances,
    "clamps": clamps,
    "curves": contacts_in_balance,
    "seats": seats_and_passes,
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
