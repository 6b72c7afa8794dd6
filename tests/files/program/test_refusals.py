"""What cannot be read is refused in one sentence with the line's number; nothing is guessed, and what is taken is noted."""

from __future__ import annotations

from pathlib import Path

import pytest
from attrs import evolve
from program_examples import HEAD, MILL, read_text

from workhold import Program
from workhold.errors import InputError
from workhold.files.budget import LIMITS
from workhold.files.program.reader import read_program_with_calls

START = HEAD + "G0 X0 Y0 Z20\n"
# What stands in line 4 behind a beginning that moves, and a word of the sentence about it.
LINES = {
    "G41 D1 X5": "radius that only the control knows",
    "G42 X5": "radius that only the control knows",
    "G68 R30": "turns, mirrors or scales",
    "G16": "turns, mirrors or scales",
    "G10 L2 P1 X0": "another zero",
    "G92 X0": "another zero",
    "G52 X5": "another zero",
    "G65 P9000": "subprogram",
    "M98 P1000": "subprogram",
    "M99": "subprogram",
    "G87 X5 Z-5 R2": "a cycle that is not read",
    "G76 X5 Z-5 R2": "a cycle that is not read",
    "G38.2 Z-5": "probes",
    "G5.1 X5 Y5": "spline",
    "G71": "G20 or G21",
    "G70 G90": "G20 or G21",
    "G71 G90 I5. J2. L4": "G20 or G21",
    "G12.3": "G12.3 is not known",
    "M96 P5": "jumps to another line",
    "M16": "write M6",
    "G2 X10 Y0": "no centre",
    "G2 X10 Y0 I4": "begins 4.0000 mm from its centre and ends 6.0000 mm",
    "G2 X0 Y0 R5": "ends where it begins",
    "G2 X10 Y0 R4.9": "more than twice its radius",
    "G2 X10 Y0 R5 I5": "R, and I, J or P besides",
    "G2 X10 Y0 I5 K1": "another plane",
    "G18 G2 X10 Z5 I5 K5": "plane G18",
    "G2 I5 P1.5": "not a number of turns",
    "G2 I0 J0": "from its centre",
    "G90.1 G2 X10 Y0 I5": "both I and J",
    "G81 X5 Z-5": "no R",
    "G81 X5 R2": "no Z",
    "G83 X5 Z-5 R2 Q-1": "below 0",
    "G73 X5 Z-5 R2 Q-1": "below 0",
    "$100=250": "speaks to the control",
    "$H X5": "speaks to the control",
    "G81 X5 Z5 R2": "above the plane R",
    "G81 X5 Z-5 R25": "below its plane R",
    "G81 X5 Z-5 R2 L0": "repeated 0 times",
    "G81 X5 Z-5 R2 L2 K2": "both L and K",
    "G18 G81 X5 Z-5 R2": "plane G18",
    "G0 G81 X5 Z-5 R2": "stand in one block",
    "G4 G1 X5": "stand in one block",
    "G4 P1 G2 X5 R5": "stand in one block",
    "G53 G2 X5 Y5 R5": "G0 or G1",
    "G0 G1 X5": "only one can be",
    "G90 G91 X5": "only one can be",
    "G20 G21": "only one can be",
    "X5 X6": "X stands twice",
    "X5 A90": "fourth axis",
    "C45": "fourth axis",
    "X5 Q1": "Q belongs to a drill cycle",
    "R5": "R belongs to an arc",
    "D1": "D belongs to G41",
    "H1 X5": "H belongs to G43",
    "X5 E2": "take it out",
    "T1.5 M6": "not a tool",
    "T-1": "not a tool",
    "F-5": "below 0",
    "X#100": "variables",
    "#100=5": "variables",
    "X[5+5]": "variables",
    "IF [#1 EQ 0] GOTO 10": "variables",
    "o100 sub": "subprogram",
    "o<drill> call": "subprogram",
    "L X+10 Y+5 R0 FMAX": "Heidenhain",
    "CYCLE81(10,0,2,-5)": "Siemens",
    "X": "no number behind its letter",
    "X 5 G": "'G' has no number",
    "X1.2.3": "is not a word|no number",
    "X5,R2": "',R2' is not a word",
    "X1e5 Y2": "take it out",
    "5 X": "is not a word",
    "X5 (open": "comment is not closed",
    "X5 (a (b) c)": "another within",
    "X5 ) Y": "comment is not closed",
    "X5 % Y5": "cannot stand within a line",
    "X2000000": "beyond",
    "X" + "9" * 400: "too large",
    "(5) X5 :": "is not a word",
    "X5 " * 800: "characters",
    "Z5 I3": "I belongs to an arc",
    "N5 N6 N7 X5": "N stands twice",
}


