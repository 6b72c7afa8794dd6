"""Nothing that cuts is lost: where the tip is stays known, and a cut at a place that is not known is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program_examples import HEAD, read_text, shapes

from workhold import Program
from workhold.errors import InputError
from workhold.files.program.reader import read_program_with_calls

TOOLS = {1: 10.0, 2: 8.0}
START = HEAD + "G0 X0. Y0. Z20.\n"
# Behind a beginning at X0 Y0 Z20, line 3: the line of a cut that is refused, and why.
LOST = {
    "G28 G91 Z0.\nG90\nG1 X50. F100\n": (
        6,
        "line 4 goes to a place of the machine's own, and Z is not named",
    ),
    "G28\nG90\nG0 Z5.\nG1 Z-5. F100\n": (7, "X and Y are not named after it: write X and Y with G0"),
    "G30 G91 Y0.\nG90 G1 Z-5. F100\n": (5, "Y is not named after it"),
    "G53 G0 Z0.\nX5. Y5.\nG1 X50. F100\n": (6, "Z is not named after it"),
    "G53 G0 X0. Y0.\nG0 X9.\nG1 Z-5. F100\n": (6, "Y is not named after it"),
    "G53 G0 X0. Y0.\nG1 X9. Y9. F100\n": (5, "X and Y are not named after it"),
    "T2 M6\nG43 H2\nG1 X50. F100\n": (
        6,
        "line 5 changes the tool's length (G43), and Z is not named after it",
    ),
    "G43 H1\nG1 X50. Z-5. F100\n": (5, "Z is not named after it"),
    "G43 H1 Z5.\nG49\nG1 X50. F100\n": (6, "Z is the height of the spindle's nose after G49"),
    "G43 H1 Z5.\nG49\nG0 Z5.\nG1 X50. F100\n": (7, "Z is the height of the spindle's nose after G49"),
    "G43 H1 Z5.\nG49\nG1 Z-5. F100\n": (6, "write G43 with H and Z before it"),
    "G43 H1 Z5.\nG43 H0\nG0 Z5.\nG1 Z-5. F100\n": (7, "spindle's nose"),
    "G43 H1 Z5.\nG49\nG81 X5. Z-5. R2. F100\n": (6, "a drill cycle begins at a height .*spindle's nose"),
    "G53 G0 Z0.\nG81 X5. Z-5. R2. F100\n": (5, "a drill cycle begins at a height"),
    "G53 G0 X0.\nG81 Y5. Z-5. R2. F100\n": (5, "a hole is drilled at a place .* X is not named after it"),
    "G81 X5. Z-5. R2. F100\nG28 G91 Z0.\nG90 X20.\n": (6, "a drill cycle begins at a height"),
    "G53 G0 Z0.\nG2 X5. I2.5 F100\n": (5, "an arc begins at a place"),
    "G53 G0 Y0.\nG3 X5. Y0. R9. F100\n": (5, "an arc begins at a place"),
    "G28 G91 Z0.\nG1 Z-5. F100\n": (5, "Z is an increment"),
    "G28 G91 X0.\nG1 X5. F100\n": (5, "X is an increment"),
    "G53 G1 Z0. F100\n": (4, "G53 with G1 cuts its way"),
    "G1 F100\nG53 Z0.\n": (5, "G53 with G1 cuts its way"),
}


@pytest.mark.parametrize("text", LOST)
def test_a_cut_at_a_place_that_is_not_known_is_refused(tmp_path: Path, text: str) -> None:
    """With its line, why the place is not known, and what helps."""
    line, words = LOST[text]
    with pytest.raises(InputError, match=f"line {line}: .*{words.replace('(G43)', '.G43.')}"):
        read_text(tmp_path, START + text, tools=TOOLS)


@pytest.mark.parametrize(
    ("text", "line", "axes"),
    [
        ("G0 Z5.\nG1 Z-8. F100\nX60.\n", 4, "X and Y are"),
        ("G0 X5. Z5.\nG1 Z-8. F100\n", 4, "Y is"),
        ("G1 X5. Y5. Z-8. F100\n", 3, "X, Y and Z are"),
        ("G0 X5. Y5.\nG1 X9. Z-8. F100\n", 4, "Z is"),
        ("G0 X5. Y5. Z9.\nM30\n%\nG1 X9.\n", 0, ""),
    ],
)
def test_a_start_is_asked_for_where_the_program_begins_to_cut(
    tmp_path: Path, text: str, line: int, axes: str
) -> None:
    """In the words of Python here; with it the cut is read."""
    if line:
        with pytest.raises(InputError, match=rf"line {line}: .*{axes} not named before.*start=\(x, y, z\)\."):
            read_text(tmp_path, HEAD + text)
    program = read_text(tmp_path, HEAD + text, start=(1, 2, 30))
    assert program.moves.start[0].tolist() == [1.0, 2.0, 30.0]
    assert program.notes[
        -1
    ] == "The tip starts at X1 Y2 Z30 mm, as given." and program.moves.cutting.any() == (line > 0)


def test_a_start_that_is_none_is_refused(tmp_path: Path) -> None:
    """It has three lengths."""
    for start in ((1, 2), (1, 2, float("nan")), (1, 2, 1e300), "abc"):
        with pytest.raises(InputError, match="start of the program"):
            read_text(tmp_path, START, start=start)


def test_places_stay_over_changes_of_tools_and_stops(tmp_path: Path) -> None:
    """NISTIR 6556: X, Y and Z are what they were over M6, M0 and M1; all may be left away or repeated."""
    text = HEAD + "G0 X-12. Y2. Z5.\nG1 Z-1. F100\nG0 Z5.\n{stop}{again}G1 Z-8. F100\nG1 X70.\nG0 Z5.\nM30\n"
    for stop, tool in (("T2 M6\n", 2), ("M0\n", 1), ("M1\n", 1), ("T2\nM1\nM6\n", 2)):
        read = read_text(tmp_path, text.format(stop=stop, again=""), tools=TOOLS)
        repeated = read_text(tmp_path, text.format(stop=stop, again="G0 X-12. Y2. Z5.\n"), tools=TOOLS)
        cuts = [one for one in shapes(read.pieces) if one[0] == "cut"]
        assert cuts == [one for one in shapes(repeated.pieces) if one[0] == "cut"]
        assert cuts[-1][1:4] == (tool, ((-12.0, 2.0, 0.0), (70.0, 2.0, 0.0)), (-8.0, -8.0))


def test_a_tool_length_ends_what_is_known_of_the_height_alone(tmp_path: Path) -> None:
    """With Z only the end of the move counts; the same length again changes nothing, and is not a length at all."""
    text = (
        HEAD
        + "G0 X5. Y2. Z20.\nG43 H1 Z20.\nG1 Z-1. F100\n{again}X70.\nT2 M6\nG0 X9.\nG43 H2 Z20.\nG1 Z-8. F100\n"
    )
    read = read_text(tmp_path, text.format(again=""), tools=TOOLS)
    assert read.moves.end.tolist() == [
        [5, 2, 20],
        [5, 2, 20],
        [5, 2, -1],
        [70, 2, -1],
        [9, 2, -1],
        [9, 2, 20],
        [9, 2, -8],
    ]
    assert "Lines 3, 4 and 9: the tool comes from a place" in read.notes[0]
    same = read_text(tmp_path, text.format(again="G43 H1\n"), tools=TOOLS)
    assert shapes(same.pieces) == shapes(read.pieces)


def test_without_tool_lengths_g49_changes_nothing(tmp_path: Path) -> None:
    """As at the head of most programs, and as FreeCAD repeats it."""
    read = read_text(tmp_path, START + "G49\nG1 Z-5. F100\nG43 H0\nX5.\n")
    assert read.moves.end.tolist() == [[0, 0, 20], [0, 0, -5], [5, 0, -5]]


def test_travel_of_the_nose_is_left_out_and_said(tmp_path: Path) -> None:
    """Until a length is in force again."""
    read = read_text(
        tmp_path, HEAD + "G49 G0 X5. Y5.\nZ50.\nG43 H1 Z9.\nG1 X9. F100\nG0 Z20.\nX30.\nG49 Z-8.\nX50.\n"
    )
    assert read.moves.end.tolist() == [[5, 5, 9], [9, 5, 9], [9, 5, 20], [30, 5, 20]]
    assert read.skipped == (4, 9)
    assert "Lines 4 and 9: after G49 a height is that of the spindle's nose" in "\n".join(read.notes)
    assert "Lines 3 and 10: a rapid move while X, Y or Z is not known is left out" in "\n".join(read.notes)


def test_a_plunge_from_a_height_that_is_not_known_is_where_it_arrives(tmp_path: Path) -> None:
    """Straight down nothing of the plane is lost."""
    read = read_text(tmp_path, HEAD + "G0 X5. Y2.\nG1 Z-3. F100\nX9.\n")
    assert read.moves.end.tolist() == [[5, 2, -3], [9, 2, -3]] and read.moves.cutting.all()
    assert (
        "Line 4: the tool comes from a place" in read.notes[0]
        and "Line 3: a rapid move while" in read.notes[1]
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "G0 X0. Y0.\nG55\nG0 Z5.\nG1 X5. F100\n",
            "line 6: .*line 4 changes to another zero, and X and Y are",
        ),
        (
            "G54.1 P1\nG0 X0. Y0. Z5.\nG54.1 P2\nG1 X5. F100\n",
            "line 6: G54.1 P2 comes after moves in G54.1 P1",
        ),
        ("G154 P1.5\n", r"P1\.5 is not the number of a zero"),
        ("G0 X0. Y0. Z5.\nG92.1\nG92 X5.\n", "line 5: G92 sets another zero"),
        ("G92 X0. Y0. Z5.\nG1 X5. F100\nG92.1\n", "line 5: G92.1 sets another zero"),
        ("G92 X0. Y0. Z5.\nG92 X9.\n", "line 4: G92 sets another zero"),
        ("G0 X5.\nG92 X0. Y0. Z5.\n", "line 4: G92 sets another zero"),
        ("G0 X0. Y0. Z5.\nG52 X0. Y1.\n", "line 4: G52 sets another zero"),
    ],
)
def test_places_of_one_zero_are_none_of_another(tmp_path: Path, text: str, words: str) -> None:
    """What was named from G54 says nothing from G55."""
    with pytest.raises(InputError, match=words):
        read_text(tmp_path, HEAD + text)


@pytest.mark.parametrize(
    "zero",
    ["G54.1 P3", "G54.1", "G154 P12", "G54 P2", "G110", "G55", "G52 X0 Y0. Z0.", "G92.1", "G54 G64 P0.02"],
)
def test_extended_zeros_are_read_as_the_zero(tmp_path: Path, zero: str) -> None:
    """One of them all through; so is a shift by nothing, and taking back what was never set."""
    text = "G0 X10. Y10. Z20.\nG1 Z-1. F100\nX40.\n"
    plain, read = (read_text(tmp_path, HEAD + one + text) for one in ("", zero + "\n"))
    assert shapes(read.pieces) == shapes(plain.pieces)


def test_g92_at_the_start_says_where_the_tip_stands(tmp_path: Path) -> None:
    """Its zero is the program's."""
    read = read_text(tmp_path, HEAD + "G92 X0. Y0. Z5.\nG1 Z-1. F100\nX40.\n")
    assert read.moves.start[0].tolist() == [0, 0, 5] and read.moves.end[-1].tolist() == [40, 0, -1]
    assert "Line 3: G92 says where the tip stands" in "\n".join(read.notes)


