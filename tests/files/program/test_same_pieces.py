"""A program written in two ways sweeps the same pieces; expected ones are written down by hand where they can be."""

from __future__ import annotations

from math import cos, pi, sin, tan
from pathlib import Path

import numpy as np
import pytest
from program_examples import HEAD, MILL, read_text, shapes

from workhold import Program

CUT = "G0 X10 Y5 Z20\nG0 Z2\nG1 Z-3 F200\nX40\nY25.5\nG0 Z20\nM30\n"


def same(folder: Path, one: str, other: str) -> Program:
    """Checks that two texts sweep the same, and returns the first program."""
    first, second = read_text(folder, one), read_text(folder, other)
    assert shapes(first.pieces) == shapes(second.pieces)
    return first


def test_the_pieces_are_those_of_the_text(tmp_path: Path) -> None:
    """Each move, with each cylinder, in order; the first positioning is its end alone."""
    program = read_text(tmp_path, HEAD + CUT)
    flutes = [piece for piece in program.pieces if piece.radius == 5.0]
    assert [(one.line, one.kind, one.path, one.tip) for one in flutes] == [
        (3, "rapid", ((10.0, 5.0, 0.0),), (20.0, 20.0)),
        (4, "rapid", ((10.0, 5.0, 0.0),), (20.0, 2.0)),
        (5, "cut", ((10.0, 5.0, 0.0),), (2.0, -3.0)),
        (6, "cut", ((10.0, 5.0, 0.0), (40.0, 5.0, 0.0)), (-3.0, -3.0)),
        (7, "cut", ((40.0, 5.0, 0.0), (40.0, 25.5, 0.0)), (-3.0, -3.0)),
        (8, "rapid", ((40.0, 25.5, 0.0),), (-3.0, 20.0)),
    ]
    assert [one.heights for one in program.pieces[:2]] == [(0.0, 30.0), (30.0, 70.0)]
    assert len(program.pieces) == 12 and program.skipped == ()
    assert "Line 3: the tool comes from a place that the program does not say" in program.notes[0]


def test_increments_are_the_places_that_they_lead_to(tmp_path: Path) -> None:
    """G91, and back to G90; sums of increments are not off by their rounding."""
    increments = "G0 X10 Y5 Z20\nG91 Z-18\nG1 Z-5 F200\nX30\nY20.5\nG0 Z23\nM30\n"
    same(tmp_path, HEAD + CUT, HEAD + increments)
    steps = HEAD + "G0 X0 Y0 Z0\nG91\n" + "G1 X0.1 F100\n" * 30
    assert read_text(tmp_path, steps).pieces[-2].path[1] == (3.0, 0.0, 0.0)


def test_an_inch_is_254_tenths_of_a_millimetre(tmp_path: Path) -> None:
    """Places, arcs by their centres, radii, drill cycles and feeds."""
    metric = (
        HEAD + "G0 X25.4 Y12.7 Z5.08\nG1 Z-2.54 F254\nG2 X50.8 Y12.7 I12.7 J0\nG3 X25.4 R12.7\n"
        "G0 Z5.08\nG83 X76.2 Y0 Z-10.16 R2.54 Q1\nM30\n"
    )
    inches = (
        "G20 G90 G17\nT1 M6\nG0 X1. Y.5 Z.2\nG1 Z-.1 F10\nG2 X2 Y.5 I.5 J0\nG3 X1. R.5\n"
        "G0 Z.2\nG83 X3 Y0 Z-.4 R.1 Q.04\nM30\n"
    )
    same(tmp_path, metric, inches)
    exact = read_text(tmp_path, "G20 G90\nT1 M6\nG0 X1.5 Y.1 Z0\n")
    assert exact.moves.end.tolist() == [[38.1, 2.54, 0.0]]
    feeds = [read_text(tmp_path, text).moves.feed for text in (metric, inches)]
    assert np.allclose(*feeds) and feeds[0].max() == 254.0
    assert read_text(tmp_path, inches).unit == "inch"