@pytest.mark.parametrize("line", LINES)
def test_a_line_is_refused_by_its_number(tmp_path: Path, line: str) -> None:
    """The number stands behind the file's name, and what follows is one sentence that says what helps."""
    with pytest.raises(InputError, match=LINES[line]) as caught:
        read_text(tmp_path, START + line + "\nG0 X1\n")
    words = str(caught.value)
    assert words.startswith(f"{tmp_path / 'program.nc'}: line 4: ")
    assert words.endswith(".") and "\n" not in words and ": " in words.split("line 4: ")[1]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no move"),
        ("%\n(nothing)\n%\n", "no move"),
        ("G21 G90\nT1 M6\nM30\nG0 X0 Y0 Z0\n", "no move"),
        ("G90\nT1 M6\nG0 X1 Y1 Z1\n", "line 3: a length stands before G20"),
        ("G21 G91\nT1 M6\nG0 X1 Y1 Z1\nG1 X1 Y1 Z1\n", "line 4: X is an increment"),
        ("G21 G91\nT1 M6\nG0 X1 Y1 Z1\n", "no move"),
        ("G21 G90\nT1 M6\nX1 Y1 Z1\n", "line 3: a place stands without G0"),
        ("G21 G90\nT1 M6\nG2 X1 Y1 I1\n", "line 3: an arc begins at a place"),
        ("G21 G90\nT1 M6\nG0 X1 Y1\nG81 Z-1 R2\n", "line 4: a drill cycle begins at a height"),
        ("G21 G90\nT1 M6\nG0 Z9\nG81 Y1 Z-1 R2\n", "line 4: a hole is drilled at a place"),
        ("G21 G90\nM6\nG0 X1 Y1 Z1\n", "line 2: M6 changes to a tool that no T"),
        ("G21 G90\nT1 M6\nG0 X0 Y0 Z0\nG55\nX5\n", "line 5: G55 comes after moves in G54"),
        ("G21\nT1 M6\nG90 G0 X0 Y0 Z9\nG91 G99 G81 X1 R-2 Z-9\nX1\n", "line 5: .* increments"),
        ("G21 G90\nT1 M6\nG0 X0 Y0 Z9\nG81 X1 R2 Z-9\nG82 X2\n", "line 5: .* no R"),
        ("a\0b", "not text"),
    ],
)
def test_what_is_not_told_is_refused(tmp_path: Path, text: str, words: str) -> None:
    """Units, places, heights and zeros that the program leaves open."""
    with pytest.raises(InputError, match=words):
        read_text(tmp_path, text)


def test_files_that_are_none_are_refused(tmp_path: Path) -> None:
    """No file, a folder, one that is too large."""
    for path, words in ((tmp_path / "none.nc", "no file of that name"), (tmp_path, "not a file")):
        with pytest.raises(InputError, match=words):
            Program.read(path, {1: MILL}, z_zero=0)
    large = tmp_path / "large.nc"
    with large.open("wb") as stream:
        stream.truncate(64_000_001)
    with pytest.raises(InputError, match="64 MB, more than"):
        Program.read(large, {1: MILL}, z_zero=0)


