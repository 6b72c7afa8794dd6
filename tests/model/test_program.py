"""What a program sweeps at given heights: exactly the moments at which a cylinder reaches them, no more and no less."""

from __future__ import annotations

import json
from math import inf, nan, pi, tan
from typing import Any

import numpy as np
import pytest
from attrs import evolve
from hypothesis import given
from hypothesis import strategies as st

from workhold import Program
from workhold.errors import InputError
from workhold.model.cutting_tool import Cylinder, Tool
from workhold.model.moves import Moves, compute_path_points
from workhold.model.program import SweptPiece
from workhold.model.program_figures import bound_tip, measure_tools

TOOL = Tool(1, [Cylinder(0, 20, 3), Cylinder(20, 60, 15)], 6.0, "mill")


def program_of(*rows: tuple[Any, ...], **options: Any) -> Program:
    """A program of rows of cutting, start, end and bulge, all of tool 1 at 300 mm/min."""
    moves = [
        (10 + k, 1, cutting, start, end, bulge, 300.0 if cutting else 0.0, 1000.0)
        for k, (cutting, start, end, bulge) in enumerate(rows)
    ]
    options.setdefault("tools", {1: TOOL})
    return Program("a.nc", "0" * 64, "mm", (0.0, 0.0), 0.0, moves=Moves.from_rows(moves), **options)


def test_a_ramp_is_cut_where_its_cylinders_reach_the_heights() -> None:
    """A tip from 50 to 10 over 40 mm: the flute, up to tip + 20, is at 35 to 38 from tip 38 to 15; the holder from 18."""
    ramp = program_of((True, (0, 0, 50), (40, 0, 10), 0.0))
    flute, holder = ramp.list_swept_pieces(35.0, 38.0)
    assert flute == SweptPiece(
        10, 1, "cut", ((12.0, 0.0, 0.0), (35.0, 0.0, 0.0)), (38.0, 15.0), 3.0, (0.0, 20.0)
    )
    assert holder == SweptPiece(
        10, 1, "cut", ((32.0, 0.0, 0.0), (40.0, 0.0, 0.0)), (18.0, 10.0), 15.0, (20.0, 60.0)
    )
    assert flute.reach == (15.0, 58.0) and holder.reach == (30.0, 78.0)


def test_the_interval_is_closed() -> None:
    """A cylinder that only touches the heights counts, at one moment or all along; beyond it, nothing does."""
    level = program_of((True, (0, 0, 5), (10, 0, 5), 0.0), tools={1: Tool(1, [Cylinder(0, 20, 3)], 6.0)})
    assert [len(level.list_swept_pieces(*ends)) for ends in ((0, 5), (25, 30), (0, 4.999), (25.001, 30))] == [
        1,
        1,
        0,
        0,
    ]
    falling = program_of((True, (0, 0, 9), (10, 0, 5), 0.0), tools={1: Tool(1, [Cylinder(0, 20, 3)], 6.0)})
    (touch,) = falling.list_swept_pieces(-3, 5)
    assert touch.path == ((10.0, 0.0, 0.0),) and touch.tip == (5.0, 5.0)
    (above,) = falling.list_swept_pieces(29, 40)
    assert above.path == ((0.0, 0.0, 0.0),) and above.tip == (9.0, 9.0)
    assert falling.list_swept_pieces(-3, 4.99) == falling.list_swept_pieces(29.01, 40) == ()


def test_a_helix_is_cut_at_equal_shares_of_its_sweep() -> None:
    """A quarter turn from 8 to 0: heights up to 4 hold the second half, an eighth of a turn with its own bulge."""
    helix = program_of(
        (True, (10, 0, 8), (0, 10, 0), tan(pi / 8)), tools={1: Tool(1, [Cylinder(0, 20, 3)], 6.0)}
    )
    (piece,) = helix.list_swept_pieces(1.0, 4.0)
    (x, y, bulge), (to_x, to_y, _) = piece.path
    assert (x, y) == pytest.approx((10 * 2**-0.5, 10 * 2**-0.5)) and (to_x, to_y) == (0.0, 10.0)
    assert bulge == pytest.approx(tan(pi / 16)) and piece.tip == pytest.approx((4.0, 0.0))


def test_upright_moves_are_points_and_tips_change() -> None:
    """A plunge has one vertex, and its tip is cut."""
    (flute, holder) = program_of((True, (4, 5, 30), (4, 5, -10), 0.0)).list_swept_pieces(0.0, 12.0)
    assert flute.path == holder.path == ((4.0, 5.0, 0.0),)
    assert flute.tip == (12.0, -10.0) and holder.tip == pytest.approx((-8.0, -10.0))


