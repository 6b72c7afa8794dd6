"""Workpieces: what is accepted, how it is turned and numbered, and what is refused."""

from __future__ import annotations

from math import cos, inf, nan, pi, radians, sin, tan
from typing import Any

import numpy as np
import pytest
from attrs import evolve
from hypothesis import given
from hypothesis import strategies as st

from strategies import outlines
from workhold import Workpiece
from workhold.errors import InputError
from workhold.geometry.loop import compute_signed_area
from workhold.model.solid import SolidOutline

SQUARE = [[0, 0, 0], [40, 0, 0], [40, 40, 0], [0, 40, 0]]
HOLE = [[10, 10, 0], [20, 10, 0], [20, 20, 0], [10, 20, 0]]


def part(*loops, **options) -> Workpiece:
    """A workpiece named "part"."""
    return Workpiece.from_loops("part", loops, **options)


def disc(x, y, radius):
    """A circle in two halves."""
    return [[x - radius, y, 1], [x + radius, y, 1]]


def moved(loop, dx, dy, scale=1.0, turn=0.0):
    """A loop scaled, turned and moved."""
    c, s = cos(turn) * scale, sin(turn) * scale
    return [[c * x - s * y + dx, s * x + c * y + dy, bulge] for x, y, bulge in loop]


def rounded_rectangle(width, height, radius, digits=6):
    """Lines and quarter arcs that join tangentially, coordinates rounded."""
    bulge, r = tan(pi / 8), radius
    corners = [
        [r, 0, 0], [width - r, 0, bulge], [width, r, 0], [width, height - r, bulge],
        [width - r, height, 0], [r, height, bulge], [0, height - r, 0], [0, r, bulge],
    ]  # fmt: skip
    return [[round(v, digits) for v in corner] for corner in corners]


@pytest.mark.thorough
@given(outlines())
def test_loops_are_turned_so_that_material_lies_on_the_left(piece):
    """Given either way round, the outer loop comes out counter-clockwise and holes clockwise, same vertices."""
    for flips in (0, 1, 2, 3):
        loops = []
        for index, vertices in enumerate(piece.loops):
            loop = vertices.tolist()
            if flips >> index & 1:
                loop = [[*loop[-k][:2], -loop[-k - 1][2]] for k in range(len(loop))]
            loops.append(loop)
        again = part(*loops)
        assert compute_signed_area(again.loop_segments[0]) > 0
        assert all(compute_signed_area(hole) < 0 for hole in again.loop_segments[1:])
        for one, two in zip(again.loops, piece.loops, strict=True):
            assert np.array_equal(one, two)


def test_segments_are_numbered_through_all_loops():
    """Segment k of a loop starts at its vertex k as used; numbers run on from loop to loop."""
    plate = part(SQUARE, HOLE, disc(30, 30, 5))
    assert len(plate.segments) == 10
    assert [face.number for face in plate.faces] == [0, 1, 2, 3, 4, 5, 6, 7, 8]
    assert plate.segments[4].start == (10, 10) and plate.segments[4].end == (10, 20)
    assert plate.faces[8].segments == (8, 9)


def test_loops_are_read_only_copies():
    """Later changes of the caller's array do not reach the workpiece, and its own cannot be written to."""
    mine = np.array(SQUARE, dtype=float)
    plate = part(mine)
    mine[0, 0] = 99
    assert plate.loops[0][0, 0] == 0
    with pytest.raises(ValueError, match="read-only"):
        plate.loops[0][0, 0] = 1


def test_bounds_and_centre():
    """The bounding box counts arcs: a disc's box is its square, a half disc's reaches its top."""
    assert part(disc(3, 4, 5)).bounds == pytest.approx((-2, -1, 8, 9))
    assert part(disc(3, 4, 5)).center == pytest.approx((3, 4))
    assert part([[0, 0, 0], [10, 0, 1]]).bounds == pytest.approx((0, 0, 10, 5))