@pytest.mark.parametrize("unit", ["G20", "G21"])
def test_a_program_without_heights_is_refused_by_its_cut(tmp_path: Path, unit: str) -> None:
    """As for a laser; a height of the machine's own is none. With a start it is read at that height."""
    text = f"{unit} G90\nM3 S0\nG53 Z0.\nG0 X5. Y5.\nG1 X65. F1500 S400\nY45.\nM5\nM2\n".replace(
        "G53", "G53 G0"
    )
    with pytest.raises(InputError, match=r"line 5: .* no height \(Z\) is given anywhere in the program"):
        read_text(tmp_path, text)
    with pytest.raises(InputError, match="there is no move in it whose height is known, as no height"):
        read_text(tmp_path, text.replace("G1 ", ""))
    high = text.replace("G53 G0 Z0.\n", "")
    assert set(read_text(tmp_path, high, start=(0, 0, -2)).moves.end[:, 2].tolist()) == {-2.0}


def test_moves_before_the_first_tool_are_left_out_and_cuts_refused(tmp_path: Path) -> None:
    """A safe retract first is not a call of T0; number 0 of the table is the tool that is in the spindle."""
    text = "G21 G90\nG0 X0. Y0. Z12.\nT2 M6\nG0 X10.\nG1 Z-2. F200\n"
    read = read_text(tmp_path, text, tools={2: 6.0})
    assert read.moves.tool.tolist() == [2, 2] and read.moves.start[0].tolist() == [0, 0, 12]
    assert "Line 2: a rapid move before any tool is called is left out." in read.notes
    assert not any("from a place" in note for note in read.notes)
    assert read_text(tmp_path, text, tools={0: 4.0, 2: 6.0}).moves.tool.tolist() == [0, 2, 2]
    for first, words in (
        ("", "no tool has been called"),
        ("T1\n", "no tool has been called"),
        ("T0 M6\n", "T0 is in"),
    ):
        cut = text.replace("T2", f"{first}G1 X5. F100\nT2")
        with pytest.raises(
            InputError, match=rf"line {3 + first.count(chr(10))}: the tool cuts while {words}.*tool\.0 = "
        ):
            read_text(tmp_path, cut, tools={1: 5.0, 2: 6.0})