def test_too_many_moves_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cycle that repeats does not fill the memory."""
    monkeypatch.setitem(LIMITS, "program", evolve(LIMITS["program"], most_elements=100))
    with pytest.raises(InputError, match=r"line 4: the file has more than the 100 moves.*: split it"):
        read_text(tmp_path, START + "G91 G81 X1 R-18 Z-5 L9000\n")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"z_zero": "top"}, "give its thickness"),
        ({"z_zero": "top", "thickness": -2}, "give its thickness"),
        ({"z_zero": "middle"}, "z_zero is not a height"),
        ({"z_zero": float("nan")}, "z_zero is not a height"),
        ({"unit": "cm"}, "mm or inch"),
        ({"zero": (float("inf"), 0)}, "zero of the program is not a place"),
        ({"clearance": -1.0}, "clearance"),
        ({"rapid": "curved"}, "straight or box"),
    ],
)
def test_where_it_runs_is_checked(tmp_path: Path, options: dict[str, object], words: str) -> None:
    """Heights, zeros and units that are none."""
    with pytest.raises(InputError, match=words):
        read_text(tmp_path, START, **options)


def test_a_unit_is_given_where_the_program_says_none(tmp_path: Path) -> None:
    """And what the program says wins over it."""
    text = "G90\nT1 M6\nG0 X1 Y1 Z1\nG1 X2 F5\n"
    assert read_text(tmp_path, text, unit="inch").moves.end[-1][0] == 50.8
    assert read_text(tmp_path, "G21\n" + text, unit="inch").moves.end[-1][0] == 2.0


def test_what_is_left_out_or_taken_is_noted(tmp_path: Path) -> None:
    """Lines that go home, that a switch can leave out, without a feed, behind the end; G90, M6 and lengths."""
    text = (
        "G21\nT1\nG53 G0 Z0\nG0 X0 Y0\nZ20\nG1 X5\n/G28 G91 Z0\nG90 G0 X1 Y1 Z1\nG30\n"
        "G28 X5 Y5\nG0 X7 Y7 Z7\nM30\nrest\n"
    )
    read = read_text(tmp_path, text, tools={1: 6.0})
    notes = "\n".join(read.notes)
    assert read.skipped == (3, 7, 9, 10)
    for words in (
        "Lines 5, 8 and 11: the tool comes from a place",
        "Lines 3, 7, 9 and 10: a move to a place of the machine's own",
        "has no M6",
        "Line 7: a line that a switch can leave out",
        "Line 6: a cutting move has no feed",
        "Line 13: the lines behind the end",
        "The holder of T1 is not known",
    ):
        assert words in notes
    unsaid = read_text(tmp_path, "G21\nT1 M6 G43 H2\nG0 X0 Y0 Z0\n")
    assert "does not say G90 or G91" in unsaid.notes[1] and "Line 2: G43 takes the length" in unsaid.notes[2]
    assert len(read_text(tmp_path, START.replace("20", "20.")).notes) == 1


def test_home_is_reached_by_way_of_the_place_that_is_written(tmp_path: Path) -> None:
    """G28 passes its place, which is a move over the part; only the axes that it names are lost afterwards."""
    program = read_text(tmp_path, START + "G28 X40 Z30\nG0 Z20\nX10\nG28\nG0 X0 Y0 Z5\n")
    ends = program.moves.end.tolist()
    assert ends == [[0, 0, 20], [40, 0, 30], [10, 0, 20], [0, 0, 5]]
    assert program.moves.line.tolist() == [3, 4, 6, 8] and program.skipped == (4, 7)
    assert not program.moves.cutting.any()


def test_a_change_of_tool_keeps_its_place_and_is_counted(tmp_path: Path) -> None:
    """NISTIR 6556; a tool that is in the spindle already is not changed."""
    path = tmp_path / "a.nc"
    path.write_text(START + "T2\nX5\nM6\nX9 Y9\nZ3\nT2 M6\nX1\n")
    read = read_program_with_calls(path, {1: 6, 2: 8}, z_zero=0)
    assert read.calls == ((2, 1), (6, 2)) and read.lines == 11
    moves = read.program.moves
    assert moves.tool.tolist() == [1, 1, 2, 2, 2] and moves.line.tolist() == [3, 5, 7, 8, 10]
    assert moves.start[2].tolist() == [5, 0, 20] and moves.end[2].tolist() == [9, 9, 20]


def test_a_rapid_move_in_increments_from_nowhere_leads_nowhere(tmp_path: Path) -> None:
    """As at the head of many programs; what it does not move is known all the same, and places are from then on."""
    program = read_text(tmp_path, HEAD + "G0 X5 Y6\nG91 G0 X2 Z15\nG90 G0 Z9\nG4 P.1 G0 X1\n")
    assert program.moves.end.tolist() == [[7, 6, 9], [1, 6, 9]]
    assert program.skipped == (4,) and "Line 4: a rapid move in increments" in program.notes[1]