STAR = [[0, 0, 0], [40, 30, 0], [40, 0, 0], [0, 30, 0]]
REFUSED = {
    "no loops": ([], "no loop"),
    "flat list": ([[1, 2, 3]], "loop 0 is not a list of"),
    "ragged": ([[[0, 0, 0], [1, 0], [1, 1, 0]]], "loop 0 is not a list of"),
    "words": ([[["a", 0, 0], [1, 0, 0], [1, 1, 0]]], "part: loop 0: a coordinate cannot be 'a'"),
    "empty loop": ([SQUARE, []], "loop 1"),
    "nan": ([[[0, 0, 0], [nan, 0, 0], [1, 1, 0]]], "loop 0, segment 1 has a coordinate or bulge"),
    "inf": (
        [SQUARE, [[10, 10, 0], [20, 10, 0], [20, 20, inf]]],
        "loop 1, segment 2 has a coordinate or bulge",
    ),
    "two lines": ([[[0, 0, 0], [10, 0, 0]]], "too few segments"),
    "one vertex": ([[[0, 0, 1]]], "too few segments"),
    "zero length": (
        [[[0, 0, 0], [40, 0, 0], [40, 0, 0], [0, 40, 0]]],
        "segment 1 has zero length at (40, 0)",
    ),
    "closing point repeated": ([[*SQUARE, [0, 0, 0]]], "segment 4 has zero length at (0, 0)"),
    "line crosses line": ([STAR], "segment 0 and part: loop 0, segment 2 cross or touch at (20, 15)"),
    "line crosses arc": (
        [[[0, 0, 0], [40, 0, -1.5], [40, 10, 0], [0, 40, 0], [5, 2, 0], [-5, 2, 0]]],
        "cross or touch",
    ),
    "arc crosses line": ([[[0, 0, 0], [40, 0, 0], [40, 20, 0.9], [0, 20, 0], [10, 45, 0]]], "cross or touch"),
    "arc crosses arc": (
        [[[0, 0, -0.9], [40, 0, 0], [40, 20, -0.9], [0, 20, 0]]],
        "segment 0 and part: loop 0, segment 2",
    ),
    "touches at a vertex": (
        [[[0, 0, 0], [40, 0, 0], [40, 40, 0], [20, 0, 0], [0, 40, 0]]],
        "touch at (20, 0)",
    ),
    "vertex visited twice": (
        [[[0, 0, 0], [20, 20, 0], [40, 0, 0], [40, 40, 0], [20, 20, 0], [0, 40, 0]]],
        "touch at (20, 20)",
    ),
    "spike": ([[[0, 0, 0], [40, 0, 0], [60, 0, 0], [40, 0, 0], [40, 40, 0]]], "cross or touch"),
    "folds back on itself": ([[[0, 0, 0], [40, 0, 0], [20, 0, 0], [20, 30, 0]]], "cross or touch"),
    "overlapping collinear edges": (
        [[[0, 0, 0], [40, 0, 0], [40, 10, 0], [30, 10, 0], [30, 0, 0], [10, 0, 0], [10, 20, 0], [0, 20, 0]]],
        "cross or touch",
    ),
    "hole outside": ([SQUARE, moved(HOLE, 60, 0)], "loop 1, at (70, 10), lies outside the outer loop"),
    "outer loop second": ([HOLE, SQUARE], "lies outside the outer loop"),
    "hole around": ([SQUARE, moved(SQUARE, -20, -20, 3)], "lies outside the outer loop"),
    "hole in a hole": (
        [SQUARE, HOLE, disc(15, 15, 2)],
        "loop 2, at (13, 15), lies inside the hole of loop 1",
    ),
    "hole around a hole": (
        [SQUARE, disc(15, 15, 2), HOLE],
        "loop 1, at (13, 15), lies inside the hole of loop 2",
    ),
    "hole crosses outer": (
        [SQUARE, moved(HOLE, 25, 0)],
        "loops must stay apart from each other; trim both where they cross, or leave one out",
    ),
    "holes cross": ([SQUARE, HOLE, disc(20, 15, 3)], "loop 1, segment 1 and part: loop 2, segment"),
    "hole touches outer": ([SQUARE, [[0, 20, 0], [10, 15, 0], [10, 25, 0]]], "cross or touch at (0, 20)"),
    "round hole touches outer": ([SQUARE, disc(5, 20, 5)], "cross or touch at (0, 20)"),
    "hole shares an edge": ([SQUARE, [[10, 0, 0], [20, 0, 0], [20, 10, 0]]], "cross or touch"),
    "the same circle twice": ([SQUARE, disc(20, 20, 5), disc(20, 20, 5)], "cross or touch"),
    "there and back on one arc": ([[[0, 0, 0.5], [40, 0, -0.5]]], "part: loop 0"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case):
    """Each forbidden outline has its own message, which names the part and the place."""
    loops, words = REFUSED[case]
    with pytest.raises(InputError) as refusal:
        part(*loops)
    assert words in str(refusal.value)
    assert str(refusal.value).startswith("part")


def test_labels_name_segments_in_messages():
    """A segment's label (its name in a drawing) stands in the message."""
    with pytest.raises(InputError, match=r"segment 0 \(LINE 2F\) and .* \(LINE 31\)"):
        part(STAR, labels=[["LINE 2F", "a", "LINE 31", "b"]])


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.0, 2.5])
@pytest.mark.parametrize("radius", [0.5, 3.0, 12.345])
@pytest.mark.parametrize("digits", [6, 9, 15])
def test_tangent_joined_outlines_are_accepted(turn, radius, digits):
    """Rounded rectangles and obrounds, whose neighbours touch at their joints to within rounding, are parts."""
    outline = [
        [round(v, digits) for v in vertex]
        for vertex in moved(rounded_rectangle(60, 40, radius), 7, -3, 1, turn)
    ]
    assert len(part(outline).faces) == 8
    obround = [[0, 0, 0], [30, 0, 1], [30, 2 * radius, 0], [0, 2 * radius, 1]]
    obround = [[round(v, digits) for v in vertex] for vertex in moved(obround, 40, 40, 1, turn)]
    assert len(part(obround).faces) == 4
    slotted = part(moved(SQUARE, -60, -60, 4), obround, moved(rounded_rectangle(60, 40, 5), -50, -50))
    assert len(slotted.loops) == 3


