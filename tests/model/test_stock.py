"""Only what cuts counts: the stretches of moves on which a tool's disc meets the stock, ends exact."""

from __future__ import annotations

from math import hypot, pi, sqrt, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from workhold import InputError, Program, Query, Vise, Workpiece
from workhold.model.cutting_tool import Cylinder, Tool
from workhold.model.moves import Moves, compute_path_points
from workhold.model.stock import Stock, find_stretches_in_stock

Array = NDArray[np.float64]
TOOLS = {2: Tool(2, [Cylinder(0, 40, 6)], 12)}
PLATE = np.array([(0.0, 0, 0), (120, 0, 0), (120, 70, 0), (0, 70, 0)])
# An L, a disc of two half turns, and a plate with a bow in and a bow out.
ELL = np.array([(0.0, 0, 0), (90, 0, 0), (90, 20, 0), (20, 20, 0), (20, 80, 0), (0, 80, 0)])
DISC = np.array([(-30.0, 10, 1), (30, 10, 1)])
BOWS = np.array([(0.0, 0, 0), (80, 0, 0.7), (80, 50, 0), (0, 50, -0.4)])
places = st.tuples(st.floats(-60, 150), st.floats(-60, 130))


def moves_of(*rows: tuple[Any, ...], tool: int = 2, cycle: bool = False) -> Moves:
    """Cutting moves from, to and with a bulge; at the height 3 where only x and y are given."""
    full = [
        (k, tool, True, (*a, 3.0)[:3], (*b, 3.0)[:3], bulge, 0.0, 0.0, cycle)
        for k, (a, b, bulge) in enumerate(rows, 1)
    ]
    return Moves.from_rows(full)


def found(moves: Moves, loops: list[Array], **how: Any) -> list[list[float]]:
    """The stretches of the first move."""
    stock = Stock.from_value(how, 10.0)
    border = stock.make_border(loops)
    return find_stretches_in_stock(moves, TOOLS, stock, border, np.ones(len(moves), np.bool_)).list_shares(0)


def sampled(loop: Array, step: float = 0.5) -> Array:
    """Points close together along a loop."""
    points = []
    for k, (x, y, bulge) in enumerate(loop):
        end = loop[(k + 1) % len(loop), :2]
        count = int(2 + 2.2 * hypot(end[0] - x, end[1] - y) / step)
        ends = (np.repeat([one], count, axis=0) for one in ((x, y), end))
        points.append(compute_path_points(*ends, np.full(count, bulge), np.linspace(0, 1, count)))
    return np.concatenate(points)


def meets_by_hand(points: Array, loop: Array, reach: float) -> NDArray[np.bool_]:
    """Whether points lie within a loop or nearer to it than a reach, from points on the loop."""
    border = sampled(loop)
    away = np.array([np.hypot(*(border - one).T).min() for one in points])
    one, other = border - points[:, None], np.roll(border, -1, axis=0) - points[:, None]
    turned = np.arctan2(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0], (one * other).sum(axis=2))
    return (np.abs(turned.sum(axis=1)) > pi) | (away < reach)


@pytest.mark.thorough
@pytest.mark.parametrize("loop", [PLATE, ELL, DISC, BOWS, BOWS[::-1] * [1, 1, -1]])
@given(places, places, st.floats(-5.5, 5.5), st.sampled_from([0.0, 5.0, 17.0]))
def test_stretches_are_those_of_a_walk(
    loop: Array, start: tuple[float, float], end: tuple[float, float], sweep: float, side: float
) -> None:
    bulge = 0.0 if abs(sweep) < 0.5 else tan(sweep / 4)
    if hypot(end[0] - start[0], end[1] - start[1]) < 1.0:
        return
    moves = moves_of((start, end, bulge))
    share = np.linspace(0.0, 1.0, 31)
    ends = (np.repeat(one[:, :2], len(share), axis=0) for one in (moves.start, moves.end))
    points = compute_path_points(*ends, np.full(len(share), bulge), share)
    loop = np.roll(loop, 1, axis=0) if loop[0, 2] > 1 else loop
    got = found(moves, [loop], side=side)
    inside = np.zeros(len(share), np.bool_)
    for low, high in got:
        inside |= (low <= share) & (share <= high)
    want, wide = meets_by_hand(points, loop, 6 + side), meets_by_hand(points, loop, 6.03 + side)
    narrow = meets_by_hand(points, loop, 5.97 + side)
    assert not (inside & ~wide).any() and not (~inside & narrow).any(), (got, want)
    # Every end that is not one of the move's own is where the edge of the tool just touches.
    for at in {one for pair in got for one in pair} - {0.0, 1.0}:
        place = compute_path_points(
            *(one[:, :2] for one in (moves.start, moves.end)), np.array([bulge]), np.array([at])
        )
        assert np.hypot(*(sampled(loop, 0.05) - place[0]).T).min() == pytest.approx(6 + side, abs=2e-4)