@pytest.mark.parametrize("unit", ["G20", "G21"])
def test_whole_numbers_may_be_thousandths(tmp_path: Path, unit: str) -> None:
    """Of lengths, with their signs; codes, tools, speeds, feeds, turns, repeats and times are what they are."""
    size = 10000 if unit == "G20" else 1000
    text = f"{unit} G90 G17\nT1 M6\nS3000 M3\nG0 X{{0}} Y-{{1}} Z+{{0}}\nG1 Z-{{1}} F200\nG4 X2\nG4 P500\n"
    text += "G2 X{0} Y{1} R{1}\nG3 X{0} Y-{1} J-{1} P2\nG0 Z{0}\nG83 X{1} R{1} Z-{0} Q{1} K2\nG80\n"
    pointed = read_text(tmp_path, text.format("2.", "1."))
    whole = read_text(tmp_path, text.format(2 * size, size), whole_numbers="thousandths")
    assert shapes(whole.pieces) == shapes(pointed.pieces)
    assert (whole.moves.feed.tolist(), whole.moves.spindle.tolist()) == (
        pointed.moves.feed.tolist(),
        pointed.moves.spindle.tolist(),
    )
    asked, left = "\n".join(whole.notes), "\n".join(read_text(tmp_path, text.format("2", "1")).notes)
    digit, inches = ("0.0001 inch", "inches") if unit == "G20" else ("0.001 mm", "mm")
    assert f"No length of the program has a decimal point; they are read as multiples of {digit}" in asked
    assert f"No length of the program has a decimal point; they are read as whole {inches}" in left
    assert not any("decimal point" in note for note in pointed.notes)
    mixed = read_text(tmp_path, text.format("2.", "1"))
    assert "Lines 4, 5, 8, 9 and 11: lengths without a decimal point, where others have one" in "\n".join(
        mixed.notes
    )


