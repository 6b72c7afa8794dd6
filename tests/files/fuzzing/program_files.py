"""Programs of mills, some of their words replaced, doubled or missing."""

from __future__ import annotations

import random
from pathlib import Path

__all__ = ["FILES"]

FOLDER = Path(__file__).parents[2] / "data" / "programs"
PROGRAMS = [
    path.read_bytes().decode("latin-1")
    for path in sorted(FOLDER.iterdir())
    if path.suffix in (".nc", ".ngc", ".tap")
]
WORDS = (
    *("G0", "G1", "G2", "G3", "G17", "G20", "G21", "G28", "G40", "G41", "G43 H1", "G49", "G54", "G68", "G80"),
    *(
        "G81 R2 Z-5",
        "G83 Z-5 R2 Q0",
        "G83 Z-5 R2 Q1e-9",
        "G90",
        "G91",
        "G92 X0",
        "G98",
        "M3",
        "M6 T1",
        "M98 P1",
        "M99",
    ),
    *(
        "X1e308",
        "X-",
        "X.",
        "X" + "9" * 400,
        "Z-1.5",
        "I0 J0",
        "R0",
        "R-1e9",
        "P999999",
        "L100000",
        "#1=2",
        "(T1 D=6.",
        ")",
    ),
    *(
        "%",
        "/",
        "O100",
        "N" + "1" * 3000,
        "\x00",
        "\x1b[2J",
        "\u202e",
        "T999999999",
        "F0",
        "A0.",
        "IF [1 EQ 1] GOTO 5",
    ),
)


def make_program(chance: random.Random) -> bytes:
    """A part of a program that other tests read."""
    lines = chance.choice(PROGRAMS).splitlines()
    first = chance.randrange(max(1, len(lines) - 60))
    lines = lines[:20] + lines[max(first, 20) : first + 60]
    for _ in range(chance.randrange(5)):
        at = chance.randrange(len(lines))
        words = lines[at].split()
        match chance.randrange(4):
            case 0 if words:
                words[chance.randrange(len(words))] = chance.choice(WORDS)
                lines[at] = " ".join(words)
            case 1:
                lines.insert(at, chance.choice(WORDS))
            case 2:
                del lines[at]
                lines.append("M30")
            case _:
                lines[at] += " " + chance.choice(WORDS)
    return chance.choice(("\n", "\r\n")).join(lines).encode("utf-8", errors="replace")


FILES = {"program.nc": make_program}
