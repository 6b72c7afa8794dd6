"""Moves through air press on nothing: those that stay beside the raw block or above it all the way."""

from __future__ import annotations

from math import tan
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workhold import Program, Query, Vise, Workpiece
from workhold.geometry.segment import Box
from workhold.model.cutting_forces import ALLOWANCE, above_block, beside_block
from workhold.model.cutting_tool import Cylinder, Tool
from workhold.model.moves import Moves, along

PART = Box(0.0, 0.0, 120.0, 70.0)
TOOLS = {2: Tool(2, [Cylinder(0, 40, 6)], 12)}
places = st.tuples(st.floats(-120, 240), st.floats(-120, 190))
# Lead in beside the part, face it, leave, and plunge above it.
FACING = """(T1 D=50)
G21 G90 G17
T1 M6
S1500 M3
G0 X-40 Y20 Z15
G1 Z0 F500
G1 X160 F750
G1 X200
G0 Z30
X60
G1 Z6
G1 X70
M30
"""


def moves_of(*rows: tuple[tuple[float, float], tuple[float, float], float]) -> Moves:
    """Cutting moves of tool 2 at the height 3, from, to and with a bulge."""
    return Moves.of_rows(
        [
            (k + 1, 2, True, (*start, 3.0), (*end, 3.0), bulge, 0.0, 0.0)
            for k, (start, end, bulge) in enumerate(rows)
        ]
    )


@given(places, places, st.floats(-3.0, 3.0))
def test_no_move_is_beside_the_block_that_enters_it(
    start: tuple[float, float], end: tuple[float, float], sweep: float
) -> None:
    """Against the path in small steps; of straight moves also the other way round."""
    moves = moves_of((start, end, tan(sweep / 4)))
    share = np.linspace(0.0, 1.0, 2001)
    ends = (np.repeat(one[:, :2], 2001, axis=0) for one in (moves.start, moves.end))
    x, y = along(*ends, np.repeat(moves.bulge, 2001), share).T
    room = 6.0 + ALLOWANCE
    across = np.maximum(np.maximum(-x, x - 120.0), np.maximum(-y, y - 70.0))
    beside = bool(beside_block(moves, TOOLS, PART)[0])
    if beside:
        assert across.min() > room - 1e-9
    elif sweep == 0.0:
        assert across.min() < room + 0.2


def test_a_circle_around_the_block_is_not_beside_it() -> None:
    half = ((-90.0, 35.0), (210.0, 35.0), 1.0)
    assert beside_block(moves_of(half), TOOLS, PART).tolist() == [False]
    assert beside_block(moves_of(((-90.0, 35.0), (-30.0, 35.0), 1.0)), TOOLS, PART).tolist() == [False]
    assert beside_block(moves_of(((-90.0, 35.0), (-70.0, 35.0), 1.0)), TOOLS, PART).tolist() == [True]


def test_moves_above_the_block_are_those_whose_tip_stays_there() -> None:
    moves = Moves.of_rows(
        [
            (1, 2, True, (0.0, 0.0, 25.0), (9.0, 0.0, 20.0), 0.0, 0.0, 0.0),
            (2, 2, True, (0.0, 0.0, 25.0), (9.0, 0.0, 19.9), 0.0, 0.0, 0.0),
        ]
    )
    assert above_block(moves, 20.0 - ALLOWANCE).tolist() == [True, False]


def test_only_what_meets_the_block_presses(tmp_path: Path) -> None:
    """The plunge and the way out beside the part press on nothing, nor does what stays above it."""
    path = tmp_path / "facing.nc"
    path.write_text(FACING)
    program = Program.read(path, thickness=15, cutting={"cutting_force": 400})
    pressing = set(program.moves.line[program.forces.torque > 0.0].tolist())
    assert pressing == {6, 7, 8}
    part = Workpiece.from_loops("plate", [[(0, 0, 0), (120, 0, 0), (120, 70, 0), (0, 70, 0)]])
    query = Query(part, Vise(pitch=10, columns=3, peg_radius=3), program=program, peg_height=8)
    assert query.program is not None and query.program.forces is not None
    assert query.program.moves.line[query.program.forces.torque > 0.0].tolist() == [7]
    assert query.program.pressing_on(Box(*part.bounds)) is query.program
    assert query.program.swept(-1e9, 1e9) == program.swept(-1e9, 1e9)
    assert query.program.forces.force.max() == pytest.approx(400)