def test_zeros_need_no_decimal_point(tmp_path: Path) -> None:
    """0 is 0 in any unit; how whole numbers count is one of two ways."""
    coarse = read_text(tmp_path, HEAD + "G64 P0.02 Q0.02\nG4 X1.5\nG0 X5 Y0 Z0\n")
    assert "No length of the program has a decimal point" in "\n".join(coarse.notes)
    read = read_text(tmp_path, HEAD + "G0 X0 Y0 Z0\nG1 X5.5 F200\n")
    assert not any("decimal point" in note for note in read.notes)
    with pytest.raises(InputError, match="whole numbers of a program count units or thousandths"):
        read_text(tmp_path, START, whole_numbers="tenths")


@pytest.mark.parametrize(
    "line",
    [
        *(
            "G05.1 Q1",
            "G5.1 Q1 R5",
            "G05.1 Q0",
            "G5 P10000",
            "G05 P0",
            "G08 P1",
            "G61.1",
            "G61",
            "G64 P0.02 Q0.01",
        ),
        *(
            "G187 P2 E0.05",
            "G187",
            "G103 P1",
            "G103",
            "G04 P1",
            "G4 X1.5",
            "G04 U2.",
            "G9",
            "G62",
            "M88",
            "M31",
        ),
        *("M19", "M19 R90.", "M29 S500", "M13", "M51", "M117", "M62 P1", "M66 P0 L3 Q5", "G05.1 Q1 G61.1"),
    ],
)
def test_what_tells_nothing_of_the_path_is_passed_over_and_listed(tmp_path: Path, line: str) -> None:
    """How a control looks ahead and rounds, dwells, and functions of the machine."""
    cut = "G1 Z-3. F200\nX40.\n"
    plain, read = (read_text(tmp_path, START + one + cut) for one in ("", line + "\n"))
    assert shapes(read.pieces) == shapes(plain.pieces)
    first = line.replace("G0", "G").split()[0]
    assert any(note.startswith("Line 4: ") and first in note and "passed over" in note for note in read.notes)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        *(("G5 X5. I1. J1. P1 Q1", "spline"), ("G5.1 X5. I2. J2.", "spline"), ("G5 P10010", "spline")),
        *(
            ("M97 P100", "subprogram"),
            ("M98 P1000", "subprogram"),
            ("M99", "subprogram"),
            ("M198 P1", "subprogram"),
        ),
        *(
            ("M96 P10 Q1", "jumps"),
            ("M16 T2", "write M6"),
            ("M61 Q2", "write M6"),
            ("M72", "brings codes back"),
        ),
        *(
            ("G81 F100", "G81 stands without X, Y, Z or R"),
            ("G83 Q2.", "G83 stands without"),
            ("G76 X5. Z-5.", "cycle"),
        ),
        *(
            ("X5. U2.", "U moves a fourth axis"),
            ("G91 A90.", "A moves a fourth"),
            ("B45.", "B moves a fourth"),
        ),
    ],
)
def test_what_does_more_is_refused(tmp_path: Path, line: str, words: str) -> None:
    """Splines, subprograms, jumps, tools that come in other ways, cycles without a place, axes that turn."""
    with pytest.raises(InputError, match=f"line 4: .*{words}"):
        read_text(tmp_path, START + line + "\nG0 X1.\n")