def test_chains_of_tangent_arcs_are_accepted():
    """An S of arcs that continue each other's tangent, and a thin crescent."""
    b = tan(radians(40) / 4)
    wave = [[0, 0, b], [20, 0, -b], [40, 0, b], [60, 0, 0], [60, 30, 0], [0, 30, 0]]
    assert len(part(wave).faces) == 6
    assert len(part([[0, 0, 0.5], [40, 0, -0.45]]).faces) == 2


@pytest.mark.thorough
@given(
    outlines(),
    st.sampled_from([(0.02, 0, 0), (30.0, 0, 0), (1.0, 1e4, -1e4), (20.0, -1e4, 1e4), (0.01, 1e3, 0)]),
)
def test_size_and_place_do_not_matter(piece, change):
    """From half a millimetre to two metres and 14 m from the origin: the same part, scaled."""
    scale, dx, dy = change
    again = part(*(moved(loop.tolist(), dx, dy, scale) for loop in piece.loops))
    assert len(again.faces) == len(piece.faces)
    for one, two in zip(again.faces, piece.faces, strict=True):
        assert one.segment.length == pytest.approx(scale * two.segment.length, rel=1e-6)
        assert one.segments == two.segments


@pytest.mark.parametrize(
    ("loops", "words"),
    [
        (np.zeros((2, 4, 3)), "segment 0 has zero length"),
        (np.zeros((2, 3, 4)), "loop 0 is not a list of .x, y, bulge. numbers"),
        (np.zeros((4, 3)), "loop 0 is not a list of .x, y, bulge. numbers"),
        (np.zeros((0, 4, 3)), "has no loop"),
        (5, "has no list of loops"),
        (None, "has no list of loops"),
    ],
)
def test_loops_of_another_form_are_refused(loops: Any, words: str) -> None:
    """Arrays of all dimensions, and what is not a list."""
    with pytest.raises(InputError, match=words):
        Workpiece.from_loops("part", loops)


def test_loops_may_be_an_array() -> None:
    """Of three dimensions, where all have as many segments."""
    loops = np.array([[[0, 0, 0], [40, 0, 0], [40, 40, 0]], [[30, 10, 0], [34, 10, 0], [34, 14, 0]]])
    assert len(Workpiece.from_loops("part", loops).segments) == 6


def test_bands_follow_loops_that_are_turned_round() -> None:
    """Loops that are run the wrong way are turned, and each band stays with its segment."""
    square = [[0, 0, 0], [0, 4, 0], [4, 4, 0], [4, 0, 0]]
    bands = [(0.0, 1.0), (0.0, 2.0), None, (0.0, 4.0)]
    solid = SolidOutline("z", 5.0, 4.0, 0.5, 1.0, bands, [[0], [1], [], [3]])
    part = Workpiece.from_loops("square", [square], solid=solid)
    assert part.solid is not None
    by_middle = {segment.middle: band for segment, band in zip(part.segments, part.solid.bands, strict=True)}
    assert by_middle == {(0, 2): (0, 1), (2, 4): (0, 2), (4, 2): None, (2, 0): (0, 4)}
    assert [part.solid.bands[face.number] for face in part.faces if face.number in part.untouchable] == [None]
    with pytest.raises(InputError, match="4 segments and 3 bands"):
        Workpiece.from_loops("square", [square], solid=evolve(solid, bands=bands[:3], faces=()))
