"""Subprograms of a file are read where they are called, as if they were written out there."""

from __future__ import annotations

from pathlib import Path

import pytest
from program_examples import read_text, shapes

from workhold.errors import InputError

HEAD = "%\nO1\nG21 G90\nT1 M6\nG0 X0 Y0\nZ5.\n"
HOLE = "G91 G1 Z-7. F100\nX5.\nG0 Z7.\nG90\n"
# A program with calls, and the same written out.
WRITTEN_OUT = {
    "M98": (f"M98 P100\nG0 X20.\nM98 P100\nM30\nO100\n{HOLE}M99\n%\n", f"{HOLE}G0 X20.\n{HOLE}"),
    "L": (f"M98 P100 L3\nM30\nO0100 (HOLE)\n{HOLE}M99\n", HOLE * 3),
    "Fanuc's short form": (f"M98 P30100\nM30\nO0100\n{HOLE}M99\n", HOLE * 3),
    "M97": (f"G90 M97 P1000 L2\nM30\nN1000\n{HOLE}M99\n", "G90\n" + HOLE * 2),
    "nested": (
        "M98 P2\nG0 Y9.\nM30\nO2\nG1 X5. F1\nM98 P3\nG1 X7.\nM99\nO3\nG1 Y5.\nM99\n",
        "G1 X5. F1\nG1 Y5.\nG1 X7.\nG0 Y9.\n",
    ),
    "a cycle": (
        "G81 X1. Y1. Z-3. R2. F1\nM98 P2\nM30\nO2\nX5.\nX9. M99\n",
        "G81 X1. Y1. Z-3. R2. F1\nX5.\nX9.\n",
    ),
    "words beside the call": ("G91 M98 P2\nG90\nM30\nO2\nG1 X5. F1\nX5.\nM99\n", "G91\nG1 X5. F1\nX5.\n"),
    "ten deep": (
        "M98 P2\nM30\n"
        + "".join(f"O{k}\nM98 P{k + 1}\nM99\n" for k in range(2, 11))
        + "O11\nG1 X5. F1\nM99\n",
        "G1 X5. F1\n",
    ),
    "an end inside, behind a switch": ("M98 P2\nM30\nO2\nG1 X5. F1\n/M30\n", "G1 X5. F1\n"),
    "an end inside": ("M98 P2\nG1 X9.\nM30\nO2\nG1 X5. F1\nM30\n", "G1 X5. F1\n"),
}


@pytest.mark.parametrize("name", WRITTEN_OUT)
def test_a_call_is_what_it_calls(tmp_path: Path, name: str) -> None:
    """The same pieces, each from the line of the subprogram."""
    called, written = WRITTEN_OUT[name]
    read = read_text(tmp_path, HEAD + called)
    lines = (HEAD + called).splitlines()
    assert shapes(read.pieces) == shapes(read_text(tmp_path, HEAD + written).pieces)
    assert all("M98" not in lines[line - 1] for line in read.moves.line.tolist())
    assert not any("behind the end" in note for note in read.notes)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("M98 P2\nM30\nO2\nM98 P2\nM99\n", 10, "more than 10 deep"),
        (
            "M98 P2\nM30\n" + "".join(f"O{k}\nM98 P{k + 1}\nM99\n" for k in range(2, 12)) + "O12\nM99\n",
            37,
            "more than 10 deep",
        ),
        ("M98 P2\nM30\n", 7, "calls the subprogram O2, which is not in this file"),
        ("M97 P2\nM30\nO2\nM99\n", 7, "calls the subprogram N2, which is not"),
        ("M98 L2\nM30\n", 7, "without its number P"),
        ("M98 P2 L0\nM30\nO2\nM99\n", 7, "runs O2 0 times"),
        ("M98 P2 L1.5\nM30\nO2\nM99\n", 7, "runs O2 1.5 times"),
        ("M98 P30100 L2\nM30\nO100\nM99\n", 7, "calls the subprogram O30100, which is not in this file"),
        ("M98 P2 M30\nO2\nM99\n", 7, "in a block with a move, a tool change or the end"),
        ("T1\nM6 M98 P2\nM30\nO2\nM99\n", 8, "a tool change"),
        ("M98 P2\nM30\nO2\nG1 X5. F1\n", 7, "without an end: write M99"),
        ("M98 P2\nM30\nO2\nG1 X5. F1\nO3\nM99\n", 7, "without an end: write M99"),
        ("M98 P2\nM30\nO2\nM99\nO2\nM99\n", 7, "more than once"),
        ("X5. M98 P2\nM30\nO2\nM99\n", 7, "in a block with a move"),
        ("M6 T1 M98 P2\nM30\nO2\nM99\n", 7, "a tool change"),
        ("G1 X5. F1\nM99\n", 8, "outside of a subprogram"),
        ("M98 P2\nM30\nO2\nM99 P5\n", 10, "goes on at another block"),
        ("M98 P2\nM30\nO2\n/M99\nG1 X5. F1\nM99\n", 10, "switch"),
        ("M98 P2\n/M30\nG1 X5. F1\nO2\nM99\n", 8, "switch"),
        ("M98 P2\nM30\nO2\nX5. A90.\nM99\n", 10, "fourth axis"),
    ],
)
def test_what_is_not_a_plain_subprogram_is_refused(tmp_path: Path, text: str, line: int, words: str) -> None:
    """With the line of the call, or of the block in the subprogram."""
    with pytest.raises(InputError, match=f": line {line}: .*{words}"):
        read_text(tmp_path, HEAD + text)


@pytest.mark.thorough
def test_calls_in_calls_end(tmp_path: Path) -> None:
    """Repeats of repeats come to more blocks than a program may have."""
    calls = "".join(f"M98 P{number} L9999\nM99\nO{number}\n" for number in range(3, 7))
    with pytest.raises(InputError, match=r"line \d+: the file has more than the 2,000,000 moves, or blocks"):
        read_text(tmp_path, f"{HEAD}M98 P2 L9999\nM30\nO2\n{calls}F1\nM99\n")


def test_a_subprogram_that_is_not_called_is_not_read(tmp_path: Path) -> None:
    """Its lines are noted."""
    read = read_text(tmp_path, HEAD + "M98 P2\nM30\nO2\nG1 X5. F1\nM99\nO3\nG1 X9.\nM99\n")
    assert 13 not in read.moves.line
    assert any(note.startswith("Line 13: the lines behind the end") for note in read.notes)