def test_the_ends_are_exact_by_hand() -> None:
    # A tool of 12 mm runs in from beside a plate with 5 mm of stock: from 11 mm before it to 11 mm behind it.
    line = moves_of(((-40.0, 20.0), (160.0, 20.0), 0.0))
    assert found(line, [PLATE]) == [pytest.approx([29 / 200, 171 / 200], abs=1e-7)]
    assert found(line, [PLATE], side=0) == [pytest.approx([34 / 200, 166 / 200], abs=1e-7)]
    # Past a corner, 8 mm beside: the disc meets the corner's rounding sqrt(11^2 - 8^2) before and behind it.
    past = moves_of(((-40.0, 110.0), (60.0, 10.0), 0.0))
    d = (110 - 40 - 70) / sqrt(2)
    want = [(40 * sqrt(2) - sqrt(121 - d * d)) / (100 * sqrt(2)), 1.0]
    assert found(past, [PLATE]) == [pytest.approx(want, abs=1e-7)]
    # Over the hook of an L twice, and over the block around it once.
    over = moves_of(((50.0, -40.0), (50.0, 120.0), 0.0))
    assert found(over, [ELL]) == [pytest.approx([29 / 160, 71 / 160], abs=1e-7)]
    assert found(over, [ELL], shape="block") == [pytest.approx([29 / 160, 131 / 160], abs=1e-7)]
    across = moves_of(((-40.0, 90.0), (100.0, -50.0), 0.0), ((10.0, 130.0), (10.0, 131.0), 0.0))
    assert len(found(across, [ELL], side=0)) == 1
    hooks = moves_of(((-20.0, 60.0), (180.0, 60.0), 0.0))
    two = np.array(
        [
            (0.0, 0, 0),
            (100, 0, 0),
            (100, 80, 0),
            (80, 80, 0),
            (80, 20, 0),
            (20, 20, 0),
            (20, 80, 0),
            (0, 80, 0),
        ]
    )
    want = [[14 / 200, 46 / 200], [94 / 200, 126 / 200]]
    assert np.array(found(hooks, [two], side=0)) == pytest.approx(np.array(want), abs=1e-7)


def test_what_only_touches_takes_nothing_off() -> None:
    # Along a finished side, and over a finished top.
    side = moves_of(((0.0, -6.0), (120.0, -6.0), 0.0))
    assert found(side, [PLATE], side=0) == []
    assert found(side, [PLATE], side=0.001) == [[0.0, 1.0]]
    top = moves_of(((0.0, 20.0, 10.0), (120.0, 20.0, 10.0), 0.0))
    assert found(top, [PLATE], top=0) == [] and found(top, [PLATE]) == [[0.0, 1.0]]
    assert found(moves_of(((0.0, 20.0, 15.0), (120.0, 20.0, 15.0), 0.0)), [PLATE]) == []
    around = moves_of(((-90.0, 35.0), (210.0, 35.0), 1.0))
    assert found(around, [PLATE]) == []


def test_heights_count_from_the_tip_to_the_end_of_the_flute() -> None:
    # From 20 down to -30, with a flute of 40: from the top of the stock at 15 all the way.
    ramp = moves_of(((0.0, 20.0, 20.0), (100.0, 20.0, -30.0), 0.0))
    assert found(ramp, [PLATE]) == [pytest.approx([0.1, 1.0])]
    short = {2: Tool(2, [Cylinder(0, 40, 6)], 12, flute_length=10)}
    stock, every = Stock(height=10), np.ones(1, np.bool_)
    got = find_stretches_in_stock(ramp, short, stock, stock.make_border([PLATE]), every).list_shares(0)
    # Where the tip is 10 below the plane, the flute has left the stock.
    assert got == [pytest.approx([0.1, 0.6])]
    # Nobody knows how high the part is: then the stock has no top.
    stock = Stock()
    assert (
        find_stretches_in_stock(ramp, short, stock, stock.make_border([PLATE]), every).list_shares(0)[0][0]
        == 0.0
    )


def test_holes_are_filled_and_pieces_count_each() -> None:
    part = Workpiece.from_loops(
        "ring", [[(0, 0, 0), (120, 0, 0), (120, 70, 0), (0, 70, 0)], [(90, 35, -1), (30, 35, -1)]]
    )
    assert len(part.outer_loops) == 1
    down = moves_of(((60.0, 35.0, 20.0), (60.0, 35.0, 0.0), 0.0))
    assert found(down, list(part.outer_loops)) == [pytest.approx([0.25, 1.0])]
    assert found(moves_of(((60.0, 35.0), (160.0, 35.0), 0.0)), [DISC, PLATE]) == [
        pytest.approx([0, 0.71], abs=1e-7)
    ]


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


def asked(path: Path, **how: Any) -> Query:
    """A query for a plate with the program of a file."""
    how = {"cutting": {"cutting_force": 400}} | how
    program = Program.read(path, thickness=15, **how)
    part = Workpiece.from_loops("plate", [PLATE.tolist()])
    return Query(part, Vise(pitch=10, columns=3, peg_radius=3), program=program, peg_height=8)