def test_a_cycle_drills_where_the_tool_is_if_it_names_a_depth(tmp_path: Path) -> None:
    """Z or R alone drill on every control; a cycle's code alone does not, and is refused."""
    text = START + "G81 Z-5. R2. F100\nG80\n"
    assert shapes(read_text(tmp_path, text).pieces) == shapes(
        read_text(tmp_path, text.replace("G81", "G81 X0 Y0")).pieces
    )


@pytest.mark.parametrize("cycle", ["G84", "G74", "G85", "G86", "G89 P1"])
def test_tapping_and_boring_are_their_moves(tmp_path: Path, cycle: str) -> None:
    """Down at the feed, and up at the feed but for G86, where the spindle stands still."""
    text = f"G0 X0. Y0. Z20.\nG99 {cycle} X10. Z-12. R2. F80\nX20.\nG80\n"
    up = "G0" if cycle == "G86" else "G1"
    holes = "".join(f"G0 X{x}.\nZ2.\nG1 Z-12. F80\n{up} Z2.\n" for x in (10, 20))
    found, expected = (
        [one[:4] for one in shapes(read_text(tmp_path, HEAD + one).pieces)]
        for one in (text, "G0 X0. Y0. Z20.\n" + holes)
    )
    assert found == expected


def test_rotary_axes_that_stay_are_said(tmp_path: Path) -> None:
    """At one value all through, also where it is named at the head alone, or goes home at the end."""
    text = HEAD + "G0 X23. Y9.6 Z10. {0}\nG1 Z-2. F200\nX40. {0}\nG0 Z10.\nG91 G28 Z0. A0.\nM30\n"
    plain = read_text(tmp_path, text.format("").replace("A0.", ""))
    for words, said in (("A0.", "A at 0"), ("B-90. C12.5", "B at -90 and C at 12.5")):
        read = read_text(tmp_path, text.format(words))
        assert shapes(read.pieces) == shapes(plain.pieces)
        assert f"A fourth axis stays where it is all through ({said}), and turns nothing." in read.notes
    for turned in ("A0.\nA90.\nG1", "A0.\nG91 A5.\nG90 G1", "\nG0 A90.\nG1"):
        with pytest.raises(InputError, match=r"A moves a fourth axis"):
            read_text(tmp_path, text.format("").replace("\nG1", turned + "\nG1"))
    with pytest.raises(InputError, match="cuts while A is at a place of the machine's own"):
        read_text(tmp_path, HEAD + "G0 X23. Y9.6 Z10. A0.\nG28 G91 A0.\nG90 G1 Z-2. F200\n")


def test_the_end_behind_a_switch_is_refused_where_more_follows(tmp_path: Path) -> None:
    """What stands behind it would be cut with the switch on."""
    cut = "G1 Z-3. F200\nX40.\n"
    with pytest.raises(InputError, match=r"line 4: a switch .* decides whether the program ends here"):
        read_text(tmp_path, START + "/M30\n" + cut)
    assert len(read_text(tmp_path, START + cut + "/M30\n%\n").moves) == 3


def test_the_places_of_a_file_are_those_of_the_text(tmp_path: Path) -> None:
    """The form of a result has no more keys than before, and a start is not part of it."""
    head = read_text(tmp_path, START + "G1 X5. F100\n", start=(0, 0, 50)).make_head()
    assert set(head) == {
        *("name", "sha256", "unit", "zero", "z_zero", "clearance", "rapid", "tools", "skipped", "notes")
    }