COORDINATE = st.floats(-50, 50).map(lambda value: round(value, 3))
PLACE = st.tuples(COORDINATE, COORDINATE, COORDINATE)


@pytest.mark.thorough
@given(PLACE, PLACE, st.floats(-1, 1), COORDINATE, st.floats(0, 30))
def test_cutting_is_the_walk_of_all_moments(
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    bulge: float,
    low: float,
    room: float,
) -> None:
    """Along any move, a moment counts if and only if tip + [l, u] meets the heights, and stands on the piece."""
    bulge = 0.0 if abs(bulge) < 1e-3 or start[:2] == end[:2] else bulge
    program = program_of((True, start, end, bulge))
    high = low + room
    shares = np.linspace(0, 1, 101)
    many = len(shares)
    where = compute_path_points(
        *(np.repeat(np.array([one[:2]], dtype=float), many, axis=0) for one in (start, end)),
        np.full(many, bulge),
        shares,
    )
    tips = start[2] + shares * (end[2] - start[2])
    found = {piece.radius: piece for piece in program.list_swept_pieces(low, high)}
    for cylinder in TOOL.cylinders:
        meets = (tips + cylinder.low <= high) & (tips + cylinder.high >= low)
        clearly = (tips + cylinder.low <= high - 1e-9) & (tips + cylinder.high >= low + 1e-9)
        piece = found.get(cylinder.radius)
        if piece is None:
            assert not clearly.any()
            continue
        ends = np.array([vertex[:2] for vertex in piece.path])
        assert min(piece.tip) + cylinder.low <= high + 1e-9 and max(piece.tip) + cylinder.high >= low - 1e-9
        if start[2] != end[2]:
            inner = (tips >= min(piece.tip) - 1e-9) & (tips <= max(piece.tip) + 1e-9)
            assert (
                not (meets & ~inner).any()
                and not (
                    inner & ~meets & ~np.isclose(tips, piece.tip[0]) & ~np.isclose(tips, piece.tip[1])
                ).any()
            )
            at = [(tip - start[2]) / (end[2] - start[2]) for tip in piece.tip]
            two = compute_path_points(
                np.array([start[:2]] * 2, dtype=float),
                np.array([end[:2]] * 2, dtype=float),
                np.full(2, bulge),
                np.array(at),
            )
            assert np.allclose(two[[0, -1]], ends[[0, -1]], atol=1e-6)
            if len(piece.path) == 2 and bulge:
                assert np.arctan(piece.path[0][2]) == pytest.approx(
                    (at[1] - at[0]) * np.arctan(bulge), abs=1e-9
                )
        else:
            assert meets.all() and np.allclose(ends[[0, -1]], where[[0, -1]])


def test_points_along_an_arc_are_at_its_radius_and_turn_evenly() -> None:
    """A third of 270° from the right of the centre is the top of the circle."""
    start, end = np.array([[7.0, 3.0]]), np.array([[2.0, -2.0]])
    point = compute_path_points(start, end, np.array([tan(3 * pi / 8)]), np.array([1 / 3]))
    assert np.allclose(point, [[2.0, 8.0]])


BOX = (
    (False, (0, 0, 30), (10, 5, 5), 0.0),
    (True, (10, 5, 5), (0, 0, 5), 0.0),
    (False, (0, 0, 5), (0, 0, 9), 0.0),
)


def test_a_rapid_move_in_a_box_is_filled_and_not_cut() -> None:
    """Whatever way a control goes, it stays in the box; cutting moves and moves along one axis are as they are."""
    program = program_of(*BOX, rapid="box", tools={1: Tool(1, [Cylinder(0, 20, 3)], 6.0)})
    box, cut, up = program.list_swept_pieces(5.0, 6.0)
    assert [(x, y) for x, y, _ in box.path] == [(0, 0), (10, 0), (10, 5), (0, 5), (0, 0)]
    assert box.filled and box.tip == (30.0, 5.0) and not cut.filled and len(cut.path) == 2
    assert not up.filled and up.tip == (5.0, 6.0)
    assert len(program.list_swept_pieces(-2.0, 4.0)) == 0
    side = program_of((False, (0, 0, 30), (10, 0, 5), 0.0), rapid="box").pieces[0]
    assert side.filled and [(x, y) for x, y, _ in side.path] == [(0, 0), (10, 0), (0, 0)]
    assert not program_of(*BOX).pieces[0].filled


