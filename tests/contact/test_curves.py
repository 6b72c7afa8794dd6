"""Features as the search takes them."""

from __future__ import annotations

import numpy as np
import pytest

from chord_examples import arc_row, line_row
from workhold.contact.curves import loosened
from workhold.conventions import LOOSE


def test_ends_are_moved_out_by_the_same_length_on_lines_and_arcs() -> None:
    """Half the length of a line and of arcs of any radius grows by ``LOOSE`` mm; a whole circle has no end to move."""
    rows = np.array(
        [line_row(1, 2, 0.3, 7.0), *(arc_row(0, 0, r, 1.0, 0.8) for r in (0.5, 3.0, 80.0)), arc_row(0, 0, 3)]
    )
    grown = (loosened(rows) - rows)[:, 5] * np.where(rows[:, 6] == 0.0, 1.0, rows[:, 6])
    assert grown == pytest.approx([LOOSE, LOOSE, LOOSE, LOOSE, 0.0], rel=1e-6)
    assert (loosened(rows)[:, :5] == rows[:, :5]).all()