def test_only_the_stretch_within_the_stock_presses(tmp_path: Path) -> None:
    """The plunge and the way out beside the part press on nothing, nor does what stays above it."""
    path = tmp_path / "facing.nc"
    path.write_text(FACING)
    query = asked(path)
    program = query.program
    assert program is not None and program.forces is not None
    line, shares = program.moves.line[program.forces.stretches.move], program.forces.stretches
    # In from 30 before the plate, out 30 behind it, of 200 mm from -40.
    assert line.tolist() == [7]
    assert [shares.first[0], shares.last[0]] == pytest.approx([10 / 200, 190 / 200], abs=1e-7)
    assert program.keep_forces_on([PLATE]) is program
    entries = [one for one in program.to_dict()["pieces"] if "cutting" in one]
    assert [one["line"] for one in entries] == [7] and entries[0]["cutting"]["kind"] == "milling"
    assert entries[0]["cutting"]["stretches"] == [[shares.first[0], shares.last[0]]]
    assert program.to_dict()["stock"] == {"side": 5.0, "top": 5.0, "shape": "outline", "height": 15.0}
    back = Program.from_entries(program.to_dict())
    assert (
        back.forces == program.forces and back.stock == program.stock and back.to_dict() == program.to_dict()
    )
    assert back.keep_forces_on([PLATE]) is back
    # A finished top, and none of the force at the finished height.
    bare = asked(path, stock={"top": 0, "side": 0})
    assert bare.program is not None and bare.program.forces is not None
    assert len(bare.program.forces.stretches) == 0 and not bare.program.forces.force.any()


@pytest.mark.parametrize(
    ("stock", "said"),
    [
        ({"side": -1}, "the stock's side -1 is not a length"),
        ({"top": float("nan")}, "the stock's top nan is not a length"),
        ({"shape": "ball"}, "the shape cannot be 'ball': choose outline or block"),
        ({"sides": 3}, "the stock has no 'sides': give side, top or shape"),
        ("ball", "the shape cannot be 'ball'"),
    ],
)
def test_a_stock_that_is_none_is_refused(stock: Any, said: str, tmp_path: Path) -> None:
    (tmp_path / "facing.nc").write_text(FACING)
    with pytest.raises(InputError, match=said):
        asked(tmp_path / "facing.nc", stock=stock)


DRILLED = """(T1 D=40. - face mill)
(T2 D=8. - drill)
(T3 D=8. - end mill)
G21 G90 G17
T1 M6
S1500 M3
G0 X-40 Y20 Z25
G1 Z0 F500
G0 Z25
X60
G1 Z4 F500
T2 M6
G0 X20 Y20 Z20
G1 Z-2 F100
G0 Z20
T3 M6
G1 Z4 F100
G0 Z20
G81 X40 Y20 Z-2 R2 F100
G80
M30
"""


def test_drills_drill_and_mills_plunge(tmp_path: Path) -> None:
    """Cycles drill with any tool; straight down a drill drills, a mill plunges, and nothing does in the air."""
    (tmp_path / "p.nc").write_text(DRILLED)
    program = asked(tmp_path / "p.nc").program
    assert program is not None and program.forces is not None
    forces, moves = program.forces, program.moves
    said = {
        int(moves.line[k]): (int(forces.kind[k]), forces.axial[k, 1]) for k in np.flatnonzero(forces.acts)
    }
    # The face mill plunges beside the part at first, which presses on nothing, and then into it.
    assert said == {11: (3, 400), 14: (2, 560), 17: (3, 400), 19: (2, 560)} and 8 not in said
    assert forces.force.max() == 0.0
    assert forces.torque[forces.acts].tolist() == [400 * 20.0, 1600, 1600, 1600]
    start = dict(
        zip(moves.line[forces.stretches.move].tolist(), forces.stretches.first.tolist(), strict=True)
    )
    # From 40 down to 31: the stock ends at 20. The drill begins at 35 and comes down to 13.
    assert start[14] == pytest.approx(15 / 22, abs=1e-6)


def test_a_type_says_what_a_tool_is(tmp_path: Path) -> None:
    (tmp_path / "p.nc").write_text(DRILLED)
    tools = {1: 40, 2: {"diameter": 8, "name": "8 mm"}, 3: {"diameter": 8, "type": "Drill"}}
    program = asked(tmp_path / "p.nc", tools=tools).program
    assert program is not None and program.forces is not None
    kinds = dict(zip(program.moves.line.tolist(), program.forces.kind.tolist(), strict=True))
    assert kinds[14] == 3 and kinds[17] == 2
    assert Tool(1, [Cylinder(0, 9, 1)], 2, "SPOT DRILL 90").is_drill
    assert not Tool(1, [Cylinder(0, 9, 1)], 2, "drill mill", kind="end mill").is_drill
    with pytest.raises(
        InputError, match=r"T1 lacks its teeth and its depth of cut, .* of a drill say type drill"
    ):
        asked(tmp_path / "p.nc", tools=tools, cutting={"material": "steel"})