@pytest.mark.parametrize("rapid", ["straight", "box"])
def test_a_file_has_all_of_a_program(rapid: str) -> None:
    """Written and read again it is the same, but for feeds and speeds; names of the entries are the contract's."""
    program = program_of(
        *BOX,
        (True, (0, 0, 9), (0, 9, 2), 0.7),
        rapid=rapid,
        skipped=(3, 7),
        notes=("Read so.",),
        clearance=0.5,
    )
    data = json.loads(json.dumps(program.to_dict()))
    assert set(data) == {
        *("name", "sha256", "unit", "zero", "z_zero", "clearance", "rapid", "tools"),
        *("pieces", "skipped", "notes"),
    }
    assert set(data["pieces"][0]) == {"line", "tool", "kind", "path", "z", "radius", "heights"}
    again = Program.from_entries(data)
    bare = evolve(program.moves, feed=np.zeros(4), spindle=np.zeros(4))
    assert again == evolve(program, moves=bare, stock=None) and again.pieces == program.pieces
    assert again != evolve(program, moves=evolve(bare, end=bare.end + 1e-9))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda data: data["pieces"].pop(), "are not those of its tool"),
        (lambda data: data["pieces"][0].update(radius=4), "are not those of its tool"),
        (lambda data: data["pieces"][1].update(z=[0, 1]), "are not those of its tool"),
        (lambda data: data["pieces"][0].update(tool=9), "are not those of its tool"),
        (lambda data: data["pieces"][0].update(kind="jump"), "cannot be used"),
        (lambda data: data["pieces"][0].update(path=[[0, 0, 0], [1, 0, 0], [1, 1, 0]]), "cannot be used"),
        (lambda data: [piece.update(path=[["x", 0, 0]]) for piece in data["pieces"]], "cannot be 'x'"),
        (lambda data: data.update(unit="ell"), "is mm or inch"),
        (lambda data: data.update(clearance=-1), "clearance"),
        (lambda data: data.update(zero=[nan, 0]), "zero"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(change: Any, words: str) -> None:
    """In a sentence."""
    data = json.loads(json.dumps(program_of(*BOX).to_dict()))
    change(data)
    with pytest.raises(InputError, match=words):
        Program.from_entries(data)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Cylinder(5, 5, 1),
        lambda: Cylinder(-1, 5, 1),
        lambda: Cylinder(0, inf, 1),
        lambda: Cylinder(0, 5, 0),
        lambda: Cylinder(0, nan, 1),
        lambda: Cylinder(0, 1e7, 1),
        lambda: Tool(1, [], 6),
        lambda: Tool(1, TOOL.cylinders, 0),
        lambda: program_of(BOX[0], tools={2: TOOL}),
        lambda: program_of((True, (0, 0, 2e6), (0, 0, 0), 0.0)),
        lambda: program_of((True, (0, 0, 0), (0, 1, 0), nan)),
        lambda: program_of(BOX[0], rapid="curved"),
    ],
)
def test_what_cannot_be_is_refused(make: Any) -> None:
    """Cylinders without height or width, tools without a diameter, moves to nowhere."""
    with pytest.raises(InputError):
        make()


def test_figures_of_tools_and_the_box_of_the_tips() -> None:
    """Lengths and times by hand; an arc reaches beyond its ends, and a helix does so at its height there."""
    program = program_of(
        (False, (0, 0, 30), (10, 0, 30), 0.0),
        (True, (10, 0, 30), (10, 0, 0), 0.0),
        (True, (10, 0, 0), (0, 10, 4), -tan(3 * pi / 8)),
    )
    (one,) = measure_tools(program)
    arc = np.hypot(1.5 * pi * 10, 4)
    assert (one.tool, one.first_line, one.rapid, one.untimed) == (1, 10, 10.0, 0.0)
    assert one.cutting == pytest.approx(30 + arc) and one.seconds == pytest.approx((30 + arc) / 300 * 60)
    assert (one.lowest, one.highest, one.lowest_cut) == (0.0, 30.0, 0.0)
    low, high = bound_tip(program.moves)
    assert np.allclose(low, [-10, -10, 0]) and np.allclose(high, [10, 10, 30])
    start, end = [10 * np.array([np.cos(a), np.sin(a)]) for a in np.radians([150, 60])]
    over = program_of((True, (*start, 0), (*end, 9), -tan(pi / 8)))
    low, high = bound_tip(over.moves)
    assert np.allclose(low, [*start, 0]) and np.allclose(high, [end[0], 10, 9])
    unfed = evolve(program, moves=evolve(program.moves, feed=np.zeros(3)))
    assert measure_tools(unfed)[0].untimed == pytest.approx(30 + arc)


def test_a_program_without_moves_sweeps_nothing() -> None:
    """It is empty at all heights."""
    assert program_of().pieces == () and len(program_of().moves) == 0
