"""Compiling the kernels of a search ahead of it, in two halves of about the same length.

Numba compiles one kernel at a time in a process, so a first run takes half as long when two processes share the work
through the cache folder. Kernels are compiled for the types they are called with: here, with arrays of nothing.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from workhold.kernels.base.given import Features, Lattice, Limits, Setting
from workhold.kernels.chord.stretches import STRETCH_LENGTH
from workhold.kernels.contact.canonical_form import contacts_of, to_canonical_form
from workhold.kernels.contact.record import RECORD_LENGTH
from workhold.kernels.crossing.sliding_pairs import sliding_three_and_one, sliding_two_and_two
from workhold.kernels.crossing.three_and_one import three_and_one_cells
from workhold.kernels.crossing.two_and_two import STATISTICS, two_and_two_cells
from workhold.kernels.curves.columns import CURVE_INTEGERS, CURVE_REALS, SLIDING_PAIR_REALS, Curves, SlidingPairs
from workhold.kernels.curves.table import tail_curves
from workhold.kernels.proof.newton_kantorovich import certified
from workhold.kernels.statics.contact_matrix import contact_matrices_of
from workhold.kernels.statics.quality import figures
from workhold.kernels.statics.reactions import LOAD_LENGTH

__all__ = ["prepare_crossings", "prepare_table_and_listing"]

FEATURE_LENGTH, CHECKED_LENGTH = 8, 10
LATTICE, LIMITS = Lattice(1.0, 1.0, 0.0), Limits(1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0)


@contextmanager
def without_collector() -> Iterator[None]:
    """Compile without the garbage collector, which would look through all that is compiled again and again."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def prepare_crossings() -> None:
    """Compile the kernels of crossings and sliding pairs."""
    none, integers = np.zeros(0, np.int64), np.zeros((0, CURVE_INTEGERS), np.int64)
    features = Features(np.zeros((0, FEATURE_LENGTH)), np.zeros((0, CHECKED_LENGTH)), (0, 0), (0, 0))
    curves = Curves(integers, np.zeros((0, CURVE_REALS)), np.zeros((0, STRETCH_LENGTH)))
    sliding_pairs = SlidingPairs(integers, np.zeros((0, SLIDING_PAIR_REALS)))
    given = (none, features, curves, LATTICE, LIMITS, False, np.zeros(STATISTICS, np.int64))
    with without_collector():
        for cells in (two_and_two_cells, three_and_one_cells):
            cells(np.zeros(1), *given)
        for meet in (sliding_two_and_two, sliding_three_and_one):
            meet(none, sliding_pairs, *given)


def prepare_table_and_listing() -> None:
    """Compile the kernels that come before and after the search."""
    none, features = np.zeros(0, np.int64), np.zeros((1, FEATURE_LENGTH))
    records, checked, outline = (np.zeros((0, width)) for width in (RECORD_LENGTH, CHECKED_LENGTH, FEATURE_LENGTH))
    outline.setflags(write=False)
    setting, whole = Setting(LATTICE, LIMITS, 0.0, 0.0, 0.0), np.zeros((0, 4), np.int64)
    with without_collector():
        tail_curves(0, features, np.zeros(1, np.int64), np.zeros(0), none, np.zeros((0, 2), np.int64), np.zeros(0))
        certified(records, checked, outline, np.zeros((0, 4)), setting, np.zeros((0, 4)))
        contacts_of(records, checked, setting, np.zeros((0, 4, 2)), np.zeros(0), np.zeros((0, 4)), np.zeros((0, 4)))
        to_canonical_form(none, np.zeros(0), whole, whole.copy(), whole.copy(), 2, 0.0)
        pairs, fours, matrices = np.zeros((0, 4, 2)), np.zeros((0, 4)), np.zeros((0, 4, 4))
        pose, two = np.zeros((0, 3)), np.zeros(2)
        contact_matrices_of(pairs, pose, fours, two, whole, features, none, two, 1.0, pairs, pairs, fours, matrices)
        rows = (np.zeros((0, width)) for width in (2, 6, LOAD_LENGTH, 6))
        figures(pairs, pairs, fours, matrices, whole, 1.0, two, *rows)