@pytest.mark.parametrize(
    ("centre", "radius"),
    [
        ("G2 X20 Y10 I10 J0", "G2 X20 Y10 R10"),
        ("G3 X20 Y10 I10 J0", "G3 X20 Y10 R10"),
        ("G3 X10 Y20 I10 J0", "G3 X10 Y20 R-10"),
        ("G2 X10 Y20 I10 J0", "G2 X10 Y20 R10"),
        ("G2 X10 Y20 I0 J10 Z-4", "G2 X10 Y20 Z-4 R-10"),
        ("G90.1\nG2 X20 Y10 I10 J10", "G2 X20 Y10 R10"),
    ],
)
def test_an_arc_by_its_radius_is_that_by_its_centre(tmp_path: Path, centre: str, radius: str) -> None:
    """Below and above half a turn, both ways, and as a helix."""
    start = HEAD + "G0 X0 Y10 Z0\n"
    one, other = (
        read_text(tmp_path, start + text + " F100\n").list_swept_pieces(-9, 9) for text in (centre, radius)
    )
    first = np.array([piece.path for piece in one if len(piece.path) == 2])
    second = np.array([piece.path for piece in other if len(piece.path) == 2])
    assert first.shape == second.shape and np.allclose(first, second, atol=1e-9)


def test_arcs_turn_the_way_they_say(tmp_path: Path) -> None:
    """A quarter to the left is a positive bulge of tan(22.5°), to the right a negative one."""
    left = read_text(tmp_path, HEAD + "G0 X10 Y0 Z0\nG3 X0 Y10 I-10 F100\n").pieces[-2]
    assert left.path[0][:2] == (10.0, 0.0) and left.path[0][2] == pytest.approx(tan(pi / 8))
    right = read_text(tmp_path, HEAD + "G0 X0 Y10 Z0\nG2 X10 Y0 J-10 F100\n").pieces[-2]
    assert right.path[0][2] == pytest.approx(-tan(pi / 8))
    most = read_text(tmp_path, HEAD + "G0 X10 Y0 Z0\nG2 X0 Y10 I-10 F100\n")
    sweep = 4 * np.arctan(most.moves.bulge).sum()
    assert sweep == pytest.approx(-3 * pi / 2) and np.abs(most.moves.bulge).max() <= 1.0


def test_a_full_circle_is_two_halves_and_a_helix_of_turns_goes_down_evenly(tmp_path: Path) -> None:
    """The end of a circle is its start; P counts turns, and each half turn takes its share of the height."""
    circle = read_text(tmp_path, HEAD + "G0 X10 Y0 Z0\nG3 I-10 F100\n")
    halves = [piece for piece in circle.pieces if piece.kind == "cut" and piece.radius == 5.0]
    assert [one.path[0][2] for one in halves] == pytest.approx([1.0, 1.0])
    assert halves[0].path[1][:2] == pytest.approx((-10.0, 0.0)) and halves[1].path[1][:2] == (10.0, 0.0)
    turns = read_text(tmp_path, HEAD + "G0 X10 Y0 Z0\nG2 X10 Y0 Z-6 I-10 P3 F100\n")
    cut = turns.moves.end[turns.moves.cutting]
    assert np.allclose(cut[:, 2], -np.arange(1, 7))
    assert np.allclose(turns.moves.length[turns.moves.cutting].sum(), np.hypot(3 * 2 * pi * 10, 6))
    written = read_text(tmp_path, HEAD + "G0 X10 Y0 Z0\n" + "G2 I-10 Z-2 F100\nI-10 Z-4\nI-10 Z-6\n")
    assert np.allclose(written.moves.end, turns.moves.end)


def test_feeds_are_along_the_path_in_mm_a_minute(tmp_path: Path) -> None:
    """By the minute (G94), by the turn of the spindle (G95); the inverse time of G93 is not counted."""
    text = HEAD + "G0 X0 Y0 Z0 S2000\nG94 G1 X1 F300\nG95 G1 X2 F0.1\nG93 G1 X3 F5\nG94 X4 F90\n"
    assert read_text(tmp_path, text).moves.feed.tolist() == [0.0, 300.0, 200.0, 0.0, 90.0]


