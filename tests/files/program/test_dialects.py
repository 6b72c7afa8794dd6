"""Programs in the manner of posts and machinists: what is read of each stands here, reckoned by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program_examples import PROGRAMS

from workhold import Program
from workhold.errors import InputError
from workhold.model.program_figures import measure_tools

# Moves, lines left out, and the cutting length of each tool in mm.
QUARTER = np.pi / 2 * 6
HELIX = 4 * np.hypot(np.pi * 5, 1.5)
READ = {
    "haas.nc": (28, (8, 32, 48, 49), {1: 4 + 13 + 40 + 60 + 40 + 60 + 5 * QUARTER, 3: 4 * 19}),
    "fanuc.nc": (24, (7, 24, 38, 39), {2: 3 + HELIX + 20 + 1.5 * np.pi * 5, 5: 4 * 22}),
    "grbl.nc": (7, (6,), {1: 2 + 3 + 2 * np.pi + 19.05}),
    "freecad_linuxcnc.ngc": (13, (), {17: 5 + 2 * np.hypot(np.pi * 3, 0.5) + 2 * 7}),
    "freecad_grbl.ngc": (8, (), {3: 4.6 + 2 * 1.5 * np.pi + 57 + 23}),
    "linuxcnc.ngc": (
        9,
        (),
        {1: 25.4 * (0.225 + 1.5 + np.pi + np.hypot(np.pi / 2, 0.125) + 0.5)},
    ),
    "mach3.tap": (14, (), {4: 12 + 2 * 5 * np.pi + 20 + 2 * 6}),
    "estlcam.nc": (8, (), {0: 0.5 + 2 * np.hypot(np.pi * 4, 1.5) + 8 * np.pi}),
    "vectric.tap": (7, (), {1: 8 + 40 + np.pi / 2 * 3}),
    "mastercam.nc": (12, (18, 19, 28), {4: 5 + 50, 9: 2 * 2 * 17}),
    "hsmworks_haas.nc": (18, (7, 22, 35), {2: 7 + 40 + 2 * (2 + 30 + 2 + 30), 6: 2 * 12}),
    "increments.nc": (26, (), {7: 5 * 12 + 5 + 5 * np.pi / 2 + 5 * 1.5 * np.pi}),
}


@pytest.mark.parametrize("name", READ)
def test_a_program_is_read(name: str) -> None:
    """Every line of it."""
    tools = {3: 6.0} if name == "freecad_grbl.ngc" else dict.fromkeys((0, 1, 4, 7, 9, 17), 6.0)
    given = None if name in ("haas.nc", "fanuc.nc", "grbl.nc", "hsmworks_haas.nc") else tools
    program = Program.read(PROGRAMS / name, given, z_zero=0)
    moves, skipped, cutting = READ[name]
    assert program.skipped == skipped
    assert {one.tool: one.cutting for one in measure_tools(program)} == pytest.approx(cutting)
    assert len(program.moves) == moves


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("heidenhain.h", "line 1: this is Heidenhain's plain language"),
        ("siemens.mpf", "line 2: .*tools as numbers"),
    ],
)
def test_other_languages_are_refused_plainly(name: str, words: str) -> None:
    """With what to post instead."""
    with pytest.raises(InputError, match=words):
        Program.read(PROGRAMS / name, {1: 6.0}, z_zero=0)


def test_comments_in_a_western_encoding_are_passed_over(tmp_path: Path) -> None:
    """A program from a Windows computer, with a byte order mark or without."""
    text = (PROGRAMS / "haas.nc").read_text()
    plain = Program.read(PROGRAMS / "haas.nc", z_zero=0)
    for encoding in ("cp1252", "utf-8", "utf-8-sig"):
        path = tmp_path / "haas.nc"
        path.write_bytes(text.replace("Contour1", "Außenkontur Ø6").replace("\n", "\r\n").encode(encoding))
        assert Program.read(path, z_zero=0).pieces == plain.pieces


def test_a_comment_with_another_at_its_end_is_one(tmp_path: Path) -> None:
    """Wherever a control ends it, the same words are left."""
    path = tmp_path / "p.nc"
    found = []
    for comment in ("", "(slot at (5, 7.5) )", "(((slot)))", "(a) (T1 D=6 (carbide))"):
        path.write_text(f"G21 G90\nT1 M6\nG0 X0 Y0 Z5\n{comment}\nG1 {comment} X9 {comment} F90\nM30\n")
        found.append(Program.read(path, {1: 6.0}, z_zero=0).pieces)
    assert found[1:] == [found[0]] * 3


@pytest.mark.parametrize("plane", ["G18", "G19"])
@pytest.mark.parametrize(
    "text",
    [
        "{plane}\nG1 X10 F200\nZ-2\nY5 Z0\nG0 Z5\n",
        "{plane} G1 X10 F200\nZ-2\nY5 Z0\nG17\nG0 Z5\n",
        "G1 {plane} X10 F200\nG17 Z-2\nG2 X10 Y0 I-1 J0\n",
        "{plane}\nG1 X10 F200\nG17\nG98 G81 X5 Y5 Z-3 R1\nG80\n",
    ],
)
def test_another_plane_without_an_arc_in_it_changes_nothing(tmp_path: Path, plane: str, text: str) -> None:
    """As Fusion's lead-ins write it: the plane counts where an arc or a cycle stands, and nowhere else."""
    path = tmp_path / "plane.nc"
    head = "G21 G90 G17\nT1 M6\nG0 X0 Y0 Z5\n"
    found = []
    for word in (plane, "G17"):
        path.write_text(head + text.format(plane=word))
        found.append(Program.read(path, {1: 6.0}, z_zero=0).pieces)
    assert found[0] == found[1] and len(found[0]) > 3