def test_a_program_of_two_tools_is_that_of_places_written_out(tmp_path: Path) -> None:
    """Leaving axes away that are known changes nothing of what cuts, at any heights."""
    path = tmp_path / "a.nc"
    short = "G21 G90 G71 G54\nT1 M6\nG0 X40. Y-3.\nG43 H1 Z20.\nG1 Z2. F100\nG0 Z20.\n"
    short += "T2 M6\nG0 X-5.\nG43 H2 Z20.\nG1 Z-9. F100\nX85.\nG0 Z20.\nM30\n"
    path.write_text(short)
    read = read_program_with_calls(path, TOOLS, z_zero=12.0).program
    path.write_text(short.replace("X-5.", "X-5. Y-3."))
    long: Program = read_program_with_calls(path, TOOLS, z_zero=12.0).program
    assert shapes(read.list_swept_pieces(0, 6)) == shapes(long.list_swept_pieces(0, 6))
    low = read.moves.cutting & (read.moves.end[:, 2] < 4)
    assert np.ptp(read.moves.end[low, 0]) == 90.0


def test_what_sets_no_zero_takes_no_cut(tmp_path: Path) -> None:
    """A place beside G92.1 is refused, and the motion of such a block stays in force."""
    with pytest.raises(InputError, match=r"line 4: G92\.1 and a place"):
        read_text(tmp_path, START + "G92.1 G1 X50.\n")
    for zero in ("G92.1", "G52 X0 Y0"):
        plain, read = (read_text(tmp_path, START + one + "X50. Z-3.\n") for one in ("G1\n", f"{zero} G1\n"))
        assert shapes(read.pieces) == shapes(plain.pieces)


def test_a_length_may_come_before_any_tool(tmp_path: Path) -> None:
    """G43 without H takes the length of what is in the spindle."""
    read = read_text(tmp_path, "G21 G90\nG0 G43 Z5.\nX0 Y0\nG1 X5. F100\n")
    assert read.moves.line.tolist() == [3, 4]


def test_the_second_place_of_the_machine_has_a_number(tmp_path: Path) -> None:
    """G30 P2 goes there, and the height is not known."""
    with pytest.raises(InputError, match=r"line 5: .*line 4 goes to a place of the machine's own"):
        read_text(tmp_path, START + "G91 G30 P2 Z0\nG90 G1 X5. F100\n")


def test_a_word_for_the_machines_own_places_without_an_axis_moves_none(tmp_path: Path) -> None:
    """G53 alone goes nowhere, as G28 alone goes home with all of them."""
    read = read_text(tmp_path, START + "G53 G0\nG1 Z-5. F100\n")
    assert read.moves.end.tolist() == [[0, 0, 20], [0, 0, -5]]


def test_an_axis_that_comes_back_from_the_machines_own_place_may_cut(tmp_path: Path) -> None:
    """To where it stood before."""
    cut = "G90 G0 A0.\nG1 Z-2. F200\n"
    read = read_text(tmp_path, HEAD + "G0 X23. Y9.6 Z10. A0.\nG28 G91 A0.\n" + cut)
    assert read.moves.end[-1].tolist() == [23, 9.6, -2]


def test_the_length_of_the_tool_in_the_spindle_is_no_others(tmp_path: Path) -> None:
    """G43 takes it without H too."""
    for length, is_noted in (("", False), (" H1", False), (" H2", True)):
        read = read_text(tmp_path, START + f"G43{length} Z20.\n")
        assert any("takes the length of another tool" in note for note in read.notes) == is_noted


def test_a_cycle_after_another_goes_back_to_the_height_before_both(tmp_path: Path) -> None:
    """G98 is the height at which the first of them began."""
    read = read_text(tmp_path, START + "G99 G81 X5. Z-5. R2. F100\nG98 G82 X9. Z-5. R2. P1\nG80\n")
    assert read.moves.end[-1].tolist() == [9, 0, 20]


def test_g92_behind_a_circle_from_a_given_start_sets_another_zero(tmp_path: Path) -> None:
    """Though nothing has named X, Y or Z so far."""
    with pytest.raises(InputError, match="line 4: G92 sets another zero"):
        read_text(tmp_path, HEAD + "G2 I5. F100\nG92 X1.\n", start=(0, 0, -1))