HOLES = "X10 Y5", "X20", "Y15"


def drilled(first: str, back: float, plane: float, bottom: float) -> str:
    """The moves of holes written out."""
    text = ""
    for place in HOLES:
        text += f"G0 {place}\nZ{plane}\nG1 Z{bottom} F80\nG0 Z{back}\n"
    return HEAD + first + text


@pytest.mark.parametrize(("mode", "back"), [("G98", 20.0), ("G99", 2.0)])
@pytest.mark.parametrize("cycle", ["G81", "G82 P0.5", "G83 Q3", "G73 Q3."])
def test_a_drill_cycle_is_its_moves(tmp_path: Path, cycle: str, mode: str, back: float) -> None:
    """Over each hole, down to R, at the feed to Z, and up to where it began or to R; until G80."""
    start = "G0 X0 Y0 Z20\n"
    text = (
        HEAD + start + f"{mode} {cycle} {HOLES[0]} Z-12 R2 F80\n" + f"{HOLES[1]}\n{HOLES[2]}\nG80\nG0 X0 Y0\n"
    )
    same(tmp_path, text, drilled(start, back, 2.0, -12.0) + "G0 X0 Y0\n")


def test_a_cycle_in_increments_makes_a_row(tmp_path: Path) -> None:
    """R counts from where it begins, Z from R, and L or K repeat the step."""
    written = (
        HEAD
        + "G0 X0 Y0 Z20\n"
        + "".join(f"G0 X{10 * k} Y{5 * k}\nZ2\nG1 Z-10 F80\nG0 Z20\n" for k in (1, 2, 3))
    )
    for times in ("L3", "K3"):
        same(tmp_path, HEAD + f"G0 X0 Y0 Z20\nG91 G81 X10 Y5 R-18 Z-12 F80 {times}\nG80\n", written)


def test_depths_of_a_cycle_stay_in_force_and_change(tmp_path: Path) -> None:
    """A block that gives Z or R alone changes it; G0 ends the cycle, and after G80 the motion before goes on."""
    text = HEAD + "G0 X0 Y0 Z20\nG81 X10 Z-5 R2 F80\nX20 Z-7\nX30 R4\nG80 X0 Z30\n"
    written = (
        HEAD
        + "G0 X0 Y0 Z20\n"
        + "".join(
            f"G0 X{x}\nZ{r}\nG1 Z{z} F80\nG0 Z20\n" for x, z, r in ((10, -5, 2), (20, -7, 2), (30, -7, 4))
        )
    )
    same(tmp_path, text, written + "G0 X0 Z30\n")


@pytest.mark.parametrize("offset", ["G54", "G55", "G59", "G59.3"])
def test_any_zero_is_the_zero(tmp_path: Path, offset: str) -> None:
    """Which zero of the control a program names says nothing of where it lies on the part."""
    same(tmp_path, HEAD + CUT, HEAD + offset + "\n" + CUT)


def test_zero_and_height_shift_the_pieces(tmp_path: Path) -> None:
    """X0 Y0 goes to the zero; Z0 to the part's top, its bottom or a height."""
    text = HEAD + CUT
    plain = read_text(tmp_path, text).moves
    for z_zero, thickness, up in (("top", 12.0, 12.0), ("bottom", None, 0.0), (3.5, None, 3.5)):
        moved = read_text(tmp_path, text, zero=(7.0, -2.0), z_zero=z_zero, thickness=thickness)
        assert np.allclose(moved.moves.end - plain.end, [7.0, -2.0, up])
        assert (moved.zero, moved.z_zero) == ((7.0, -2.0), up)