@pytest.mark.parametrize(
    ("line", "plane"), [("G18 G3 X19 Z-1 I-1 K0. F40.", "18"), ("G19\nG2 Y1 Z-1 J1 K0", "19")]
)
def test_a_lead_in_along_an_upright_arc_is_refused_with_what_helps(
    tmp_path: Path, line: str, plane: str
) -> None:
    """Fusion's vertical lead-in: its line, and the setting that posts it otherwise."""
    path = tmp_path / "lead.nc"
    path.write_text(f"G21 G90 G17\nT1 M6\nG0 X20 Y0 Z5\nG0 Z0\n{line}\nG17\n")
    at = 5 + line.count("\n")
    with pytest.raises(
        InputError, match=rf"line {at}: an arc stands in the plane G{plane}: .*vertical lead-in"
    ):
        Program.read(path, {1: 6.0}, z_zero=0)


def test_questions_to_grbl_move_nothing(tmp_path: Path) -> None:
    """grbl's own lines, v1.1 "Commands": $I, $G, $$, $# and ? report, $X unlocks, $H goes to the machine's ends."""
    plain = "G21 G90\nG0 X0 Y0 Z5\nG1 Z-1 F100\nX20\nG0 Z5\n"
    path = tmp_path / "program.nc"
    path.write_text("$I ; build\n$g\n$$\n$#\n$N\n$X\n?\n" + plain)
    read = Program.read(path, {0: 6.0}, z_zero=0)
    assert len(read.moves) == 4 and any(
        "Lines 1, 2, 3, 4, 5 and 2 more: a question" in one for one in read.notes
    )
    path.write_text("$H\n" + plain)
    read = Program.read(path, {0: 6.0}, z_zero=0)
    assert read.skipped == (1,) and len(read.moves) == 4
    # After the machine's own ends nobody knows where the tip is.
    path.write_text(plain + "$H\nG1 X40\n")
    with pytest.raises(InputError, match=r"line 7: .*line 6 goes to a place of the machine's own"):
        Program.read(path, {0: 6.0}, z_zero=0)


@pytest.mark.parametrize("peck", ["G83 X9 Y9 Z-5 R1", "G83 X9 Y9 Z-5 R1 Q0.", "G73 X9 Y9 Z-5 R1 Q0."])
def test_pecks_of_no_depth_drill_the_same_hole(tmp_path: Path, peck: str) -> None:
    """Fusion's post for Mach3 writes Q0. for full depth; what a drill sweeps is the same with every Q."""
    start = "G21 G90\nG0 X0 Y0 Z5\n"
    path = tmp_path / "program.nc"
    moves = []
    for cycle in (peck, "G81 X9 Y9 Z-5 R1"):
        path.write_text(f"{start}{cycle} F100\nX20\nG80\nG0 Z9\n")
        read = Program.read(path, {0: 6.0}, z_zero=0)
        moves.append(np.hstack([read.moves.start, read.moves.end, np.c_[read.moves.cutting]]))
        assert any("Lines 3 and 4: peck drilling has no depth" in one for one in read.notes) == (
            cycle == peck
        )
    np.testing.assert_array_equal(*moves)
