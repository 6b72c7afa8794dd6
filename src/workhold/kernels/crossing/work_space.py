"""What a block of a search works with and hands from kernel to kernel: made once, so that no inner kernel makes an array.

Kernels that list fixtures go on until all is done or their output is full. They tell where in their pairs they stopped in
``at``; what they began there is taken back, and begun anew when the caller has made room.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from workhold.kernels.base.compiling import inner_making_arrays
from workhold.kernels.contact.record import PEG_LENGTH
from workhold.kernels.crossing.roots import MOST_ROOTS, STACK_DEPTH, STACK_LENGTH

__all__ = ["TRIPLE_ROWS", "WorkSpace", "work_space"]

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Rows of what moving pegs need of three standing ones.
TRIPLE_ROWS = 8


class WorkSpace(NamedTuple):
    """Work space of a block.

    Parameters
    ----------
    at : (2,) where among its pairs a kernel stopped.
    stack, roots : see ``roots.crossings``.
    pegs : (4, 6) places, see ``kernels.contact.record``.
    contacts, null : see ``contact.rules.is_fixture``.
    triple : see ``three_and_one.write_triple``.
    """

    at: IntArray
    stack: Array
    roots: Array
    pegs: Array
    contacts: Array
    null: Array
    triple: Array


@inner_making_arrays
def work_space() -> WorkSpace:
    """A work space."""
    return WorkSpace(
        np.zeros(2, np.int64),
        np.empty((STACK_DEPTH, STACK_LENGTH)),
        np.empty((MOST_ROOTS, 3)),
        np.empty((4, PEG_LENGTH)),
        np.empty((8, 2)),
        np.empty(4),
        np.empty((TRIPLE_ROWS, 3)),
    )