@pytest.mark.parametrize(
    "text",
    [
        HEAD + CUT.replace("M30", "(M30)") + "%\nthis is behind the end\n",
        "%\n" + HEAD + CUT.replace("M30", "") + "%\nX99\n",
        "g21g90g17\nt1m6\ng0x10y5z20\ng0z2\ng1z-3f200\nx40\ny25.5\ng0z20\nm30\n",
        "G21 G90 G17\nM6 T1\nX10. Z+20. G00 Y5\nG00 Z2.\nF200 Z-3.0 G01\nX+40\nY25.50\nZ20 G0\nM02\n",
        "%\nO1 (A)\nN10 G21 G90 G17 (x) T1 M6\nN20 G0 X10 Y 5 Z20 ; to the part\n\nN30 Z2\n(G1 X99)\nG1\tZ-3 F200\n"
        "X40 N40\nY25.5\nG40 G49 G0 Z20\nM5 M9\nM30\n%\nX99\n",
        "G21 G90 G17\r\nT1 M6\r\nG0 X10 Y5 Z20\r\nG0 Z2\r\nG1 Z-3 F200\r\nX40\r\nG4 P1\r\nG4 X2.5\r\nY25.5\r\nG0 Z20\r\n",
        "G21 G90 G17\nT1 M6\nG0 X10 Y5 Z20\nG0 Z2\nG1 Z-3 F200\nX40\n/Y25.5\nG53 G0 Z0\nG90 G0 X40 Y25.5 Z20\n",
    ],
)
def test_the_manner_of_writing_does_not_count(tmp_path: Path, text: str) -> None:
    """Small letters, no spaces, any order, numbers and ends of lines, remarks, block numbers, dwells."""
    expected, found = (shapes(read_text(tmp_path, one).pieces) for one in (HEAD + CUT, text))
    if "G53" in text:
        # The way up comes from nowhere here: only its end counts.
        assert found[:-2] == expected[:-2] and found[-2][2:4] == (((40.0, 25.5, 0.0),), (20.0, 20.0))
    else:
        assert found == expected


def test_a_helix_is_its_chords_within_their_height(tmp_path: Path) -> None:
    """Cut at any heights, the axis of a helix is nowhere farther from that of its chords than an arc from a chord."""
    count = 90
    angles = [2 * pi * k / count for k in range(count + 1)]
    chords = "".join(
        f"G1 X{20 * cos(a):.6f} Y{20 * sin(a):.6f} Z{-10 * a / (2 * pi):.6f} F100\n" for a in angles[1:]
    )
    helix = read_text(tmp_path, HEAD + "G0 X20 Y0 Z0\nG3 X20 Y0 Z-10 I-20 F100\n", tools={1: MILL})
    lines = read_text(tmp_path, HEAD + "G0 X20 Y0 Z0\n" + chords, tools={1: MILL})
    sagitta = 20 * (1 - cos(pi / count))
    for low, high in ((-9.0, -7.5), (-4.0, -3.999), (23.0, 24.0)):
        one = {
            tuple(np.round(point, 2))
            for piece in helix.list_swept_pieces(low, high)
            for point in along_path(piece)
        }
        other = {
            tuple(np.round(point, 2))
            for piece in lines.list_swept_pieces(low, high)
            for point in along_path(piece)
        }
        for near, far in ((one, other), (other, one)):
            away = np.array(list(near))[:, None] - np.array(list(far))[None]
            assert np.sqrt((away**2).sum(axis=2)).min(axis=1).max() < sagitta + 0.4


def along_path(piece: object) -> np.ndarray:
    """Points along the path of a piece, some 0.3 mm apart."""
    from workhold.model.moves import compute_path_points

    path = np.array(piece.path)  # type: ignore[attr-defined]
    if len(path) == 1:
        return path[:, :2]
    count = 2 + int(np.hypot(*(path[1] - path[0])[:2]) / 0.3) * 2
    share = np.linspace(0, 1, count)
    start, end = (np.repeat(path[k : k + 1, :2], count, axis=0) for k in (0, 1))
    return compute_path_points(start, end, np.full(count, path[0, 2]), share)
